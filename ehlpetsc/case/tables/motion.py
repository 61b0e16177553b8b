"""Keys of `[motion]`, `[operation]`, `[gears]`, `[mesh]` and `[time]`: conditions, nodes and time steps."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any

from ehlpetsc.base.counts import whole_near
from ehlpetsc.base.declarations import Key, KeyTable, Refused, Required, Values
from ehlpetsc.case.tables.contact import VARYING
from ehlpetsc.gears.load_sharing import RULES

if TYPE_CHECKING:
    from ehlpetsc.gears.geometry import GearPair

MIN_COARSE_POINTS = 4  # of the smooth roller of a window: nodes per half-width, rows on half of its length
MAX_NODES_ALONG = 200_000  # with more a time step would take hours; more likely a typing error
COLUMNS = {  # allowed names of the columns of a file, by key
    "time": ("time", "t"),
    "load": ("load", "w"),
    "radius": ("radius", "r"),
    "speed_1": ("speed 1", "u1"),
    "speed_2": ("speed 2", "u2"),
}

MOTION_KEYS = {
    "entrainment_speed": Required(
        "mean speed `u = (u1 + u2)/2`, not zero", "m/s", 1e-9, 1e3, replaced_by=VARYING
    ),
    "slide_roll_ratio": Key(
        "`xi = (u1 - u2)/u`; `u1 = u (1 + xi/2)`, `u2 = u (1 - xi/2)`", "", -100, 100, default=0.0
    ),
    "spin": Key(
        "speed of body 1 over body 2 about the normal of the contact, half of it of either body; or a list "
        "of both bodies' speeds; positive: rows of positive y are faster along x; left out: none",
        *("rad/s", -1e5, 1e5),
        many="axes",
        contacts=("point", "roller"),
        departs="one speed across",
        assumes=("one direction of entrainment", "a whole contact"),
        equation="`u_i(y) = u_i + w_i y` along x, `v_i(x) = -w_i x` across",
    ),
}


def _complete_motion(motion: Values) -> dict[str, Any]:
    spin = motion.spin
    both = spin if isinstance(spin, tuple) else (0.5 * (spin or 0.0), -0.5 * (spin or 0.0))
    return {"spin": both if any(both) else None}


MOTION = KeyTable(
    "motion", "speeds; needed with [fluid] and with [time]", MOTION_KEYS, complete=_complete_motion
)


def _column(text: str, unit: str, point_unit: str = "") -> Key:
    text = f"{text}, here instead of in a file"
    return Key(text, unit, -1e15, 1e15, many="list", min_items=2, point_unit=point_unit)


def _file_or_columns(operation: Values) -> dict[str, Any]:
    if (operation.file is None) == all(getattr(operation, key) is None for key in COLUMNS):
        raise Refused("needs either file or time with load, radius, speed_1 or speed_2")
    return {}


OPERATION_KEYS = {
    "file": Key(
        "CSV table beside the case file; its first line names columns, with units in brackets: time [s], "
        "load [N/m], radius [m], speed 1 [m/s], speed 2 [m/s]; other conditions are constant; of a point "
        "contact load [N] and the radius along, that across in the ratio of contact.radius",
        kind=str,
    ),
    "repeat": Key("times that the table is run through", "", 1, 100_000, kind=int, default=1),
    "time": _column("increasing", "s"),
    "load": _column("above 0", "N/m", "N"),
    "radius": _column("above 0", "m"),
    "speed_1": _column("of surface 1, signed", "m/s"),
    "speed_2": _column("of surface 2, signed", "m/s"),
}
OPERATION = KeyTable(
    "operation", "conditions over time; left out: constant", OPERATION_KEYS, complete=_file_or_columns
)


class Gears(Values):
    """`[gears]`: geometry and running conditions of a gear pair."""

    @property
    def pair(self) -> GearPair:
        """Geometry of the pair."""
        from ehlpetsc.gears.geometry import GearPair

        return GearPair(**{key: value for key, value in self.as_dict().items() if key not in NOT_GEOMETRY})

    @property
    def notes(self) -> list[str]:
        """Warnings of the pair."""
        from ehlpetsc.gears.faults import notes

        return notes(self.pair)


def _check_geometry(gears: Gears) -> dict[str, Any]:
    if (gears.path is None) != (gears.load is None):
        raise Refused("path and load need each other")
    if gears.load is not None and len(gears.path) != len(gears.load):
        raise Refused(f"load has {len(gears.load)} values, path {len(gears.path)}; allowed: as many")
    if gears.load is not None and (
        max(gears.load) <= 0.0 or any(later <= sooner for sooner, later in pairwise(gears.path))
    ):
        raise Refused("allowed: a path that increases and a load above 0 somewhere", "path")
    from ehlpetsc.gears.faults import faults

    if found := faults(gears.pair):
        raise Refused("; ".join(fault.removeprefix("gears.") for fault in found))
    return {}


NOT_GEOMETRY = ("load_file", "heat_transfer", "oil_factor")
PATH_COLUMNS = {"path": ("path", "position"), "load": ("load", "w")}  # of gears.load_file
GEARS_KEYS = {
    "module": Required("normal module", "m", 1e-5, 1),
    "teeth": Required(
        "of pinion and wheel, the driving and the driven one; 1000000: a rack",
        *("", 5, 1_000_000),
        kind=int,
        many="two",
    ),
    "internal": Key(
        "the wheel is a ring with teeth inside; its shift as in DIN 3960", kind=bool, default=False
    ),
    "pressure_angle": Key("of the basic rack", "degrees", 5, 40, default=20.0),
    "helix_angle": Key("at the reference circle; the middle slice is solved", "degrees", 0, 45, default=0.0),
    "profile_shift": Key("`x1` and `x2`, of the play-free pair (DIN 3960)", "", -2, 4, many="two"),
    "addendum": Key("of the basic rack, over the module", "", 0.1, 2, default=1.0),
    "tip_clearance": Key("to the root of the other gear, over the module", "", 0, 1, default=0.25),
    "centre_distance": Key("left out: by profile_shift", "m", 1e-4, 100),
    "tip_diameter": Key("of pinion and wheel; left out: by profile_shift", "m", 1e-4, 100, many="two"),
    "face_width": Required("common to both", "m", 1e-5, 10),
    "torque": Required("on the pinion", "N m", 1e-6, 1e9),
    "speed": Required("rotational speed of the pinion", "1/min", 1e-3, 1e6),
    "tip_relief": Key("depth at both tips, linear from B and D on", "m", 0, 1e-3, default=0.0),
    "tip_radius": Key("of the tip edges; left out: 0.05 module", "m", 1e-7, 0.1),
    "load_sharing": Key(
        "left out: tip-relief with a relief, stiffness with helix_angle or a contact ratio from 2 on, else "
        "thirds",
        choices=tuple(RULES),
    ),
    "mesh_stiffness": Key("`c'` of a tooth pair per width; left out: by ISO 6336-1, steel", "Pa", 1e6, 1e12),
    "load_file": Key(
        "CSV table beside the case file: load of a pair over the path, from a tooth contact analysis, "
        "path [m] from the pitch point, load [N/m]; instead of load_sharing",
        kind=str,
    ),
    "path": Key("increasing, here instead of in a file", "m", -10, 10, many="list", min_items=2),
    "load": Key("at path", "N/m", 0, 1e12, many="list", min_items=2),
    "heat_transfer": Key(
        'of the gears\' sides and tips, for heat.bulk_temperature = "losses"; left out: ISO/TS 6336-20',
        *("W/(m^2 K)", 1e-3, 1e6),
        many="both",
    ),
    "oil_factor": Key(
        "`X_L` of friction by ISO/TR 14179-2: 1 for mineral oils, 0.8 for PAO and esters, 0.75 for PAG "
        "(from memory); fitted to FZG tests by Fernandes and Seabra: 0.846, 0.65, 0.65, 0.585",
        *("", 0.1, 2),
        default=1.0,
    ),
}
GEARS = KeyTable(
    "gears",
    "gear pair through its mesh, surface 1 the flank of the pinion; left out: constant conditions",
    GEARS_KEYS,
    values=Gears,
    complete=_check_geometry,
)


class Mesh(Values):
    """`[mesh]`: nodes in x."""

    @property
    def nodes(self) -> int:
        """Number of nodes; the outlet is rounded to a whole number of spacings."""
        return whole_near((self.outlet - self.inlet) * self.points_per_half_width) + 1


def _complete_mesh(mesh: Mesh) -> dict[str, Any]:
    points = mesh.points_per_half_width
    along, across = points if isinstance(points, tuple) else (points, None)
    values = {"points_per_half_width": along, "points_across": across}
    if mesh.copy(values).nodes > MAX_NODES_ALONG + 1:
        raise Refused(key="points_per_half_width")
    for points, parts in zip((along, across), mesh.window.coarsening if mesh.window else (), strict=False):
        if points is None or points % parts or points < MIN_COARSE_POINTS * parts:
            allowed = (
                f"two, multiples of mesh.window.coarsening and at least {MIN_COARSE_POINTS} times as many"
            )
            raise Refused(f"allowed: {allowed}", "points_per_half_width")
    return values


WINDOW = KeyTable(
    "mesh.window",
    "part of a roller that is computed, beside which the smooth roller is held; left out: all of it",
    {
        "from": Required("y of its begin, rounded to a row of the smooth roller", *("m", -5, 5), below="to"),
        "to": Required("y of its end; of the length or more: with the end of the roller", "m", -5, 5),
        "coarsening": Key(
            "spacings of the smooth roller over those of the window, along and across",
            *("", 1, 1000),
            kind=int,
            many="two",
            default=(1, 1),
        ),
    },
    needs=("contact.length",),
)


MESH_KEYS = {
    "inlet": Required("first node", "half-widths", -100, lt=-1),
    "outlet": Required("last node", "half-widths", gt=1, le=100),
    "points_per_half_width": Required(
        "nodes `a/dx`, at most 200000 nodes; two: along, across per half-width b of a point, a of "
        "a strip, half of the length of a roller",
        *("", 4, 100_000),
        kind=int,
        many="axes",
    ),
    "width": Key(
        "of a point contact in b [4]; of a roller with round ends in halves of its length; with one radius "
        "otherwise, in a: a strip, periodic across",
        *("half-widths", 0.01, 1000),
    ),
    "near_field": Key(
        "nodes of deflection in the matrix, each side", "", 2, 1000, kind=int, default=3, contacts=("line",)
    ),
    "window": WINDOW.key,
}
MESH = KeyTable("mesh", "nodes", MESH_KEYS, required=True, values=Mesh, complete=_complete_mesh)


class Time(Values):
    """`[time]`: length of the run and of its steps."""

    @property
    def shortest(self) -> float:
        """Courant number of the shortest step."""
        return self.courant if self.tolerance is None else min(self.min_courant, self.courant)


TIME_KEYS = {
    "travel": Required(
        "travel of the faster surface, `travel a = u_max t`", "half-widths", 1e-6, 1e5, replaced_by=VARYING
    ),
    "start": Key(
        "smooth: profiles enter the contact from time 0; rough: they fill it, after a ramp before time 0",
        choices=("smooth", "rough"),
        default="smooth",
    ),
    "ramp": Key(
        "mesh of the ramp of a rough start in the plane; coarse: half the nodes along and across until its "
        "last part, with roughness as the only effect",
        choices=("fine", "coarse"),
        default="fine",
    ),
    "courant": Key(
        "mesh spacings that the film moves in a step; less where surfaces pass it faster, "
        "`dt = courant dx/max(|u|, |u1 - u2|/2)`; with tolerance in the longest step",
        *("", 1e-3, 100),
        default=1.0,
    ),
    "tolerance": Key(
        "relative error of the film in a step under conditions that vary, by which steps are long or short; "
        "left out: all steps by courant",
        *("", 1e-6, 0.1),
    ),
    "min_courant": Key(
        "courant of the shortest step, with tolerance", "", 1e-3, 100, default=1.0, below="courant"
    ),
    "passes": Key("passes of the same stretches of both surfaces", "", 1, 10_000, kind=int, default=1),
    "pass_shift": Key(
        "shift of the profile of surface 2 from pass to pass; left out: none, of a life 0.382 half-widths",
        *("m", -1, 1),
    ),
}
TIME = KeyTable("time", "left out: steady", TIME_KEYS, values=Time)
