"""The Jacobian against differences of the residual; vectors of the Krylov method; block LU."""

from dataclasses import dataclass

import numpy as np
import petsc4py
import pytest
from support import CASES

petsc4py.init([])

from petsc4py import PETSc

from ehlpetsc.case.loading import load
from ehlpetsc.discretisation.film_history import FilmHistory
from ehlpetsc.discretisation.line.curvature_product import BLOCK
from ehlpetsc.discretisation.unknowns import Unknowns, q_of, w_index, w_of
from ehlpetsc.nonlinear.line.banded_jacobian import FILMS, GROUP, TERMS
from ehlpetsc.nonlinear.line.block_lu import (
    FROM_LEFT,
    FROM_RIGHT,
    LEFT,
    RIGHT,
    ROW_WIDTH,
    SIZE,
    STRIDE,
    BlockLU,
    backward_transposed,
    forward,
)
from ehlpetsc.nonlinear.line.exchange import LINEAR_TOLERANCE, collective
from ehlpetsc.nonlinear.line.gmres import MAX_IT, orthonormalise
from ehlpetsc.nonlinear.line.jacobian import PIVOT_REGULARISATION, JacobianOperator, NearFieldMatrix
from ehlpetsc.nonlinear.line.system import line_system
from ehlpetsc.nonlinear.newton import NewtonSolver
from ehlpetsc.nonlinear.two_fields import python_matrix
from ehlpetsc.physics.film_formulas import expected_film
from ehlpetsc.physics.scales import Scales

MESH = ["mesh.points_per_half_width=24", "mesh.inlet=-1.5", "mesh.outlet=1.3"]
ALONE, BESIDE = [20, 30, 47], 31  # nodes that touch; one beside another of them
H00 = -0.3
MIXED, YIELDING = "contact.model='mixed'", "contact.yield_pressure=1.05e9"
LAYER = [MIXED, "contact.asperity_height=2e-9", "contact.asperity_stiffness=1.0"]
HARD = ["contact.asperity_hardness=2e11", "contact.adsorbed_film=1e-9"]
SCENES = {
    "direct": ("table1_smooth.toml", []),
    "direct over 1 nm": ("table1_smooth.toml", ["contact.minimum_film=1e-9"]),
    "mixed": ("table1_smooth.toml", [MIXED]),
    "yielding": ("table1_smooth.toml", [MIXED, YIELDING]),
    "dry, yielding": ("dry_hertz.toml", [MIXED, YIELDING]),
    "compliant": ("table1_smooth.toml", LAYER),
    "compliant, hard, adsorbed film": ("table1_smooth.toml", [*LAYER, *HARD]),
    "dry, compliant": ("dry_hertz.toml", LAYER),
    "compliant, yielding": ("table1_smooth.toml", [*LAYER, YIELDING]),
    "dry, compliant, yielding": ("dry_hertz.toml", [*LAYER, YIELDING]),
    "starved": ("table1_smooth.toml", ["fluid.inlet_film=1e-7"]),
    "dry": ("dry_hertz.toml", []),
}


@dataclass
class Scene:
    solver: NewtonSolver
    state: np.ndarray  # interleaved
    inputs: object
    touching: list

    def residual(self, state):
        system = self.solver.system
        n = system.n
        unknowns = Unknowns(q_of(state, n).copy(), w_of(state, n).copy(), state[-1:])
        model = self.inputs.contact or system.problem.model
        sums = system.problem.deflection.sums(model.state(unknowns.q, unknowns.w).pressure)
        return system.problem.evaluate(unknowns, self.inputs, sums).residual.copy()


def scene(name):
    """A solver at an uneven state: oil, a cavity behind it, solids that touch, roughness, a past."""
    file, extra = SCENES[name]
    case = load(CASES / file, MESH + extra)
    scales = Scales.of(case)
    film = expected_film(case, scales)
    system = line_system(case, scales, film, PETSc.COMM_SELF)
    solver = NewtonSolver(system)
    rng, n, problem = np.random.default_rng(2), scales.nx, system.problem
    q = np.sqrt(np.maximum(1.05 - scales.x**2, 0.01)) * rng.uniform(0.5, 1.2, n)
    w = film * rng.uniform(0.3, 3.0, n)
    if problem.fluid is not None:
        q[scales.x > 1.02] = rng.uniform(-0.8, -0.1, (scales.x > 1.02).sum())
    # two nodes side by side without any film are a kink: the limiter of the upwind flux
    touching = ALONE if solver.bound == 0.0 and problem.fluid is not None else [*ALONE, BESIDE]
    w[touching] = system.model.w_from_state(np.zeros(1), np.full(1, 0.4))
    history = None
    if problem.fluid is not None:
        m = problem.mass_per_area(q, w)
        history = FilmHistory(*(m * rng.uniform(0.6, 1.6, n) + 1e-6 for _ in range(2)), 0.01, 0.012)
    state = np.append(np.stack([q, w], axis=1).ravel(), H00)
    return Scene(solver, state, problem.inputs(1e-5 * rng.standard_normal(n), history), sorted(touching))


def differences(at, direction, step):
    """Derivative of the residual along a direction, second order; to one side, where films may not fall."""
    f = [at.residual(at.state + k * step * direction) for k in range(3)]
    return (-3.0 * f[0] + 4.0 * f[1] - f[2]) / (2.0 * step)


def linearised(at):
    """The system with its Jacobian at the state, as SNES asks for it."""
    system, n = at.solver.system, at.solver.system.n
    system.set_initial_guess(Unknowns(q_of(at.state, n), w_of(at.state, n), at.state[-1:]), at.inputs)
    at.solver.snes.computeJacobian(system.x, system.operator, system.preconditioned)
    return system


def columns_of(matrix, size):
    """A PETSc matrix as a dense array, by products with unit vectors."""
    v, out = matrix.createVecs()
    dense = np.empty((size, size))
    for column in range(size):
        v.set(0.0)
        v.array[column] = 1.0
        matrix.mult(v, out)
        dense[:, column] = out.array_r
    return dense


@pytest.mark.parametrize("name", SCENES)
def test_jacobian_columns_equal_residual_differences(name):
    at = scene(name)
    system, size = linearised(at), len(at.state)
    w = w_of(at.state, system.n)
    np.testing.assert_array_equal(np.flatnonzero(system.model.contact_mask(w, np.zeros_like(w))), at.touching)
    found = columns_of(system.operator, size)
    for column in range(size):
        scale = max(abs(at.state[column]), 1e-2 * system.problem.film_scale)
        unit = np.zeros(size)
        unit[column] = 1.0
        expected = differences(at, unit, 1e-5 * scale)
        largest = np.abs(found[:, column]).max()
        np.testing.assert_allclose(found[:, column], expected, rtol=1e-5, atol=1e-6 * largest, err_msg=column)


@pytest.mark.parametrize("name", ["direct", "mixed", "dry"])
def test_assembled_jacobian_equals_the_operator(name):
    """What other preconditioners get: with a near field as wide as the mesh, the Jacobian, regularised."""
    at = scene(name)
    system, size = linearised(at), len(at.state)
    problem, jacobian = system.problem, system.jacobian
    exact = JacobianOperator(problem, system.exchange.halo, system.ranks, None)
    exact.linearise(system.evaluation(system.x))
    exact = python_matrix(exact, system.x.getSizes(), PETSc.COMM_SELF)
    matrix = PETSc.Mat().createAIJ((size, size), comm=PETSc.COMM_SELF)
    NearFieldMatrix(problem, problem.n, matrix).fill(jacobian.state, jacobian.reynolds_derivatives)
    assembled, whole = columns_of(matrix, size), columns_of(exact, size)
    added = np.diag(assembled - whole)
    np.testing.assert_allclose(assembled - np.diag(added), whole, rtol=1e-9, atol=1e-12 * np.abs(whole).max())
    blind = jacobian.state.p_q == 0.0
    assert blind.any() == (problem.fluid is not None)
    np.testing.assert_allclose(q_of(added, problem.n), np.where(blind, PIVOT_REGULARISATION, 0.0), atol=1e-9)
    np.testing.assert_allclose(w_of(added, problem.n), 0.0, atol=1e-9)
    # the product inside GMRES has the far kernel to its own tolerance
    far = LINEAR_TOLERANCE * problem.deflection.curvature[BLOCK + 1]
    far *= np.abs(jacobian.state.p_w).max(initial=1.0)
    np.testing.assert_allclose(columns_of(system.operator, size), whole, rtol=0, atol=far)


@pytest.mark.parametrize("name", ["direct", "mixed"])
def test_restricted_operator_is_a_block_of_the_jacobian(name):
    """What SNESVI keeps of the system."""
    at = scene(name)
    system, size = linearised(at), len(at.state)
    active_dofs = np.setdiff1d(np.arange(size), w_index(np.array(at.touching))).astype(np.int32)
    block = system.operator.createSubMatrix(PETSc.IS().createGeneral(active_dofs, comm=PETSc.COMM_SELF))
    expected = columns_of(system.operator, size)[np.ix_(active_dofs, active_dofs)]
    np.testing.assert_allclose(columns_of(block, len(active_dofs)), expected, rtol=1e-12)
    context = block.getPythonContext()
    np.testing.assert_array_equal(context.inactive_nodes, at.touching)


LENGTH, VECTORS = 300, 4


@pytest.mark.parametrize("left", [1.0, 1e-3, 1e-6, 1e-10, 1e-13])
def test_krylov_remainder_is_orthonormal_with_exact_norm(left):
    """A preconditioner that is nearly exact leaves little; by differences alone 1e-8 would be rounding."""
    rng = np.random.default_rng(1)
    basis = np.linalg.qr(rng.standard_normal((LENGTH, VECTORS + 1)))[0].T
    v, products = np.zeros((MAX_IT + 1, LENGTH)), rng.standard_normal(VECTORS)
    v[:VECTORS], v[VECTORS] = basis[:-1], products @ basis[:-1] + left * basis[-1]
    column, sums = np.zeros(MAX_IT + 1), np.zeros((1, MAX_IT + 2))
    norm = orthonormalise(v, VECTORS, column, sums, 0, collective(PETSc.COMM_SELF.tompi4py()))
    assert norm == pytest.approx(left, rel=1e-7 + 1e-15 / left)
    np.testing.assert_allclose(column[:VECTORS], products, rtol=0, atol=1e-14)
    products = v[: VECTORS + 1] @ v[: VECTORS + 1].T
    np.testing.assert_allclose(np.diag(products), 1.0, rtol=1e-7)
    np.testing.assert_allclose(np.tril(products, -1), 0.0, atol=1e-11)


@pytest.mark.parametrize("value", [0.0, np.nan])
def test_zero_and_nan_remainders(value):
    v, sums = np.zeros((MAX_IT + 1, LENGTH)), np.zeros((1, MAX_IT + 2))
    v[0, 0], v[1] = 1.0, value
    norm = orthonormalise(v, 1, np.zeros(MAX_IT + 1), sums, 0, collective(PETSc.COMM_SELF.tompi4py()))
    np.testing.assert_equal(norm, value)


def by_columns(rows):
    columns = np.zeros((len(rows), ROW_WIDTH, STRIDE))
    columns[:, :, :SIZE] = rows.transpose(0, 2, 1)
    return columns


def solved(lu, b, first=0):
    """Solution for `b` (groups, SIZE), independent of the padding between groups."""
    room = np.full((len(b), STRIDE), 7.0)
    room[:first], room[:, :SIZE] = 0.0, b
    lu.solve(room.ravel(), first)
    return room[:, :SIZE]


def dense(rows):
    groups = len(rows)
    matrix = np.zeros((groups * SIZE, (groups + 2) * SIZE))
    for i, row in enumerate(rows):
        here, before, behind = (np.arange(SIZE) + (i + k) * SIZE for k in (1, 0, 2))
        at = np.concatenate([before[FROM_LEFT:], here, behind[FROM_RIGHT : FROM_RIGHT + RIGHT]])
        matrix[i * SIZE : (i + 1) * SIZE, at] = row
    return matrix[:, SIZE:-SIZE]


def test_sizes_of_blocks_and_finite_solutions_of_singular_ones():
    assert SIZE == TERMS + 2 * GROUP
    assert LEFT == TERMS + GROUP + 2  # sums, pressures and, upwind, two films
    assert RIGHT == LEFT and FROM_RIGHT == SIZE - FROM_LEFT - RIGHT  # the same from the right end
    assert len(FILMS) == GROUP
    assert STRIDE == 12 >= SIZE  # what take_off takes off
    rows = np.random.default_rng(3).standard_normal((4, SIZE, ROW_WIDTH))
    rows[2, 5] = 0.0
    rows[1, :, LEFT + 4] = 0.0
    rows[0, :, LEFT + SIZE + 4 - FROM_RIGHT] = rows[2, :, 4 - FROM_LEFT] = 0.0
    lu, b = BlockLU(4), np.ones((4, SIZE))
    lu.factor(by_columns(rows))
    assert np.isfinite(solved(lu, b)).all()


@pytest.mark.parametrize("groups", [1, 2, 30])
@pytest.mark.parametrize("sparse", [False, True])
def test_block_lu_solves(groups, sparse):
    """Without dominance of the diagonal, so that rows are exchanged; `sparse`: with zeros there too."""
    rng = np.random.default_rng(groups)
    rows = rng.standard_normal((groups, SIZE, ROW_WIDTH))
    if sparse:
        rows[rng.random(rows.shape) < 0.6] = 0.0
        rows[:, np.arange(SIZE), LEFT + (np.arange(SIZE) + 1) % SIZE] = 3.0
    lu, matrix = BlockLU(groups), dense(rows)
    lu.factor(by_columns(rng.standard_normal(rows.shape)))  # what it leaves must not matter
    lu.factor(by_columns(rows))
    for first in {0, groups // 2, groups - 1}:
        b = rng.standard_normal((groups, SIZE))
        b[:first] = 0.0
        expected = np.linalg.solve(matrix, b.ravel())
        found = solved(lu, b, first)
        solution, coefficients = np.zeros((2, groups, STRIDE))
        solution[:, :SIZE], coefficients[:, :SIZE] = b, rng.standard_normal(b.shape)
        forward(lu.factors, solution.ravel(), first)
        product = (coefficients[:, :SIZE] * found).sum()
        rows = np.stack([coefficients.ravel(), 2.0 * coefficients.ravel(), -coefficients.ravel()])
        backward_transposed(lu.factors[2], rows)  # the same sums over what is not substituted yet
        expected_sums = pytest.approx(np.array([1.0, 2.0, -1.0]) * product, rel=1e-6, abs=1e-6)
        assert rows @ solution.ravel() == expected_sums
        np.testing.assert_allclose(found.ravel(), expected, rtol=0, atol=1e-8 * np.abs(expected).max())
