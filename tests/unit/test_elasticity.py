"""Products with the deflection's kernels: by transforms, and by blocks."""

import numpy as np
import pytest
from scipy.fft import next_fast_len
from scipy.linalg import toeplitz

from ehlpetsc.discretisation.curvature_product import TOLERANCE, CurvatureProduct, exponentials
from ehlpetsc.discretisation.elasticity import SymmetricToeplitz, curvature_kernel, fast_length


def test_fast_length_is_that_of_scipy():
    assert [fast_length(n) for n in range(1, 5000)] == [next_fast_len(n, real=True) for n in range(1, 5000)]


def test_product_by_transforms():
    kernel, p = curvature_kernel(101), np.random.default_rng(4).standard_normal(101)
    np.testing.assert_allclose(SymmetricToeplitz(kernel)(p), toeplitz(kernel) @ p, rtol=0, atol=1e-13)


@pytest.mark.parametrize("nodes", [3, 32, 33, 64, 65, 97, 1000])
def test_product_by_blocks(nodes):
    """At the exponentials' error, whatever part of the last block the nodes fill, and in a second call."""
    kernel, p = curvature_kernel(nodes), np.random.default_rng(4).standard_normal(nodes)
    product, expected = CurvatureProduct(kernel), toeplitz(kernel) @ p
    first = product(p)
    product(np.ones(nodes))
    np.testing.assert_allclose([first, product(p)], [expected, expected], rtol=0, atol=1e-13)


@pytest.mark.parametrize("n, nearest, terms", [(301, 9, 24), (12801, 9, 36), (801, 33, 22), (12801, 33, 32)])
def test_the_far_kernel_is_a_sum_of_exponentials(n, nearest, terms):
    kernel = curvature_kernel(n)
    rates, weights = exponentials(kernel, nearest)
    by_terms = np.exp(-np.outer(np.arange(n - nearest), rates)) @ weights
    assert len(rates) == terms
    np.testing.assert_allclose(by_terms, kernel[nearest:], rtol=TOLERANCE, atol=0)
