"""The convergence check accepts and refuses solutions independently of SNES; both contact models."""

import numpy as np
import pytest
from support import CASES

import ehlpetsc
from ehlpetsc.base.errors import NotConverged
from ehlpetsc.discretisation.unknowns import Unknowns
from ehlpetsc.stepping.convergence_check import find_fault

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


def test_solution_passes_the_convergence_check(solved):
    assert solved.stepper.solver.tolerance == pytest.approx(1e-7)
    assert fault(solved) is None


@pytest.mark.parametrize("model, tolerance", [("direct", 1e-5), ("mixed", 1e-7)])
def test_mixed_contact_has_looser_default_tolerances(model, tolerance):
    simulation = ehlpetsc.Simulation(
        ehlpetsc.load(CASES / "table1_smooth.toml", MESH | {"contact.model": model})
    )
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


def test_nan_tolerances_fail_the_check(solved):
    assert fault(solved, tolerance=np.nan) is not None


def test_unconverged_guess_is_rejected(solved, monkeypatch):
    def solve(guess, inputs, max_it=None, watch=None):
        solver = simulation.stepper.solver
        solver.tolerance = 1e-7
        solver.system.set_initial_guess(guess, inputs)
        return guess, 0

    simulation = ehlpetsc.Simulation(solved.case)
    monkeypatch.setattr(simulation.stepper.solver, "solve", solve)
    with pytest.raises(NotConverged, match=r"check: .* load is .* 1\.0e-07 after 0 "):
        simulation.advance()


@pytest.mark.parametrize(
    "options",
    [{"snes_convergence_test": "default"}, {"snes_convergence_test": "skip"}, {"snes_stol": "1e-3"}],
)
def test_user_convergence_test_replaces_the_check(solved, options):
    simulation = ehlpetsc.Simulation(solved.case, options=options)
    assert simulation.advance().h_min == pytest.approx(solved.state.h_min, rel=1e-6)
