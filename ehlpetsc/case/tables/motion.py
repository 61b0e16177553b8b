"""Keys of `[motion]`, `[operation]`, `[gears]`, `[mesh]` and `[time]`: conditions, nodes and time steps."""

from __future__ import annotations

from typing import Any

from ehlpetsc.gears.geometry import MESH_STIFFNESS, GearPair
from ehlpetsc.gears.load_sharing import RULES
from ehlpetsc.keys import Key, KeyTable, Refused, Values

MAX_NODES = 200_000  # with more a time step would take hours; more likely a typing error
COLUMNS = {  # allowed names of the columns of a file, by key
    "time": ("time", "t"),
    "load": ("load", "w"),
    "radius": ("radius", "r"),
    "speed_1": ("speed 1", "u1"),
    "speed_2": ("speed 2", "u2"),
}

MOTION = KeyTable(
    "motion",
    "speeds; needed with [fluid] and with [time]",
    {
        "entrainment_speed": Key(
            "mean of both speeds, not zero",
            unit="m/s",
            ge=1e-9,
            le=1e3,
            required=True,
            replaced_by=("[gears]", "[operation]"),
            equation="u = (u1 + u2)/2",
        ),
        "slide_roll_ratio": Key(
            "sliding speed over entrainment speed",
            ge=-100,
            le=100,
            default=0.0,
            equation="xi = (u1 - u2)/u; u1 = u (1 + xi/2), u2 = u (1 - xi/2)",
        ),
    },
)


def _column(text: str, unit: str) -> Key:
    return Key(f"{text}, here instead of in a file", unit=unit, ge=-1e15, le=1e15, many="list", min_items=2)


def _file_or_columns(operation: Values) -> dict[str, Any]:
    if (operation.file is None) == all(getattr(operation, key) is None for key in COLUMNS):
        raise Refused("needs either file or time with load, radius, speed_1 or speed_2")
    return {}


OPERATION = KeyTable(
    "operation",
    "conditions over time; left out: constant",
    {
        "file": Key(
            "CSV table beside the case file; its first line names the columns, with units in brackets: "
            "time [s], load [N/m], radius [m], speed 1 [m/s], speed 2 [m/s]; other conditions are constant",
            str,
        ),
        "repeat": Key("times that the table is run through", int, ge=1, le=100_000, default=1),
        "time": _column("increasing", "s"),
        "load": _column("above 0", "N/m"),
        "radius": _column("above 0", "m"),
        "speed_1": _column("of surface 1, signed", "m/s"),
        "speed_2": _column("of surface 2, signed", "m/s"),
    },
    complete=_file_or_columns,
)


class Gears(Values):
    """`[gears]`: geometry and running conditions of a spur gear pair."""

    @property
    def pair(self) -> GearPair:
        return GearPair(**self.as_dict())


def _check_geometry(gears: Gears) -> dict[str, Any]:
    faults = gears.pair.faults()
    if faults:
        raise Refused("; ".join(fault.removeprefix("gears.") for fault in faults))
    return {}


GEARS = KeyTable(
    "gears",
    "spur gear pair through its mesh, surface 1 the flank of the pinion; left out: constant conditions",
    {
        "module": Key("normal module", unit="m", ge=1e-5, le=1, required=True),
        "teeth": Key("of pinion and wheel", int, ge=5, le=10_000, many="two", required=True),
        "pressure_angle": Key("of the basic rack", unit="degrees", ge=5, le=40, default=20.0),
        "centre_distance": Key("above the sum of base radii", unit="m", ge=1e-4, le=100, required=True),
        "tip_diameter": Key("of pinion and wheel", unit="m", ge=1e-4, le=100, many="two", required=True),
        "face_width": Key("common to both", unit="m", ge=1e-5, le=10, required=True),
        "torque": Key("on the pinion", unit="N m", ge=1e-6, le=1e9, required=True),
        "speed": Key("rotational speed of the pinion", unit="1/min", ge=1e-3, le=1e6, required=True),
        "tip_relief": Key("depth at both tips, linear from B and D on", unit="m", ge=0, le=1e-3, default=0.0),
        "load_sharing": Key(
            "rule; left out: tip-relief where there is one, else thirds", str, choices=tuple(RULES)
        ),
        "mesh_stiffness": Key(
            "of one tooth pair per face width, c' of ISO 6336",
            unit="Pa",
            ge=1e6,
            le=1e12,
            default=MESH_STIFFNESS,
        ),
    },
    values=Gears,
    complete=_check_geometry,
)


class Mesh(Values):
    """`[mesh]`: nodes in x."""

    @property
    def nodes(self) -> int:
        """Number of nodes; the outlet is rounded to a whole number of spacings."""
        return round((self.outlet - self.inlet) * self.points_per_half_width) + 1


def _check_node_count(mesh: Mesh) -> dict[str, Any]:
    if mesh.nodes > MAX_NODES + 1:
        raise Refused(key="points_per_half_width")
    return {}


MESH = KeyTable(
    "mesh",
    "nodes",
    {
        "inlet": Key("first node", unit="half widths", ge=-100, lt=-1, required=True),
        "outlet": Key("last node", unit="half widths", gt=1, le=100, required=True),
        "points_per_half_width": Key(
            "nodes per half width, at most 200000 in all",
            int,
            ge=4,
            le=100_000,
            required=True,
            equation="dx = a/points_per_half_width",
        ),
        "near_field": Key("nodes of deflection in the matrix, each side", int, ge=2, le=1000, default=3),
    },
    required=True,
    values=Mesh,
    complete=_check_node_count,
)

TIME = KeyTable(
    "time",
    "left out: steady",
    {
        "travel": Key(
            "distance travelled by the faster surface",
            unit="half widths",
            ge=1e-6,
            le=1e5,
            required=True,
            replaced_by=("[gears]", "[operation]"),
            equation="the run lasts travel a/u_max",
        ),
        "courant": Key(
            "Courant number of the faster surface",
            ge=1e-3,
            le=100,
            default=0.5,
            equation="dt = courant dx/u_max",
        ),
        "passes": Key(
            "number of passes of the same stretches of both surfaces", int, ge=1, le=10_000, default=1
        ),
        "pass_shift": Key(
            "shift of the profile of surface 2 from pass to pass", unit="m", ge=-1, le=1, default=0.0
        ),
    },
)
