"""The deflection of lines in second differences and by kernels, that of planes by convolution."""

import itertools
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.fft import next_fast_len
from scipy.integrate import dblquad, quad
from scipy.linalg import toeplitz
from support import ROOT
from support.convergence import observed_order

from ehlpetsc.case.loading import load
from ehlpetsc.discretisation.line.curvature_product import TOLERANCE, Blocks, pack, product, unpack
from ehlpetsc.discretisation.line.curvature_product import exponentials as far_exponentials
from ehlpetsc.discretisation.line.deflection import (
    Deflection,
    PressureSums,
    SymmetricToeplitz,
    fast_length,
)
from ehlpetsc.discretisation.plane.deflection import (
    Convolution,
    Transposition,
)
from ehlpetsc.discretisation.plane.deflection import Deflection as PlaneDeflection
from ehlpetsc.discretisation.unknowns import Unknowns, q_of
from ehlpetsc.elasticity.half_plane import curvature_kernel, deflection_kernel
from ehlpetsc.elasticity.half_space import (
    NEAR,
    cell_potential,
    differences_of_primitive,
    free_kernel,
    periodic_kernel,
)
from ehlpetsc.elasticity.kernel import Kernel
from ehlpetsc.nonlinear.line.banded_jacobian import GROUP, exponentials, grouped_kernel
from ehlpetsc.nonlinear.line.system import line_problem
from ehlpetsc.physics.film_formulas import expected_film
from ehlpetsc.physics.scales import Scales

CASE = Path(__file__).parents[2] / "cases" / "table1_smooth.toml"
N, DX = 137, 0.021


@pytest.mark.parametrize("seed", [0, 1])
def test_integral_form_satisfies_second_differences(seed):
    rng = np.random.default_rng(seed)
    p, approach = rng.uniform(-1.0, 3.0, N), -0.7
    d = Deflection(N, DX, 0, N)
    sums = d.sums(p)
    rows = d.residual(approach + d.integral(p), approach, sums)
    terms = d.curvature_coefficient * np.abs(d.integral(p)).max()
    assert np.abs(rows).max() < 1e-12 * terms
    assert sums.load[2] == pytest.approx(DX * p.sum(), rel=1e-14)


def test_second_differences_satisfy_the_integral_form():
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
    mesh = ["mesh.points_per_half_width=32", f"contact.model='{model}'"]
    case = load(CASE, mesh)
    scales = Scales.of(case)
    problem = line_problem(case, scales, expected_film(case, scales), 0, scales.nx)
    rng = np.random.default_rng(5)
    q, phi, border = rng.uniform(0.1, 1.5, scales.nx), 1e-3 * rng.standard_normal(scales.nx), np.array([9.0])
    film = problem.film(q, border, phi)
    assert film.min() > 0.0
    w = problem.model.w_from_film(film)
    sums = problem.deflection.sums(problem.model.state(q, w).pressure)
    evaluation = problem.evaluate(Unknowns(q, w, border), problem.inputs(phi), sums)
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


def test_recurrence_sums_an_exponential_and_groups_have_the_mean_over_pairs():
    rate, n = 0.3, 60
    p = np.random.default_rng(0).standard_normal(n)
    matrix = np.diag(np.full(n, 2 * np.cosh(rate))) - np.eye(n, k=1) - np.eye(n, k=-1)
    matrix[0, 0] -= np.exp(-rate)
    matrix[-1, -1] -= np.exp(-rate)
    distance = np.abs(np.subtract.outer(np.arange(n), np.arange(n)))
    found = np.linalg.solve(matrix, 2 * np.sinh(rate) * p)
    np.testing.assert_allclose(found, np.exp(-rate * distance) @ p, rtol=1e-12)
    kernel = np.random.default_rng(0).standard_normal(40)
    i, j = np.arange(GROUP), 3 * GROUP + np.arange(GROUP)
    assert grouped_kernel(kernel)[3] == pytest.approx(kernel[np.subtract.outer(j, i)].mean())


def test_kernel_product_by_transforms_of_fast_length():
    assert [fast_length(n) for n in range(1, 5000)] == [next_fast_len(n, real=True) for n in range(1, 5000)]
    kernel, p = curvature_kernel(101), np.random.default_rng(4).standard_normal(101)
    np.testing.assert_allclose(SymmetricToeplitz(kernel)(p), toeplitz(kernel) @ p, rtol=0, atol=1e-13)


@pytest.mark.parametrize("nodes", [3, 32, 33, 64, 65, 97, 1000])
def test_kernel_product_by_blocks(nodes):
    """At the exponentials' error, whatever part of the last block the nodes fill, and in a second call."""
    kernel, p = curvature_kernel(nodes), np.random.default_rng(4).standard_normal(nodes)
    blocks, expected = Blocks.of(kernel), toeplitz(kernel) @ p
    first = product(blocks, p)
    product(blocks, np.ones(nodes))
    np.testing.assert_allclose([first, product(blocks, p)], [expected, expected], rtol=0, atol=1e-13)


@pytest.mark.parametrize("tolerance", [TOLERANCE, 1e-8, 1e-6])
@pytest.mark.parametrize("n, nearest", [(34, 33), (50, 33), (301, 9), (801, 33), (12801, 9), (12801, 33)])
def test_far_kernel_is_a_sum_of_exponentials(n, nearest, tolerance):
    kernel = curvature_kernel(n)
    rates, weights = far_exponentials(kernel, nearest, tolerance)
    by_terms = np.exp(-np.outer(np.arange(n - nearest), rates)) @ weights
    np.testing.assert_allclose(by_terms, kernel[nearest:], rtol=tolerance, atol=0)
    assert (weights > 0.0).all()  # nothing cancels
    assert len(rates) <= 5 - np.log(tolerance) * (0.4 + 0.16 * np.log(n / nearest))


def test_exponentials_are_a_quadrature_of_the_laplace_transform():
    kernel = curvature_kernel(30)
    for k in (3, 4, 9, 29):
        f = quad(lambda t, k=k: t * (np.sinh(t / 2) / (t / 2)) ** 4 * np.exp(-k * t), 0, 60, epsrel=1e-12)[0]
        assert f == pytest.approx(kernel[k], rel=1e-10)


CPU_FLAG_OF_KERNELS = {"Prescott": "sse3", "Haswell": "avx2", "SkylakeX": "avx512f"}
TERMS = """
import json
from ehlpetsc.discretisation.line.curvature_product import exponentials
from ehlpetsc.elasticity.half_plane import curvature_kernel
terms = [exponentials(curvature_kernel(n), nearest) for n, nearest in ((50, 33), (12801, 9), (12801, 33))]
print(json.dumps([[rates.tolist(), weights.tolist()] for rates, weights in terms]))
"""


def test_exponentials_are_the_same_with_every_kernel_of_openblas():
    """A least-squares fit had 36 terms with the kernels of Haswell and 52 with those of SkylakeX."""
    flags = Path("/proc/cpuinfo").read_text().replace("pni", "sse3").split()
    kernels = [name for name, flag in CPU_FLAG_OF_KERNELS.items() if flag in flags]
    if len(kernels) < 2:
        pytest.skip("one of these kernels alone runs on this processor, so there is nothing to compare")
    plain = {"PATH": os.environ["PATH"], "HOME": "/", "PYTHONPATH": str(ROOT)}
    words, pipe = [sys.executable, "-c", TERMS], subprocess.PIPE
    runs = [subprocess.Popen(words, env=plain | {"OPENBLAS_CORETYPE": name}, stdout=pipe) for name in kernels]
    first, *others = (json.loads(run.communicate(timeout=60)[0]) for run in runs)
    for name, other in zip(kernels[1:], others, strict=True):
        for (rates, weights), (expected_rates, expected_weights) in zip(other, first, strict=True):
            assert rates == pytest.approx(expected_rates, rel=1e-15, abs=0.0), name
            assert weights == pytest.approx(expected_weights, rel=1e-15, abs=0.0), name


CELL_X, CELL_Y = 0.03, 0.05
CIRCLE = 2.0 / np.pi**2  # C of a circular contact


def test_kernel_of_a_plane_is_the_integral_over_a_cell_near_and_far():
    def integrand(t, s):
        return (1.0 - abs(s) / CELL_X) / np.hypot(3 * CELL_X - s, 2 * CELL_Y - t)

    ends = (-CELL_X, 0.0), (0.0, CELL_X)
    parts = (dblquad(integrand, *end, -CELL_Y / 2, CELL_Y / 2, epsabs=1e-14)[0] for end in ends)
    assert free_kernel(8, 8, CELL_X, CELL_Y)[2, 3] == pytest.approx(sum(parts), abs=1e-15)
    exact = differences_of_primitive(NEAR + 20, NEAR + 20, CELL_X, CELL_Y)
    expansion = cell_potential(np.arange(NEAR + 20) * CELL_X, np.arange(NEAR + 20) * CELL_Y, CELL_X, CELL_Y)
    np.testing.assert_allclose(expansion[NEAR - 1 :, NEAR - 1 :], exact[NEAR - 1 :, NEAR - 1 :], rtol=1e-12)


def test_strip_sums_to_the_line_and_over_many_periods():
    line = -2.0 * CELL_X * -(deflection_kernel(100) - np.log(CELL_X))
    np.testing.assert_allclose(periodic_kernel(100, 24, CELL_X, CELL_Y).sum(axis=0), line, rtol=0, atol=1e-15)
    n_y, periods = 20, 200
    whole = free_kernel(30, (periods + 1) * n_y + 1, CELL_X, CELL_Y)
    rows = np.abs(np.arange(n_y)[:, None] + np.arange(-periods, periods + 1) * n_y)
    summed = whole[rows].sum(axis=1)
    strip = periodic_kernel(30, n_y, CELL_X, CELL_Y)
    waves, expected = (values - values.mean(axis=0) for values in (strip, summed))
    np.testing.assert_allclose(waves, expected, rtol=0, atol=2e-5 * expected.max())  # ~ 1/periods^2


def test_film_of_hertz_pressure_is_flat_to_second_order():
    spreads, approaches = [], []
    for points in (16, 32, 64):
        x = np.arange(-2 * points, 2 * points + 1) / points
        square = x**2 + x[:, None] ** 2
        kernel = Kernel(free_kernel(len(x), len(x), 1 / points, 1 / points))
        deflection = PlaneDeflection((1 / points, 1 / points), kernel, CIRCLE, 1.0, False, slice(None))
        film = deflection.integral(np.sqrt(np.maximum(1.0 - square, 0.0)).ravel()) + 0.5 * square.ravel()
        inside = film[square.ravel() < 0.81]
        spreads.append(inside.std())
        approaches.append(inside.mean() - 1.0)
    assert spreads[-1] < 6e-5 and abs(approaches[-1]) < 4e-4
    assert observed_order(spreads) > 1.8


@pytest.mark.parametrize("periodic", (False, True))
def test_convolution_has_the_precision_of_its_argument(periodic):
    kernel = (periodic_kernel if periodic else free_kernel)(33, 24, CELL_X, CELL_Y)
    product = Convolution(Kernel(kernel), periodic, Transposition())
    pressure = np.random.default_rng(5).random(24 * 33)
    exact, single = product(pressure), product(pressure.astype(np.float32))
    assert single.dtype == np.float32
    assert 1e-9 < np.abs(single - exact).max() / np.abs(exact).max() < 1e-6
