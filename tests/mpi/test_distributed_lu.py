"""The preconditioner solves the matrix that it stands for, on any number of ranks."""

from pathlib import Path

import numpy as np
import petsc4py
import pytest

petsc4py.init([])

from petsc4py import PETSc

from ehlpetsc.case.loading import load
from ehlpetsc.discretisation.unknowns import Unknowns
from ehlpetsc.nonlinear.line.banded_jacobian import GROUP, BandedJacobian, exponentials
from ehlpetsc.nonlinear.line.distributed_lu import DistributedLU, solve
from ehlpetsc.nonlinear.line.jacobian import PIVOT_REGULARISATION
from ehlpetsc.nonlinear.line.node_pairs import node_pairs
from ehlpetsc.nonlinear.line.system import line_problem
from ehlpetsc.physics.film_formulas import expected_film
from ehlpetsc.physics.scales import Scales

CASE = Path(__file__).parents[2] / "cases" / "table1_smooth.toml"
MESH = ["mesh.points_per_half_width=32", "mesh.inlet=-1.5", "mesh.outlet=1.3"]
TOUCHING = np.array([20, 21, 40, 63])


def state(case, scales):
    """A rough pressure with cavities, an uneven film; in mixed contact solids that carry at some nodes."""
    rng = np.random.default_rng(1)
    p = np.sqrt(np.maximum(1.0 - scales.x**2, 0.0)) * rng.uniform(0.5, 1.5, scales.nx)
    q = np.where(p > 0.0, p, rng.uniform(-0.9, 0.1, scales.nx))
    w = expected_film(case, scales) * rng.uniform(0.2, 3.0, scales.nx)
    if case.contact.model == "mixed":
        w[TOUCHING] *= -1.0
    return q, w, np.zeros(1)


def evaluated(problem, at):
    """Rows and derivatives of the whole mesh."""
    sums = problem.deflection.sums(problem.model.state(*at[:2]).pressure)
    return problem.evaluate(Unknowns(*at), problem.inputs(), sums)


def dense(problem, at, inactive_nodes):
    """The matrix in q and w, its far deflection by exponentials; second unknowns of inactive nodes held."""
    n, d = problem.n, problem.deflection
    rates, weights = exponentials(d.curvature, 1.0 / problem.dx)
    group, node = np.arange(n) // GROUP, np.arange(n)
    apart = np.abs(np.subtract.outer(group, group))
    kernel = np.exp(-apart[..., None] * rates) @ weights
    by_pressure = -np.where(apart > 1, kernel, d.curvature[np.abs(np.subtract.outer(node, node))])
    by_film = d.curvature_coefficient * (np.eye(n, k=-1) - 2.0 * np.eye(n) + np.eye(n, k=1))
    for end in (0, n - 1):
        by_pressure[end], by_film[end] = d.end_row(end), 0.0
        by_film[end, end] = d.end_row_coefficient
    evaluation = evaluated(problem, at)
    nodes, derivatives = evaluation.state, evaluation.reynolds_derivatives
    matrix = np.zeros((2 * n + 1, 2 * n + 1))
    leak = np.where((nodes.p_q > 0.0) | (nodes.p_w != 0.0), 0.0, PIVOT_REGULARISATION)
    matrix[: 2 * n : 2, : 2 * n : 2] = by_pressure * nodes.p_q + np.diag(leak)
    matrix[: 2 * n : 2, 1 : 2 * n : 2] = by_pressure * nodes.p_w + by_film * nodes.h_w
    matrix[[0, 2 * n - 2], -1] = -d.end_row_coefficient
    for i, row in enumerate(derivatives):
        for k, j in enumerate(range(i - 2, i + 2)):
            if 0 <= j < n:
                matrix[2 * i + 1, [2 * j, 2 * j + 1]] = row[2 * k], row[2 * k + 1] * nodes.h_w[j]
    matrix[2 * inactive_nodes + 1] = 0.0
    matrix[2 * inactive_nodes + 1, 2 * inactive_nodes + 1] = 1.0
    matrix[2 * n, : 2 * n : 2], matrix[2 * n, 1 : 2 * n : 2] = (
        problem.dx * nodes.p_q,
        problem.dx * nodes.p_w,
    )
    return matrix


@pytest.mark.parametrize("model", ["direct", "mixed"])
def test_distributed_lu_solves_its_matrix(model):
    case, ranks = load(CASE, [*MESH, f"contact.model={model}"]), PETSc.COMM_WORLD.tompi4py()
    scales = Scales.of(case)
    n, at, film = scales.nx, state(case, scales), expected_film(case, scales)
    assert n % GROUP  # the last group is not full
    inactive_nodes = TOUCHING if model == "direct" else TOUCHING[:0]
    cuts = [n // GROUP * k // ranks.size * GROUP for k in range(ranks.size)] + [n]
    first, last = cuts[ranks.rank], cuts[ranks.rank + 1]
    whole, part = line_problem(case, scales, film, 0, n), line_problem(case, scales, film, first, last)
    right = np.random.default_rng(2).standard_normal(2 * n + 1)
    right[2 * inactive_nodes + 1] = 0.0
    lu = DistributedLU(BandedJacobian(part), -part.deflection.end_row_coefficient, ranks)
    mine = inactive_nodes[(inactive_nodes >= first) & (inactive_nodes < last)] - first
    nodes = part.model.state(at[0][part.window], at[1][part.window])
    derivatives = evaluated(whole, at).reynolds_derivatives[first:last]
    entries, unknowns = node_pairs(nodes, part.model.compliance, derivatives, lu.band.stencil)
    other = entries._replace(
        p_first=np.zeros_like(entries.p_first),
        separation_second=np.zeros_like(entries.p_first),
        reynolds_derivatives=3.0 * entries.reynolds_derivatives,
    )
    lu.factor(other, inactive_nodes[:0])  # what it leaves must not matter
    lu.factor(entries, mine)
    has_load = int(last == n)
    found = np.empty(2 * (last - first) + has_load)
    lu.units[:] = unknowns[:, part.owned]
    solve(lu.factors, right[2 * first : 2 * last + has_load], found)
    found, approach = found[: 2 * (last - first)], ranks.bcast(found[-1], root=ranks.size - 1)
    expected = np.linalg.solve(dense(whole, at, inactive_nodes), right)
    scale = np.tile(np.abs(expected[:-1]).reshape(-1, 2).max(axis=0), last - first)
    np.testing.assert_allclose(found / scale, expected[2 * first : 2 * last] / scale, rtol=0, atol=1e-7)
    assert abs(approach / expected[-1] - 1.0) < 1e-7
