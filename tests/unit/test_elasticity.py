"""Products with the deflection's kernels: by transforms, and by blocks."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.fft import next_fast_len
from scipy.integrate import quad
from scipy.linalg import toeplitz
from support import ROOT

from ehlpetsc.discretisation.line.curvature_product import TOLERANCE, Blocks, exponentials, product
from ehlpetsc.discretisation.line.deflection import SymmetricToeplitz, curvature_kernel, fast_length


def test_fast_length_is_that_of_scipy():
    assert [fast_length(n) for n in range(1, 5000)] == [next_fast_len(n, real=True) for n in range(1, 5000)]


def test_kernel_product_by_transforms():
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
    """To the tolerance at every distance; their number grows as the logarithms of distance and tolerance."""
    kernel = curvature_kernel(n)
    rates, weights = exponentials(kernel, nearest, tolerance)
    by_terms = np.exp(-np.outer(np.arange(n - nearest), rates)) @ weights
    np.testing.assert_allclose(by_terms, kernel[nearest:], rtol=tolerance, atol=0)
    assert (weights > 0.0).all()  # nothing cancels
    assert len(rates) <= 5 - np.log(tolerance) * (0.4 + 0.16 * np.log(n / nearest))


def test_exponentials_are_a_quadrature_of_the_laplace_transform():
    """Against adaptive quadrature, from the least distance at which the integral converges quickly."""
    kernel = curvature_kernel(30)
    for k in (3, 4, 9, 29):
        f = quad(lambda t, k=k: t * (np.sinh(t / 2) / (t / 2)) ** 4 * np.exp(-k * t), 0, 60, epsrel=1e-12)[0]
        assert f == pytest.approx(kernel[k], rel=1e-10)


CPU_FLAG_OF_KERNELS = {"Prescott": "sse3", "Haswell": "avx2", "SkylakeX": "avx512f"}
TERMS = """
import json
from ehlpetsc.discretisation.line.curvature_product import exponentials
from ehlpetsc.discretisation.line.deflection import curvature_kernel
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
    runs = [
        subprocess.Popen(
            [sys.executable, "-c", TERMS], env=plain | {"OPENBLAS_CORETYPE": name}, stdout=subprocess.PIPE
        )
        for name in kernels
    ]
    first, *others = (json.loads(run.communicate(timeout=60)[0]) for run in runs)
    for name, other in zip(kernels[1:], others, strict=True):
        for (rates, weights), (expected_rates, expected_weights) in zip(other, first, strict=True):
            assert rates == pytest.approx(expected_rates, rel=1e-15, abs=0.0), name
            assert weights == pytest.approx(expected_weights, rel=1e-15, abs=0.0), name
