"""Dry contact of half-spaces by conjugate gradients (Polonsky and Keer 1999), independent of the package."""

import numpy as np
from scipy.fft import irfft2, rfft2


def hat_kernel(n_x, n_y, dx, dy):
    """Sum of 1/r over a cell, hat along x and constant across, at distances 0 .. n - 1; shape (n_y, n_x)."""
    wide = np.longdouble
    x = np.abs(np.arange(-1, n_x + 1).astype(wide)[None, :] * wide(dx))
    y = (np.arange(n_y + 1).astype(wide)[:, None] - wide(0.5)) * wide(dy)
    side, y = np.sign(y), np.abs(y)
    r, safe = np.sqrt(x * x + y * y), np.where(x > 0, x, 1)
    by_x = np.where(x > 0, 0.5 * x * x * np.arcsinh(y / safe), 0)
    g = side * (by_x + x * y * np.arcsinh(x / y) - 0.5 * y * r)
    g = (g[:, 2:] - 2 * g[:, 1:-1] + g[:, :-2]) / wide(dx)
    return np.asarray(g[1:] - g[:-1], float)


class HalfSpaces:
    """Deflection [m] of pressures [Pa]; with a share of free ends at both edges of the rows.

    `share`: of the images, pressures mirrored about the edges of the first and last cell, times `factor` of
    s/r, s and r their distances across and in all, plus `weighted` times 1.5 y y'/r^2 of distances from the
    edge.
    """

    def __init__(self, shape, spacings, modulus, share=0.0, factor=np.ones_like, weighted=0.0):
        (self.n_y, n_x), (dy, dx) = shape, spacings
        self.shape, self.weighted = (3 * self.n_y, n_x), share * weighted
        self.y = dy * (np.arange(self.n_y)[:, None] + 0.5)
        scale = 2.0 / (np.pi * modulus)
        kernel = scale * hat_kernel(n_x, 3 * self.n_y, dx, dy)
        s = dy * np.maximum(np.arange(3.0 * self.n_y)[:, None], 0.5)
        r = np.hypot(dx * np.arange(n_x), s)
        self.lengths = 2 * self.shape[0], 2 * n_x
        self.direct, self.images = self.spectrum(kernel), share * self.spectrum(kernel * factor(s / r))
        self.dipoles = self.spectrum(1.5 * scale * dx * dy / r**3)

    def spectrum(self, kernel):
        even = np.zeros(self.lengths)
        n_y, n_x = kernel.shape
        even[:n_y, :n_x] = kernel
        even[n_y + 1 :, :n_x] = kernel[:0:-1]
        even[:, n_x + 1 :] = even[:, n_x - 1 : 0 : -1]
        return rfft2(even)

    def product(self, pressure, block, spectrum):
        whole, n = np.zeros(self.shape), self.n_y
        whole[block * n : (block + 1) * n] = pressure
        return irfft2(rfft2(whole, self.lengths) * spectrum, self.lengths)[n : 2 * n, : self.shape[1]]

    def __call__(self, pressure):
        found = self.product(pressure, 1, self.direct)
        for block, y in ((0, self.y), (2, self.y[::-1])):
            found += self.product(pressure[::-1], block, self.images)
            if self.weighted:
                found += self.weighted * y * self.product((y * pressure)[::-1], block, self.dipoles)
        return found


def dry_pressure(gap, load, cell, deflection, tolerance=1e-9):
    """Pressure [Pa] of a load [N] on a gap [m] of cells [m^2]."""
    p = np.full(gap.shape, load / (cell * gap.size))
    t, former, conjugate = np.zeros_like(p), 1.0, 0.0
    for _ in range(20_000):
        g, touching = deflection(p) + gap, p > 0
        g = g - g[touching].mean()
        size = (g[touching] ** 2).sum()
        t = np.where(touching, g + conjugate * size / former * t, 0.0)
        former, r = size, deflection(t)
        r = r - r[touching].mean()
        step = (g[touching] * t[touching]).sum() / (r[touching] * t[touching]).sum()
        new = np.maximum(p - np.where(touching, step * t, 0.0), 0.0)
        entering = (new == 0.0) & (g < 0.0)
        conjugate = 0.0 if entering.any() else 1.0
        new = np.where(entering, new - step * g, new)
        new *= load / (cell * new.sum())
        change, p = np.abs(new - p).sum() / new.sum(), new
        if change < tolerance:
            return p
    raise AssertionError("no dry contact in 20000 iterations")
