"""Cases to begin with: a roller, a gear pair, a case with every key in comments."""

from __future__ import annotations

import json
import tomllib

from ehlpetsc.case.key_page import tables
from ehlpetsc.case.messages import value_text
from ehlpetsc.command_parser import CommandParser, exit_status, put
from ehlpetsc.keys import Key

ROLLER = """# Cylindrical roller on an inner ring: `ehlpetsc explain CASE.toml`, then `ehlpetsc CASE.toml`.
title = "My roller"

[contact]
radius = "5.6 mm"                  # 1/R = 1/R1 + 1/R2
load = "150 N/mm"                  # per length of contact
material = "100Cr6"                # or ["100Cr6", "16MnCr5"]: elastic constants, yield pressure, fatigue
model = "mixed"                    # oil and asperities share the load
boundary_friction = 0.1            # friction coefficient of asperities

[fluid]
grade = "ISO VG 68"                # or { v40 = "68 mm^2/s", v100 = "8.7 mm^2/s", density = "850 kg/m^3" }
temperature = "70 degC"            # of the oil in the inlet
law = "roelands"                   # viscosity of pressure
density = "dowson-higginson"       # density of pressure
eyring_stress = "6 MPa"            # shear thinning

[motion]
entrainment_speed = "8 m/s"        # mean speed of both surfaces through the contact
slide_roll_ratio = "2 %"           # sliding speed over entrainment speed

[mesh]
inlet = -4.0                       # half widths of the contact
outlet = 1.5
points_per_half_width = 100        # roughness: add [surface.1], [surface.2] and [time]
"""
GEARS = """# Spur gear pair along its path of contact. `ehlpetsc gears CASE.toml` prints and draws the path.
title = "My gear pair"

[gears]                            # pairs of values: pinion, wheel
module = "4.5 mm"
teeth = [16, 24]
centre_distance = "91.5 mm"
tip_diameter = ["82.5 mm", "118.4 mm"]
face_width = "14 mm"
torque = "302 N m"                 # on the pinion
speed = "2250 rpm"                 # of the pinion
tip_relief = "20 um"

[contact]                          # load, radius and speeds follow from [gears]
material = "16MnCr5"
model = "mixed"                    # oil and asperities share the load
boundary_friction = 0.1

[fluid]
grade = "ISO VG 100"
temperature = "90 degC"
law = "roelands"
density = "dowson-higginson"
eyring_stress = "6 MPa"

[mesh]
inlet = -3.0                       # half widths of the widest contact
outlet = 1.5
points_per_half_width = 50         # roughness: add [surface.1] and [surface.2], and 200 points

[time]                             # all of the path
"""
TEMPLATES = {"roller": ROLLER, "gears": GEARS}
LEFT_OUT = ("surface.2", "post", "series")  # in a full template


def template(kind: str = "roller") -> str:
    """Text of a case: "roller", "gears", or "full" with all other keys in comments."""
    return TEMPLATES[kind] if kind in TEMPLATES else _full(tomllib.loads(ROLLER))


def _full(example: dict) -> str:
    lines = []
    for place, table in tables().items():
        if place.split(" ")[0] in LEFT_OUT or " (" in place:
            continue
        values = example.get(place, {}) if place else example
        if place:
            lines += ["", f"[{place}]" if values else f"# [{place}]"]
        for name, key in table.keys.items():
            if name in values and not isinstance(values[name], dict):
                lines.append(f"{name} = {json.dumps(values[name])}  # {_comment(key)}")
            elif not key.table and key.kind is not dict:
                shown = "..." if key.default is None else json.dumps(key.default)
                lines.append(f"# {name} = {shown}  # {_comment(key)}")
    return "\n".join(lines) + "\n"


def _comment(key: Key) -> str:
    return f"{key.text}; {value_text(key)}"


def main(words: list[str]) -> int:
    """Run the command ``ehlpetsc template``; returns its exit status."""
    parser = CommandParser("template", "A commented case file to begin with.")
    kinds = [*TEMPLATES, "full"]
    parser.add_argument("kind", nargs="?", choices=kinds, default="roller", help="full: with every key")
    chosen = parser.parse_args(words)
    return exit_status("template", lambda: put(template(chosen.kind), chosen))
