"""Newton's method around SNES: interruptions, bounds, options, failures; the check of convergence."""

import re

import numpy as np
import pytest
from support import CASES
from support.running import PYTHON, called

import ehlpetsc
from ehlpetsc.base.errors import NotConverged, UsageError
from ehlpetsc.discretisation.ehl_problem import EHLProblem
from ehlpetsc.discretisation.unknowns import Unknowns
from ehlpetsc.nonlinear.line.jacobian import JacobianOperator
from ehlpetsc.nonlinear.two_fields import TwoFields
from ehlpetsc.stepping.convergence_check import find_fault

# the inlet near the contact, thin oil: the asperities touch within few steps
TOUCHING_MESH = {"mesh.inlet": -1.2, "mesh.outlet": 1.3, "mesh.points_per_half_width": 40}
TOUCHING = TOUCHING_MESH | {"time.travel": 1.0, "time.courant": 1.0, "fluid.viscosity": 0.001}


class Interruption(Exception):
    """Raised by a watch."""


def interrupt():
    raise Interruption


def test_interruptions_keep_tolerances_and_results_and_options_belong_to_their_call():
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
    case = ehlpetsc.load(CASES / "table1_smooth.toml", {"mesh.points_per_half_width": 20})
    given = {"snes_vi_zero_tolerance": 1e-7, "snes_max_it": 12}
    ones, others = ehlpetsc.Simulation(case, options=given), ehlpetsc.Simulation(case)
    steppers = [simulation.stepper for simulation in (ones, others)]
    found = [(s.problem.model.bound_tolerance, s.solver.start_iterations()) for s in steppers]
    assert found == [(1e-7, 12), (1e-8, 210)]
    with pytest.raises(UsageError, match="-snes_vi_zero_tolerance much"):
        ehlpetsc.Simulation(case, options={"snes_vi_zero_tolerance": "much"})


def test_film_at_its_bound_is_a_domain_error(capfd):
    """PETSc's line search ends there, no residual is nan, and the step is solved with the bound."""
    case = ehlpetsc.load(CASES / "table1_rough.toml", TOUCHING)
    simulation = ehlpetsc.Simulation(case, options={"snes_converged_reason": None})
    states = list(simulation)
    assert any(state.in_contact.any() for state in states) and sum(state.retries for state in states) == 0
    lines = capfd.readouterr().out
    assert re.search("DIVERGED_(LINE_SEARCH|FUNCTION_DOMAIN)", lines) and "FNORM_NAN" not in lines


def test_krylov_iterations_equal_those_of_petsc(capfd):
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


MESH = {"mesh.points_per_half_width": 30, "mesh.inlet": -1.5, "mesh.outlet": 1.3}
CLOSED = 20  # a node that is put into contact
TIGHT = {"snes_atol": "1e-7"}


@pytest.fixture(scope="module", params=["direct", "mixed"])
def solved(request):
    case = ehlpetsc.load(CASES / "table1_smooth.toml", MESH | {"contact.model": request.param})
    simulation = ehlpetsc.Simulation(case, options=TIGHT)
    simulation.advance()
    return simulation


def fault(simulation, change=lambda q, w, rows: None, tolerance=None):
    """Fault of the solution once its copy is changed."""
    state, solver = simulation.dimensionless, simulation.stepper.solver
    rows = [np.copy(part) for part in solver.residual()]
    q, w = state.q.copy(), state.w.copy()
    change(q, w, rows)
    tolerance = solver.tolerance if tolerance is None else tolerance
    return find_fault(solver.problem, Unknowns(q, w, state.unknowns.border), rows, tolerance)


def test_solution_passes_the_convergence_check_and_an_unconverged_guess_does_not(solved, monkeypatch):
    assert solved.stepper.solver.tolerance == pytest.approx(1e-7)
    assert fault(solved) is None
    assert fault(solved, tolerance=np.nan) is not None

    def solve(guess, inputs, max_it=None, watch=None):
        solver = simulation.stepper.solver
        solver.tolerance = 1e-7
        solver.system.set_initial_guess(guess, inputs)
        return guess, 0

    simulation = ehlpetsc.Simulation(solved.case)
    monkeypatch.setattr(simulation.stepper.solver, "solve", solve)
    with pytest.raises(NotConverged, match=r"check: .* load is .* 1\.0e-07 after 0 "):
        simulation.advance()


@pytest.mark.parametrize("model, tolerance", [("direct", 1e-5), ("mixed", 1e-7)])
def test_mixed_contact_has_looser_default_tolerances(model, tolerance):
    case = ehlpetsc.load(CASES / "table1_smooth.toml", MESH | {"contact.model": model})
    simulation = ehlpetsc.Simulation(case)
    simulation.advance()
    assert simulation.stepper.solver.tolerance == pytest.approx(tolerance)


def put(which, node, value):
    def change(*parts):
        parts[which][node] = value

    return change


@pytest.mark.parametrize(
    "change, words",
    [
        (put(0, 3, np.nan), "not finite"),
        (put(1, 3, np.inf), "not finite"),
        (lambda q, w, rows: rows[0].fill(np.nan), "not finite"),
        (put(0, 3, -1.1), " -0.1 of "),
        (lambda q, w, rows: rows[0].__setitem__(9, 2e-7), "deflection is 2.00e-07, allowed: 1.0e-07"),
        (lambda q, w, rows: rows[0].__setitem__(9, 1.01e-7), "deflection is 1.01e-07, allowed: 1.0e-07"),
        (lambda q, w, rows: rows[1].__setitem__(9, -2e-7), "balance is 2.00e-07"),
        (lambda q, w, rows: rows[2].fill(2e-7), "load is 2.00e-07"),
    ],
)
def test_every_residual_has_its_tolerance(solved, change, words):
    assert words in fault(solved, change)


def test_contact_nodes_need_contact_pressure():
    case = ehlpetsc.load(CASES / "table1_smooth.toml", MESH)
    simulation = ehlpetsc.Simulation(case, options=TIGHT)
    simulation.advance()

    def touching(residual):
        def change(q, w, rows):
            w[CLOSED], rows[1][CLOSED] = 0.0, residual

        return change

    assert fault(simulation, touching(0.3)) is None  # Reynolds is left out there
    assert "residual is -2.00e-07" in fault(simulation, touching(-2e-7))
    assert " -1e-06 a^2/R below" in fault(simulation, put(1, CLOSED, -1e-6))


@pytest.mark.parametrize(
    "options",
    [{"snes_convergence_test": "default"}, {"snes_convergence_test": "skip"}, {"snes_stol": "1e-3"}],
)
def test_user_convergence_test_replaces_the_check(solved, options):
    simulation = ehlpetsc.Simulation(solved.case, options=options)
    assert simulation.advance().h_min == pytest.approx(solved.state.h_min, rel=1e-6)
