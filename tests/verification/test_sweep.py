"""The paper's sweeps against Newton's method: two iterations that share nothing but the equations agree.

Both solve a time step of cases/table1_rough.toml with contacts, of which rough_contacts.npz stores guess and
history; after a change of the case ``python3 tests/verification/test_sweep.py`` writes it anew.
"""

import itertools
from pathlib import Path

import numpy as np
import petsc4py
import pytest
from support import CASES

petsc4py.init([])

from support import sweeps
from support.sweeps import swept

from ehlpetsc.base.errors import SolveFailed
from ehlpetsc.case.loading import load
from ehlpetsc.discretisation.unknowns import Unknowns
from ehlpetsc.nonlinear.two_fields import ZERO_TOLERANCE
from ehlpetsc.run.simulation import Simulation
from ehlpetsc.stepping.state import State

STORED = Path(__file__).with_name("rough_contacts.npz")
STEP, CONTACTS = 434, [304, 305, 319, 369]


def simulations(name, *overrides):
    """One scene by Newton's method and by sweeps."""
    case = load(CASES / name, overrides)
    return [Simulation(case, options={"snes_atol": 1e-7}), swept(case, 1e-7)]


def assert_same(problem, newton, swept, rtol):
    """Alike to `rtol` at every node: films over 1e-3 of the expected one, pressures over 1e-3 p0."""
    floor = 1e-3 * rtol
    np.testing.assert_allclose(swept[1], newton[1], rtol=rtol, atol=floor * problem.film_scale)
    np.testing.assert_allclose(np.maximum(swept[0], 0.0), np.maximum(newton[0], 0.0), rtol=rtol, atol=floor)


@pytest.mark.slow
def test_sweeps_equal_newton():
    found = []
    with np.load(STORED) as stored:
        q, h, m, m_older = stored["levels"]
        h00, time, dt_older, dt = stored["scalars"]
    for simulation in simulations("table1_rough.toml"):
        stepper = simulation.stepper
        history = stepper.history(State(None, m=m, m_older=m_older, time=time, dt=dt_older), dt)
        scales, travelled = simulation.scales, simulation.operation.travelled(time + dt)
        phi = simulation.roughness.phi_after(scales.x * scales.a, travelled, scales.spacing) / scales.h
        inputs = stepper.problem.inputs(phi, history)
        found.append(stepper.solver.solve(Unknowns(q, h, np.array([h00])), inputs)[0])
    for _, film, _ in found:
        np.testing.assert_array_equal(np.flatnonzero(film <= ZERO_TOLERANCE), CONTACTS)
    assert_same(stepper.problem, *found, rtol=1e-5)
    assert found[1][2] == pytest.approx(found[0][2], rel=1e-5)


def test_sweeps_step_from_their_own_start():
    states = []
    for simulation in simulations("table1_rough.toml", "mesh.points_per_half_width=50"):
        for state in itertools.islice(simulation, 6):
            assert state.retries == 0
        states.append((state.dimensionless.q, state.dimensionless.h))
    assert_same(simulation.stepper.problem, *states, rtol=1e-5)


def test_load_balance_at_an_exit_film_of_150_nm():
    coarse = "mesh.points_per_half_width=50"
    both = simulations("table1_smooth.toml", coarse, "contact.minimum_film=150e-9")
    states = [simulation.advance().dimensionless for simulation in both]
    other = both[1].stepper
    bound = other.solver.bound
    assert states[1].h.min() == bound
    np.testing.assert_array_equal(states[1].h <= bound, states[0].h <= bound)
    assert_same(other.problem, *((state.q, state.h) for state in states), rtol=1e-5)
    load = other.problem.dx * states[1].p.sum()
    assert load == pytest.approx(0.5 * np.pi, rel=1e-7)


def test_sweeps_stop_at_the_evaluation_limit(monkeypatch):
    monkeypatch.setattr(sweeps, "MAX_EVALUATIONS", 2)
    stepper = simulations("table1_smooth.toml", "mesh.points_per_half_width=50")[1].stepper
    with pytest.raises(SolveFailed, match="MAX_IT after 2 "):
        ones = np.ones(stepper.problem.n)
        stepper.solver.solve(Unknowns(ones, ones, np.zeros(1)), stepper.problem.inputs())


def store():
    """Run the case to the step and keep what goes before it."""
    simulation, _ = simulations("table1_rough.toml")
    state = simulation.advance().dimensionless
    while state.step < STEP:
        before, state = state, simulation.advance().dimensionless
    levels = np.array([*simulation.stepper.guess(before, state.dt), before.m, before.m_older])
    scalars = before.unknowns.border[0], before.time, before.dt, state.dt
    print(state.step, np.flatnonzero(state.h <= ZERO_TOLERANCE))
    np.savez_compressed(STORED, levels=levels, scalars=scalars)


if __name__ == "__main__":
    store()
