"""Reading of case files: overrides and checks; all faults are reported at once."""

from __future__ import annotations

import copy
import math
import os
from collections.abc import Collection, Iterable, Mapping
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from ehlpetsc.base.case import KINDS, kind_of
from ehlpetsc.base.declarations import Values
from ehlpetsc.base.errors import CaseError, ProfileError
from ehlpetsc.base.toml_file import (
    Tables,
    keys_of,
    member_tables,
    parse_toml,
    parsed,
    plain,
    put,
    read_text,
    settings_of,
)
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
    resolve_measured_layer,
    with_derived,
    with_layer_stiffness,
)
from ehlpetsc.case.tables import CASE, Case, extend, key_of
from ehlpetsc.case.tables.surface import AREAL, PROFILE, SIDES, file_digests
from ehlpetsc.case.values import is_number, shortened, show
from ehlpetsc.effects import EFFECTS
from ehlpetsc.effects.effect import Effect
from ehlpetsc.physics.film_formulas import expected_film
from ehlpetsc.physics.oil.law import Law
from ehlpetsc.physics.scales import Scales

if TYPE_CHECKING:
    from ehlpetsc.surfaces.topography import Topography

DICT_NAME = "case"  # name of a case without a file in messages
NO_SPEEDS = "motion is missing; allowed: a table (speeds; needed with [fluid] and with [time])"
MAX_PLANE_NODES = 1_000_000  # of a plane, which take 5 GB and minutes a time step
OWN_ADVICE = "; if it is of your own, set EHLPETSC_OWN to the module that defines it"
Overrides = Tables | Iterable[str] | str | None
__all__ = ["Case", "CaseError", "load", "members", "stored_case"]


def load(
    case: str | PathLike | Tables,
    overrides: Overrides = None,
    *,
    laws: Mapping[str, Law] | None = None,
    density_laws: Mapping[str, Law] | None = None,
    shear_laws: Mapping[str, Law] | None = None,
    effects: Iterable[type[Effect]] = (),
) -> Case:
    """Read and check a case; raises `CaseError` with all faults, one message each.

    Parameters
    ----------
    case
        TOML file or its tables; profile files of a dict are in the current folder, and heights of
        a surface may be arrays, ``{"surface": {"1": {"x": x, "z": z}}}`` [m].
    overrides
        ``{"fluid.viscosity": 0.003}``, None removes the key; or ``table.key=value``, the value in TOML
        syntax, otherwise text. An empty table, ``time={}``, leaves out a table that must have keys.
    laws, density_laws, shear_laws, effects
        Viscosity, density and shear laws by name, and effects, of your own. With their keys and quantities
        they are known to the process from then on; names of built-in ones are refused.

    Examples
    --------
    >>> import ehlpetsc
    >>> case = ehlpetsc.load("cases/table1_smooth.toml", {"fluid.viscosity": 0.003})
    >>> case.fluid.viscosity, case.contact.radius  # Pa s, m
    (0.003, 0.0191)
    """
    extend(laws, density_laws, effects, shear_laws)
    if not isinstance(case, dict | str | PathLike):  # a number would be a file descriptor
        raise CaseError([f"{_not_tables(case)}; allowed: the path of a case file, or a dict of its tables"])
    path, text = (DICT_NAME, None) if isinstance(case, dict) else (case, read_text(case))
    data = plain(case) if text is None else parse_toml(path, text)
    written, folder = copy.deepcopy(data), Path(path).parent
    faults = _override(data, overrides)
    kind = kind_of(data)
    faults += _of_roller(folder, data)
    faults += in_si(data, kind)
    faults += resolve_measured_layer(folder, data, {fault.place for fault in faults})
    base = copy.deepcopy(data) if "series" in data else data  # each member has bulk temperatures of its own
    checked, found = _with_profiles(folder, base, kind, {fault.place for fault in faults})
    lines = _lines(path, faults + found)
    if not lines and "series" in data:
        lines = _series_faults(path, folder, data)
    if lines:
        raise CaseError(lines)
    stored = with_columns(data, folder, kind)
    text = text if stored == written else None
    return _of_files(checked.copy({"_path": Path(path), "_tables": stored, "_text": text}))


def _not_tables(given: object) -> str:
    if isinstance(given, Case):
        return "a Case, which is loaded already; for other values load its file or tables with them"
    return f"{shortened(repr(given))}: not a case"


def _of_files(case: Case) -> Case:
    """The case with the digests of its surface files."""
    return case.copy({"_digests": file_digests(case)})


def _of_roller(folder: Path, data: Tables) -> list[Fault]:
    """Resolve the profile of a roller, if any; returns the faults."""
    contact = data.get("contact")
    if not isinstance(contact, dict) or "profile" not in contact:
        return []
    from ehlpetsc.case.profile_files import resolve_profile

    return resolve_profile(folder, contact)


def stored_case(text: str, overrides: Overrides = None) -> Case:
    """Case from the text in a result file, which it keeps, without its profile files; raises `CaseError`."""
    data = parse_toml(DICT_NAME, text)
    faults = _override(data, overrides)
    kind = kind_of(data)
    faults += in_si(data, kind)
    case, found = _checked(Path(), data, kind, is_stored=True)
    if faults + found:
        own = "" if overrides or os.environ.get("EHLPETSC_OWN") else OWN_ADVICE
        raise CaseError([f"{line}{own}" for line in _lines(DICT_NAME, faults + found)])
    return case.copy({"_path": Path(DICT_NAME), "_tables": data, "_text": text})


def members(case: Case | str | PathLike | Tables) -> list[tuple[Any, Case]]:
    """Values and members of a series: the same case without `[series]`, with one value of each varied key.

    For several keys the value is a tuple.
    """
    case = case if isinstance(case, Case) else load(case)
    data, result = copy.deepcopy(case._tables), []
    if "series" not in data:
        raise CaseError([f"{case.path}: no [series]: it has no members; solve the case itself"])
    for settings in settings_of(data["series"]):
        tables = member_tables(data, settings)
        member, _ = _checked(case.path.parent, tables, kind_of(tables))
        values = tuple(value for _, value in settings)
        member = _of_files(member.copy({"_path": case.path, "_tables": tables, "_text": None}))
        result.append((values[0] if case.series.key else values, member))
    return result


def _override(data: Tables, overrides: Overrides) -> list[Fault]:
    """Set keys in the tables; returns a fault for each invalid one."""
    faults = []
    items: Any = overrides.items() if isinstance(overrides, dict) else overrides or ()
    for override in [items] if isinstance(items, str | int | float) else list(items):
        try:
            keys, value = parsed(override)
            put(data, keys, None if _leaves_out(keys, value) else value)
        except ValueError:
            one_line = " ".join(override.split()) if isinstance(override, str) else show(override)
            text = shortened(one_line)
            faults.append(Fault("", f"{text}: allowed: table.key=value, as in fluid.viscosity=0.003"))
    return faults


def _leaves_out(keys: list[str], value: object) -> bool:
    """Whether a value is an empty table in place of one that must have keys."""
    key = key_of(".".join(keys)) if value == {} else None
    return bool(key and key.table and check(key.table, {})[1])


def _checked(
    folder: Path, data: Tables, kind: str, known: Collection[str] = (), is_stored: bool = False
) -> tuple[Any, list[Fault]]:
    """The case of a kind with its conditions over time, None with faults, and the faults of its tables."""
    heat = data.get("heat")
    if isinstance(heat, dict) and heat.get("bulk_temperature") == "losses":
        return _checked_with_losses(folder, data, kind, known)
    faults, conditions = [], None
    if wrong := approach_faults(data, kind) or given_by_gears(data, kind):
        return None, wrong
    unsound = unsound_tables(data, known)
    data, underived = with_derived(data, unsound)
    faults += underived
    gears = data.get("gears")
    load_file = gears.get("load_file") if isinstance(gears, dict) else None
    try:
        data = with_columns(data, folder, kind, ("gears",))
        conditions = conditions_of(data, folder, kind, unsound)
    except ProfileError as error:
        faults += [] if is_stored else [_file_fault(data, error)]
    if not unsound:
        data = with_reference_state(data, conditions, kind)
    if "motion" not in data and ("fluid" in data or "time" in data):
        faults.append(Fault("motion", NO_SPEEDS, bool(unsound) or "gears" in data or "operation" in data))
    case, found = check(in_kind(CASE, kind), data, known=known, is_sound=not unsound and not faults)
    if case:
        case = case.copy({"_kind": kind, "_conditions": conditions})
        if load_file:  # of which the columns have been checked in its place
            case = case.copy({"gears": case.gears.copy({"load_file": load_file})})
        case = case if faults else with_layer_stiffness(case)  # which needs speeds
        reversed_flow = reversal_faults(cast(Case, case), conditions) if conditions else []
        faults += [Fault("mesh", line) for line in reversed_flow]
        faults += contact_faults(cast(Case, case), data) if case.contact and case.mesh else []
    return (case if case and not faults else None), faults + found


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
    return faults + (_size_faults(case) if KINDS[case.kind].is_areal else [])


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


def _file_fault(data: Tables, error: ProfileError) -> Fault:
    name, key = ("gears", "load_file") if "gears" in data else ("operation", "file")
    file = data[name].get(key)
    return Fault(name, f"{name}{f'.{key} = {show(file)}' if file else ''}: {error}")


def _checked_with_losses(
    folder: Path, data: Tables, kind: str, known: Collection[str]
) -> tuple[Any, list[Fault]]:
    """As :func:`_checked`, with bulk temperatures from the losses of the gears, which are put into `data`."""
    fluid, heat = data.get("fluid"), data["heat"]
    graded = fluid.get("temperature") if isinstance(fluid, dict) else None
    oil = heat.get("inlet_temperature") or graded or heat.get("reference_temperature")
    if not isinstance(data.get("gears"), dict) or not is_number(oil):
        text = 'heat.bulk_temperature = "losses": needs [gears] and the temperature of the oil, '
        text += "heat.inlet_temperature, fluid.temperature or heat.reference_temperature"
        return None, [Fault("heat.bulk_temperature", text)]
    case, faults = _checked(folder, data | {"heat": heat | {"bulk_temperature": oil}}, kind, known)
    if case is None:
        return None, faults
    from ehlpetsc.gears.standards import bulk_temperatures

    try:
        bulk = bulk_temperatures(rating_of(case, folder), heat_transfer=case.gears.heat_transfer)
    except ProfileError:  # of a surface, reported by its check
        return None, []
    heat["bulk_temperature"] = [round(value, 1) for value in bulk]
    return _checked(folder, data, kind, known)


def _series_faults(path: str | PathLike, folder: Path, data: Tables) -> list[str]:
    """Faults of the members of a series, of which the base case has none."""
    lines = []
    for settings in settings_of(data["series"]):
        try:
            member = member_tables(data, settings)
        except ValueError:
            named = ", ".join(show(key) for key in keys_of(data["series"]))
            return [f"{path}: series.key = {named}: allowed: a key of this case"]
        _, faults = _with_profiles(folder, member, kind_of(member))
        values = ", ".join(show(value) for _, value in settings)
        lines += [f"{line} (series.values: {values})" for line in _lines(path, faults)]
    return lines


def _lines(path: str | PathLike, faults: list[Fault]) -> list[str]:
    """Messages of faults, each once, without consequences of others."""
    own = [fault for fault in faults if not fault.is_consequence] or faults
    return list(dict.fromkeys(f"{path}: {fault.text}" for fault in own))


def _with_profiles(
    folder: Path, data: Tables, kind: str, known: Collection[str] = ()
) -> tuple[Any, list[Fault]]:
    """As :func:`_checked`, with the faults of the files or heights of both surfaces.

    Without a case, as other tables have faults, they are read alone, as profiles or maps.
    """
    case, faults = _checked(folder, data, kind, known)
    whole = case if case and case.contact and case.mesh else None  # its kind is known
    surface = data.get("surface")
    tables = {side: surface.get(side) if isinstance(surface, dict) else None for side in SIDES}
    specs = {side: check(PROFILE, t)[0] if isinstance(t, dict) else None for side, t in tables.items()}
    for side, spec in specs.items():
        if spec is None:  # smooth, or its faults are reported with its keys
            continue
        try:
            _check_surface(folder, spec, whole)
        except ProfileError as error:
            key = "z" if "z" in tables[side] else "file"
            of_map = whole and KINDS[whole.kind].is_areal  # of several keys
            given = "" if of_map else f".{key} = {show(tables[side][key])}"
            faults.append(Fault("", f"surface.{side}{given}: {error}"))
    return case, faults


def _check_surface(folder: Path, spec: Values, case: Case | None) -> None:
    """Raise `ProfileError` for a surface that cannot be used in a case; None: in any kind of contact."""
    from ehlpetsc.surfaces.samples import areal_samples, measured_samples, samples

    if case is not None and KINDS[case.kind].is_areal:
        grid = Scales.of(case).grid
        width = grid.spacings[0] * grid.shape[0]
        if spec.synthetic:
            areal_samples(folder, spec, width, grid.periodic)
        else:
            _check_plausible(areal_samples(folder, spec, width, False), case)  # with its own spacings
    elif not spec.synthetic:
        if case is None:
            measured_samples(folder, spec)
        else:
            _check_plausible(samples(folder, spec), case)


def _check_plausible(given: Topography, case: Case) -> None:
    from ehlpetsc.surfaces.motion.profile_checks import absurd

    scales = Scales.of(case)
    across = scales.b if math.isfinite(scales.b) else scales.grid.spacings[0] * scales.grid.shape[0]
    film = scales.h * expected_film(case, scales) if case.fluid else 0.0
    if fault := absurd(given, scales.a, across, scales.h, film):
        raise ProfileError(fault)
