r"""Standards for gear pairs, beside which computed films, temperatures and losses are put.

Each is a pure function of a `Rating` in the table `STANDARDS`. The film of ISO/TS 6336-22 is checked against
Procedia Struct. Integr. 57 (2024) 199, eq. 10, friction and :math:`H_V` against public code (GEARpie of
C. Fernandes); the other formulas, and the limits of all, are from memory.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ehlpetsc.gears.geometry import GearPair
from ehlpetsc.gears.path import Path, hertz, loss
from ehlpetsc.physics.flash_temperature import STEEL, blok_flash_temperature
from ehlpetsc.physics.traction import hoehn_michaelis

BULK_OF_FLASH = 0.47  # of the mean flash temperature, for dip lubrication, one mesh a revolution


@dataclass(frozen=True)
class Rating:
    """Contact, oil and temperatures of a gear pair, as standards need them.

    `modulus`: reduced modulus E' [Pa].
    `roughness`: Ra, mean of both flanks [m]; 0: smooth.
    `viscosity`, `pressure_viscosity`: of the oil at ambient pressure [Pa s], [1/Pa], functions of temperature
        [K].
    `film_friction`: coefficient of friction along the path of smooth flanks, shape (n,); None: rough ones.
    `oil_factor`: X_L of ISO/TR 14179-2.
    `bulk`, `oil`: temperatures of the gears, mean of both, and of the oil that is supplied [K].
    """

    path: Path
    modulus: float
    roughness: float
    viscosity: Callable[[np.ndarray], np.ndarray]
    pressure_viscosity: Callable[[np.ndarray], np.ndarray]
    film_friction: np.ndarray | None
    bulk: float
    oil: float
    effusivities: tuple[float, float] = (STEEL.effusivity, STEEL.effusivity)
    oil_factor: float = 1.0


def friction(rating: Rating) -> float:
    """Mean coefficient of friction along the path, by load, speed and radius at the pitch point."""
    pair, at = rating.path.pair, rating.path.pair.points["C"]
    of_oil = rating.viscosity(rating.oil), rating.roughness, rating.oil_factor
    return float(hoehn_michaelis(pair.normal_load, sum(pair.speeds(at)), pair.radius(at), *of_oil))


def flash(rating: Rating, coefficient: float | np.ndarray | None = None) -> np.ndarray:
    """Flash temperature of Blok along the path [K], with the mean friction of ISO/TR 14179-2."""
    path, a = rating.path, hertz(rating.path, rating.modulus)[0]
    coefficient = friction(rating) if coefficient is None else coefficient
    speeds = path.speed_1 - path.speed_2, path.speed_1, path.speed_2
    conditions = path.load, *speeds, np.maximum(a, 1e-9), rating.effusivities
    return blok_flash_temperature(coefficient, *conditions)


def film(rating: Rating) -> np.ndarray:
    r"""Film of Dowson and Higginson along the path [m], corrected for the flash temperature.

    :math:`h_Y=1.6\,R\,G^{0.6}U^{0.7}W^{-0.13}S^{0.22}` with :math:`G=\alpha E'`, :math:`U=\eta u/(E'R)` at
    bulk temperature, :math:`W=w'/(E'R)` and S the ratio of :math:`\alpha\eta` with flash temperature to that
    at bulk temperature; nan without load.
    """
    path, bulk, modulus = rating.path, rating.bulk, rating.modulus
    contact = bulk + flash(rating)
    eta, alpha = rating.viscosity(bulk), rating.pressure_viscosity(bulk)
    thinning = rating.viscosity(contact) * rating.pressure_viscosity(contact) / (eta * alpha)
    scale = modulus * path.radius
    load = np.where(path.load > 0.0, path.load, np.nan) / scale
    speed = eta * path.entrainment / scale
    return 1.6 * path.radius * (alpha * modulus) ** 0.6 * speed**0.7 * load**-0.13 * thinning**0.22


def film_ratio(rating: Rating) -> np.ndarray:
    """lambda_GF: the film over the mean Ra of both flanks."""
    return film(rating) / rating.roughness if rating.roughness else np.full_like(rating.path.rho, np.nan)


def loss_factor(pair: GearPair) -> float:
    r"""Loss factor H_V from tooth numbers and contact ratios, Ohlendorf (1958), Niemann & Winter.

    .. math:: H_V=\frac{\pi(i+1)}{z_1i\cos\beta_b}(1-\varepsilon_\alpha+\varepsilon_1^2+\varepsilon_2^2)

    with the gear ratio i and the contact ratios :math:`\varepsilon_{1,2}` from C to E and from A to C: twice
    the integral of :math:`|x|/n`, x the distance from C in base pitches, of a load that the n pairs in
    contact share equally, one or two, with the pitch point where one carries; here for any such point and n.
    """
    points, i = pair.points, pair.teeth[1] / pair.teeth[0]
    a, e = ((points[name] - points["C"]) / pair.base_pitch for name in "AE")
    steps = np.arange(pair.fewest_pairs + 1)
    x = np.unique(np.concatenate([a + steps, e - steps]))
    middle = 0.5 * (x[1:] + x[:-1])
    pairs = np.floor(middle - a) + np.floor(e - middle) + 1.0
    factor = np.pi * (i + 1.0) / (pair.teeth[0] * i * np.cos(pair.base_helix_angle))
    return float(factor * (np.diff(x * np.abs(x)) / pairs).sum())


def bulk_temperatures(
    rating: Rating,
    coefficient: float | np.ndarray | None = None,
    heat_transfer: tuple[float, float] | None = None,
) -> tuple[float, float]:
    r"""Bulk temperatures of pinion and wheel [K] from the losses.

    :math:`T_{oil}+0.47\,\overline{T_{flash}}` of ISO/TS 6336-20, the mean over the path; or, with
    coefficients of heat transfer h [W/(m^2 K)], :math:`T_{oil}+\frac12P_{loss}/(hA)`: half of the losses to
    each gear, A its two sides and the cylinder of its tips.

    `coefficient`: coefficient of friction, also along the path; None: of ISO/TR 14179-2 or, where that of
    smooth flanks is none, of the oil film.
    """
    path, pair = rating.path, rating.path.pair
    if coefficient is None:
        coefficient = friction(rating) if rating.film_friction is None else rating.film_friction
    if heat_transfer is None:
        flashes = flash(rating, coefficient)
        mean = 0.5 * (flashes[1:] + flashes[:-1]) @ np.diff(path.rho) / np.ptp(path.rho)
        return (rating.oil + BULK_OF_FLASH * float(mean),) * 2
    heat = 0.5 * pair.torque * pair.angular_speeds[0] * loss(path, coefficient)
    areas = [np.pi * abs(d) * (0.5 * abs(d) + pair.face_width) for d in pair.tip_diameter]
    return tuple(rating.oil + heat / (h * area) for h, area in zip(heat_transfer, areas, strict=True))


class Standard(NamedTuple):
    """A quantity of a standard: function of a rating, unit and factor to it, source, reduction of a path."""

    function: Callable[[Rating], np.ndarray | float]
    unit: str
    factor: float
    source: str
    reduction: Callable[[np.ndarray], float] = float


STANDARDS = {
    "mean film": Standard(film, "µm", 1e6, "ISO/TS 6336-22", np.nanmean),
    "minimum lambda_GF": Standard(film_ratio, "", 1.0, "ISO/TS 6336-22", np.nanmin),
    "maximum flash temperature": Standard(flash, "K", 1.0, "ISO/TS 6336-20 (Blok)", np.nanmax),
    "mean friction coefficient": Standard(friction, "", 1.0, "ISO/TR 14179-2"),
    "loss factor H_V": Standard(lambda r: loss_factor(r.path.pair), "", 1.0, "Niemann and Winter"),
    "power lost": Standard(lambda r: friction(r) * loss_factor(r.path.pair), "%", 1e2, "ISO/TR 14179-2"),
    "bulk temperature": Standard(lambda r: bulk_temperatures(r)[0], "K", 1.0, "ISO/TS 6336-20"),
}


def values_of(rating: Rating) -> dict[str, np.ndarray | float]:
    """Values of all standards in their unit, along the path or one; without those that need rough flanks."""
    found = {name: entry.factor * entry.function(rating) for name, entry in STANDARDS.items()}
    return {name: value for name, value in found.items() if np.any(np.nan_to_num(value) > 0.0)}
