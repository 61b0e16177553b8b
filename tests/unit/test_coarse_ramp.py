"""Rough start whose ramp is left to a coarser mesh."""

import numpy as np
import petsc4py
import pytest

petsc4py.init([])

from support.points import point

from ehlpetsc.base.errors import CaseError, NotConverged
from ehlpetsc.case.loading import load
from ehlpetsc.physics.scales import Scales
from ehlpetsc.run.simulation import Simulation
from ehlpetsc.stepping.time_stepping import TimeStepping


def tables(ramp):
    """Wavy surface that slides through a thick film, with the whole film renewed at the end."""
    case = point(50.0, 5.0, 12, {"motion.slide_roll_ratio": 0.3, "mesh.inlet": -1.6, "mesh.outlet": 1.3}, 3.0)
    a = Scales.of(load(case)).a
    wave = {"kind": "sine", "amplitude": 5e-9, "wavelength": a, "wavelength_across": a}
    time = {"travel": 3.5, "start": "rough", "ramp": ramp}
    return case | {"surface": {"1": {"synthetic": wave}}, "time": time}


def test_film_of_a_coarse_ramp_ends_as_that_of_a_fine_one_and_takes_a_few_of_its_steps():
    ends, counts = [], []
    for ramp in ("fine", "coarse"):
        simulation, shares = Simulation(load(tables(ramp))), []
        simulation.stepper.show_ramp(shares.append)
        films = [state.film_thickness for state in simulation]
        ends.append((films[0], films[-1]))
        counts.append(len(shares))
        assert shares[-1] == pytest.approx(1.0)
    assert counts == [12, 2]  # the coarse mesh takes 5 of 6
    (begin, end), (coarse_begin, coarse_end) = ends
    contact = end < 1.5 * np.median(end[end < 2.0 * end.min()])
    at_begin, at_end = (
        (abs(b / a - 1.0))[contact].max() for a, b in ((begin, coarse_begin), (end, coarse_end))
    )
    assert at_begin > 0.05  # it falls by ten in each 1.3 half-widths
    assert at_end < 1e-3


def test_mesh_does_the_ramp_itself_where_the_coarser_one_has_no_solution(monkeypatch):
    def fail_on_coarse(stepping, records, watch, guess, begun, left=0.0):
        if left:
            raise NotConverged("steady start")
        return ramped(stepping, records, watch, guess, begun, left)

    states, ramped = [], TimeStepping.ramped
    monkeypatch.setattr(TimeStepping, "ramped", fail_on_coarse)
    for ramp in ("fine", "coarse"):
        states.append(Simulation(load(tables(ramp))).advance())
    np.testing.assert_array_equal(states[1].pressure, states[0].pressure)


@pytest.mark.parametrize(
    "change", [{"time": {"travel": 1.0, "ramp": "coarse"}}, {"wear": {"coefficient": 1e-18}}]
)
def test_ramp_that_a_coarser_mesh_cannot_do_is_refused(change):
    case = load(tables("coarse") | change)
    with pytest.raises(CaseError, match='time.ramp = "coarse": allowed: in steps of a point contact'):
        Simulation(case)
