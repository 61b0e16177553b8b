"""Quarter space by alternating half-spaces (Hetenyi 1960), for waves cos(k x) along its edge, k = 1.

Two half-spaces, each under pressures mirrored about the face of the other, have no shear on either face. The
normal stress A p that those of one leave on the other's face is its pressure: (1 - A A)^-1 p deflects it.
"""

from functools import cache

import numpy as np
from scipy.interpolate import CubicSpline, RectBivariateSpline
from scipy.special import k0, k1

NEAREST, FARTHEST, NODES = 1e-8, 40.0, 400  # distances from the edge, evenly spaced logarithms
CELL, CELL_WEIGHTS = np.polynomial.legendre.leggauss(6)
PERIODS = 16  # of twice the mesh along x
EULER = 0.5772156649015329


def below_surface(y, z):
    """Integral of K0(r) over depths from z to infinity."""
    points, weights = np.polynomial.legendre.leggauss(40)
    first = np.arcsinh(z / y)
    half = 0.5 * np.maximum(np.arccosh(np.maximum(1.0, FARTHEST / y)) - first, 0.0)
    total = np.zeros(np.broadcast(y, z).shape)
    for point, weight in zip(points, weights, strict=True):
        r = y * np.cosh(first + (1.0 + point) * half)
        total += weight * half * k0(r) * r
    return total


def normal_stress(z, y, poisson_ratio):
    """A: normal stress on the plane of symmetry at a depth z, of line forces at both distances y from it.

    Of a wave of pressure m along y and kappa^2 = 1 + m^2 it is
    exp(-kappa z) (m^2/kappa^2 (1 - kappa z) + 2 nu/kappa^2).
    """
    r = np.hypot(y, z)
    first = 2.0 * k1(r) / r
    by_depth = first - 2.0 * (z / r) ** 2 * (k0(r) + 2.0 * k1(r) / r)
    by_both = (1.0 - 2.0 * poisson_ratio) * 2.0 * below_surface(y, z)
    return (z * first + z * by_depth + 2.0 * z * k0(r) - by_both) / np.pi


@cache
def beyond_images(poisson_ratio):
    """Deflection at y by a line force at y' besides K0(|y - y'|) + K0(y + y'): spline of both logarithms."""
    y = np.geomspace(NEAREST, FARTHEST, NODES)
    step = np.log(y[1] / y[0])
    stress = normal_stress(y[:, None], y, poisson_ratio)
    operator = stress * (step * y)
    pressure = np.linalg.solve(np.eye(NODES) - operator @ operator, operator @ stress)
    distance = np.abs(y[:, None] - y) + np.diag(step * y / (2.0 * np.pi))
    mirrored = k0(distance) + k0(y[:, None] + y)
    mirrored[np.diag_indices(NODES)] = np.log(2.0 / np.diag(distance)) - EULER + k0(2.0 * y)
    return RectBivariateSpline(np.log(y), np.log(y), (mirrored * (step * y)) @ pressure)


def rows_beyond_images(k, width, rows, poisson_ratio):
    """Deflection of rows from the edge on by unit pressures cos(k x) on each besides images, E = 1."""
    centres, spline = k * width * (np.arange(rows) + 0.5), beyond_images(poisson_ratio)
    near = np.count_nonzero(centres < 0.5 * FARTHEST)
    found = np.zeros((rows, rows))
    for point, weight in zip(CELL, CELL_WEIGHTS, strict=True):
        by = centres[:near] + 0.5 * k * width * point
        found[:near, :near] += 0.5 * weight * spline(np.log(centres[:near]), np.log(by))
    return 2.0 * (1.0 - poisson_ratio**2) / np.pi * width * found


def factors(x, across, poisson_ratio):
    """Images' factor at x along and t = (y - y')/(y + y'), y + y' = 1, by integrals over waves; (x, t)."""
    k, spline = np.concatenate([[1e-6], np.geomspace(1e-4, 30.0, 1200)]), beyond_images(poisson_ratio)
    found = np.ones((len(x), len(across)))
    for j, t in enumerate(across):
        waves = spline(np.log(0.5 * k * (1.0 + t)), np.log(0.5 * k * (1.0 - t)), grid=False)
        of_image = (waves[1] - waves[60]) / np.log(k[60] / k[1])  # the same for long waves
        rest = waves - of_image * k0(k)
        rest[0], slope = rest[1], np.diff(rest) / np.diff(k)
        for i, along in enumerate(x):
            ends = rest[-1] * np.sin(k[-1] * along) / along
            integral = ends + (slope * np.diff(np.cos(k * along))).sum() / along**2
            found[i, j] += of_image + 2.0 / np.pi * np.hypot(along, 1.0) * integral
    return found


class FreeEnds:
    """Deflection [m] of a half-space and a body with free ends, both of one modulus, by pressures [Pa].

    `by_images`: deflection with images of a factor 1, to which the rest of both quarter spaces is added.
    `modulus`: E' of both [Pa].
    """

    def __init__(self, by_images, shape, spacings, modulus, poisson_ratio):
        self.by_images, (n_y, self.n_x), (dy, dx) = by_images, shape, spacings
        waves = np.pi * np.arange(PERIODS * self.n_x + 1) / (PERIODS * self.n_x * dx)
        waves[0] = waves[1] / (2.0 * np.e)  # mean of a logarithm from 0 to half of the first
        k = np.geomspace(waves[0], min(waves[-1], 8.0 / dy), 40)
        found = np.array([rows_beyond_images(one, dy, n_y, poisson_ratio) for one in k])
        found = (found + found[:, ::-1, ::-1]) / ((1.0 - poisson_ratio**2) * modulus)
        short = waves[waves <= k[-1]]
        hat = np.sinc(0.5 * short * dx / np.pi)[:, None, None] ** 2
        self.rest = hat * CubicSpline(np.log(k), found)(np.log(short))

    def __call__(self, pressure):
        waves = np.fft.rfft(pressure, 2 * PERIODS * self.n_x, axis=1)
        waves[:, len(self.rest) :] = 0.0
        own = waves[:, : len(self.rest)].T[:, :, None]
        waves[:, : len(self.rest)] = (self.rest @ own)[:, :, 0].T
        return self.by_images(pressure) + np.fft.irfft(waves, axis=1)[:, : self.n_x]
