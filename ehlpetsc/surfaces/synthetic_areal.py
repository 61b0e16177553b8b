"""Synthetic areal surfaces, on grids."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ehlpetsc.base.errors import ProfileError
from ehlpetsc.surfaces import self_affine, synthetic
from ehlpetsc.surfaces.synthetic import POINTS_PER_WAVE
from ehlpetsc.surfaces.topography import Topography

if TYPE_CHECKING:
    from ehlpetsc.base.declarations import Values

GROUND_POINTS, GROUND_LENGTH = 5, 60  # points a correlation length, correlation lengths along x
CUTOFF_POINTS, ROLL_OFFS = 6, 20  # points of the shortest wave, longest self-affine waves along x
MAX_POINTS = 16_000_000  # of a map
RANDOM = ("ground", "self-affine")  # may have any direction


def sampled(spec: Values, direction: float, width: float, is_strip: bool) -> Topography:
    """Map of a synthetic surface.

    A random surface is periodic over the width; all others have their middle at y = 0.

    `direction`: of the rows of a random surface against x [degrees].
    `width`: of the mesh across [m].
    `is_strip`: whether the contact is periodic over the width.
    """
    if spec.kind == "self-affine":
        return _self_affine(spec, direction, width)
    if spec.kind == "ground" and spec.correlation_across is not None:
        return _ground(spec, direction, width)
    if direction:
        raise ProfileError(
            f"direction = {direction:g}: of a map in a file or of a random surface; leave it out, or write "
            "kind = " + " or ".join(f'"{kind}"' for kind in RANDOM)
        )
    if spec.kind == "sine" and spec.wavelength_across is not None:
        return _waves(spec, width, is_strip)
    if spec.kind == "dent" or spec.kind == "ridge" and spec.wavelength_across is not None:
        return _bump(spec, width, is_strip)
    X, z, repeats = synthetic.sampled(spec)
    return Topography(X, np.zeros(1), z[np.newaxis], "mirrored" if repeats else "zero")


def _waves(spec: Values, width: float, is_strip: bool) -> Topography:
    """Product of cosines with a crest at X = 0, y = 0."""
    across = spec.wavelength_across
    if is_strip and abs(width / across - max(round(width / across), 1)) > 1e-6 * width / across:
        fitting = width / max(round(width / across), 1)
        raise ProfileError(
            f"wavelength_across = {across:g} m; allowed: whole waves over the width of the strip, "
            f"{width:g} m, next to it {fitting:g} m"
        )
    half_wave = np.cos(np.linspace(0.0, np.pi, POINTS_PER_WAVE // 2 + 1))
    X, Y = (np.linspace(0.0, 0.5 * length, len(half_wave)) for length in (spec.wavelength, across))
    return Topography(X, Y, spec.amplitude * np.multiply.outer(half_wave, half_wave))


def _bump(spec: Values, width: float, is_strip: bool) -> Topography:
    r"""Ridge or dent, :math:`z=\pm A\exp[-(2(X-X_c)/w)^2-(2y/w_y)^2]`; over a strip one in every period."""
    across = spec.wavelength if spec.wavelength_across is None else spec.wavelength_across
    X, along = synthetic.bump(spec)
    reach = 0.5 * width if is_strip else 3 * across
    Y = np.linspace(-reach, reach, max(round(2 * reach / across * POINTS_PER_WAVE), 4) + 1)
    images = width * np.arange(-np.ceil(3 * across / width), np.ceil(3 * across / width) + 1)
    distances = np.subtract.outer(Y, images if is_strip else np.zeros(1))
    profile = np.exp(-((2 * distances / across) ** 2)).sum(axis=1)
    return Topography(X, Y, np.multiply.outer(profile, along), "zero", "periodic" if is_strip else "zero")


def _self_affine(spec: Values, direction: float, width: float) -> Topography:
    spectrum = self_affine.Spectrum(spec.sq, spec.hurst, spec.roll_off, spec.short_cutoff, spec.peklenik)
    finest = np.array([spec.short_cutoff, spec.short_cutoff / spec.peklenik]) / CUTOFF_POINTS
    shape, steps = _grid(
        finest, ROLL_OFFS * spec.roll_off / spec.short_cutoff * CUTOFF_POINTS, direction, width
    )
    return _periodic(self_affine.heights(shape, steps, spectrum, spec.seed, direction), steps)


def _ground(spec: Values, direction: float, width: float) -> Topography:
    r"""Random map with autocorrelation :math:`\exp[-(\xi/l)^2-(\eta/l_\eta)^2]` before it is skewed.

    Along and across the rows; otherwise as :func:`.synthetic.ground`.
    """
    lengths = np.array([spec.correlation, spec.correlation_across])
    shape, steps = _grid(lengths / GROUND_POINTS, GROUND_LENGTH * GROUND_POINTS, direction, width)
    along, across = self_affine.turned_wavenumbers(shape, steps, direction)
    noise = np.fft.rfft2(np.random.default_rng(spec.seed).standard_normal(shape))
    # the square root of the transform of the autocorrelation
    noise *= np.exp(-((along * lengths[0]) ** 2 + (across * lengths[1]) ** 2) / 8.0)
    noise[0, 0] = 0.0
    z = synthetic.with_skewness(np.fft.irfft2(noise, s=shape), spec.skewness)
    return _periodic(z * (spec.ra / np.abs(z).mean()), steps)


def _grid(
    finest: np.ndarray, columns: float, direction: float, width: float
) -> tuple[tuple[int, int], tuple[float, float]]:
    """Points (ny, nx) and spacings (dy, dx) [m] of a periodic map over a width.

    `finest`: spacings along and across its rows [m].
    `columns`: along its rows.
    """
    turn = np.abs([np.cos(np.radians(direction)), np.sin(np.radians(direction))])
    dx, dy = finest if turn[1] < 1e-9 else finest[::-1] if turn[0] < 1e-9 else np.full(2, finest.min())
    length = columns * np.hypot(finest[0] * turn[0], finest[1] * turn[1])
    shape = max(int(np.ceil(width / dy)), 4), int(np.ceil(length / dx))
    if shape[0] * shape[1] > MAX_POINTS:
        raise ProfileError(
            f"{shape[1]} x {shape[0]} points; allowed: at most {MAX_POINTS} in all, so make its shortest "
            "waves longer, its longest shorter, or mesh.width smaller"
        )
    return shape, (width / shape[0], dx)


def _periodic(z: np.ndarray, steps: tuple[float, float]) -> Topography:
    """Map of periodic heights, closed by their first row and column."""
    Y, X = (step * np.arange(n + 1) for n, step in zip(z.shape, steps, strict=True))
    return Topography(X, Y, np.pad(z, (0, 1), mode="wrap"), "periodic", "periodic")
