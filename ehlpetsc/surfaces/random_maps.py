"""Random maps: self-affine ones, and ground ones with a lay.

A map is a function of its keys and its seed, not of the mesh, so that contacts of different loads or widths
compare one surface. It is white noise on a lattice that the keys set, filtered with the lattice as its
period, and repeats along and across after `SELF_AFFINE_WAVES` or `GROUND_WAVES` of its longest waves.

A strip is periodic over its own width. It takes the noise next to y = 0 that its width holds, and its heights
are continuous in the width: two strips agree around y = 0, and differ near the edges of the narrower one,
where its neighbours are those of its own other edge.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ehlpetsc.base.counts import whole_up
from ehlpetsc.base.errors import ProfileError
from ehlpetsc.surfaces.synthetic import (
    Spectrum,
    random_heights,
    turned_wavenumbers,
    white_noise,
    with_skewness,
)
from ehlpetsc.surfaces.topography import Topography

if TYPE_CHECKING:
    from ehlpetsc.base.declarations import Values

RANDOM_MAPS = ("ground", "self-affine")  # kinds; may have any direction
SELF_AFFINE_POINTS, SELF_AFFINE_WAVES = 6, 20  # points of the shortest wave, longest waves of a period
GROUND_POINTS, GROUND_WAVES = 5, 60  # points of a correlation length, correlation lengths of a period
MAX_MAP_POINTS = 4_000_000  # the period is shorter beyond it
MIN_WAVES = 2  # longest waves of a period


def random_map(spec: Values, direction: float, width: float | None) -> Topography:
    """Periodic map of a random surface with its row Y = 0 at y = 0.

    `direction`: of its rows against x, towards y [degrees].
    `width`: period of a strip [m]; None: that of the surface.

    ProfileError if a period of `MIN_WAVES` longest waves has too many points.
    """
    return (_self_affine if spec.kind == "self-affine" else _ground)(spec, direction, width)


def _self_affine(spec: Values, direction: float, width: float | None) -> Topography:
    spectrum = Spectrum(spec.sq, spec.hurst, spec.roll_off, spec.short_cutoff, spec.peklenik)
    longest = np.array([spec.roll_off, spec.roll_off / spec.peklenik])
    finest = longest * (spec.short_cutoff / spec.roll_off / SELF_AFFINE_POINTS)
    shape, steps, rows = _lattice(longest, finest, SELF_AFFINE_WAVES, direction, width)
    return _periodic(random_heights(shape, steps, spectrum, spec.seed, direction, rows), steps)


def _ground(spec: Values, direction: float, width: float | None) -> Topography:
    r"""Random map with autocorrelation :math:`\exp[-(\xi/l)^2-(\eta/l_\eta)^2]` before it is skewed.

    Along and across the rows; otherwise as :func:`.synthetic.ground`.
    """
    lengths = np.array([spec.correlation, spec.correlation_across])
    shape, steps, rows = _lattice(lengths, lengths / GROUND_POINTS, GROUND_WAVES, direction, width)
    along, across = turned_wavenumbers(shape, steps, direction)
    noise = white_noise(shape, spec.seed, rows)
    # the square root of the transform of the autocorrelation
    noise *= np.exp(-((along * lengths[0]) ** 2 + (across * lengths[1]) ** 2) / 8.0)
    noise[0, 0] = 0.0
    z = with_skewness(np.fft.irfft2(noise, s=shape), spec.skewness)
    return _periodic(z * (spec.ra / np.abs(z).mean()), steps)


def _lattice(
    longest: np.ndarray, finest: np.ndarray, waves: int, direction: float, width: float | None
) -> tuple[tuple[int, int], tuple[float, float], float | None]:
    """Points (ny, nx) and spacings (dy, dx) [m] of one period, and rows of the lattice in a width.

    `longest`, `finest`: waves and spacings along and across the rows of the surface [m].
    `waves`: longest waves of a period.
    `width`: period across [m]; None: as along.
    """
    c, s = np.abs([np.cos(np.radians(direction)), np.sin(np.radians(direction))])
    steps = finest if s < 1e-9 else finest[::-1] if c < 1e-9 else np.full(2, finest.min())
    wave = np.hypot(longest * c, longest[::-1] * s)  # along x and y
    period = waves * wave
    if width is not None:
        period[1] = width
    excess = max(np.prod(period / steps) / MAX_MAP_POINTS, 1.0)
    period /= [excess, 1.0] if width is not None else np.sqrt(excess)
    nx, ny = (max(whole_up(count), 4) for count in period / steps)
    if excess > 1.0 and (period < MIN_WAVES * wave * [1, width is None]).any():
        nx, ny = (whole_up(count) for count in np.maximum(period, MIN_WAVES * wave) / steps)
        raise ProfileError(
            f"{nx} x {ny} points; allowed: at most {MAX_MAP_POINTS} in all, so make its shortest waves "
            "longer, its longest shorter, or the mesh.width of a strip smaller"
        )
    dx, dy = map(float, steps)
    return ((ny, nx), (dy, dx), None) if width is None else ((ny, nx), (width / ny, dx), width / dy)


def _periodic(z: np.ndarray, steps: tuple[float, float]) -> Topography:
    """Map of periodic heights, closed by their first row and column."""
    Y, X = (step * np.arange(n + 1) for n, step in zip(z.shape, steps, strict=True))
    return Topography(X, Y, np.pad(z, (0, 1), mode="wrap"), "periodic", "periodic")
