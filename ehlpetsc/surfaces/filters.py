"""Levelling and filtering of measured profiles."""

from __future__ import annotations

import numpy as np

from ehlpetsc.base.errors import ProfileError

SPACING_TOLERANCE = 0.01  # relative rounding of the abscissas of equally spaced points in a file
MIN_SPACINGS = 2  # of the shortest wave in a profile


def levelled(x: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Heights minus their least-squares line."""
    x = x - x.mean()
    return z - z.mean() - x * (x @ z / (x @ x))


def high_pass(x: np.ndarray, z: np.ndarray, cutoff: float) -> np.ndarray:
    """Roughness: profile minus the mean line of cut-off `cutoff` [m], see `mean_line`."""
    return z - mean_line(x, z, cutoff, "cutoff")


def low_pass(x: np.ndarray, z: np.ndarray, cutoff: float) -> np.ndarray:
    """Profile without waves shorter than `cutoff` [m]: S-filter of ISO 3274, see `mean_line`."""
    return mean_line(x, z, cutoff, "short_cutoff")


def mean_line(x: np.ndarray, z: np.ndarray, cutoff: float, key: str) -> np.ndarray:
    r"""Mean line of the Gaussian profile filter of ISO 16610-21.

    The convolution with :math:`s(x)=\frac{1}{\alpha\lambda_c}\exp[-\pi(x/\alpha\lambda_c)^2]`,
    :math:`\alpha=\sqrt{\ln 2/\pi}`: of a wave of length :math:`\lambda` it passes
    :math:`2^{-(\lambda_c/\lambda)^2}` of the amplitude, half at the cut-off. At the ends the profile is
    mirrored, as in a run; a cosine transform then gives the convolution exactly, however short the cut-off.
    (ISO drops half a cut-off at either end, where a slope makes a kink of what is mirrored.)

    `x`, `z`: m; x equally spaced, shape (n,).
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
    exponent = np.arange(z.size) * (cutoff / (2.0 * length))
    return idct(spectrum * np.exp2(-np.square(exponent)), type=1)
