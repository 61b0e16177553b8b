"""Substitution with LAPACK's banded factors against LAPACK's own."""

import numpy as np
import pytest
from scipy.linalg.lapack import dgbtrf, dgbtrs

from ehlpetsc.nonlinear.preconditioner.substitution import substitute


@pytest.mark.parametrize("order, half", [(5, 2), (40, 7), (200, 17), (12, 17)])
@pytest.mark.parametrize("rows", [1, 3])
def test_as_lapack(order, half, rows):
    rng = np.random.default_rng(order)
    band = np.zeros((3 * half + 1, order), order="F")
    band[half:] = rng.standard_normal((2 * half + 1, order))  # no diagonal dominance: rows are exchanged
    i = np.arange(-half, half + 1)[:, None] + np.arange(order)
    band[half:][(i < 0) | (i >= order)] = 0.0
    factors, pivots, info = dgbtrf(band, half, half)
    assert info == 0 and (pivots != np.arange(order)).any()
    for first in (0, order // 2, order - 1):
        b = rng.standard_normal((rows, order))
        b[:, :first] = 0.0
        expected = dgbtrs(factors, half, half, b.T, pivots)[0].T
        substitute(factors.T, pivots, b, first)
        np.testing.assert_allclose(b, expected, rtol=0, atol=1e-9 * np.abs(expected).max())
