r"""Involute geometry of an external spur gear pair (Niemann & Winter, Maschinenelemente 2; ISO 21771).

Positions on the line of action are measured from the base circle of the pinion: :math:`\rho_1`, which is the
radius of curvature of its flank. Flank 1 belongs to the pinion, flank 2 to the wheel; the pinion drives.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

POINTS = ("A", "B", "C", "D", "E")
MESH_STIFFNESS = 14e9  # Pa: single stiffness c' of steel teeth, 14 N/(mm um) of ISO 6336-1


@dataclass(frozen=True)
class GearPair:
    """Dimensions and running conditions of a spur gear pair; pairs of values are those of pinion and wheel.

    Attributes
    ----------
    module, centre_distance, face_width
        [m].
    pressure_angle
        Pressure angle of the basic rack [degrees].
    tip_diameter
        [m].
    torque, speed
        Torque [N m] and speed [1/min] of the pinion.
    tip_relief
        Depth of the relief at both tips, falling linearly to none at B and D [m].
    load_sharing
        "thirds" or "tip-relief", see :mod:`ehlpetsc.gears.load_sharing`; by default by the relief.
    mesh_stiffness
        Single stiffness c' of a tooth pair per face width [Pa].
    """

    module: float
    teeth: tuple
    centre_distance: float
    tip_diameter: tuple
    face_width: float
    torque: float
    speed: float
    pressure_angle: float = 20.0
    tip_relief: float = 0.0
    load_sharing: str | None = None
    mesh_stiffness: float = MESH_STIFFNESS

    @property
    def rule(self) -> str:
        """Load sharing rule: `load_sharing`, by default according to the tip relief."""
        return self.load_sharing or ("tip-relief" if self.tip_relief > 0.0 else "thirds")

    @property
    def base_radii(self) -> tuple[float, float]:
        r"""Base circles [m], :math:`r_b=\frac12 mz\cos\alpha`."""
        cosine = math.cos(math.radians(self.pressure_angle))
        return tuple(0.5 * self.module * z * cosine for z in self.teeth)

    @property
    def base_pitch(self) -> float:
        r"""Distance of neighbouring flanks on the line of action [m], :math:`p_b=\pi m\cos\alpha`."""
        return math.pi * self.module * math.cos(math.radians(self.pressure_angle))

    @property
    def working_angle(self) -> float:
        r"""Working pressure angle [rad], :math:`\cos\alpha_w=(r_{b1}+r_{b2})/a_w`."""
        return math.acos(sum(self.base_radii) / self.centre_distance)

    @property
    def line_of_action(self) -> float:
        r"""Length between the base circles [m], :math:`L=a_w\sin\alpha_w`."""
        return self.centre_distance * math.sin(self.working_angle)

    @property
    def base_speed(self) -> float:
        r"""Speed along the line of action [m/s], :math:`\omega_1r_{b1}`."""
        return self.angular_speeds[0] * self.base_radii[0]

    @property
    def angular_speeds(self) -> tuple[float, float]:
        """Angular speeds of pinion and wheel [rad/s]."""
        omega = self.speed * math.pi / 30.0
        return omega, omega * self.teeth[0] / self.teeth[1]

    @property
    def normal_load(self) -> float:
        r"""Load on the flanks per face width [N/m], :math:`T_1/(r_{b1}b)`."""
        return self.torque / self.face_width / self.base_radii[0]

    @property
    def points(self) -> dict[str, float]:
        """Positions of A, B, C, D and E [m]: dict of str to float.

        A: tip of the wheel, contact begins; E: tip of the pinion, contact ends; a single pair carries between
        B and D; C: pitch point.
        """
        a, e = self._a_and_e()
        c = self.base_radii[0] * math.tan(self.working_angle)
        return {"A": a, "B": e - self.base_pitch, "C": c, "D": a + self.base_pitch, "E": e}

    @property
    def contact_ratio(self) -> float:
        r""":math:`\varepsilon_\alpha=(\rho_E-\rho_A)/p_b`."""
        a, e = self._a_and_e()
        return (e - a) / self.base_pitch

    def _a_and_e(self) -> tuple[float, float]:
        rho = [
            math.sqrt((0.5 * d) ** 2 - r * r) for d, r in zip(self.tip_diameter, self.base_radii, strict=True)
        ]
        return self.line_of_action - rho[1], rho[0]

    def radius(self, rho: Any) -> Any:
        r"""Radius of relative curvature [m], :math:`\rho_1(L-\rho_1)/L`."""
        return rho * (self.line_of_action - rho) / self.line_of_action

    def speeds(self, rho: Any) -> tuple[Any, Any]:
        r"""Rolling speeds of flanks 1 and 2 [m/s], :math:`\omega_i\rho_i`."""
        omega = self.angular_speeds
        return omega[0] * rho, omega[1] * (self.line_of_action - rho)

    def flank_arcs(self, rho: Any) -> tuple[Any, Any]:
        r"""Arc lengths on flanks 1 and 2 from A [m], :math:`|\rho_i^2-\rho_{i,A}^2|/(2r_{b,i})`.

        The integrals of both speeds over time.
        """
        a, (r_1, r_2), length = self.points["A"], self.base_radii, self.line_of_action
        return (rho**2 - a**2) / (2.0 * r_1), ((length - a) ** 2 - (length - rho) ** 2) / (2.0 * r_2)

    @property
    def partners(self) -> int:
        r"""Number of wheel teeth that one pinion tooth meets, :math:`z_2/\gcd(z_1,z_2)`."""
        return self.teeth[1] // math.gcd(*self.teeth)

    @property
    def hunting_shift(self) -> float:
        """Shift of flank 2 between engagements of one pinion tooth [m].

        The wheel flanks in contact with the tooth follow each other in one profile: each engagement begins at
        the end of the previous flank, and the profile of `partners` flanks repeats. 0 if the tooth meets the
        same wheel tooth every time.
        """
        return float(self.flank_arcs(self.points["E"])[1]) if self.partners > 1 else 0.0

    def faults(self) -> list[str]:
        """Faults of the geometry, one message each, with the key."""
        r_b = self.base_radii
        faults = []
        if not 0.0 < self.pressure_angle < 45.0:
            return [f"gears.pressure_angle = {self.pressure_angle:g}: allowed: > 0 and < 45 degrees"]
        if self.load_sharing == "tip-relief" and self.tip_relief == 0.0:
            faults.append('tip_relief is missing; load_sharing = "tip-relief" needs its depth')
        if self.centre_distance <= sum(r_b):
            faults.append(
                f"centre_distance = {self.centre_distance:g}: the base circles overlap; allowed: above "
                f"{sum(r_b):.5g} m, the sum of their radii"
            )
        for name, d, r in zip(("pinion", "wheel"), self.tip_diameter, r_b, strict=True):
            if d <= 2.0 * r:
                faults.append(
                    f"tip_diameter = {d:g} of the {name}: no involute flank below its base circle; allowed: "
                    f"above {2.0 * r:.5g} m"
                )
        return [f"gears.{fault}" for fault in (faults or self._faults_of_the_path())]

    def _faults_of_the_path(self) -> list[str]:
        (a, e), length, r_b = self._a_and_e(), self.line_of_action, self.base_radii
        faults = []
        for name, other, over, r in (
            ("wheel", "pinion", a <= 0.0, r_b[1]),
            ("pinion", "wheel", e >= length, r_b[0]),
        ):
            if over:
                faults.append(
                    f"tip_diameter: the tips of the {name} reach below the base circle of the {other} "
                    f"(interference); allowed for the {name}: below {2.0 * math.hypot(length, r):.5g} m"
                )
        ratio = self.contact_ratio
        if not faults and not 1.0 <= ratio < 2.0:
            faults.append(
                f"tip_diameter = {list(self.tip_diameter)}: contact ratio {ratio:.3f}, at a distance "
                f"of the centres of {self.centre_distance:g} m; allowed: 1 to 2"
            )
        return faults
