"""Self-affine random roughness, of profiles and of areal surfaces."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ehlpetsc.base.errors import ProfileError


class Spectrum(NamedTuple):
    r"""Power spectrum of isotropic, or stretched, self-affine roughness.

    In d dimensions :math:`C(q)\propto1` up to :math:`q_0=2\pi/` `roll_off`,
    :math:`C(q)\propto(q/q_0)^{-(2H+d)}` from there to :math:`q_1=2\pi/` `short_cutoff`, and 0 beyond
    (Persson, J. Phys.: Condens. Matter 17 (2005) R1).

    `sq`: root mean square height [m].
    `hurst`: H, between 0 and 1.
    `roll_off`, `short_cutoff`: longest self-affine and shortest wavelength along x [m].
    `peklenik`: ratio of the wavelengths along x to those along y, for two dimensions; below 1 the lay is
        along y. The spectrum along x stays the same.
    """

    sq: float
    hurst: float
    roll_off: float
    short_cutoff: float
    peklenik: float = 1.0

    def density(self, q: np.ndarray, dimensions: int) -> np.ndarray:
        """C(q) over its plateau at angular wavenumbers q along x [rad/m]."""
        relative = np.maximum(q * (self.roll_off / (2 * np.pi)), 1.0)
        within = q <= (1 + 1e-12) * 2 * np.pi / self.short_cutoff
        return within * relative ** -(2 * self.hurst + dimensions)


def heights(
    shape: Sequence[int],
    spacing: Sequence[float],
    spectrum: Spectrum,
    seed: int,
    direction: float = 0.0,
) -> np.ndarray:
    """Periodic heights [m] of one realisation, Gaussian, of mean 0 and root mean square `sq` exactly.

    White noise, filtered in Fourier space by the square root of the spectrum.

    `shape`: points, (nx,) or (ny, nx).
    `spacing`: their distances [m], (dx,) or (dy, dx).
    `direction`: of the stretch against x, towards y [degrees].

    ProfileError where the points resolve no wave of the spectrum: `short_cutoff` below two spacings or
    above the period.
    """
    spectrum_spacing = np.array(spacing, float)
    spectrum_spacing[:-1] *= spectrum.peklenik  # across: in lengths along x
    shortest, period = 2 * spectrum_spacing.max(), (spectrum_spacing * shape).max()
    if not shortest * (1 - 1e-12) <= spectrum.short_cutoff <= period:
        raise ProfileError(
            f"short_cutoff = {spectrum.short_cutoff:g} m; allowed: at least two spacings, {shortest:g} m, at "
            f"most the period, {period:g} m"
        )
    along, *across = turned_wavenumbers(shape, spacing, direction)
    q = np.sqrt(sum(np.square(component / spectrum.peklenik) for component in across) + along**2)
    noise = np.fft.rfftn(np.random.default_rng(seed).standard_normal(shape))
    power = spectrum.density(q, len(shape))
    if across and not direction:
        power *= _same_along(along[0], spectrum, spacing[0] * shape[0])
    noise *= np.sqrt(power)
    noise.flat[0] = 0.0
    z = np.fft.irfftn(noise, s=shape, axes=range(len(shape)))
    return z * (spectrum.sq / np.sqrt(np.mean(z**2)))


def _same_along(q: np.ndarray, spectrum: Spectrum, period: float) -> np.ndarray:
    """Factor by which a stretched surface has the spectrum along x of an isotropic one of this period across.

    Without it a lay longer than the period would leave only the waves of q_y = 0, a steeper spectrum.

    `q`: angular wavenumbers along x [rad/m].
    `period`: across [m].
    """
    if spectrum.peklenik == 1.0:
        return np.ones_like(q)

    def along(peklenik: float) -> np.ndarray:
        count = np.ceil(peklenik * period / spectrum.short_cutoff)
        across = 2 * np.pi / (peklenik * period) * np.arange(-count, count + 1)
        return spectrum.density(np.hypot.outer(across, q), 2).sum(axis=0)

    stretched = along(spectrum.peklenik)
    return np.divide(along(1.0), stretched, out=np.ones_like(q), where=stretched > 0.0)


def turned_wavenumbers(
    shape: Sequence[int], spacing: Sequence[float], direction: float = 0.0
) -> list[np.ndarray]:
    """Angular wavenumbers [rad/m] of a real transform along a direction and, in two dimensions, across it.

    `direction`: against x, towards y [degrees].
    """
    frequencies = [np.fft.fftfreq] * (len(shape) - 1) + [np.fft.rfftfreq]
    axes = [2 * np.pi * f(n, d) for f, n, d in zip(frequencies, shape, spacing, strict=True)]
    x, *y = np.meshgrid(*axes, indexing="ij")[::-1]
    if not y or not direction:
        return [x, *y]
    c, s = np.cos(np.radians(direction)), np.sin(np.radians(direction))
    return [c * x + s * y[0], c * y[0] - s * x]
