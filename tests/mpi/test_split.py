"""The preconditioner solves the matrix that it stands for, on any number of ranks."""

from pathlib import Path

import numpy as np
import petsc4py

petsc4py.init([])

from petsc4py import PETSc

from ehlpetsc.case.loading import load
from ehlpetsc.discretisation.ehl_problem import ContactProblem
from ehlpetsc.nonlinear.preconditioner.banded_jacobian import LEAK, ExtendedBand
from ehlpetsc.nonlinear.preconditioner.exponential_kernel import GROUP, exponentials
from ehlpetsc.nonlinear.preconditioner.spike import SplitBand
from ehlpetsc.physics.film_formulas import expected_film
from ehlpetsc.physics.scales import Scales

CASE = Path(__file__).parents[2] / "cases" / "table1_smooth.toml"
MESH = ["mesh.points_per_half_width=32", "mesh.inlet=-1.5", "mesh.outlet=1.3"]
TOUCHING = np.array([20, 21, 40, 63])


def state(case, scales):
    """A rough pressure with cavities, a film that is thin and uneven."""
    rng = np.random.default_rng(1)
    p = np.sqrt(np.maximum(1.0 - scales.x**2, 0.0)) * rng.uniform(0.5, 1.5, scales.nx)
    q = np.where(p > 0.0, p, rng.uniform(-0.9, 0.1, scales.nx))
    return q, expected_film(case, scales) * rng.uniform(0.2, 3.0, scales.nx), 0.0


def problem_of(case, scales, first, last, at):
    problem = ContactProblem(case, scales, expected_film(case, scales), first, last)
    problem.residual(*at)
    return problem


def dense(problem, slope):
    """The matrix, its far deflection by exponentials; films of the touching nodes held."""
    n = problem.n
    matrix = np.zeros((2 * n + 1, 2 * n + 1))
    rates, weights = exponentials(problem.curvature, 1.0 / problem.dx)
    group = np.arange(n) // GROUP
    apart = np.abs(np.subtract.outer(group, group))
    kernel = np.exp(-apart[..., None] * rates) @ weights
    exact = problem.curvature[np.abs(np.subtract.outer(np.arange(n), np.arange(n)))]
    matrix[: 2 * n : 2, : 2 * n : 2] = -np.where(apart > 1, kernel, exact)
    for i in range(1, n - 1):
        matrix[2 * i, [2 * i - 1, 2 * i + 1, 2 * i + 3]] = np.pi / problem.dx * np.array([1.0, -2.0, 1.0])
    for end in (0, n - 1):
        matrix[2 * end, : 2 * n : 2] = problem.end_row(end)
        matrix[2 * end, [2 * end + 1, 2 * n]] = problem.end_scale, -problem.end_scale
    matrix[: 2 * n : 2, : 2 * n : 2] *= slope
    matrix[range(0, 2 * n, 2), range(0, 2 * n, 2)] += np.where(slope > 0.0, 0.0, LEAK)
    for i, row in enumerate(problem.flow_values):
        for k, node in enumerate(range(i - 2, i + 2)):
            if 0 <= node < n:
                matrix[2 * i + 1, [2 * node, 2 * node + 1]] = row[[2 * k, 2 * k + 1]]
    matrix[2 * TOUCHING + 1] = 0.0
    matrix[2 * TOUCHING + 1, 2 * TOUCHING + 1] = 1.0
    matrix[2 * n, : 2 * n : 2] = problem.dx * slope
    return matrix


def test_it_solves_its_matrix():
    case, ranks = load(CASE, MESH), PETSc.COMM_WORLD.tompi4py()
    scales = Scales.of(case)
    n, at = scales.nx, state(case, scales)
    assert n % GROUP  # the last group is not full
    cuts = [n // GROUP * k // ranks.size * GROUP for k in range(ranks.size)] + [n]
    first, last = cuts[ranks.rank], cuts[ranks.rank + 1]
    whole, part = problem_of(case, scales, 0, n, at), problem_of(case, scales, first, last, at)
    slope = whole.slope(at[0])
    right = np.random.default_rng(2).standard_normal(2 * n + 1)
    right[2 * TOUCHING + 1] = 0.0
    split = SplitBand(ExtendedBand(part), -part.end_scale, ranks)
    touching = TOUCHING[(TOUCHING >= first) & (TOUCHING < last)] - first
    kept = np.setdiff1d(np.arange(2 * (last - first)), 2 * touching + 1)
    split.factor(np.zeros(n), 3.0 * part.flow_values, touching[:0])  # what it leaves must not matter
    split.factor(slope, part.flow_values, touching)
    found, approach = split.solve(right[2 * first : 2 * last][kept], kept, right[-1] if last == n else 0.0)
    matrix = dense(whole, slope)
    expected = np.linalg.solve(matrix, right)
    scale = np.tile(np.abs(expected[:-1]).reshape(-1, 2).max(axis=0), last - first)
    np.testing.assert_allclose(found / scale, expected[2 * first : 2 * last] / scale, rtol=0, atol=1e-7)
    assert abs(approach / expected[-1] - 1.0) < 1e-7
