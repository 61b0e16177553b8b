"""What a time step keeps: order in unequal steps, signs of film and pressure, mass, the state if it fails."""

import numpy as np
import pytest
from support import CASES, roelands_oil

from ehlpetsc.base.errors import NotConverged, SolveFailed
from ehlpetsc.case.loading import load
from ehlpetsc.effects.effect import flat
from ehlpetsc.run.simulation import Simulation

WAVE = {
    "title": "A wave that passes",
    "contact": {"radius": 0.0125, "load": 1e5, "material": "100Cr6", "model": "mixed"},
    "fluid": roelands_oil(0.04, 22e-9) | {"eyring_stress": 6e6},
    "motion": {"entrainment_speed": 1.0, "slide_roll_ratio": 0.5},
    "mesh": {"inlet": -1.8, "outlet": 1.3, "points_per_half_width": 25},
    "surface": {"1": {"synthetic": {"kind": "sine", "amplitude": 0.05e-6, "wavelength": 150e-6}}},
    "time": {"travel": 3.0},
}


def film_after(pattern):
    """Film [m] at 0.9 of the travel, in steps of these lengths in turn, in nominal ones."""
    simulation = Simulation(load(WAVE))
    state, step, end = simulation.advance(), 0, 0.9 * simulation.end
    while (left := end - float(state.time)) > 1e-9 * end:
        state = simulation.advance(min(pattern[step % len(pattern)] * simulation.scales.dt, left))
        step += 1
    return np.asarray(state.film_thickness)[np.abs(simulation.scales.x) < 0.8]


def test_unequal_steps_are_as_accurate_as_equal_ones():
    """In a film wave of 60 nm; with the older step taken as long as the new one the error is 2.6 nm."""
    fine = film_after([0.25])
    equal, unequal = (np.abs(film_after(steps) - fine).max() for steps in ([0.75], [1.0, 0.5]))
    assert 0.3e-9 < equal < 1e-9 and unequal < 1.1 * equal


ROUGH = {
    "mesh": {"inlet": -1.4, "outlet": 1.3, "points_per_half_width": 32},
    "contact.model": "mixed",
    "contact.yield_pressure": 2e9,
    "wear.coefficient": 1e-15,
    "time.travel": 2.5,
    "fluid.viscosity": 0.001,
}


def test_any_steps_keep_the_signs_of_film_pressure_and_oil():
    """Under measured asperities, which reach the contact, in steps of .1 to 2.5 nominal ones."""
    simulation, random = Simulation(load(CASES / "table1_rough.toml", ROUGH)), np.random.default_rng(3)
    state, touched = simulation.advance(), 0
    while not simulation.finished:
        nominal = simulation.scales.dt * random.uniform(0.1, 2.5)
        state = simulation.advance(min(nominal, simulation.end - float(state.time)))
        now, touched = state.dimensionless, touched + state.contacts
        assert (
            min(state.film_thickness.min(), state.pressure.min(), state.contact_pressure.min(), now.m.min())
            >= 0
        )
        assert 0.0 <= state.void_fraction.min() and state.void_fraction.max() <= 1.0
        assert state.load_error < 1e-6 and state.mass_error < 1e-6
    assert touched > 5


def whole(state):
    """All arrays of a state, of its effects too."""
    records = {
        f"{name}.{key}": value
        for name, one in state.records.items()
        for key, value in flat(one, name).items()
    }
    return {"q": state.q, "w": state.w, "m": state.m, "m_older": state.m_older, "time": state.time} | records


def test_a_step_that_fails_leaves_the_state_as_it_was(monkeypatch):
    """The run then continues, to the last bit, as one without it."""
    ends = []
    for fails in (True, False):
        simulation = Simulation(load(CASES / "table1_rough.toml", ROUGH))
        for _ in range(30):
            simulation.advance()
        solver, before = simulation.stepper.solver, simulation.dimensionless
        kept = {key: np.array(value) for key, value in whole(before).items()}
        if fails:
            solve = solver.solve

            def given_up(*arguments, solve=solve, **named):
                solve(*arguments, **named)  # all of it, and then the solution is refused
                raise SolveFailed("SNES", "REFUSED", 3)

            with monkeypatch.context() as patch, pytest.raises(NotConverged, match="REFUSED"):
                patch.setattr(solver, "solve", given_up)
                simulation.advance()
            assert simulation.dimensionless is before
            for key, value in whole(before).items():
                np.testing.assert_array_equal(value, kept[key], err_msg=key)
        for _ in range(5):
            state = simulation.advance()
        ends.append(whole(state.dimensionless))
    for key, value in ends[0].items():
        np.testing.assert_array_equal(value, ends[1][key], err_msg=key)
