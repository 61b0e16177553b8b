r"""Profiles by name: of rollers along their length, and of any contact along the motion.

Of rollers the drop z(y) beside the cylinder, positive into the body:

.. math:: z=A\ln\frac1{1-k\,t^2},\qquad t=\frac{(|y|-s/2)_+}{(L-s)/2},\qquad k=1-e^{-z_m/A}

with the height A, the length s of the straight middle and the drop :math:`z_m` at the ends, without a drop
k = 1 (Lundberg 1939). y is the distance from the middle of the length L.

Designs for a load Q, :math:`w=Q/L`, half-width a of Hertz: Lundberg :math:`A=2w/(\pi E')`, s = 0; Johns and
Gohar (1981), Tribol. Int. 14: the same A and :math:`z_m=A\ln\frac{L/2}{0.3033a}`; Fujiwara and Kawase (2007),
J. Tribol. 129, of NTN: :math:`A=2K_1w/(\pi E')`, :math:`s=(1-K_2)L` and a given :math:`z_m`. ISO/TS 16281
(2008): A = 0.00035 D, s = 0, D the diameter of the roller; for L > 2.5 D, A = 0.0005 D and s = L - 2.5 D; of
tapered rollers A = 0.00045 D, s = 0.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from ehlpetsc.base.declarations import Key, Refused, Required, Values
from ehlpetsc.physics.contact.hertz import hertz_line

ISO_HEIGHT, ISO_LONG_HEIGHT, ISO_TAPERED_HEIGHT = 0.00035, 0.0005, 0.00045  # over the diameter
ISO_MAX_LENGTH = 2.5  # diameters: of a roller without a straight middle
JOHNS_GOHAR = 0.3033
MAX_GAP = 200e-6  # m: in place of the infinite drop of a logarithm, far from any contact


class Design(NamedTuple):
    """Design values of a profile: length [m], load [N], radius [m], E' [Pa]."""

    length: float
    load: float
    radius: float
    modulus: float


class Profile(NamedTuple):
    """A profile: its constants as keys, drop z [m] at y [m] by its values and the design, a check of both.

    `check`: raises :class:`Refused`.
    """

    equation: str
    keys: dict[str, Key]
    drop: Callable[[np.ndarray, Values, Design], np.ndarray]
    check: Callable[[Values], Any] = lambda profile: {}


class ProfileAlong(NamedTuple):
    """A profile along the motion: its constants as keys, gap z [m] at x [m], a check that may refuse."""

    equation: str
    keys: dict[str, Key]
    gap: Callable[[np.ndarray, Values], np.ndarray]
    check: Callable[[Values], Any] = lambda profile: {}


def beyond_middle(y: np.ndarray, length: float, straight: float) -> np.ndarray:
    """Distance from the straight middle over that of the ends from it."""
    return np.clip((np.abs(y) - 0.5 * straight) / (0.5 * (length - straight)), 0.0, 1.0)


def logarithmic(
    y: np.ndarray, length: float, height: float, drop: float = np.inf, straight: float = 0.0
) -> np.ndarray:
    r"""Logarithmic profile :math:`A\ln[1/(1-k\,t^2)]` [m]; at most `MAX_GAP` without a drop.

    `height`, `drop`, `straight`: A, the drop at the ends, the length of the straight middle [m].
    """
    t = beyond_middle(y, length, straight)
    with np.errstate(divide="ignore"):
        return np.minimum(-height * np.log1p(np.expm1(-drop / height) * t * t), MAX_GAP)


def unit_height(profile: Values, design: Design) -> float:
    r"""Lundberg's :math:`2w/(\pi E')` [m] of the load of the profile, by default of the contact."""
    load = profile.load or design.load
    return 2.0 * load / (np.pi * design.length * design.modulus)


def _logarithmic(y: np.ndarray, profile: Values, design: Design) -> np.ndarray:
    drop = np.inf if profile.drop == "none" else profile.drop
    return logarithmic(y, design.length, profile.height, drop, profile.straight)


def _iso(y: np.ndarray, profile: Values, design: Design) -> np.ndarray:
    straight = max(design.length - ISO_MAX_LENGTH * profile.diameter, 0.0)
    if profile.tapered:
        return logarithmic(y, design.length, ISO_TAPERED_HEIGHT * profile.diameter)
    height = ISO_LONG_HEIGHT if straight else ISO_HEIGHT
    return logarithmic(y, design.length, height * profile.diameter, straight=straight)


def _lundberg(y: np.ndarray, profile: Values, design: Design) -> np.ndarray:
    return logarithmic(y, design.length, unit_height(profile, design))


def _johns_gohar(y: np.ndarray, profile: Values, design: Design) -> np.ndarray:
    height, load = unit_height(profile, design), profile.load or design.load
    a, _ = hertz_line(load / design.length, design.radius, design.modulus)
    return logarithmic(y, design.length, height, height * np.log(0.5 * design.length / (JOHNS_GOHAR * a)))


def _ntn(y: np.ndarray, profile: Values, design: Design) -> np.ndarray:
    height, straight = profile.k1 * unit_height(profile, design), (1.0 - profile.k2) * design.length
    return logarithmic(y, design.length, height, profile.drop, straight)


def _circular(y: np.ndarray, profile: Values, design: Design) -> np.ndarray:
    if profile.radius:
        return 0.5 * np.maximum(np.abs(y) - 0.5 * profile.straight, 0.0) ** 2 / profile.radius
    return profile.drop * beyond_middle(y, design.length, profile.straight) ** 2


def _two_radii(y: np.ndarray, profile: Values, design: Design) -> np.ndarray:
    middle, end = profile.radius
    inner = np.minimum(np.abs(y), 0.5 * profile.middle)
    outer = np.abs(y) - inner
    return 0.5 * inner**2 / middle + inner / middle * outer + 0.5 * outer**2 / end


def _table(y: np.ndarray, profile: Values, design: Design) -> np.ndarray:
    return between(profile.y, profile.z, y)


def between(points: Sequence[float], z: Sequence[float], s: np.ndarray) -> np.ndarray:
    """Monotone cubics through z at points, the same on both sides if these begin at 0 or above."""
    from scipy.interpolate import PchipInterpolator

    return PchipInterpolator(points, z)(np.abs(s) if points[0] >= 0.0 else s)


def _one_of_radius_and_drop(profile: Values) -> dict[str, Any]:
    if (profile.radius is None) == (profile.drop is None):
        raise Refused("needs either radius or drop")
    return {}


def _as_many(profile: Values, name: str = "y") -> dict[str, Any]:
    points = profile.as_dict()[name]
    if len(points) != len(profile.z):
        raise Refused(f"{name} has {len(points)} values, z {len(profile.z)}; allowed: as many")
    if any(later <= sooner for sooner, later in zip(points, points[1:], strict=False)):
        raise Refused("allowed: increasing distances", name)
    return {}


DROP = "m", 1e-9, 1e-2
LOAD = Key("for which the profile is designed; left out: of the contact", "N", 1e-3, 1e10)
STRAIGHT = Key("length of the straight middle", "m", 0, 10, default=0.0)
LOGARITHM = "`z = A ln(1/(1 - k t^2))`, `t = (|y| - s/2)/((L - s)/2)`, `k = 1 - exp(-drop/A)`"
PROFILES = {
    "logarithmic": Profile(
        f"{LOGARITHM}, `A = height`, `s = straight`",
        {
            "height": Required("`A`", *DROP),
            "drop": Key('at the ends; "none": `k = 1`', *DROP, words=("none",), default="none"),
            "straight": STRAIGHT,
        },
        _logarithmic,
    ),
    "iso": Profile(
        "ISO/TS 16281: `A = 0.00035 D`, `s = 0`; for `L > 2.5 D` `A = 0.0005 D`, `s = L - 2.5 D`; tapered "
        "`A = 0.00045 D`, `s = 0`; `k = 1`",
        {
            "diameter": Required("`D` of the roller, of a tapered one its mean", "m", 1e-6, 10),
            "tapered": Key("a tapered roller", kind=bool, default=False),
        },
        _iso,
    ),
    "lundberg": Profile(
        "`A = 2 w/(pi E')`, `s = 0`, `k = 1`, `w` load per length", {"load": LOAD}, _lundberg
    ),
    "johns-gohar": Profile(
        "`A = 2 w/(pi E')`, `s = 0`, `drop = A ln(L/(0.6066 a))`", {"load": LOAD}, _johns_gohar
    ),
    "ntn": Profile(
        "modified logarithmic profile of Fujiwara and Kawase: `A = 2 k1 w/(pi E')`, `s = (1 - k2) L`",
        {
            "load": LOAD,
            "k1": Key("load of the design over `load`", "", 0.01, 100, default=1.0),
            "k2": Key("share of the length outside the straight middle", "", 0.01, 1, default=1.0),
            "drop": Required("at the ends", *DROP),
        },
        _ntn,
    ),
    "circular": Profile(
        "arcs tangent to the straight middle, `z = (|y| - s/2)^2/(2 radius)`, or of a drop",
        {
            "radius": Key("of the arcs", "m", 1e-4, 1e5),
            "drop": Key("at the ends, in place of a radius", *DROP),
            "straight": STRAIGHT,
        },
        _circular,
        _one_of_radius_and_drop,
    ),
    "two-radii": Profile(
        "an arc over the middle and tangent to it arcs of another radius",
        {
            "radius": Required("of the middle and of the ends", "m", 1e-4, 1e5, many="two"),
            "middle": Required("length of the arc of the middle", "m", 1e-6, 10),
        },
        _two_radii,
    ),
    "table": Profile(
        "monotone cubics between the points",
        {
            "y": Required(
                "distance from the middle: from 0, of equal ends, or from one end of the roller to the other",
                *("m", -10, 10),
                many="list",
                min_items=2,
            ),
            "z": Required("positive into the body", "m", -1e-2, 1e-2, many="list", min_items=2),
        },
        _table,
        _as_many,
    ),
}
"""Profiles by name; `contact.profile.kind`."""


def _power(x: np.ndarray, profile: Values) -> np.ndarray:
    return profile.height * np.abs(x / profile.distance) ** profile.exponent


def _points_along(x: np.ndarray, profile: Values) -> np.ndarray:
    nearest = np.abs(x) if profile.x[0] >= 0.0 else x
    return between(profile.x, profile.z, np.clip(nearest, profile.x[0], profile.x[-1]))


ALONG = {
    "power": ProfileAlong(
        "`z = height |x/distance|^exponent`",
        {
            "height": Required("at the distance", "m", -1e-2, 1e-2),
            "distance": Required("from the middle", "m", 1e-9, 1),
            "exponent": Required("of the distance", "", 1, 100),
        },
        _power,
    ),
    "table": ProfileAlong(
        "monotone cubics between the points, beyond them z of the last one",
        {
            "x": Required(
                "distance from the middle, positive downstream: from 0, of equal sides, or over both",
                *("m", -10, 10),
                many="list",
                min_items=2,
            ),
            "z": Required("positive into the body", "m", -1e-2, 1e-2, many="list", min_items=2),
        },
        _points_along,
        lambda profile: _as_many(profile, "x"),
    ),
}
"""Profiles along the direction of motion beside the parabola; `contact.profile_along.kind`."""


def gap_along(x: np.ndarray, profile: Values) -> np.ndarray:
    """Gap [m] of a profile at distances x [m] along the motion from the middle."""
    return ALONG[profile.kind].gap(x, profile)


def drop_of(y: np.ndarray, profile: Values | None, design: Design) -> np.ndarray:
    """Drop [m] at distances y [m] from the middle of a roller; None: a straight roller."""
    return np.zeros_like(y) if profile is None else PROFILES[profile.kind].drop(y, profile, design)
