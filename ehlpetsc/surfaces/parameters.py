"""Roughness parameters of profiles (ISO 21920-2) and areal surfaces (ISO 25178-2), correlation, spectrum."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ehlpetsc.base.compiled import compiled
from ehlpetsc.base.counts import whole_down
from ehlpetsc.surfaces.filters import SPACING_TOLERANCE, deviations

SECTIONS = 5  # section lengths of a profile without a cut-off
CORE_FRACTION = 0.4  # of the material ratio, over which the core has its smallest slope
SLOPE_WEIGHTS = np.array([-1.0, 9.0, -45.0, 0.0, 45.0, -9.0, 1.0]) / 60.0  # at seven points
MIN_PARAMETER_POINTS = 50
BINS_PER_DECADE = 12  # of the averaged spectrum
CORRELATION_THRESHOLD = 0.2  # of the autocorrelation, for Sal and Str
LAY_DIRECTIONS = 360  # of half a turn, in which the autocorrelation is followed
LAY_ANGLES = np.pi * np.arange(LAY_DIRECTIONS) / LAY_DIRECTIONS
PRUNED = 0.05  # of Sz: lower hills and dales belong to their neighbours (Wolf pruning)
PEAK_RATIO, VALLEY_RATIO = 0.1, 0.8  # material ratios of Vmp and Vvv
S10Z_PEAKS = 5  # peaks, and pits, of S10z

PARAMETERS = (
    ("?a", "um", "arithmetic mean height"),
    ("?q", "um", "root mean square height"),
    ("Rz", "um", "mean maximum height of the sections"),
    ("Sz", "um", "maximum height"),
    ("S10z", "um", "ten-point height, of peaks and pits of more than 5% of Sz"),
    ("?sk", "", "skewness"),
    ("?ku", "", "kurtosis"),
    ("?pk", "um", "reduced peak height"),
    ("?k", "um", "core height, from {mr1:.1%} to {mr2:.1%} of material"),
    ("?vk", "um", "reduced valley depth"),
    ("Vmp", "um", "volume of the peaks above 10% of material, per area"),
    ("Vvv", "um", "volume of the valleys below 80% of material, per area"),
    ("Rdq", "", "root mean square slope"),
    ("Sdq", "", "root mean square gradient"),
    ("curv", "/m", "root mean square curvature, of a map of its mean curvature"),
    ("Sdr", "%", "developed interfacial area ratio"),
    ("l", "um", "correlation length, autocorrelation 1/e"),
    ("Sal", "um", "autocorrelation length, 0.2 in the direction of its fastest decay"),
    ("Str", "", "texture aspect ratio: 0 a lay, 1 isotropic"),
    ("Std", "°", "direction of the lay against the rows, towards Y"),
)
"""Name, with ? for R or S, unit shown, and meaning; mr1, mr2: material ratios of the core."""

ISOTROPIC = 0.5  # Str above which a texture has no direction


def profile_parameters(z: np.ndarray, dx: float, section: float | None = None) -> dict[str, float]:
    """Parameters of heights dx [m] apart by their names in `PARAMETERS`, lengths in m; shape (n,).

    nan: skewness and kurtosis without heights; `l` where the autocorrelation does not fall to 1/e.

    `section`: section length [m], the cut-off.
    """
    z = deviations(z)
    return _of_heights(z, "R") | {
        "Rz": mean_maximum_height(z, dx, section),
        "Rdq": float(np.sqrt(np.mean(slopes(z, dx) ** 2))),
        "curv": rms_curvature(z, dx),
        "l": correlation_length(z, dx),
    }


def areal_parameters(z: np.ndarray, dx: float, dy: float) -> dict[str, float]:
    """Parameters of a map, shape (ny, nx), with spacings [m], as of :func:`profile_parameters`.

    nan: on a plane those of shape; where the autocorrelation stays above 0.2 up to half the size of the map,
    in all directions Sal, in one Str.
    """
    z = deviations(z)
    upper, lower = np.quantile(z, (1.0 - PEAK_RATIO, 1.0 - VALLEY_RATIO))
    fastest, slowest = correlation_lengths(z, dx, dy) if z.any() else (np.nan, np.nan)
    return _of_heights(z, "S") | {
        "Sz": float(np.ptp(z)),
        "S10z": ten_point_height(z),
        "Vmp": float(np.maximum(z - upper, 0.0).mean()),
        "Vvv": float(np.maximum(lower - z, 0.0).mean()),
        "Sdq": rms_gradient(z, dx, dy),
        "curv": rms_curvature(z, dx, dy),
        "Sdr": developed_ratio(z, dx, dy),
        "Sal": fastest,
        "Str": fastest / slowest,
        "Std": np.nan if not z.any() or fastest > ISOTROPIC * slowest else texture_direction(z, dx, dy),
    }


def moments(z: np.ndarray) -> dict[str, float]:
    """Mean "a" and root mean square "q" [m], skewness "sk", kurtosis "ku" of heights minus their mean.

    The latter are nan without heights.
    """
    z = z - z.mean()
    q = float(np.sqrt(np.mean(z**2)))
    sk, ku = (float(np.mean((z / q) ** k)) if q > 0 else np.nan for k in (3, 4))
    return {"a": float(np.abs(z).mean()), "q": q, "sk": sk, "ku": ku}


def _of_heights(z: np.ndarray, letter: str) -> dict[str, float]:
    """Parameters of heights that profiles and maps share, with the letter of their names."""
    return {letter + name: value for name, value in (moments(z) | core_parameters(z)).items()}


def equally_spaced(x: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, bool]:
    """Profile at its mean spacing, and whether it was interpolated, by the spline of a run."""
    from scipy.interpolate import CubicSpline

    step = (x[-1] - x[0]) / (x.size - 1)
    if np.ptp(np.diff(x)) <= 2 * SPACING_TOLERANCE * step:
        return x, z, False
    even = np.linspace(x[0], x[-1], x.size)
    return even, CubicSpline(x, z, bc_type="clamped")(even), True


def mean_maximum_height(z: np.ndarray, dx: float, section: float | None = None) -> float:
    """Rz: mean over sections of maximum minus minimum, by default five; `section`: their length [m]."""
    count = SECTIONS if section is None else max(whole_down(z.size * dx / section), 1)
    return float(np.mean([np.ptp(part) for part in np.array_split(z, min(count, z.size))]))


def core_parameters(z: np.ndarray) -> dict[str, float]:
    """Rpk, Rk, Rvk [m] without their R, by the equivalent line of ISO 21920-2 (ISO 13565-2).

    The line is the least-squares one over the 40 % of the material ratio curve whose secant falls least; at
    material ratios 0 and 1 it gives the ends of the core. Triangles with the areas of the peaks above it and
    the valleys below have the heights Rpk and Rvk. Also for heights of an areal surface (Spk, Sk, Svk).

    Returns them as "pk", "k", "vk", with the material ratios "mr1" and "mr2" at the upper and lower end of
    the core, and the height of its upper end, "top" [m].
    """
    heights, ratio = np.sort(z, axis=None)[::-1], (np.arange(z.size) + 0.5) / z.size
    width = max(int(round(CORE_FRACTION * z.size)), 1)
    first = int(np.argmin(heights[:-width] - heights[width:]))
    core = slice(first, first + width + 1)
    fall, top = np.polyfit(ratio[core], heights[core], 1)
    bottom = top + fall
    peaks, valleys = np.maximum(heights - top, 0.0), np.maximum(bottom - heights, 0.0)
    mr1, below = float((heights > top).mean()), float((heights < bottom).mean())
    rpk = 2.0 * peaks.mean() / mr1 if mr1 else 0.0
    rvk = 2.0 * valleys.mean() / below if below else 0.0
    lengths = {"pk": float(rpk), "k": 0.0 - float(fall), "vk": float(rvk), "top": float(top)}
    return lengths | {"mr1": mr1, "mr2": 1.0 - below}


def slopes(z: np.ndarray, dx: float) -> np.ndarray:
    """Local slopes along the last axis by the seven-point formula of ISO 21920-2, shape (..., n - 6).

    Central differences of fewer than seven points, shape (..., n).
    """
    from scipy.ndimage import correlate1d

    half = len(SLOPE_WEIGHTS) // 2
    if z.shape[-1] <= 2 * half:
        return np.gradient(z, dx, axis=-1)
    return correlate1d(z, SLOPE_WEIGHTS)[..., half:-half] / dx


def correlation_length(z: np.ndarray, dx: float) -> float:
    """Lag [m] at which the autocorrelation of heights of mean 0 falls to 1/e; nan: not within half of them.

    The autocorrelation is the mean product of all pairs of points with a lag, over the mean square.
    """
    from scipy.fft import irfft, next_fast_len, rfft

    lags = np.arange(z.size // 2)
    length = next_fast_len(2 * z.size, real=True)
    products = irfft(np.abs(rfft(z, length)) ** 2, length)[lags] / (z.size - lags)
    below = products < products[0] / np.e
    if not below.any():
        return np.nan
    k = int(below.argmax())
    return float(dx * (k - (products[0] / np.e - products[k]) / (products[k - 1] - products[k])))


def power_spectrum(z: np.ndarray, dx: float) -> tuple[np.ndarray, np.ndarray]:
    r"""Power spectral density C of heights of mean 0 along the last axis, with a Hann window.

    Normalised by :math:`R_q^2=\frac1\pi\int_0^\infty C\,dq` (Jacobs, Junge and Pastewka, Surf. Topogr.:
    Metrol. Prop. 5 (2017) 013001).

    Returns q [rad/m] above 0 and C [m^3], the mean over other axes.
    """
    n = z.shape[-1]
    window = np.hanning(n + 1)[:-1]
    amplitude = np.fft.rfft(z * window).reshape(-1, n // 2 + 1)[:, 1:]
    q = 2.0 * np.pi * np.fft.rfftfreq(n, dx)[1:]
    return q, dx * np.mean(np.abs(amplitude) ** 2, axis=0) / np.sum(window**2)


def binned(q: np.ndarray, density: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Means of wavenumbers and densities in bins of equal width of log q."""
    number = np.floor(BINS_PER_DECADE * np.log10(q / q[0]) + 1e-9).astype(int)
    count = np.bincount(number)
    used = count > 0
    sums = np.bincount(number, weights=q), np.bincount(number, weights=density)
    return sums[0][used] / count[used], sums[1][used] / count[used]


def rms_gradient(z: np.ndarray, dx: float, dy: float) -> float:
    """Sdq: root mean square of the gradient, by the formula of :func:`slopes` along rows and columns."""
    return float(np.sqrt(np.mean(slopes(z, dx) ** 2) + np.mean(slopes(z.T, dy) ** 2)))


def rms_curvature(z: np.ndarray, *steps: float) -> float:
    r"""Root mean square of :math:`z_{xx}` [1/m], of a map of :math:`(z_{xx}+z_{yy})/2`, by three points.

    `z`: shape (n,) or (ny, nx), three points or more along each axis.
    `steps`: distance of the points, of a map dx and dy [m].
    """
    inner = [slice(1, -1)] * z.ndim
    second = [
        (np.roll(z, -1, axis) - 2.0 * z + np.roll(z, 1, axis))[tuple(inner)] / step**2
        for axis, step in zip(range(z.ndim - 1, -1, -1), steps, strict=True)
    ]
    return float(np.sqrt(np.mean((sum(second) / z.ndim) ** 2)))


def autocorrelation(z: np.ndarray) -> np.ndarray:
    """Autocorrelation of heights of mean 0, shape (ny, nx), at lags below half the size.

    Mean of the products of all pairs of points with this lag over the mean square; lag 0 is in the middle.

    Returns shape (2 (ny // 2) + 1, 2 (nx // 2) + 1).
    """
    from scipy.fft import irfft2, next_fast_len, rfft2

    shape = [next_fast_len(n + n // 2, real=True) for n in z.shape]
    products = irfft2(np.abs(rfft2(z, shape)) ** 2, shape)
    lags = [np.arange(-(n // 2), n // 2 + 1) for n in z.shape]
    pairs = np.multiply.outer(*(n - np.abs(lag) for n, lag in zip(z.shape, lags, strict=True)))
    return products[np.ix_(*lags)] / pairs / np.mean(z**2)


def correlation_lengths(z: np.ndarray, dx: float, dy: float) -> tuple[float, float]:
    """Lags [m] at which the autocorrelation falls to 0.2 in the direction of its fastest and slowest decay.

    Followed from lag 0 in all directions; nan where it has not fallen at half the size of the map.
    """
    correlation, step = autocorrelation(z), 0.5 * min(dx, dy)
    half = [n // 2 * spacing for n, spacing in zip(correlation.shape, (dy, dx), strict=True)]
    lag = step * np.arange(whole_down(np.hypot(*half) / step) + 1)
    followed = _in_all_directions(correlation, lag, (dy, dx), np.nan)
    below = followed < CORRELATION_THRESHOLD
    fallen, falls = np.full(LAY_DIRECTIONS, np.nan), np.flatnonzero(below.any(axis=0))
    first = below.argmax(axis=0)[falls]
    after, before = followed[first, falls], followed[first - 1, falls]
    fallen[falls] = lag[first] - step * (CORRELATION_THRESHOLD - after) / (before - after)
    if np.isnan(fallen).all():
        return np.nan, np.nan
    return float(np.nanmin(fallen)), float(fallen.max())


def _in_all_directions(
    values: np.ndarray, distance: np.ndarray, steps: Sequence[float], beyond: float
) -> np.ndarray:
    """Values (ny, nx) at distances (n,) from their middle in `LAY_DIRECTIONS` directions of half a turn.

    `steps`: spacings of the rows and columns. `beyond`: value outside. Returns shape (n, LAY_DIRECTIONS).
    """
    from scipy.ndimage import map_coordinates

    places = [
        n // 2 + np.outer(distance, along) / step
        for n, along, step in zip(values.shape, (np.sin(LAY_ANGLES), np.cos(LAY_ANGLES)), steps, strict=True)
    ]
    return map_coordinates(values, places, order=1, cval=beyond)


def developed_ratio(z: np.ndarray, dx: float, dy: float) -> float:
    r"""Sdr: mean of :math:`\sqrt{1+z_x^2+z_y^2}-1` where both slopes exist.

    Slopes by :func:`slopes`.
    """
    along, across = slopes(z, dx), slopes(z.T, dy).T
    above, before = (len(along) - len(across)) // 2, (across.shape[1] - along.shape[1]) // 2
    both = along[above : above + len(across)], across[:, before : before + along.shape[1]]
    squared = both[0] ** 2 + both[1] ** 2
    return float(np.mean(squared / (np.sqrt(1.0 + squared) + 1.0)))  # without cancellation


def texture_direction(z: np.ndarray, dx: float, dy: float) -> float:
    r"""Std [degrees]: normal to the direction with the largest :math:`\int r|F(r,\theta)|^2 dr`.

    F is the Fourier transform of the heights in polar coordinates, with a Hann window along x and y.
    """
    window = np.multiply.outer(*(np.hanning(n + 2)[1:-1] for n in z.shape))
    power = np.fft.fftshift(np.abs(np.fft.fft2(z * window)) ** 2)
    steps = [1.0 / (n * step) for n, step in zip(z.shape, (dy, dx), strict=True)]  # of frequencies
    radius = min(steps) * np.arange(1, whole_down(0.5 / max(dx, dy) / min(steps)) + 1)
    along = radius @ _in_all_directions(power, radius, steps, 0.0)
    return float(np.degrees(LAY_ANGLES[along.argmax()]) + 90.0) % 180.0


def ten_point_height(z: np.ndarray) -> float:
    """S10z [m] of heights of mean 0."""
    least = PRUNED * np.ptp(z)
    return float(sum(np.sort(peaks(side, least))[-S10Z_PEAKS:].mean() for side in (z, -z)))


def peaks(z: np.ndarray, least: float) -> np.ndarray:
    """Heights of the peaks from which every way to a higher one falls by `least` or more."""
    order = np.argsort(-z, axis=None, kind="stable")
    return _peaks(np.ascontiguousarray(z, float), order, float(least))


@compiled()
def _peaks(z: np.ndarray, order: np.ndarray, least: float) -> np.ndarray:
    """Peaks of hills that grow as points are added in falling order and end where they meet higher ones."""
    ny, nx = z.shape
    heights = z.ravel()
    parent = np.full(z.size, -1)
    is_peak = np.zeros(z.size, np.bool_)
    for point in order:
        row, column, best = point // nx, point % nx, -1
        for k in range(9):
            j, i = row + k // 3 - 1, column + k % 3 - 1
            if j < 0 or j >= ny or i < 0 or i >= nx or parent[j * nx + i] < 0:
                continue
            root = j * nx + i
            while parent[root] != root:
                parent[root] = parent[parent[root]]
                root = parent[root]
            if best < 0:
                best = root
            elif root != best:
                lower = root if heights[root] <= heights[best] else best
                best = best if lower == root else root
                is_peak[lower] = heights[lower] - heights[point] >= least
                parent[lower] = best
        parent[point] = point if best < 0 else best
    is_peak[order[0]] = True
    return heights[is_peak]
