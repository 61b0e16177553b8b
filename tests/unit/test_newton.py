"""Newton's method around SNES: interruptions, films that reach their bound, options, failures."""

import re

import numpy as np
import pytest
from support import CASES
from support.running import PYTHON, called

import ehlpetsc
from ehlpetsc.base.errors import UsageError
from ehlpetsc.discretisation.ehl_problem import EHLProblem
from ehlpetsc.nonlinear.line.jacobian import JacobianOperator
from ehlpetsc.nonlinear.two_fields import TwoFields

# the inlet near the contact, thin oil: the asperities touch within few steps
TOUCHING_MESH = {"mesh.inlet": -1.2, "mesh.outlet": 1.3, "mesh.points_per_half_width": 40}
TOUCHING = TOUCHING_MESH | {"time.travel": 1.0, "time.courant": 1.0, "fluid.viscosity": 0.001}


class Interruption(Exception):
    """Raised by a watch."""


def interrupt():
    raise Interruption


def test_interruptions_keep_tolerances_and_results():
    case = ehlpetsc.load(CASES / "table1_rough.toml", TOUCHING | {"time.travel": 0.1})
    expected = list(ehlpetsc.Simulation(case))
    simulation = ehlpetsc.Simulation(case)
    solver = simulation.stepper.solver
    limit = solver.start_iterations()
    for state in expected:
        for _ in range(3):
            with pytest.raises(Interruption):
                simulation.advance(watch=interrupt)
            assert solver.start_iterations() == limit == 210
        found = simulation.advance()
        assert found.newton == state.newton
        np.testing.assert_array_equal(found.pressure, state.pressure)


def test_film_at_its_bound_is_a_domain_error(capfd):
    """PETSc's line search ends there, no residual is nan, and the step is solved with the bound."""
    case = ehlpetsc.load(CASES / "table1_rough.toml", TOUCHING)
    simulation = ehlpetsc.Simulation(case, options={"snes_converged_reason": None})
    states = list(simulation)
    assert any(state.in_contact.any() for state in states) and sum(state.retries for state in states) == 0
    lines = capfd.readouterr().out
    assert re.search("DIVERGED_(LINE_SEARCH|FUNCTION_DOMAIN)", lines) and "FNORM_NAN" not in lines


def test_krylov_iterations_equal_those_of_petsc(capfd):
    """In contact and out of it; PETSc's monitor and tolerances hold for both."""
    case = ehlpetsc.load(CASES / "table1_rough.toml", TOUCHING)
    found = []
    for options in ({}, {"ksp_type": "fgmres"}, {"ksp_rtol": 1e-10}):
        states = list(ehlpetsc.Simulation(case, options=options | {"ksp_monitor": None}))
        residuals = re.findall(r"(\d+) KSP Residual norm (\S+)", capfd.readouterr().out)
        found.append((states, [int(k) for k, _ in residuals], np.array([float(r) for _, r in residuals])))
    (mine, numbers, residuals), (petscs, their_numbers, their_residuals), (_, more, _) = found
    assert any(state.in_contact.any() for state in mine)
    assert numbers == their_numbers and sum(more) > 1.5 * sum(numbers)
    np.testing.assert_allclose(residuals, their_residuals, rtol=1e-6, atol=1e-9 * residuals.max())
    for one, other in zip(mine, petscs, strict=True):
        assert one.newton == other.newton
        np.testing.assert_allclose(one.pressure, other.pressure, rtol=0, atol=1e-9 * one.pressure.max())


def test_nan_in_a_linear_solve_halves_the_step(monkeypatch):
    simulation = ehlpetsc.Simulation(ehlpetsc.load(CASES / "table1_rough.toml", TOUCHING))
    simulation.advance()
    linearise, calls = JacobianOperator.linearise, []

    def faulty(operator, evaluation):
        linearise(operator, evaluation)
        calls.append(operator)
        if len(calls) <= 2:  # solved without the bound, then with it
            operator.reynolds_derivatives[:] = np.nan

    monkeypatch.setattr(JacobianOperator, "linearise", faulty)
    state = simulation.advance()
    assert state.retries == 1 and np.isfinite(state.pressure).all()


@pytest.mark.parametrize("model", ["direct", "mixed"])
def test_overflow_is_met_by_a_shorter_step(monkeypatch, model):
    """The first step, and one after it, have no finite residual until they are shorter."""
    case = ehlpetsc.load(CASES / "table1_smooth.toml", {"contact.model": model} | TOUCHING_MESH)
    expected = ehlpetsc.Simulation(case).advance()
    evaluate, begin, changes, failed = EHLProblem.evaluate, [], [], []

    def faulty(problem, unknowns, inputs, sums=None):
        evaluation = evaluate(problem, unknowns, inputs, sums)
        begin.append(unknowns.q.copy())
        change = np.abs(unknowns.q - begin[0]).max()
        changes.extend([change] if change > 0.0 else [])
        if change > 0.0 and len(failed) < 5 and change > 0.3 * changes[0]:
            failed.append(change)
            evaluation.residual[5] = np.nan
        return evaluation

    monkeypatch.setattr(EHLProblem, "evaluate", faulty)
    state = ehlpetsc.Simulation(case).advance()
    assert len(failed) == 5 and failed[1] < 0.6 * failed[0]
    np.testing.assert_allclose(state.pressure, expected.pressure, rtol=0, atol=1e-6 * expected.p_max)


FAULTY = """
import ehlpetsc
from ehlpetsc.nonlinear.line import gmres

def faulty(*arguments):
    raise ERROR("of a callback")

gmres.iterations = faulty
ehlpetsc.Simulation(ehlpetsc.load(CASE, {"mesh.points_per_half_width": 20})).advance()
"""


@pytest.mark.parametrize("error, status", [("ValueError", 1), ("KeyboardInterrupt", -2)])
def test_process_ends_after_an_error_inside_petsc(error, status):
    """The traceback keeps PETSc's objects alive, which PetscFinalize would destroy after Python's end."""
    script = FAULTY.replace("CASE", repr(str(CASES / "table1_smooth.toml"))).replace("ERROR", error)
    process = called([PYTHON, "-c", script], CASES)
    assert process.returncode == status and process.stderr.endswith(f"{error}: of a callback\n")


@pytest.mark.parametrize("options, expected", [({}, 5e-7), ({"snes_atol": 1e-8}, 1e-7)])
def test_rounding_raises_the_tolerance_of_a_layer_as_that_of_rigid_contact(monkeypatch, options, expected):
    """Slow oil trapped by a closed layer reaches no smaller residual; ten times a tolerance of the user."""
    layer = {"contact.model": "mixed", "contact.asperity_height": 10e-9, "mesh.points_per_half_width": 20}
    monkeypatch.setattr(TwoFields, "rounding", lambda system: 5e-7)
    simulation = ehlpetsc.Simulation(ehlpetsc.load(CASES / "table1_smooth.toml", layer), options=options)
    simulation.advance()
    assert simulation.stepper.solver.tolerance == pytest.approx(expected)


def test_options_belong_to_their_call():
    case = ehlpetsc.load(CASES / "table1_smooth.toml", {"mesh.points_per_half_width": 20})
    given = {"snes_vi_zero_tolerance": 1e-7, "snes_max_it": 12}
    ones, others = ehlpetsc.Simulation(case, options=given), ehlpetsc.Simulation(case)
    found = [
        (s.stepper.problem.model.bound_tolerance, s.stepper.solver.start_iterations()) for s in (ones, others)
    ]
    assert found == [(1e-7, 12), (1e-8, 210)]
    with pytest.raises(UsageError, match="-snes_vi_zero_tolerance much"):
        ehlpetsc.Simulation(case, options={"snes_vi_zero_tolerance": "much"})
