r"""Involute geometry of a cylindrical gear pair (Niemann & Winter, Maschinenelemente 2; DIN 3960).

Positions on the line of action are measured in the transverse section from the base circle of the pinion:
:math:`\rho_1`, the radius of curvature of its profile. Flank 1 belongs to the pinion, which drives, flank 2
to the wheel. A ring with teeth inside has, as in DIN 3960, a negative number of teeth, negative diameters
and a negative centre distance: the same equations then hold, with :math:`L<0` and :math:`\rho_2<0`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np


def involute(angle: float) -> float:
    """tan(angle) - angle [rad]."""
    return math.tan(angle) - angle


def angle_of(value: float) -> float:
    """Angle [rad] whose involute function has a positive value, by Newton's method."""
    angle = min((3.0 * value) ** (1.0 / 3.0), 1.2)
    for _ in range(30):
        angle -= (involute(angle) - value) / math.tan(angle) ** 2
    return angle


@dataclass(frozen=True)
class GearPair:
    """Dimensions and running conditions of a gear pair; pairs of values are those of pinion and wheel.

    `module`, `pressure_angle`: of the basic rack, in the normal section [m], [degrees].
    `centre_distance`, `tip_diameter`: [m]; left out: of the play-free pair with `profile_shift`.
    `torque`, `speed`: torque [N m] and speed [1/min] of the pinion.
    `helix_angle`: at the reference circle [degrees].
    `addendum`, `tip_clearance`: of the basic rack, over the module.
    `tip_radius`: radius of the tip edges [m].
    `tip_relief`: depth of the relief at both tips, falling linearly to none at B and D [m].
    `internal`: whether the wheel is a ring with teeth inside.
    `load_sharing`: see :mod:`ehlpetsc.gears.load_sharing`; by default by relief and helix.
    `mesh_stiffness`: single stiffness c' of a tooth pair per face width [Pa]; by default that of ISO 6336-1.
    `path`, `load`: positions from the pitch point [m] and load of a pair there [N/m], of a tooth contact
        analysis.
    """

    module: float
    teeth: tuple
    face_width: float
    torque: float
    speed: float
    centre_distance: float | None = None
    tip_diameter: tuple | None = None
    pressure_angle: float = 20.0
    helix_angle: float = 0.0
    profile_shift: tuple | None = None
    addendum: float = 1.0
    tip_clearance: float = 0.25
    tip_radius: float | None = None
    tip_relief: float = 0.0
    load_sharing: str | None = None
    mesh_stiffness: float | None = None
    path: tuple | None = None
    load: tuple | None = None
    internal: bool = False
    given: dict = field(default_factory=dict, init=False, compare=False)

    def __post_init__(self) -> None:
        if self.internal:
            for name in ("teeth", "tip_diameter"):
                if (pair := getattr(self, name)) is not None:
                    object.__setattr__(self, name, (pair[0], -abs(pair[1])))
            if self.centre_distance is not None:
                object.__setattr__(self, "centre_distance", -abs(self.centre_distance))
        if self.profile_shift is None or not 0.0 < self.pressure_angle < 45.0:
            return
        names = ("centre_distance", "tip_diameter")
        self.given.update({name: getattr(self, name) for name in names if getattr(self, name) is not None})
        for name in names:
            if name not in self.given:
                object.__setattr__(self, name, getattr(self, f"play_free_{name}"))

    @property
    def play_free_centre_distance(self) -> float:
        r"""Centre distance by :math:`inv\,\alpha_w=inv\,\alpha_t+2\tan\alpha_n(x_1+x_2)/(z_1+z_2)` [m]."""
        tangent = math.tan(math.radians(self.pressure_angle))
        if sum(self.teeth) == 0:  # a ring with the teeth of its pinion
            return math.nan
        value = involute(self.transverse_angle) + 2.0 * tangent * sum(self.profile_shift) / sum(self.teeth)
        return sum(self.base_radii) / math.cos(angle_of(value)) if value > 0.0 else math.nan

    @property
    def play_free_tip_diameter(self) -> tuple[float, ...]:
        """Tips that leave the tip clearance to the root of the other gear [m]."""
        clearance = self.tip_clearance * self.module
        return tuple(2.0 * (self.centre_distance - clearance) - d for d in reversed(self.root_diameters))

    @property
    def root_diameters(self) -> tuple[float, float]:
        """By profile shift and basic rack [m]."""
        dedendum = self.addendum + self.tip_clearance
        teeth = zip(self.teeth, self.shifts, strict=True)
        return tuple(self.transverse_module * z + 2.0 * self.module * (x - dedendum) for z, x in teeth)

    @property
    def shifts(self) -> tuple[float, float]:
        """Profile shift coefficients: given, or of the play-free pair with this centre distance and tips."""
        if self.profile_shift is not None:
            return self.profile_shift
        tangent = math.tan(math.radians(self.pressure_angle))
        rise = involute(self.working_angle) - involute(self.transverse_angle)
        both = 0.5 * rise * sum(self.teeth) / tangent
        tips = [d - self.transverse_module * z for d, z in zip(self.tip_diameter, self.teeth, strict=True)]
        difference = 0.5 * (tips[0] - tips[1]) / self.module
        return 0.5 * (both + difference), 0.5 * (both - difference)

    @property
    def tip_thicknesses(self) -> tuple[float, ...]:
        r"""Transverse thickness of the tips [m].

        :math:`s_a=d_a[(\frac\pi2+2x\tan\alpha_n)/z+inv\,\alpha_t-inv\,\alpha_a]`,
        :math:`\cos\alpha_a=2r_b/d_a`; below 0 both flanks meet within the tooth.
        """
        tangent, found = math.tan(math.radians(self.pressure_angle)), []
        for z, x, d, r in zip(self.teeth, self.shifts, self.tip_diameter, self.base_radii, strict=True):
            half_turn = (0.5 * math.pi + 2.0 * x * tangent) / z
            at_tip = involute(math.acos(2.0 * r / d))
            found.append(d * (half_turn + involute(self.transverse_angle) - at_tip))
        return tuple(found)

    @property
    def undercut_shifts(self) -> tuple[float, ...]:
        r"""Profile shifts below which a rack undercuts, addendum - :math:`z\sin^2\alpha_t/(2\cos\beta)`."""
        per_tooth = 0.5 * math.sin(self.transverse_angle) ** 2 / math.cos(math.radians(self.helix_angle))
        return tuple(self.addendum - per_tooth * z if z > 0 else -math.inf for z in self.teeth)

    @property
    def load_ratio(self) -> float:
        """Given load of all pairs in contact, mean over the path, over that of the torque."""
        load, path = np.asarray(self.load), np.asarray(self.path)
        return float(0.5 * (load[1:] + load[:-1]) @ np.diff(path) / self.base_pitch / self.normal_load)

    @property
    def rule(self) -> str:
        """Load sharing rule: `load_sharing`, by default according to load, helix and tip relief."""
        if self.load is not None:
            return "load_file"
        is_shared = self.helix_angle or self.fewest_pairs > 1
        default = "tip-relief" if self.tip_relief > 0.0 else "stiffness" if is_shared else "thirds"
        return self.load_sharing or default

    @property
    def transverse_module(self) -> float:
        """[m]."""
        return self.module / math.cos(math.radians(self.helix_angle))

    @property
    def transverse_angle(self) -> float:
        """Pressure angle in the transverse section [rad]."""
        alpha, beta = math.radians(self.pressure_angle), math.radians(self.helix_angle)
        return math.atan(math.tan(alpha) / math.cos(beta)) if beta else alpha

    @property
    def base_helix_angle(self) -> float:
        r"""[rad], :math:`\sin\beta_b=\sin\beta\cos\alpha_n`."""
        alpha, beta = math.radians(self.pressure_angle), math.radians(self.helix_angle)
        return math.asin(math.sin(beta) * math.cos(alpha))

    @property
    def overlap_ratio(self) -> float:
        r""":math:`\varepsilon_\beta=b\sin\beta/(\pi m_n)`."""
        return self.face_width * math.sin(math.radians(self.helix_angle)) / (math.pi * self.module)

    @property
    def base_radii(self) -> tuple[float, float]:
        r"""Base circles [m], :math:`r_b=\frac12 m_tz\cos\alpha_t`."""
        cosine = math.cos(self.transverse_angle)
        return tuple(0.5 * self.transverse_module * z * cosine for z in self.teeth)

    @property
    def base_pitch(self) -> float:
        r"""Distance of neighbouring flanks on the line of action [m], :math:`p_b=\pi m_t\cos\alpha_t`."""
        return math.pi * self.transverse_module * math.cos(self.transverse_angle)

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
        r"""Load of the mesh per length of contact across the face [N/m], :math:`T_1/(r_{b1}b)`.

        Of helical gears too: both the normal load and the line are longer by :math:`1/\cos\beta_b`.
        """
        return self.torque / self.face_width / self.base_radii[0]

    @property
    def points(self) -> dict[str, float]:
        """Positions of A, B, C, D and E [m]: dict of str to float.

        A: tip of the wheel, contact begins; E: tip of the pinion, contact ends; from A to B and from D to E
        one pair more is in contact than the `fewest_pairs`; C: pitch point, which may lie beyond A or E.
        """
        (a, e), others = self._a_and_e(), self.fewest_pairs * self.base_pitch
        c = self.base_radii[0] * math.tan(self.working_angle)
        return {"A": a, "B": e - others, "C": c, "D": a + others, "E": e}

    @property
    def points_on_path(self) -> dict[str, float]:
        """`points` from A to E: without a pitch point beyond them."""
        points = self.points
        return {name: rho for name, rho in points.items() if points["A"] <= rho <= points["E"]}

    @property
    def contact_ratio(self) -> float:
        r""":math:`\varepsilon_\alpha=(\rho_E-\rho_A)/p_b`."""
        a, e = self._a_and_e()
        return (e - a) / self.base_pitch

    @property
    def fewest_pairs(self) -> int:
        """Number of pairs that are in contact at any time: the whole part of the contact ratio, from 1 on."""
        return max(int(self.contact_ratio), 1)

    def _a_and_e(self) -> tuple[float, float]:
        rho = [
            math.copysign(math.sqrt((0.5 * d) ** 2 - r * r), d)
            for d, r in zip(self.tip_diameter, self.base_radii, strict=True)
        ]
        return self.line_of_action - rho[1], rho[0]

    def radius(self, rho: np.ndarray | float) -> np.ndarray | float:
        r"""Radius of relative curvature [m], :math:`\rho_1(L-\rho_1)/(L\cos\beta_b)`, in a normal section."""
        return rho * (self.line_of_action - rho) / (self.line_of_action * math.cos(self.base_helix_angle))

    def speeds(self, rho: np.ndarray | float) -> tuple[np.ndarray | float, np.ndarray | float]:
        r"""Speeds of flanks 1 and 2 [m/s], :math:`\omega_i\rho_i`, across the line of contact."""
        omega = self.angular_speeds
        return omega[0] * rho, omega[1] * (self.line_of_action - rho)

    def flank_arcs(self, rho: np.ndarray | float) -> tuple[np.ndarray | float, np.ndarray | float]:
        r"""Arc lengths on flanks 1 and 2 from A [m], :math:`|\rho_i^2-\rho_{i,A}^2|/(2r_{b,i})`.

        The integrals of both speeds over time.
        """
        a, (r_1, r_2), length = self.points["A"], self.base_radii, self.line_of_action
        return (rho**2 - a**2) / (2.0 * r_1), ((length - a) ** 2 - (length - rho) ** 2) / (2.0 * r_2)

    @property
    def partners(self) -> int:
        r"""Number of wheel teeth that one pinion tooth meets, :math:`z_2/\gcd(z_1,z_2)`."""
        return abs(self.teeth[1]) // math.gcd(*self.teeth)

    @property
    def hunting_shift(self) -> float:
        """Shift of flank 2 between engagements of one pinion tooth [m].

        The wheel flanks in contact with the tooth follow each other in one profile: each engagement begins at
        the end of the previous flank, and the profile of `partners` flanks repeats. 0 if the tooth meets the
        same wheel tooth every time.
        """
        return float(self.flank_arcs(self.points["E"])[1]) if self.partners > 1 else 0.0
