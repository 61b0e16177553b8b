"""Path of contact of a gear pair: load, radius and speeds over time, of helical pairs in a normal section."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ehlpetsc.base.errors import CaseError
from ehlpetsc.gears.faults import faults, notes
from ehlpetsc.gears.geometry import GearPair
from ehlpetsc.gears.load_sharing import share, single_stiffness

PATH_INTERVALS = 2000  # equal intervals of the path, in addition to its points


@dataclass(frozen=True)
class Path:
    """Conditions of a contact from A, tip of the wheel, to E, tip of the pinion.

    `time`: from A on [s], increasing, shape (n,).
    `load`: load of this pair of teeth [N/m], shape (n,).
    `radius`: radius of relative curvature [m], shape (n,).
    `speed_1`, `speed_2`: speeds of the flanks of pinion and wheel through the contact [m/s], shape (n,).
    `rho`: position on the line of action from the base circle of the pinion [m], shape (n,).
    `pressure_angle`: working pressure angle [degrees].
    """

    time: np.ndarray
    load: np.ndarray
    radius: np.ndarray
    speed_1: np.ndarray
    speed_2: np.ndarray
    rho: np.ndarray
    contact_ratio: float
    pressure_angle: float
    pair: GearPair

    @property
    def entrainment(self) -> np.ndarray:
        """Entrainment speed, mean of both speeds [m/s]."""
        return 0.5 * (self.speed_1 + self.speed_2)

    @property
    def slide_roll_ratio(self) -> np.ndarray:
        """Sliding over entrainment speed, positive where flank 1 is the faster."""
        return (self.speed_1 - self.speed_2) / self.entrainment

    def index(self, point: str) -> int:
        """Index of the sample at a point of :attr:`GearPair.points_on_path`."""
        return int(np.argmin(np.abs(self.rho - self.pair.points[point])))


def hertz(path: Path, modulus: float) -> tuple[np.ndarray, np.ndarray]:
    """Half-width [m] and Hertz pressure [Pa] along a path; `modulus`: reduced modulus E' [Pa]."""
    a = np.sqrt(8.0 * path.load * path.radius / (np.pi * modulus))
    return a, 0.25 * modulus * a / path.radius


def path_of_contact(gears: GearPair | Mapping[str, Any]) -> Path:
    """Path of contact of a gear pair, or of its keys; raises `CaseError` for an impossible geometry.

    Examples
    --------
    >>> from ehlpetsc.gears import path_of_contact
    >>> path = path_of_contact({
    ...     "module": 4.5e-3, "teeth": [16, 24], "pressure_angle": 20.0, "centre_distance": 91.5e-3,
    ...     "tip_diameter": [82.5e-3, 118.4e-3], "face_width": 14e-3, "torque": 302.0, "speed": 2250.0,
    ... })
    >>> round(path.contact_ratio, 3), round(path.pressure_angle, 3)
    (1.443, 22.439)
    """
    pair = gears if isinstance(gears, GearPair) else GearPair(**gears)
    found = faults(pair)
    if found:
        raise CaseError(found)
    points = pair.points_on_path
    rho = np.linspace(points["A"], points["E"], PATH_INTERVALS + 1)
    rho = np.unique(np.concatenate([rho, list(points.values())]))
    # positions that differ by rounding would be equal times
    rho = rho[np.append(True, np.diff(rho) > 1e-9 * pair.base_pitch)]
    speed_1, speed_2 = pair.speeds(rho)
    return Path(
        time=(rho - points["A"]) / pair.base_speed,
        load=share(pair, rho) * pair.normal_load,
        radius=pair.radius(rho),
        speed_1=speed_1,
        speed_2=speed_2,
        rho=rho,
        contact_ratio=pair.contact_ratio,
        pressure_angle=float(np.degrees(pair.working_angle)),
        pair=pair,
    )


def describe(path: Path) -> list[str]:
    """Lines of text about a path: angle, ratios, lengths, sharing, hunting."""
    pair = path.pair
    overlap = f", overlap ratio {pair.overlap_ratio:.3f}" if pair.helix_angle else ""
    tips = " and ".join(f"{1e3 * abs(d):.3f}" for d in pair.tip_diameter)
    x1, x2 = pair.shifts
    source = "as given" if pair.mesh_stiffness is not None else "ISO 6336-1"
    lines = [
        f"working pressure angle {path.pressure_angle:.3f} degrees, "
        f"contact ratio {path.contact_ratio:.3f}{overlap}",
        f"centre distance {1e3 * abs(pair.centre_distance):.3f} mm, tip diameters {tips} mm, "
        f"profile shift {x1:.4f} and {x2:.4f}",
        f"load {1e-3 * pair.normal_load:.1f} kN/m of the mesh, load sharing: {pair.rule}",
        f"single stiffness c' of a tooth pair {1e-9 * single_stiffness(pair):.2f} N/(mm µm), {source}: "
        f"one pair bends by {1e6 * pair.normal_load / single_stiffness(pair):.1f} µm",
        f"a pinion tooth meets {pair.partners} of {abs(pair.teeth[1])} wheel teeth; "
        f"shift of flank 2 between passes {1e3 * pair.hunting_shift:.4f} mm",
    ]
    if "C" not in pair.points_on_path:
        at, a, e = (pair.points[name] for name in "CAE")
        where = f"{1e3 * (a - at):.3g} mm before A" if at < a else f"{1e3 * (at - e):.3g} mm after E"
        lines.append(f"the pitch point lies {where}: the flanks slide in one direction along the whole path")
    lines += [f"warning: {note}" for note in notes(pair)]
    if pair.tip_relief > 0.0:
        kappa = single_stiffness(pair) * pair.tip_relief / pair.normal_load
        lines.append(f"tip relief {1e6 * pair.tip_relief:.1f} µm, c' C_a/w' = {kappa:.2f}")
    return lines


def gear_loss_factor(path: Path) -> float:
    r"""Loss factor H_V of the load sharing of a path.

    .. math:: H_V=\frac{1}{p_b}\int_A^E\frac{w'}{w'_\mathrm{mesh}}\frac{|u_1-u_2|}{v_b}d\rho

    with the speed :math:`v_b=\omega_1r_{b1}` along the line of action.
    """
    return loss(path, 1.0)


def loss(path: Path, friction: float | np.ndarray) -> float:
    r"""Power lost over the transmitted power, with friction coefficients along the path.

    `friction`: :math:`\mu` at the samples of the path, shape (n,).
    """
    pair = path.pair
    sliding = np.abs(path.speed_1 - path.speed_2) / pair.base_speed
    integrand = friction * path.load / pair.normal_load * sliding
    return float(0.5 * (integrand[1:] + integrand[:-1]) @ np.diff(path.rho) / pair.base_pitch)


def mean_friction(path: Path, friction: float | np.ndarray) -> float:
    """Mean coefficient of friction of the mesh: the loss over H_V."""
    return loss(path, friction) / gear_loss_factor(path)
