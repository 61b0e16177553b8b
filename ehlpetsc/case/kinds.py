"""Keys that only some kinds of contact have: faults of the others."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ehlpetsc.base.case import KINDS
from ehlpetsc.base.toml_file import Tables
from ehlpetsc.case.checking import Fault, entries
from ehlpetsc.case.tables import CASE
from ehlpetsc.case.tables.contact import CONTACT
from ehlpetsc.case.tables.surface import AREAL
from ehlpetsc.case.values import show
from ehlpetsc.effects import EFFECTS
from ehlpetsc.physics.scales import reduced_modulus

if TYPE_CHECKING:
    from ehlpetsc.case.tables import Case

OF_GEARS = {"contact": ("load", "radius"), "motion": ("entrainment_speed", "slide_roll_ratio")}
MAX_PLANE_NODES = 1_000_000  # of a plane, which take 5 GB and minutes a time step


def given_by_gears(data: Tables, kind: str) -> list[Fault]:
    """Faults of keys beside `[gears]`, which gives their values and is of line contacts and strips."""
    if "gears" not in data:
        return []
    if KINDS[kind].is_whole:
        given = f"contact.radius = {show(data['contact']['radius'])}"
        text = f"{given}: a {kind} contact has no [gears]"
        text += "; leave the radius out (mesh.width: a strip), or [gears]"
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


def approach_faults(data: Tables, kind: str) -> list[Fault]:
    """Faults of an approach in another contact than a point's, and of loads beside it."""
    contact = data.get("contact")
    if not isinstance(contact, dict) or "approach" not in contact:
        return []
    beside = ["contact.load"] * ("load" in contact) + [
        f"[{name}]" for name in ("operation", "gears") if name in data
    ]
    if "radius" in contact and kind not in CONTACT.keys["approach"].contacts:
        reason = (
            "of point contacts, and one radius is of a line or a strip; allowed: two radii, or contact.load"
        )
    elif beside:
        reason = f"in place of the load, which {' and '.join(beside)} would give; leave out one of both"
    else:
        return []
    return [Fault("contact.approach", f"contact.approach = {show(contact['approach'])}: {reason}")]


def contact_faults(case: Case, data: Tables) -> list[Fault]:
    """Faults of keys and effects that the kind of contact does not have, and of a plane of too many nodes."""
    kind = KINDS[case.kind]
    given = [(holder[name], key, place) for holder, name, key, place in entries(data, CASE, "") if key]
    served = {place: key.contacts for value, key, place in given if key.contacts and value != key.default}
    served |= {(e.table.name if e.table else e.name): e.contacts for e in EFFECTS if e.is_in(case)}
    served |= {"[life]": ("line", "strip")} if case.life else {}
    for value, _, place in given:
        if place in ("surface.1.z", "surface.2.z") and isinstance(value[0], list):
            served[place] = AREAL
    faults = [
        Fault(place, f"{place}: of {' and '.join(of)} contacts, and this is a {case.kind}; leave it out")
        for place, of in served.items()
        if case.kind not in of
    ]
    return faults + (_size_faults(case) if kind.is_areal else [])


def _size_faults(case: Case) -> list[Fault]:
    """Fault of a plane with too many nodes."""
    geometry, contact = KINDS[case.kind].part("geometry"), case.contact
    dry = geometry.dry(contact, reduced_modulus(contact.youngs_modulus, contact.poisson_ratio))
    rows = geometry.rows(case.mesh, dry)
    if rows * case.mesh.nodes <= MAX_PLANE_NODES:
        return []
    size = f"{case.mesh.nodes} x {rows} nodes; allowed: {MAX_PLANE_NODES} in all"
    cure = "a smaller mesh.width or mesh.points_per_half_width (two: along and across) has fewer"
    return [Fault("mesh", f"mesh: {size}; {cure}")]
