"""Levelling and filtering of measured profiles and maps."""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce

import numpy as np

from ehlpetsc.base.errors import ProfileError

SPACING_TOLERANCE = 0.01  # relative rounding of the abscissas of equally spaced points in a file
ROUNDING = 1e-12  # of the largest height
MIN_SPACINGS = 2  # of the shortest wave in a profile


def deviations(z: np.ndarray, given: np.ndarray | None = None) -> np.ndarray:
    """Heights minus their mean; all 0 where no more than rounding errors of the heights given are left.

    `given`: heights before a form was subtracted; default: z.
    """
    largest = np.abs(z if given is None else given).max()
    z = z - z.mean()
    return z if np.ptp(z) > ROUNDING * largest else np.zeros_like(z)


def levelled(x: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Heights minus their least-squares line along the last axis."""
    x, z = x - x.mean(), z - z.mean(axis=-1, keepdims=True)
    return z - np.multiply.outer(z @ x / (x @ x), x)


def without_form(axes: Sequence[np.ndarray], z: np.ndarray, degree: int) -> np.ndarray:
    """Heights minus their least-squares polynomial of a total degree; 1: minus a line or plane.

    On a grid the products of polynomials that are orthonormal on the points of each axis are orthonormal too,
    so that the fit is a projection.

    `axes`: abscissas along each axis of z.
    `z`: shape (nx,) or (ny, nx).
    """
    bases = [_orthonormal_polynomials(x, degree) for x in axes]
    # each product moves one axis from the first place to the last: after all of them they are in order again
    coefficients = reduce(lambda values, basis: np.tensordot(values, basis, (0, 0)), bases, z)
    coefficients[sum(np.indices(coefficients.shape)) > degree] = 0.0
    return z - reduce(lambda values, basis: np.tensordot(values, basis, (0, 1)), bases, coefficients)


def _orthonormal_polynomials(x: np.ndarray, degree: int) -> np.ndarray:
    """Values of polynomials up to a degree, shape (n, degree + 1), orthonormal on the points x."""
    centred = (x - 0.5 * (x[0] + x[-1])) / (0.5 * (x[-1] - x[0]))
    return np.linalg.qr(np.polynomial.legendre.legvander(centred, degree))[0]


def mean_line(x: np.ndarray, z: np.ndarray, cutoff: float, key: str) -> np.ndarray:
    r"""Mean line of the Gaussian profile filter of ISO 16610-21: profile without shorter waves.

    The convolution with :math:`s(x)=\frac{1}{\alpha\lambda_c}\exp[-\pi(x/\alpha\lambda_c)^2]`,
    :math:`\alpha=\sqrt{\ln 2/\pi}`: of a wave of length :math:`\lambda` it passes
    :math:`2^{-(\lambda_c/\lambda)^2}` of the amplitude, half at the cut-off. At the ends the profile is
    mirrored, as in a run; a cosine transform then gives the convolution exactly, however short the cut-off.
    (ISO drops half a cut-off at either end, where a slope makes a kink of what is mirrored.)

    `x`, `z`: m; x equally spaced, shape (n,), z with this as its last axis.
    `cutoff`: wavelength [m].
    `key`: key of the cut-off in the case.
    """
    from scipy.fft import dct, idct

    length, step = x[-1] - x[0], (x[-1] - x[0]) / (x.size - 1)
    if np.ptp(np.diff(x)) > 2 * SPACING_TOLERANCE * step:
        raise ProfileError(f"{key}: the filter needs equally spaced x")
    if cutoff > length:
        raise ProfileError(f"{key} = {cutoff:g} m; allowed: at most the length of the profile, {length:g} m")
    if cutoff < MIN_SPACINGS * step:
        limit = MIN_SPACINGS * step
        raise ProfileError(
            f"{key} = {cutoff:g} m; allowed: at least {MIN_SPACINGS} spacings of its points, {limit:g} m; "
            'where its x is not in m, write unit = "mm", "um" or "nm"'
        )
    spectrum = dct(z, type=1)
    exponent = np.arange(x.size) * (cutoff / (2.0 * length))
    return idct(spectrum * np.exp2(-np.square(exponent)), type=1)


def periodic_mean(z: np.ndarray, cutoff: float) -> np.ndarray:
    """Gaussian filter of `mean_line` along the first axis of z, which repeats.

    `cutoff`: wavelength in spacings of this axis.
    """
    waves = np.fft.rfftfreq(len(z))[:, None]
    return np.fft.irfft(np.fft.rfft(z, axis=0) * np.exp2(-np.square(waves * cutoff)), len(z), axis=0)


def smoothed(axes: Sequence[np.ndarray], z: np.ndarray, cutoff: float, key: str) -> np.ndarray:
    r"""Mean line of a profile, or mean surface of the areal Gaussian filter of ISO 16610-61.

    The weight of the latter :math:`\exp[-\pi(x^2+y^2)/(\alpha\lambda_c)^2]` is the product of two weights of
    `mean_line`: of a wave of length :math:`\lambda` in any direction it passes
    :math:`2^{-(\lambda_c/\lambda)^2}`.

    `axes`: abscissas along each axis of z [m].
    """
    for x in reversed(axes):
        z = mean_line(x, z, cutoff, key).T
    return z
