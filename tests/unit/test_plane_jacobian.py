"""Jacobian of contacts in the plane against differences of the residual; its preconditioner."""

import numpy as np
import petsc4py
import pytest

petsc4py.init([])

from petsc4py import PETSc
from scipy.sparse import bsr_matrix
from support.points import point

from ehlpetsc.base.errors import SolveFailed, UsageError
from ehlpetsc.case.loading import load
from ehlpetsc.discretisation import reynolds
from ehlpetsc.discretisation.contact.node_state import limit_cavitation, open_cavity
from ehlpetsc.discretisation.film_history import FilmHistory
from ehlpetsc.discretisation.finite_volumes import STENCIL
from ehlpetsc.discretisation.unknowns import Unknowns
from ehlpetsc.elasticity.half_space import free_kernel
from ehlpetsc.nonlinear.newton import NewtonSolver
from ehlpetsc.nonlinear.options import RunOptions
from ehlpetsc.nonlinear.plane import step_limit
from ehlpetsc.nonlinear.plane.coarse_space import CoarseSpace
from ehlpetsc.nonlinear.plane.held_films import HeldFilms, settle, solution
from ehlpetsc.nonlinear.plane.preconditioner import Elimination, SparseForm
from ehlpetsc.nonlinear.plane.reduction import BOUND, reduction_of
from ehlpetsc.nonlinear.plane.screened_poisson import MIDDLE, fill, neighbour
from ehlpetsc.nonlinear.plane.system import plane_system
from ehlpetsc.physics.film_formulas import expected_film
from ehlpetsc.physics.scales import Scales

SLIDING = {"motion.slide_roll_ratio": 0.3}
EYRING = SLIDING | {"fluid.eyring_stress": 4e6, "fluid.eyring_stress_pressure": 1e-9}
LAYER = {"contact.boundary_film": None, "contact.asperity_height": 20e-9}
STRIP = {"contact.radius": 0.0125, "contact.load": 2e5, "mesh.width": 0.6}
SCENES = {
    "rolling": {},
    "eyring": EYRING,
    "eyring, rolling": {"fluid.eyring_stress": 4e6},
    "carreau": SLIDING | {"fluid.carreau_stress": 4e6, "fluid.carreau_exponent": 0.5},
    "layer": EYRING | LAYER,
    "yielding": {"contact.yield_pressure": 0.25e9},
    "yielding layer": LAYER | {"contact.yield_pressure": 0.25e9},
    "starved": {"fluid.inlet_film": 2e-7},
    # of a film without thickness the extrapolation of the storage has a kink
    "direct": {"contact.model": "direct", "contact.boundary_film": None, "contact.minimum_film": 1e-9},
    "dry": {"fluid": None, "motion": None},
    "strip": STRIP | EYRING,
    "approach": {"contact.load": None, "contact.approach": 2e-6},
    "tilt": {"contact.self_aligning": True},
    "spinning": EYRING | {"motion.spin": [40.0, -10.0], "contact.groove_radius": 0.02},
}


def scene(name):
    """System of a coarse mesh, a state with cavities and contacts, inputs of a time step."""
    changes = dict(SCENES[name])
    tables = point(50.0, 5.0, 8, {k: v for k, v in changes.items() if "." in k})
    for key in ("fluid", "motion"):
        if key in changes:
            tables.pop(key)
    case = load(tables)
    scales = Scales.of(case)
    film = expected_film(case, scales)
    system = plane_system(case, scales, film, PETSc.COMM_SELF)
    problem, grid, rng = system.problem, scales.grid, np.random.default_rng(3)
    p = np.sqrt(np.maximum(1.0 - grid.distance**2, 0.0)) + 1e-3
    q = np.where(rng.random(grid.n) < 0.1, -0.3 * rng.random(grid.n), p * (0.8 + 0.2 * rng.random(grid.n)))
    h = film * (1.0 + 0.3 * rng.random(grid.n)) + np.maximum(grid.distance - 1.0, 0.0) ** 1.5
    touching = (grid.distance < 0.8) & (rng.random(grid.n) < 0.15)
    q[touching] = np.abs(q[touching])  # no void between solids
    w = problem.model.w_from_state(np.where(touching, 0.0, h), np.where(touching, 0.3, 0.0))
    history = None
    if case.fluid is not None:
        m = problem.mass_per_area(np.abs(q), np.abs(w) + film)
        history = FilmHistory(m, 0.9 * m, 0.02, 0.02, follows_path=not scales.across.varies)
    inputs = problem.inputs(history=history)
    return system, Unknowns(q, w, problem.balance.uniform(-0.8)), inputs


@pytest.mark.parametrize("name", SCENES)
def test_product_equals_differences(name):
    system, state, inputs = scene(name)
    NewtonSolver(system, RunOptions(kind="point"))
    system.set_initial_guess(state, inputs)
    vector, rng = system.x.array.copy(), np.random.default_rng(1)
    system.linearise(system.x)
    product = system.x.duplicate()
    direction = rng.standard_normal(len(vector)) * np.maximum(np.abs(vector), 1e-3)
    change = system.x.duplicate()
    change.array[:] = direction
    system.operator.mult(change, product)
    found, rows = [], product.array.copy()
    for step in (4e-6, 8e-6):
        ends = []
        for sign in (1.0, -1.0):
            system.x.array[:] = vector + sign * step * direction
            ends.append(system.evaluate(system.x).residual.copy())
        found.append((ends[0] - ends[1]) / (2.0 * step))
    expected = (4.0 * found[0] - found[1]) / 3.0
    scale = np.abs(expected).reshape(-1)[: 2 * system.n].reshape(-1, 2).max(axis=0)
    error = np.abs(rows - expected)[: 2 * system.n].reshape(-1, 2) / scale
    # the table of Carreau's law interpolates derivatives by themselves
    assert error.max() < (3e-7 if name == "carreau" else 1e-7)
    np.testing.assert_allclose(rows[2 * system.n :], expected[2 * system.n :], rtol=1e-7)


@pytest.fixture
def complete(monkeypatch):
    """Complete factors of the sparse form in place of incomplete ones."""
    build = Elimination._build
    monkeypatch.setattr(Elimination, "_build", lambda self, *given: build(self, *given, True))


@pytest.mark.parametrize("name", ("rolling", "eyring", "layer", "strip", "tilt"))
def test_preconditioner_with_exact_factors_is_nearly_the_inverse(name, complete):
    system, state, inputs = scene(name)
    options = RunOptions(of_call={"ksp_rtol": "1e-6"}, kind="point")
    solver = NewtonSolver(system, options)
    system.set_initial_guess(state, inputs)
    system.linearise(system.x)
    system.operator.assemble()
    ksp = solver.snes.ksp
    ksp.setOperators(system.operator)
    b, x = system.x.duplicate(), system.x.duplicate()
    b.array[:] = np.random.default_rng(2).standard_normal(len(b.array))
    ksp.solve(b, x)
    assert 0 < ksp.getIterationNumber() <= 40
    residual = b.duplicate()
    system.operator.mult(x, residual)
    assert (residual - b).norm() < 1.01e-6 * b.norm()


@pytest.mark.parametrize("name", ("layer", "direct", "dry"))
def test_krylov_iterations_in_the_plane_equal_those_of_petsc(name):
    system, state, inputs = scene(name)
    is_dry = system.problem.fluid is None
    found, b = [], np.random.default_rng(2).standard_normal(len(system.x.array))
    for of_call in ({}, {"ksp_type": "fgmres"}):
        solver = NewtonSolver(system, RunOptions(of_call=of_call, kind="point", is_dry=is_dry))
        system.set_initial_guess(state, inputs)
        system.linearise(system.x)
        system.operator.assemble()
        ksp, right, x = solver.snes.ksp, system.x.duplicate(), system.x.duplicate()
        ksp.setOperators(system.operator)
        right.array[:] = b
        ksp.setConvergenceHistory()
        ksp.solve(right, x)
        found.append((ksp.getConvergenceHistory(), x.array.copy()))
        assert ksp.getType() == of_call.get("ksp_type", "python")
    (mine, of_mine), (petscs, of_petscs) = found
    assert len(mine) == len(petscs) > 4
    np.testing.assert_allclose(mine, petscs, rtol=1e-9)
    np.testing.assert_allclose(of_mine, of_petscs, rtol=0.0, atol=1e-9 * abs(of_petscs).max())


def test_derivatives_of_one_state_at_a_time_are_kept(monkeypatch):
    system, state, inputs = scene("layer")
    solver, problem = NewtonSolver(system, RunOptions("mixed", kind="point")), system.problem
    evaluate, kept = problem.evaluate, []

    def watched(*given):
        kept.append(system.jacobian.reynolds_derivatives is not None or system._evaluation is not None)
        return evaluate(*given)

    monkeypatch.setattr(problem, "evaluate", watched)
    solver.solve(*solver.solve(state, inputs)[:1], inputs)
    solver.residual()
    assert len(kept) > 4 and not any(kept)
    assert system._evaluation is None and system.jacobian.derivatives is None


@pytest.mark.parametrize("name", ("layer", "strip", "starved"))
def test_properties_do_not_depend_on_the_blocks_that_are_computed_at_a_time(name, monkeypatch):
    system, state, inputs = scene(name)
    window = system.problem.share.window
    given = state.q[window], np.abs(state.w[window]), inputs.oil
    whole = system.problem.reynolds.properties(*given)
    monkeypatch.setattr(reynolds, "BLOCK", 100)
    np.testing.assert_array_equal(whole, system.problem.reynolds.properties(*given))


@pytest.mark.parametrize(("name", "value"), [("pc_type", "lu"), ("pc_python_type", "own.Preconditioner")])
def test_preconditioners_of_the_user_are_refused(name, value):
    with pytest.raises(UsageError, match=f"^-{name} {value}: a contact in the plane has a precond"):
        RunOptions(of_call={name: value}, kind="point")
    options = RunOptions(of_call={"pc_type": "python"}, kind="point")
    assert PETSc.Options(options.prefix)["pc_python_type"].endswith("EliminatedFilm")


def prepared(system, state, inputs):
    """Elimination with the factors of a state."""
    NewtonSolver(system, RunOptions(kind="point"))
    system.set_initial_guess(state, inputs)
    system.linearise(system.x)
    elimination = system.matrices.elimination
    elimination.prepare(system.jacobian)
    return elimination


def test_coarse_functions_around_an_isolated_node_are_independent():
    space = CoarseSpace(free_kernel(9, 9, 0.1, 0.1), False)
    assert space.spacing == 2
    mask = np.zeros((9, 9), dtype=bool)
    mask[:, 2:5] = mask[5, 7] = True  # the last one lies between four coarse nodes
    functions, kept = space.chosen(mask.ravel())
    assert functions.shape[1] == len(kept) == 10
    assert np.linalg.matrix_rank(functions.toarray()) == functions.shape[1]


def test_rows_of_nodes_without_a_balance_reach_neither_the_coarse_space_nor_a_pressure():
    """Of nodes at the bound of the film, whose Reynolds rows are not in the system."""
    system, state, inputs = scene("direct")
    bound = np.flatnonzero(system.problem.grid.distance < 0.8)[::5]
    elimination = prepared(system, state, inputs)
    system.jacobian.inactive_nodes = bound
    elimination.renew()
    elimination.prepare(system.jacobian)
    assert (elimination.factors.sparse.kind[bound] == BOUND).all() and elimination.factors.coarse
    rows, none = np.random.default_rng(5).standard_normal(system.n), np.zeros(system.n)
    (changed := rows.copy())[bound] += 1e3
    one, other = (elimination._pressures(system.jacobian, r, none)[0] for r in (rows, changed))
    np.testing.assert_array_equal(one, other)
    changed[bound + 1] += 1.0
    assert not np.array_equal(one, elimination._pressures(system.jacobian, changed, none)[0])


def test_solvers_of_one_process_have_options_of_their_own():
    table = PETSc.Options()
    table["ksp_max_it"] = "17"  # of the user
    try:
        point, line = RunOptions("mixed", {"snes_max_it": "7"}, kind="point"), RunOptions("direct")
        of_point, of_line = (PETSc.Options(one.prefix) for one in (point, line))
        assert [one.getInt("snes_max_it") for one in (of_point, of_line)] == [7, 30]
        assert [one.getInt("ksp_max_it") for one in (of_point, of_line)] == [17, 17]
        refinement = [one.hasName("ksp_gmres_cgs_refinement_type") for one in (of_point, of_line)]
        assert refinement == [True, False]
        assert point.given == {"snes_max_it": "7", "ksp_max_it": "17"}
        del point
        assert not of_point.hasName("snes_max_it") and of_line.hasName("snes_max_it")
        del line
        assert table.getAll() == {"ksp_max_it": "17"}
    finally:
        table.delValue("ksp_max_it")


@pytest.mark.parametrize("name", ("layer", "strip", "direct"))
def test_blocks_filled_in_place_are_those_of_the_matrix(name, complete):
    system, state, inputs = scene(name)
    elimination = prepared(system, state, inputs)
    form, p = elimination.factors.sparse, system.problem
    factors = form.factors
    blocks, nothing = np.zeros_like(factors.blocks), np.zeros(p.share.window_size, dtype=bool)
    reduction = reduction_of(system.jacobian.derivatives, nothing)
    whole = form._at_hand([part[p.owned] for part in reduction[:6]])
    scales = p.deflection.row_scale, *p.grid.increments
    rows = form.rows.start, form.rows.stop, factors.pointers, factors.places
    derivatives = system.exchange.window(system.jacobian.reynolds_derivatives)
    fill(tuple(whole), derivatives, form.term, scales, form.n_x, rows, blocks, form.of_rows)
    expected = bsr_matrix((blocks.transpose(0, 2, 1), factors.columns, factors.pointers))
    factors.b[:] = np.random.default_rng(4).standard_normal(factors.b.shape)
    factors.matrix.mult(factors.right, factors.left)
    np.testing.assert_allclose(factors.left.array, expected @ factors.right.array, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("name", ("layer", "direct"))
def test_own_incomplete_factors_are_those_of_petsc(name, request):
    """ILU(1) of the same order of nodes."""
    system, state, inputs = scene(name)
    rows = np.random.default_rng(9).standard_normal((2, system.n))
    own = prepared(system, state, inputs).factors.sparse.solve(*rows)
    request.getfixturevalue("complete")
    form = prepared(*scene(name)).factors.sparse
    of_petsc = PETSc.PC().create()
    of_petsc.setOperators(form.factors.matrix)
    of_petsc.setType("ilu")
    of_petsc.setFactorLevels(1)
    of_petsc.setFactorShift(PETSc.Mat.FactorShiftType.INBLOCKS)
    form.factors.pc = of_petsc
    for values, expected in zip(own, form.solve(*rows), strict=True):
        np.testing.assert_allclose(values, expected, atol=1e-4 * abs(expected).max())


@pytest.mark.parametrize(("nodes", "functions"), [(65, 22), (129, 22), (257, 33), (513, 47)])
def test_coarse_space_grows_as_the_root_of_the_nodes(nodes, functions):
    assert CoarseSpace(np.zeros((2, nodes)), False).counts[1] == functions


@pytest.mark.parametrize("name", ("layer", "strip", "starved", "spinning"))
def test_balance_of_single_cells_is_that_of_the_mesh(name):
    system, state, inputs = scene(name)
    problem, reynolds = system.problem, system.problem.reynolds
    window = problem.share.window
    q, film = state.q[window], problem.model.state(state.q, state.w).film[window]
    residual, derivatives = reynolds.evaluate(q, film, inputs)
    nodes = np.flatnonzero(np.arange(problem.n) % reynolds.n_x)[::-3].copy()
    rows, by = HeldFilms(reynolds, inputs, q, film).balance(nodes)
    scale = reynolds.film_scale
    np.testing.assert_allclose(rows / scale, residual[nodes], rtol=1e-11, atol=1e-11 * abs(residual).max())
    expected = derivatives[nodes, ::2]
    np.testing.assert_allclose(by[expected != 0.0] / scale, expected[expected != 0.0], rtol=1e-10)


@pytest.mark.parametrize("share", (0.15, 0.9))  # of the nodes: many islands; one
def test_islands_of_cells_are_solved_as_by_a_sparse_solver(share):
    (n_y, n_x), rng = (12, 17), np.random.default_rng(3)
    nodes = rng.permutation(np.flatnonzero(rng.random(n_y * n_x) < share))
    place = np.full(n_y * n_x, -1, dtype=np.int32)
    place[nodes] = np.arange(len(nodes))
    by, rows = rng.normal(size=(len(nodes), STENCIL)), rng.normal(size=len(nodes))
    mesh = n_x, n_y * n_x, False
    by[:, MIDDLE] += 12.0
    matrix = np.zeros((len(nodes), len(nodes)))
    for row, node in enumerate(nodes):
        for k in range(STENCIL):
            near = neighbour(node, k, mesh)
            if near >= 0 and place[near] >= 0:
                matrix[row, place[near]] += by[row, k]
    found = solution(nodes, by, mesh, place, rows)
    np.testing.assert_allclose(matrix @ found, rows, atol=1e-13)


def test_island_that_is_too_large_is_left():
    side = 100
    nodes = np.arange(side * side)
    by = np.tile(np.array([0.0, -1.0, 5.0, -1.0, -1.0, -1.0]), (side * side, 1))
    mesh, place = (side, side * side, False), nodes.astype(np.int32)
    assert not solution(nodes, by, mesh, place, np.ones(side * side)).any()


def test_settled_pressures_balance_thin_oil():
    system, state, inputs = scene("rolling")
    reynolds, rng = system.problem.reynolds, np.random.default_rng(7)
    inlet = np.arange(system.n) % reynolds.n_x < 8
    film = system.model.state(*state[:2]).film
    q = np.where(inlet, 0.01 + 0.02 * rng.random(system.n), state.q)
    wrong = np.flatnonzero(inlet & (np.arange(system.n) % reynolds.n_x > 2))[5::40].copy()
    cells = HeldFilms(reynolds, inputs, q, film)
    before = abs(cells.balance(wrong)[0]).max()
    settle(cells, q, wrong)
    assert abs(HeldFilms(reynolds, inputs, q, film).balance(wrong)[0]).max() < 1e-3 * before


def test_solve_after_one_whose_factors_failed(monkeypatch):
    """PETSc's preconditioner keeps a failed factorisation."""
    system, state, inputs = scene("layer")

    def linearise(x, is_evaluated=False):
        type(system).linearise(system, x, is_evaluated)
        system.jacobian.reynolds_derivatives = np.zeros_like(system.jacobian.reynolds_derivatives)

    options = RunOptions(kind="point")
    solver = NewtonSolver(system, options)
    with monkeypatch.context() as patched:
        patched.setattr(system, "linearise", linearise)
        with pytest.raises(SolveFailed):
            solver.solve(state, inputs)
    solver.solve(state, inputs)
    assert solver.snes.getFunctionNorm() < solver.tolerance


def test_complete_factors_follow_incomplete_ones_that_break_down(monkeypatch):
    """As with oil of 1e28 Pa s; for the rest of the solve."""
    (system, state, inputs), incomplete = scene("layer"), SparseForm.solve

    def solve(form, *rows):
        return incomplete(form, *rows) if form.is_complete else tuple(np.nan * row for row in rows)

    monkeypatch.setattr(SparseForm, "solve", solve)
    options = RunOptions(kind="point")
    solver = NewtonSolver(system, options)
    solver.solve(state, inputs)
    elimination = system.matrices.elimination
    assert solver.snes.getFunctionNorm() < solver.tolerance
    assert elimination.form.is_complete
    elimination.begin_solve()
    assert elimination.form is None


def test_pressures_are_settled_in_the_first_steps_of_each_solve(monkeypatch):
    """Later on it would keep a cycle alive, as of a node whose film gives way at once."""
    calls = []
    monkeypatch.setattr(step_limit, "settle", lambda cells, q, changed: calls.append(len(changed)))
    (system, state, inputs), counts = scene("rolling"), []
    for _ in range(2):
        system.set_initial_guess(state, inputs)
        system.evaluate(system.x)
        for _ in range(12):
            y = system.x.duplicate()
            y.array[2 * system.n // 3 // 2 * 2] = 0.05  # of a pressure
            system.limit_step(system.x, y)
        counts.append(len(calls))
    assert counts == [8, 16]


@pytest.mark.parametrize(
    ("q", "dq", "new"), [(-5e-14, 3e-14, -2e-12), (-5e-14, -3e-14, -2e-14), (-5e-14, 0.3, -0.3)]
)
def test_oil_at_the_ambient_pressure_that_would_be_lower_opens_a_cavity(q, dq, new):
    """Smaller steps would change no pressure: thick oil would creep towards its cavity for 30 iterations."""
    assert q - limit_cavitation(q, open_cavity(q, dq)) == pytest.approx(new, rel=1e-12)
