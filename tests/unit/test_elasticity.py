"""Products with the deflection's kernels by transforms."""

import numpy as np
import pytest
from scipy.fft import next_fast_len
from scipy.linalg import toeplitz

from ehlpetsc.discretisation.elasticity import SymmetricToeplitz, curvature_kernel, fast_length


def test_fast_length_is_that_of_scipy():
    assert [fast_length(n) for n in range(1, 5000)] == [next_fast_len(n, real=True) for n in range(1, 5000)]


@pytest.mark.parametrize("first, last", [(0, None), (0, 40), (40, 71), (70, 101)])
def test_rows_of_the_product(first, last):
    kernel, p = curvature_kernel(101), np.random.default_rng(4).standard_normal(101)
    expected = (toeplitz(kernel) @ p)[first:last]
    np.testing.assert_allclose(SymmetricToeplitz(kernel, first, last)(p), expected, rtol=0, atol=1e-13)
