"""The deflection in second differences, as one integral, and its far kernel as exponentials."""

import itertools
from pathlib import Path

import numpy as np
import pytest

from ehlpetsc.case.loading import load
from ehlpetsc.discretisation.line.curvature_product import Blocks, pack, unpack
from ehlpetsc.discretisation.line.deflection import Deflection, PressureSums, curvature_kernel
from ehlpetsc.discretisation.unknowns import Unknowns, q_of
from ehlpetsc.nonlinear.line.banded_jacobian import GROUP, exponentials, grouped_kernel
from ehlpetsc.nonlinear.line.system import line_problem
from ehlpetsc.physics.film_formulas import expected_film
from ehlpetsc.physics.scales import Scales

CASE = Path(__file__).parents[2] / "cases" / "table1_smooth.toml"
N, DX = 137, 0.021


@pytest.mark.parametrize("seed", [0, 1])
def test_integral_form_satisfies_second_differences(seed):
    """Any pressure, smooth or not: the film of the integral form leaves no residual in any row."""
    rng = np.random.default_rng(seed)
    p, approach = rng.uniform(-1.0, 3.0, N), -0.7
    d = Deflection(N, DX, 0, N)
    sums = d.sums(p)
    rows = d.residual(approach + d.integral(p), approach, sums)
    terms = d.curvature_coefficient * np.abs(d.integral(p)).max()
    assert np.abs(rows).max() < 1e-12 * terms
    assert sums.load[2] == pytest.approx(DX * p.sum(), rel=1e-14)


def test_second_differences_satisfy_the_integral_form():
    """The rows solved for the separation give the film of the integral: nothing is lost in differencing."""
    rng = np.random.default_rng(3)
    p, approach = rng.uniform(0.0, 2.0, N), 0.4
    d = Deflection(N, DX, 0, N)
    by_separation = np.array([d.residual(unit, 0.0, d.sums(np.zeros(N))) for unit in np.eye(N)]).T
    found = np.linalg.solve(by_separation, -d.residual(np.zeros(N), approach, d.sums(p)))
    np.testing.assert_allclose(found, approach + d.integral(p), rtol=0, atol=1e-9)


@pytest.mark.parametrize("cuts", [(0, 64, N), (0, 48, 96, N), (0, 16, 32, 64, 80, 96, 112, N)])
def test_local_deflection_rows_equal_global_rows(cuts):
    """Each is given its window of the separation, and of the pressures beyond its own the messages alone."""
    rng = np.random.default_rng(4)
    g, p = rng.standard_normal((2, N))
    whole = Deflection(N, DX, 0, N)
    rows, load = whole.residual(g, 0.3, whole.sums(p)), whole.sums(p).load
    parts = [Deflection(N, DX, *ends) for ends in itertools.pairwise(cuts)]
    blocks = [Blocks.of(whole.curvature, cuts, rank) for rank in range(len(parts))]
    messages = np.full((len(parts), blocks[0].message_size), np.nan)  # all of it is filled in
    for its, d, message in zip(blocks, parts, messages, strict=True):
        pack(*its, p[d.first : d.last], message)
    loads = sum(d.load_weights @ p[d.first : d.last] for d in parts)
    np.testing.assert_allclose(loads, load, rtol=1e-12)
    for its, d in zip(blocks, parts, strict=True):
        mine = d.residual(g[d.window], 0.3, PressureSums(unpack(*its, messages), loads))
        np.testing.assert_allclose(mine, rows[d.first : d.last], rtol=0, atol=1e-11)


@pytest.mark.parametrize("model", ["direct", "mixed"])
def test_film_equation_has_zero_deflection_residual(model):
    """Parabola, roughness, approach and deflection as `EHLProblem.film` has them, against its residual."""
    mesh = ["mesh.points_per_half_width=32", f"contact.model='{model}'"]
    case = load(CASE, mesh)
    scales = Scales.of(case)
    problem = line_problem(case, scales, expected_film(case, scales), 0, scales.nx)
    rng = np.random.default_rng(5)
    q, phi, border = rng.uniform(0.1, 1.5, scales.nx), 1e-3 * rng.standard_normal(scales.nx), np.array([9.0])
    film = problem.film(q, border, phi)
    assert film.min() > 0.0
    evaluation = problem.evaluate(Unknowns(q, problem.model.w_from_film(film), border), problem.inputs(phi))
    terms = problem.deflection.curvature_coefficient * film.max()
    assert np.abs(q_of(evaluation.residual, problem.n)).max() < 1e-12 * terms


@pytest.mark.parametrize("points, error", [(50, 0.15), (200, 0.11), (800, 0.3)])
def test_exponentials_approximate_the_kernel_within_half_a_half_width(points, error):
    kernel = curvature_kernel(4 * points + 1)
    rates, weights = exponentials(kernel, points)
    far = grouped_kernel(kernel)[2:]
    distance = 2.0 + np.arange(len(far))
    found = np.exp(-np.outer(distance, rates)) @ weights
    assert np.abs(found / far - 1.0)[distance * GROUP <= 0.5 * points].max() < error
    assert np.abs(found - far).max() < 0.5 * error * far[0]
    assert found.sum() / far.sum() == pytest.approx(1.0, abs=0.06)


def test_recurrence_sums_an_exponential():
    rate, n = 0.3, 60
    p = np.random.default_rng(0).standard_normal(n)
    matrix = np.diag(np.full(n, 2 * np.cosh(rate))) - np.eye(n, k=1) - np.eye(n, k=-1)
    matrix[0, 0] -= np.exp(-rate)
    matrix[-1, -1] -= np.exp(-rate)
    distance = np.abs(np.subtract.outer(np.arange(n), np.arange(n)))
    np.testing.assert_allclose(
        np.linalg.solve(matrix, 2 * np.sinh(rate) * p), np.exp(-rate * distance) @ p, rtol=1e-12
    )


def test_grouped_kernel_is_the_mean_over_pairs_of_nodes():
    kernel = np.random.default_rng(0).standard_normal(40)
    i, j = np.arange(GROUP), 3 * GROUP + np.arange(GROUP)
    assert grouped_kernel(kernel)[3] == pytest.approx(kernel[np.subtract.outer(j, i)].mean())
