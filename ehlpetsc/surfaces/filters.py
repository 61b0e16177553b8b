"""Levelling and filters of measured heights; their faults: no-data values, held heights, spikes."""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce

import numpy as np

from ehlpetsc.base.errors import ProfileError

SPACING_TOLERANCE = 0.01  # relative rounding of the abscissas of equally spaced points in a file
HEIGHT_ROUNDING = 1e-12  # of the largest height
MIN_SPACINGS = 2  # of the shortest wave in a profile


def deviations(z: np.ndarray, given: np.ndarray | None = None) -> np.ndarray:
    """Heights minus their mean; all 0 where no more than rounding errors of the heights given are left.

    `given`: heights before a form was subtracted; default: z.
    """
    largest = np.abs(z if given is None else given).max()
    z = z - z.mean()
    return z if np.ptp(z) > HEIGHT_ROUNDING * largest else np.zeros_like(z)


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


MIN_REPEATS, MIN_DISTINCT = 3, 20  # of a no-data value; of other heights: fewer are a synthetic profile
MAX_SHARE = 0.5  # of a no-data value
NO_DATA_JUMP = 8.0  # of a no-data value to its neighbours, over the median step of the others
SPIKE_WIDTH = 5  # maximum, in points
WAVE_WINDOW = 101  # points, of medians that follow the waves but not the roughness
SPIKE_RATIOS = 10.0, 4.0  # of a spike over the noise, and over the roughness, both in the root mean square
SHOULDER_RATIO = 0.3  # of this limit, for points beside a spike that belong to it
HELD_POINTS, MAX_HELD_SHARE, RARE_SHARE = 5, 0.2, 0.01
NOISELESS = 1e-9  # of the heights
SIGMA_OF_MAD = 1.4826  # standard deviation of Gaussian heights over their median absolute deviation


def no_data_value(z: np.ndarray) -> float | None:
    """Placeholder for missing heights, far from all its neighbours, as 9999 or 0; None if there is none.

    Candidates are the minimum, the maximum, 0 and the most frequent value, where they occur at least
    `MIN_REPEATS` times and at no more than half of the points. The median jump to their neighbours must
    exceed `NO_DATA_JUMP` times the median step between other heights; nan in `z` is no neighbour.
    """
    finite = z[np.isfinite(z)]
    values, counts = np.unique(finite, return_counts=True)
    if values.size <= MIN_DISTINCT:
        return None
    frequent = {values[0], values[-1], values[counts.argmax()], 0.0}
    for value in sorted(frequent, key=lambda v: -abs(v - np.median(finite))):
        others = finite[finite != value]
        if not MIN_REPEATS <= finite.size - others.size <= MAX_SHARE * finite.size:
            continue
        before, after = finite[:-1], finite[1:]
        at_border = (before == value) ^ (after == value)
        jump = np.median(np.abs(after - before)[at_border]) if at_border.any() else 0.0
        inside = (before != value) & (after != value)
        if inside.any() and jump > NO_DATA_JUMP * np.median(np.abs(after - before)[inside]) > 0.0:
            return float(value)
    return None


def without_no_data(z: np.ndarray, unit: float) -> tuple[np.ndarray, str]:
    """Heights [m], nan where they are missing or a no-data value, and words on these values for messages.

    `z`: of a profile or a map, whose rows are read to and fro, so that neighbours stay neighbours.
    `unit`: of the heights in the file [m].
    """
    z = np.array(np.ma.filled(np.ma.asarray(z, float), np.nan))
    counts: dict[float, int] = {}
    while True:
        path = np.atleast_2d(z).copy()
        path[1::2] = path[1::2, ::-1]
        if (value := no_data_value(path.ravel())) is None:
            return z, _words({value / unit: count for value, count in counts.items()})
        counts[value] = int(np.count_nonzero(z == value))
        z[z == value] = np.nan


def _words(counts: dict[float, int]) -> str:
    """Words on no-data values, in the unit of the file, and on their numbers."""
    if len(counts) > 2:
        some = f"{sum(counts.values())} of them of {len(counts)} values"
        return f", {some}, {min(counts):.6g} to {max(counts):.6g}, far from all others"
    return "".join(f", {n} of them the value {value:.6g} far from all others" for value, n in counts.items())


def spikes(z: np.ndarray) -> np.ndarray:
    """Whether each height belongs to a spike of at most `SPIKE_WIDTH` points, of either sign.

    A spike leaves the running median of twice its width by `SPIKE_RATIOS` times the noise (deviation from the
    mean of both neighbours) and the roughness (deviation from medians of `WAVE_WINDOW` points), both by
    their median absolute deviation. Heights that are missing (nan) are interpolated.
    """
    from scipy.ndimage import binary_propagation, median_filter

    present = ~np.isnan(z)
    if z.size < WAVE_WINDOW or np.count_nonzero(present) < 2:
        return np.zeros(z.size, bool)
    number = np.arange(z.size)
    z = np.interp(number, number[present], z[present])
    noise = SIGMA_OF_MAD * np.median(np.abs(z[1:-1] - 0.5 * (z[2:] + z[:-2])))
    medians = np.median(z[: z.size // WAVE_WINDOW * WAVE_WINDOW].reshape(-1, WAVE_WINDOW), axis=1)
    waves = np.interp(number, WAVE_WINDOW * (np.arange(medians.size) + 0.5), medians)
    roughness = SIGMA_OF_MAD * np.median(np.abs(z - waves))
    threshold = max(SPIKE_RATIOS[0] * noise, SPIKE_RATIOS[1] * roughness)
    deviation = np.abs(z - median_filter(z, 2 * SPIKE_WIDTH + 1, mode="nearest"))
    if noise <= NOISELESS * np.ptp(z):  # heights without noise are not measured
        return np.zeros(z.size, bool)
    foot = deviation > SHOULDER_RATIO * threshold
    return binary_propagation(deviation > threshold, mask=foot) & present


def map_spikes(z: np.ndarray) -> np.ndarray:
    """Whether each height of a map belongs to a spike of its row and of its column, see :func:`spikes`."""
    return np.array([spikes(row) for row in z]) & np.array([spikes(column) for column in z.T]).T


def held(z: np.ndarray) -> np.ndarray:
    """Whether each height belongs to `HELD_POINTS` equal ones in a row, where equal neighbours are rare.

    An instrument holds a height across a drop-out or at the end of its range. More than `MAX_HELD_SHARE` of
    all points are plateaus of a shape.
    """
    is_equal = np.diff(z) == 0.0
    ends = np.flatnonzero(np.diff(np.concatenate([[0], is_equal.astype(np.int8), [0]])))
    runs = ends.reshape(-1, 2)  # first and last point
    flags = np.zeros(z.size, bool)
    for first, last in runs[runs[:, 1] - runs[:, 0] >= HELD_POINTS - 1]:
        flags[first : last + 1] = True
    others = is_equal & ~np.isin(z[1:], z[flags])
    is_rare = np.count_nonzero(others) < RARE_SHARE * z.size
    return flags & (is_rare and flags.mean() <= MAX_HELD_SHARE)


def groups(flags: np.ndarray) -> int:
    """Number of runs of true values."""
    return int(np.count_nonzero(np.diff(flags.astype(np.int8), prepend=0) == 1))
