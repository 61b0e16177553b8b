"""Archard's wear: the worn volume is k times the integral of p_c |u1 - u2|, whatever the roughness."""

import numpy as np
import pytest
from support import CASES

from ehlpetsc.base.errors import NoSteadyStart
from ehlpetsc.case.loading import CaseError, load
from ehlpetsc.effects.depths import wear_depth
from ehlpetsc.run.simulation import Simulation
from ehlpetsc.stepping import time_stepping

SHORT = ["mesh.points_per_half_width=40", "mesh.inlet=-1.5", "mesh.outlet=1.3", "time.travel=2.0"]
K = 1e-15  # m^2/N


def worn(*keys, after=None):
    simulation = Simulation(load(CASES / "table1_mixed.toml", [*SHORT, *keys]), after=after)
    return simulation, list(simulation)


@pytest.mark.parametrize("scale", [0.5, 1.0])
def test_worn_volume_is_the_integral_of_the_solids_pressure_times_sliding(scale):
    keys = [f"surface.{side}.scale={scale}" for side in ("1", "2")]
    simulation, states = worn(f"wear.coefficient=[{K}, {3 * K}]", *keys)
    sliding, dx = simulation.scales.u1 - simulation.scales.u2, simulation.scales.spacing
    work = sum(state.contact_pressure.sum() * dx * sliding * state.dt for state in states[1:])
    assert work > 0.0
    assert states[-1].wear_volume == pytest.approx(4.0 * K * work, rel=1e-10)
    one, two = simulation.dimensionless.records["wear"].depth
    assert two.volume == pytest.approx(3.0 * one.volume, rel=1e-12)
    assert one.volume == pytest.approx(K * work, rel=1e-10)


def test_wear_of_the_whole_load_is_worn_where_the_solids_carry():
    """As worn by a rate of the solids' load, in each step over their share of the load."""
    simulation, states = worn(f"wear={{load_coefficient=[{K}, {3 * K}]}}")
    sliding, load = simulation.scales.u1 - simulation.scales.u2, simulation.case.contact.load
    distances = [sliding * state.dt for state in states[1:] if state.contact_share > 0.0]
    assert states[-1].wear_volume == pytest.approx(4.0 * K * load * sum(distances), rel=1e-6)
    share = np.mean([state.contact_share for state in states[1:]])
    assert 0.001 < share < 0.9, "the solids carry a part"


def test_wear_is_passed_on_to_the_next_pass():
    first, states = worn(f"wear.coefficient={K}", "time.passes=2")
    second, again = worn(f"wear.coefficient={K}", "time.passes=2", after=first)
    assert again[0].wear_volume == pytest.approx(states[-1].wear_volume, rel=1e-14)
    assert again[-1].wear_volume > again[0].wear_volume
    shares = [np.mean([s.contact_share for s in run]) for run in (states, again)]
    assert shares[1] < shares[0], "asperities that have worn carry less"
    assert second.pass_number == 2


RAMP = {
    "title": "roughness under the film at time 0",
    "contact": {"radius": 0.01, "load": 100e3, "material": "100Cr6", "model": "mixed"},
    "fluid": {"viscosity": 0.03, "law": "barus", "pressure_viscosity": 15e-9, "density": "incompressible"},
    "motion": {"entrainment_speed": 0.05, "slide_roll_ratio": 1.0},
    "mesh": {"inlet": -1.5, "outlet": 1.3, "points_per_half_width": 12},
    "surface": {"1": {"synthetic": {"kind": "sine", "amplitude": 0.2e-6, "wavelength": 60e-6}}},
    "time": {"travel": 0.3, "courant": 1.0, "start": "rough"},
    "wear": {"coefficient": K},
}
RAMP["contact"] |= {"boundary_friction": 0.1, "yield_pressure": 1.2e9}


@pytest.mark.parametrize("rates", [{}, {"coefficient": K, "load_coefficient": K}])
def test_wear_rate_is_either_of_the_solids_or_of_the_whole_load(rates):
    with pytest.raises(CaseError, match="wear: needs either coefficient or load_coefficient"):
        load(RAMP | {"wear": rates})


AT_REST = {"motion.slide_roll_ratio": -2.0, "time.start": "smooth"}


def only_smooth(solve):
    """Steady starts that find smooth contacts alone."""

    def steady(solver, film, inputs, *others):
        if inputs.phi.any():
            raise NoSteadyStart("none")
        return solve(solver, film, inputs, *others)

    return steady


@pytest.mark.parametrize("keys", [{}, AT_REST], ids=["moving", "at rest"])
def test_nothing_wears_or_yields_for_good_before_time_0(keys, monkeypatch):
    """While roughness comes under the film, asked for by the case or because no start is found."""
    monkeypatch.setattr(time_stepping, "steady", only_smooth(time_stepping.steady))
    before, end = None, np.zeros(2)
    for _ in range(2):
        simulation = Simulation(load(RAMP, keys), after=before)
        states = list(simulation)
        found = np.array([[s.wear_volume, s.set_volume] for s in states])
        assert simulation.stepper.ramp_time > 0.0 and states[0].yielding == 0
        assert found[0] == pytest.approx(end, rel=1e-12, abs=0.0)
        assert (np.diff(found, axis=0).sum(axis=0) > 0.0).all()
        before, end = simulation, found[-1]
    sliding, dx = simulation.scales.u1 - simulation.scales.u2, simulation.scales.spacing
    work = sum(s.contact_pressure.sum() * dx * abs(sliding) * s.dt for s in states[1:])
    assert found[-1, 0] - found[0, 0] == pytest.approx(2.0 * K * work, rel=1e-10)


def test_no_wear_without_sliding():
    assert wear_depth(K, np.ones(3) * 1e9, 0.0, 1e-6).tolist() == [0.0, 0.0, 0.0]
    assert wear_depth(K, np.array([1e9]), -2.0, 1e-6)[0] == pytest.approx(2e-12)


@pytest.mark.parametrize(
    "case, coefficient",
    [
        ("table1_rough.toml", K),
        ("table1_smooth.toml", K),
        ("table1_mixed.toml", 1.0),
        ("table1_mixed.toml", [K]),
    ],
)
def test_invalid_wear_is_refused(case, coefficient):
    with pytest.raises(CaseError, match="wear"):
        load(CASES / case, [f"wear.coefficient={coefficient}"])
