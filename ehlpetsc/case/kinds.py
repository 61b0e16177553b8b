"""Keys that only some kinds of contact have: faults of the others."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ehlpetsc.base.case import KINDS
from ehlpetsc.base.declarations import Values
from ehlpetsc.base.toml_file import Tables
from ehlpetsc.case.checking import Fault, is_point
from ehlpetsc.case.tables.surface import areal_keys
from ehlpetsc.case.values import show
from ehlpetsc.physics.scales import reduced_modulus

if TYPE_CHECKING:
    from ehlpetsc.case.tables import Case

OF_GEARS = {"contact": ("load", "radius"), "motion": ("entrainment_speed", "slide_roll_ratio")}
MAX_NODES = 1_000_000  # of a plane, which take 5 GB and minutes a time step


def given_by_gears(data: Tables) -> list[Fault]:
    """Faults of keys beside `[gears]`, which gives their values and is of line contacts."""
    if "gears" not in data:
        return []
    if is_point(data):
        given = f"contact.radius = {show(data['contact']['radius'])}"
        text = (
            f"{given}: a point contact has no [gears]; leave the radius out (mesh.width: a strip), or [gears]"
        )
        return [Fault("contact.radius", text)]
    faults = []
    for table, keys in OF_GEARS.items():
        values = data.get(table)
        for key in keys if isinstance(values, dict) else ():
            if key in values:
                given = f"{table}.{key} = {show(values[key])}"
                faults.append(
                    Fault(f"{table}.{key}", f"{given}: follows from [gears]; leave out one of both")
                )
    return faults


def approach_faults(data: Tables) -> list[Fault]:
    """Faults of an approach in another contact than a point's, and of loads beside it."""
    contact = data.get("contact")
    if not isinstance(contact, dict) or "approach" not in contact:
        return []
    beside = ["contact.load"] * ("load" in contact) + [
        f"[{name}]" for name in ("operation", "gears") if name in data
    ]
    if "radius" in contact and not is_point(data):
        reason = (
            "of point contacts, and one radius is of a line or a strip; allowed: two radii, or contact.load"
        )
    elif beside:
        reason = f"in place of the load, which {' and '.join(beside)} would give; leave out one of both"
    else:
        return []
    return [Fault("contact.approach", f"contact.approach = {show(contact['approach'])}: {reason}")]


def faults_of_kind(case: Case, data: Tables, surfaces: dict[str, Values | None]) -> list[Fault]:
    """Faults of keys that a line contact, or a plane, does not have; `surfaces` by side."""
    return KINDS[case.kind].part("faults")(case, data, surfaces)


def line_faults(case: Case, data: Tables, surfaces: dict[str, Values | None]) -> list[Fault]:
    """Faults of keys of planes."""
    reason = "of maps, and a line contact has profiles; leave it out"
    keys = [f"surface.{side}.{key}" for side, spec in surfaces.items() if spec for key in areal_keys(spec)]
    faults = [Fault("", f"{key}: {reason}") for key in keys]
    file = "output.xdmf = true: of points and strips, and a line contact has no plane; leave it out"
    return faults + [Fault("output.xdmf", file)] * case.output.xdmf


def plane_faults(case: Case, data: Tables, surfaces: dict[str, Values | None]) -> list[Fault]:
    """Faults of keys of line contacts, and of too many nodes."""
    faults = []
    if "near_field" in data["mesh"]:
        text = (
            f"mesh.near_field = {case.mesh.near_field}: of line contacts, not of a {case.kind}; leave it out"
        )
        faults.append(Fault("mesh.near_field", text))
    return faults + _size_faults(case)


def point_faults(case: Case, data: Tables, surfaces: dict[str, Values | None]) -> list[Fault]:
    """Faults of keys of line contacts and strips."""
    life = Fault("life", "[life]: of line contacts and strips, not of a point; leave it out")
    return [life] * bool(case.life) + plane_faults(case, data, surfaces)


def _size_faults(case: Case) -> list[Fault]:
    """Fault of a plane with too many nodes."""
    geometry, contact = KINDS[case.kind].part("geometry"), case.contact
    dry = geometry.dry(contact, reduced_modulus(contact.youngs_modulus, contact.poisson_ratio))
    rows = geometry.rows(case.mesh, dry)
    if rows * case.mesh.nodes <= MAX_NODES:
        return []
    size = f"{case.mesh.nodes} x {rows} nodes; allowed: {MAX_NODES} in all"
    cure = "a smaller mesh.width or mesh.points_per_half_width (two: along and across) has fewer"
    return [Fault("mesh", f"mesh: {size}; {cure}")]
