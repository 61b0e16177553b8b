r"""Plane-strain half-plane deflection under piecewise linear pressure.

With hat functions on a uniform mesh the deflection at node i is
:math:`\frac{4}{\pi E'}\Delta x\sum_k g_k\,p_{i+k}` with :math:`g_k=-\int\Lambda(s)\ln|k-s|\,ds-\ln\Delta x`,
and its second difference :math:`\frac{4}{\pi E'}\Delta x\sum_k f_k\,p_{i+k}`, where
:math:`f_k=g_{k-1}-2g_k+g_{k+1}` decays as :math:`1/k^2` although the logarithm does not
(differential deflection, Evans & Hughes 2000; Holmes et al. 2005, eq. (2)). The discrete equations
in second differences equal the integral form exactly.
"""

import numpy as np
from numpy.fft import irfft, rfft

ASYMPTOTIC_DISTANCE = 40  # nodes: from here on the asymptotic series are exact to 1e-14


def deflection_kernel(n):
    r"""Hat-function kernel :math:`g_k+\ln\Delta x`, k = 0 .. n-1 (dimensionless)."""
    near = np.arange(min(n, ASYMPTOTIC_DISTANCE), dtype=np.longdouble)  # differences of the primitive cancel

    def primitive(x):  # its second derivative is ln|x|
        x = np.abs(x)
        return x**2 * np.log(np.where(x == 0.0, 1.0, x)) / 2 - 3 * x**2 / 4

    far = np.arange(len(near), n, dtype=float)
    series = -np.log(far) + 1 / (12 * far**2) + 1 / (60 * far**4) + 1 / (168 * far**6)
    exact = -(primitive(near + 1) - 2 * primitive(near) + primitive(near - 1))
    return np.concatenate([exact.astype(float), series])


def curvature_kernel(n):
    r"""Second-difference kernel :math:`f_k`, k = 0 .. n-1: -4 ln 2, 0.601422, 0.366900, 0.126091 ..."""
    k = np.arange(n, dtype=float)
    g = deflection_kernel(min(n, ASYMPTOTIC_DISTANCE) + 1)
    near = np.empty(len(g) - 1)
    near[0] = 2 * (g[1] - g[0])
    near[1:] = g[:-2] - 2 * g[1:-1] + g[2:]
    far = np.where(k < ASYMPTOTIC_DISTANCE, np.inf, k)
    f = 1 / far**2 + 1 / far**4 + 1.5 / far**6 + 17 / (6 * far**8)
    f[: len(near)] = near
    return f


def fast_length(n):
    """Smallest length from n on without a prime factor above 5, for fast Fourier transforms.

    `scipy.fft.next_fast_len` would load 4 MB more than `numpy.fft`, which is as quick.
    """
    while True:
        cofactor = n
        for prime in (2, 3, 5):
            while cofactor % prime == 0:
                cofactor //= prime
        if cofactor == 1:
            return n
        n += 1


class SymmetricToeplitz:
    """Exact product with a symmetric Toeplitz kernel by FFT, O(n log n).

    Parameters
    ----------
    kernel : ndarray, shape (n,)
        Value at distance 0 .. n-1 nodes.
    """

    def __init__(self, kernel):
        self.count = n = len(kernel)
        self.length = fast_length(2 * n - 1)
        circulant = np.zeros(self.length)
        circulant[:n], circulant[self.length - n + 1 :] = kernel, kernel[:0:-1]
        self.spectrum = rfft(circulant)

    def __call__(self, p):
        """Return the product with `p` (n,)."""
        return irfft(self.spectrum * rfft(p, self.length), self.length)[: self.count]
