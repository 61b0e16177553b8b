"""Faults that make a gear pair impossible, and warnings to its user."""

from __future__ import annotations

import math

import numpy as np

from ehlpetsc.gears.geometry import GearPair, involute
from ehlpetsc.gears.load_sharing import single_stiffness

SHIFT_TOLERANCE = 0.02  # of the module: centre distance, tip diameters against those of the profile shift
MAX_CONTACT_RATIO = 3  # above it four pairs would share the load
MIN_TIP_THICKNESS = 0.2  # of the module: thinner tips chip
LOAD_RATIO = 2 / 3, 3 / 2  # of given loads to that of the torque: room for dynamic and face load factors
FITTING_LOAD_RATIO = 0.9, 1.1  # without a note
MAX_BENDING = 0.1  # of the module: teeth break far below it
FLANK_NAMES = "pinion", "wheel"


def faults(pair: GearPair) -> list[str]:
    """Faults of the geometry, one message each, with the key."""
    if not 0.0 < pair.pressure_angle < 45.0:
        return [f"gears.pressure_angle = {pair.pressure_angle:g}: allowed: > 0 and < 45 degrees"]
    missing = [name for name in ("centre_distance", "tip_diameter") if getattr(pair, name) is None]
    if missing:
        return [f"gears.{' and '.join(missing)} missing; allowed: a length, or profile_shift for both"]
    if pair.internal and not pair.teeth[0] < -pair.teeth[1]:
        return ["gears.teeth: allowed with internal: more of the wheel than of the pinion"]
    if math.isnan(pair.centre_distance):  # of no working pressure angle
        tangent, side = math.tan(math.radians(pair.pressure_angle)), "below" if pair.internal else "above"
        limit = -0.5 * involute(pair.transverse_angle) * sum(pair.teeth) / tangent
        shifts = " and ".join(f"{x:g}" for x in pair.profile_shift)
        return [f"gears.profile_shift = {shifts}: no pair without play; allowed: a sum {side} {limit:.3g}"]
    found = []
    if pair.load_sharing == "tip-relief" and pair.tip_relief == 0.0:
        found.append('tip_relief is missing; load_sharing = "tip-relief" needs its depth')
    if pair.load_sharing == "thirds" and pair.helix_angle:
        found.append('load_sharing = "thirds": of spur gears; allowed with helix_angle: "stiffness"')
    r_b = pair.base_radii
    if not abs(pair.centre_distance) > abs(sum(r_b)):
        between = "difference" if pair.internal else "sum"
        found.append(
            f"centre_distance = {abs(pair.centre_distance):g}: the base circles overlap; allowed: above "
            f"{abs(sum(r_b)):.5g} m, the {between} of their radii"
        )
    for name, d, r in zip(FLANK_NAMES, pair.tip_diameter, r_b, strict=True):
        if not abs(d) > 2.0 * abs(r):
            found.append(
                f"tip_diameter = {abs(d):g} of the {name}: no involute flank below its base circle; "
                f"allowed: above {2.0 * abs(r):.5g} m"
            )
    found = found or _faults_of_the_path(pair) or _faults_of_the_shift(pair)
    if not found and pair.load_sharing == "thirds" and pair.fewest_pairs > 1:
        found.append(
            f'load_sharing = "thirds": of contact ratios below 2, here {pair.contact_ratio:.3f}; allowed: '
            '"stiffness"'
        )
    found = found or _faults_of_the_ring(pair)
    found = found or _faults_of_the_tips(pair) or _faults_of_the_load(pair)
    return [f"gears.{fault}" for fault in found]


def notes(pair: GearPair) -> list[str]:
    """Warnings of thin tips, of undercut and of loads that differ from the torque's, with the key."""
    found = []
    for name, thickness in zip(FLANK_NAMES, pair.tip_thicknesses, strict=True):
        if thickness < MIN_TIP_THICKNESS * pair.module:
            found.append(
                f"gears.tip_diameter: the tips of the {name} are {1e3 * thickness:.3g} mm thick, below "
                f"{MIN_TIP_THICKNESS:g} modules; a smaller profile_shift or tip diameter thickens them"
            )
    for name, x, least in zip(FLANK_NAMES, pair.shifts, pair.undercut_shifts, strict=True):
        if x < least:
            found.append(
                f"gears.profile_shift = {x:.3g} of the {name}: a rack undercuts its teeth below "
                f"{least:.3g}; the flank is computed as if it were an involute to the base circle"
            )
    low, high = FITTING_LOAD_RATIO
    if pair.load is not None and not low <= pair.load_ratio <= high:
        found.append(
            f"gears.load: of all pairs, in the mean, {pair.load_ratio:.3g} of the load of gears.torque, "
            "by which losses are computed"
        )
    return found


def _faults_of_the_ring(pair: GearPair) -> list[str]:
    r"""Tips of a pinion that cut into those of its ring beside the path (KHK, Gear technical reference).

    .. math:: \theta_1z_1/z_2+inv\,\alpha_w-inv\,\alpha_{a2}\ge\theta_2
    """
    if not pair.internal:
        return []
    tips = [0.5 * abs(d) for d in pair.tip_diameter]
    distance, angle = abs(pair.centre_distance), involute(pair.working_angle)
    at_tips = [involute(math.acos(abs(r) / tip)) for r, tip in zip(pair.base_radii, tips, strict=True)]
    apart = tips[1] ** 2 - tips[0] ** 2
    cosines = (
        (apart - distance**2) / (2.0 * distance * tips[0]),
        (apart + distance**2) / (2.0 * distance * tips[1]),
    )
    if max(map(abs, cosines)) >= 1.0:  # the tip circles do not meet
        return []
    first, second = map(math.acos, cosines)
    ratio = pair.teeth[0] / -pair.teeth[1]
    if (first + at_tips[0] - angle) * ratio + angle - at_tips[1] >= second:
        return []
    return [
        "tip_diameter: the tips of the pinion cut into those of the ring beside the path of contact; "
        "allowed: more teeth of the ring, or lower tips"
    ]


def _faults_of_the_tips(pair: GearPair) -> list[str]:
    """Tips at which both flanks meet below the tip diameter."""
    return [
        f"tip_diameter = {abs(d):.5g} of the {name}: its teeth are pointed below it, the thickness of "
        f"the tip is {1e3 * thickness:.3g} mm; allowed: above 0 mm, by a smaller profile_shift or tip "
        "diameter"
        for name, d, thickness in zip(FLANK_NAMES, pair.tip_diameter, pair.tip_thicknesses, strict=True)
        if thickness <= 0.0
    ]


def _faults_of_the_load(pair: GearPair) -> list[str]:
    """A torque that breaks teeth, given loads at positions off the line of action or unlike the torque."""
    bending = pair.normal_load / single_stiffness(pair)
    if not bending <= MAX_BENDING * pair.module:
        of = f"module = {pair.module:g} and face_width = {pair.face_width:g} m"
        return [
            f"torque = {pair.torque:g}: a tooth pair of {of} bends by {1e3 * bending:.3g} mm; allowed: at "
            f"most {MAX_BENDING:g} modules; are all in SI units?"
        ]
    if pair.load is None:
        return []
    longest = abs(pair.line_of_action) + (pair.points["E"] if pair.internal else 0.0)
    if max(map(abs, pair.path)) > longest:
        return [
            f"path = {pair.path[0]:g} to {pair.path[-1]:g} m from the pitch point; allowed: within "
            f"{longest:.3g} m, the line of action; a unit, path [mm], is read"
        ]
    (low, high), ratio = LOAD_RATIO, pair.load_ratio
    if not low <= ratio <= high:
        return [
            f"load: of all pairs, in the mean, {ratio:.3g} of the {1e-3 * pair.normal_load:.4g} kN/m of "
            f"torque = {pair.torque:g}; allowed: {low:.2g} to {high:.2g}; a unit, load [N/mm], is read"
        ]
    return []


def _faults_of_the_shift(pair: GearPair) -> list[str]:
    """The first given length that is not that of the profile shift."""
    for name in pair.given:
        given, free = (np.abs(np.atleast_1d(getattr(pair, key))) for key in (name, f"play_free_{name}"))
        if not np.abs(given - free).max() <= SHIFT_TOLERANCE * pair.module:
            own, lengths = (", ".join(f"{value:.5g}" for value in of) for of in (given, free))
            reason = f"the play-free pair of this profile_shift has {lengths} m"
            return [f"{name} = {own}: {reason}; allowed: within {SHIFT_TOLERANCE:g} modules, or left out"]
    return []


def _faults_of_the_path(pair: GearPair) -> list[str]:
    (a, e), length, r_b = pair._a_and_e(), pair.line_of_action, pair.base_radii
    found = []
    for name, other, over, r in (
        ("wheel", "pinion", a <= 0.0, r_b[1]),
        ("pinion", "wheel", e >= length and not pair.internal, r_b[0]),
    ):
        if over:
            found.append(
                f"tip_diameter: the tips of the {name} reach below the base circle of the {other} "
                f"(interference); allowed for the {name}: {'above' if pair.internal else 'below'} "
                f"{2.0 * math.hypot(length, r):.5g} m"
            )
    ratio = pair.contact_ratio
    if not found and not 1.0 <= ratio < MAX_CONTACT_RATIO:
        found.append(
            f"tip_diameter = {list(map(abs, pair.tip_diameter))}: contact ratio {ratio:.3f}, at a "
            f"distance of the centres of {abs(pair.centre_distance):g} m; allowed: 1 to {MAX_CONTACT_RATIO}"
        )
    return found
