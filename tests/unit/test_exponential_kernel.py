"""The far kernel as exponentials, and as the solution of their recurrences."""

import numpy as np
import pytest

from ehlpetsc.discretisation.deflection import curvature_kernel
from ehlpetsc.nonlinear.preconditioner.exponential_kernel import GROUP, exponentials, grouped_kernel


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
