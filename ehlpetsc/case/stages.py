"""Case of its tables in three stages, each of which returns new tables and leaves the given ones as they are.

- :func:`resolved`: what the file and overrides say, in SI units, with the points of profiles and the
  height of a measured layer: all that is stored with the case;
- :func:`derived`: with all that follows from it, as constants of steels and oils, the load of an approach,
  conditions over time of tables and gears, the reference state of the scales;
- :func:`checked`: values by the table of keys, then what keys mean together: a mesh for reversing oil,
  features that the contact lacks or that assume what it is not.

Nothing is derived from tables with a fault of their own, and a fault that may be a consequence of another one
is marked as such: all stages run, and the reader of a case reports all faults at once. New tables cost a copy
of all but the rows of maps; `tests/unit/test_case.py` holds that no stage changes those it is given.
"""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path
from typing import Any, NamedTuple

from ehlpetsc.base.case import KINDS, Case
from ehlpetsc.base.errors import ProfileError
from ehlpetsc.base.toml_file import Tables
from ehlpetsc.case.assumptions import faults as departures
from ehlpetsc.case.checking import Fault, check, entries, in_kind, in_si, unsound_tables
from ehlpetsc.case.conditions import (
    approach_faults,
    conditions_of,
    given_by_gears,
    reversal_faults,
    with_columns,
    with_reference_state,
)
from ehlpetsc.case.derived import (
    modulus_of,
    rating_of,
    with_derived,
    with_layer_stiffness,
    with_measured_layer,
)
from ehlpetsc.case.tables import CASE
from ehlpetsc.case.tables.surface import AREAL
from ehlpetsc.case.values import is_number, show
from ehlpetsc.effects import EFFECTS
from ehlpetsc.physics.scales import Scales

NO_SPEEDS = "motion is missing; allowed: a table (speeds; needed with [fluid] and with [time])"
MAX_PLANE_NODES = 1_100_000  # of a plane, 1,048 a side, which take some GB and seconds a time step


class Checked(NamedTuple):
    """Tables to be stored, the case, None with faults, and the faults of all stages."""

    tables: Tables
    case: Any
    faults: list[Fault]


def resolved(folder: Path, written: Tables, kind: str) -> tuple[Tables, list[Fault]]:
    """First stage, with the faults so far; `written`: tables of a case file with its overrides."""
    tables, of_profiles = _with_profiles(folder, written)
    tables, of_units = in_si(tables, kind)
    faults = of_profiles + of_units
    tables, of_layer = with_measured_layer(folder, tables, {fault.place for fault in faults})
    return tables, faults + of_layer


def _with_profiles(folder: Path, written: Tables) -> tuple[Tables, list[Fault]]:
    contact = written.get("contact")
    if not isinstance(contact, dict) or not contact.keys() & {"profile", "profile_along"}:
        return written, []
    from ehlpetsc.case.profile_files import with_profiles  # few cases need it

    return with_profiles(folder, written)


class Derived(NamedTuple):
    """Tables with all that follows from them.

    `conditions`: over time, `physics.variable_operation`; None: constant. `faults`: so far. `is_sound`:
    whether no given table has a fault.
    """

    tables: Tables
    conditions: Any
    faults: list[Fault]
    is_sound: bool


def derived(folder: Path, given: Tables, kind: str, known: Collection[str], is_stored: bool) -> Derived:
    """Second stage; `known`: places of faults of the first. Files of a stored case may be gone."""
    unsound = unsound_tables(given, known)
    tables, faults = with_derived(given, unsound)
    conditions = None
    try:
        tables = with_columns(tables, folder, kind, ("gears",))
        conditions = conditions_of(tables, folder, kind, unsound)
    except ProfileError as error:
        faults = faults + ([] if is_stored else [_file_fault(tables, error)])
    if not unsound:
        tables = with_reference_state(tables, conditions, kind)
    if "motion" not in tables and ("fluid" in tables or "time" in tables):
        follows = bool(unsound) or "gears" in tables or "operation" in tables
        faults = [*faults, Fault("motion", NO_SPEEDS, follows)]
    return Derived(tables, conditions, faults, not unsound)


def checked(
    folder: Path, given: Tables, kind: str, known: Collection[str] = (), is_stored: bool = False
) -> Checked:
    """Third stage: the case of a kind with its conditions over time; parameters as of :func:`derived`."""
    heat = given.get("heat")
    if isinstance(heat, dict) and heat.get("bulk_temperature") == "losses":
        return _checked_with_losses(folder, given, kind, known)
    if wrong := approach_faults(given, kind) or given_by_gears(given, kind):
        return Checked(given, None, wrong)
    tables, conditions, faults, is_sound = derived(folder, given, kind, known, is_stored)
    values, found = check(in_kind(CASE, kind), tables, known=known, is_sound=is_sound and not faults)
    if values is None:
        return Checked(given, None, faults + found)
    case: Case = _with_load_file(values.copy({"_kind": kind, "_conditions": conditions}), given)
    case = case if faults else with_layer_stiffness(case)  # which needs speeds
    reversed_flow = reversal_faults(case, conditions) if conditions else []
    faults = [*faults, *found, *(Fault("mesh", line) for line in reversed_flow)]
    faults += contact_faults(case, tables) if case.contact and case.mesh else []
    return Checked(given, None if faults else case, faults)


def _with_load_file(case: Case, given: Tables) -> Case:
    """The case with the file of the gears' load, of which the columns have been checked in its place."""
    gears = given.get("gears")
    file = gears.get("load_file") if isinstance(gears, dict) else None
    return case.copy({"gears": case.gears.copy({"load_file": file})}) if file else case


def _checked_with_losses(folder: Path, given: Tables, kind: str, known: Collection[str]) -> Checked:
    """Case checked as by :func:`checked`, with bulk temperatures from the losses of the gears.

    They are stored with the case, which then does not depend on how losses are computed.
    """
    fluid, heat = given.get("fluid"), given["heat"]
    graded = fluid.get("temperature") if isinstance(fluid, dict) else None
    oil = heat.get("inlet_temperature") or graded or heat.get("reference_temperature")
    if not isinstance(given.get("gears"), dict) or not is_number(oil):
        text = 'heat.bulk_temperature = "losses": needs [gears] and the temperature of the oil, '
        text += "heat.inlet_temperature, fluid.temperature or heat.reference_temperature"
        return Checked(given, None, [Fault("heat.bulk_temperature", text)])
    _, case, faults = checked(folder, given | {"heat": heat | {"bulk_temperature": oil}}, kind, known)
    if case is None:
        return Checked(given, None, faults)
    from ehlpetsc.gears.standards import bulk_temperatures

    try:
        bulk = bulk_temperatures(rating_of(case, folder), heat_transfer=case.gears.heat_transfer)
    except ProfileError:  # of a surface, reported by its check
        return Checked(given, None, [])
    found = [round(value, 1) for value in bulk]
    return checked(folder, given | {"heat": heat | {"bulk_temperature": found}}, kind, known)


def contact_faults(case: Case, data: Tables) -> list[Fault]:
    """Faults of features that the contact lacks, or that assume what it is not, and of a plane too large."""
    given = [(holder[name], key, place) for holder, name, key, place in entries(data, CASE, "") if key]
    served = {place: key.contacts for value, key, place in given if key.contacts and value != key.default}
    served |= {(e.table.name if e.table else e.name): e.contacts for e in EFFECTS if e.is_in(case)}
    served |= {"[life]": ("line", "strip")} if case.life else {}
    for value, _, place in given:
        if place in ("surface.1.z", "surface.2.z") and isinstance(value[0], list):
            served[place] = AREAL
    faults = [
        Fault(place, f"{place}: of {_listed(of)} contacts, and this is a {case.kind}; leave it out")
        for place, of in served.items()
        if case.kind not in of
    ]
    faults += [Fault(place, text) for place, text in departures(case)]
    too_large = _size_faults(case) if KINDS[case.kind].is_areal else []
    return faults + too_large + ([] if faults or too_large else _speed_faults(case))


def _listed(words: Collection[str]) -> str:
    """Words as "one, two and three"."""
    return " and ".join(filter(None, (", ".join([*words][:-1]), [*words][-1])))


def _size_faults(case: Case) -> list[Fault]:
    """Fault of a plane with too many nodes."""
    geometry = KINDS[case.kind].part("geometry")
    rows = geometry.rows(case.contact, case.mesh, geometry.dry(case.contact, modulus_of(case)))
    if rows * case.mesh.nodes <= MAX_PLANE_NODES:
        return []
    size = f"{case.mesh.nodes} x {rows} nodes; allowed: {MAX_PLANE_NODES} in all"
    cure = "a smaller mesh.width or mesh.points_per_half_width (two: along and across) has fewer"
    return [Fault("mesh", f"mesh: {size}; {cure}")]


def _speed_faults(case: Case) -> list[Fault]:
    """Fault of rows whose oil enters at the outlet, by the spin or the groove."""
    if case.motion is None or not (case.motion.spin or case.contact.groove_radius):
        return []
    scales = Scales.of(case)
    slowest = scales.conditions
    if case.conditions is not None:
        k = case.conditions.entrainment.argmin()
        slowest = slowest._replace(u1=case.conditions.u1[k], u2=case.conditions.u2[k])
    speeds, y = scales.across.entrainment(slowest), scales.across.y
    if speeds.min() > 0.0:
        return []
    row = 1e3 * y[speeds.argmin()]
    text = f"motion: an entrainment speed of {speeds.min():.3g} m/s at y = {row:.3g} mm; allowed: above 0 in "
    text += "each row: a smaller mean of motion.spin of both bodies, or a narrower mesh"
    return [Fault("motion", text)]


def _file_fault(data: Tables, error: ProfileError) -> Fault:
    name, key = ("gears", "load_file") if "gears" in data else ("operation", "file")
    file = data[name].get(key)
    return Fault(name, f"{name}{f'.{key} = {show(file)}' if file else ''}: {error}")
