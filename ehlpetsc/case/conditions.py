"""Conditions that change with time, from `[operation]` or `[gears]`.

A case with either has a reference state, from which its scales come: the load and radius of the widest
contact and the fastest entrainment. It is filled in under the keys of constant cases. Keys that give the same
conditions twice are refused.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ehlpetsc.base.case import KINDS
from ehlpetsc.base.counts import whole_up
from ehlpetsc.base.declarations import KeyTable
from ehlpetsc.base.errors import ProfileError
from ehlpetsc.base.toml_file import Tables
from ehlpetsc.base.units import UnitFault, factor
from ehlpetsc.case.checking import Fault, check, in_kind
from ehlpetsc.case.tables import Case
from ehlpetsc.case.tables.contact import CONTACT
from ehlpetsc.case.tables.motion import COLUMNS, GEARS, OPERATION, PATH_COLUMNS
from ehlpetsc.case.values import is_number, shortened, show
from ehlpetsc.elasticity.bodies import reduced_modulus

if TYPE_CHECKING:
    from ehlpetsc.gears.path import Path as ContactPath
    from ehlpetsc.physics.variable_operation import ConditionsTable

OF_GEARS = {"contact": ("load", "radius"), "motion": ("entrainment_speed", "slide_roll_ratio")}
Columns = Mapping[str, tuple[str, ...]]  # names of columns in files by key


def read_table(path: Path, units: Mapping[str, str], names: Columns) -> dict[str, list[float]]:
    """Columns of a text file in SI units, `units` by key; raises `ProfileError`."""
    from ehlpetsc.surfaces.files.text import text_columns

    try:
        columns, header = text_columns(path)
        columns = columns[~np.isnan(columns).all(axis=1)]
    except OSError as error:
        raise ProfileError(f"cannot be read: {error.strerror}: {path}") from None
    headings = [line.partition("#")[0].strip() for line in header.splitlines()]
    factors = _factors(next(filter(None, reversed(headings)), ""), units, names)
    if len(factors) != len(columns):
        count = f"{len(factors)} column names, {len(columns)} columns of numbers"
        allowed = f"a line with some of {_spellings(names)}, and numbers below it"
        raise ProfileError(f"{count}; allowed: {allowed}")
    scaled = zip(factors.items(), columns, strict=True)
    return {key: (size * column).tolist() for (key, size), column in scaled}


def _spellings(names: Columns) -> str:
    return ", ".join(spellings[0] for spellings in names.values())


def units_in(kind: str, table: KeyTable) -> dict[str, str]:
    """Units of the keys of a table in a kind of contact."""
    return {name: key.unit for name, key in in_kind(table, kind).keys.items()}


def _factors(heading: str, units: Mapping[str, str], names: Columns) -> dict[str, float]:
    """Factor to SI units of each column named in a heading, by key; units are in brackets: ``time [us]``."""
    key_by_name = {name: key for key, spellings in names.items() for name in spellings}
    factors: dict[str, float] = {}
    for word in heading.split(next((sign for sign in ";,\t" if sign in heading), None)):
        name, _, unit = word.strip(" \"'").replace("(", "[").partition("[")
        key = key_by_name.get(" ".join(name.lower().replace("_", " ").split()))
        if key is None or key in factors:
            allowed = f"allowed: one each of {_spellings(names)}"
            raise ProfileError(f"column {shortened(name.strip())!r}: {allowed}")
        try:
            factors[key] = factor(unit.rstrip(")] ") or units[key], units[key])
        except UnitFault as fault:
            raise ProfileError(f"column {shortened(word.strip())!r}: {fault}") from None
    return factors


MIN_LOAD_FRACTION = 0.05  # of the load of the mesh: load of two teeth at the ends of their contact


def conditions_of(tables: Tables, folder: Path, kind: str, unsound: Set[str]) -> ConditionsTable | None:
    """Conditions over time from the tables of a case of a kind in a folder; raises `ProfileError`.

    None: constant conditions, or unsound tables, whose faults the check of the keys reports.
    """
    gears, operation = tables.get("gears"), tables.get("operation")
    if gears is not None and isinstance(operation, dict):
        raise ProfileError("[gears] gives the same conditions; allowed: one of both")
    if isinstance(gears, dict):
        from ehlpetsc.gears.path import path_of_contact

        values, _ = check(GEARS, gears)
        return of_gears(path_of_contact(values.pair)) if values else None
    values = (
        check(in_kind(OPERATION, kind), operation, root=tables)[0] if isinstance(operation, dict) else None
    )
    if values is None:
        return None
    if values.file is not None:
        columns = read_table(folder / values.file, units_in(kind, OPERATION), COLUMNS)
    else:
        columns = {key: column for key, column in values.as_dict().items() if key in COLUMNS and column}
    return _table(columns, tables, kind, values.repeat, unsound)


FILES = {"operation": ("file", OPERATION, COLUMNS), "gears": ("load_file", GEARS, PATH_COLUMNS)}


def with_columns(tables: Tables, folder: Path, kind: str, of: Sequence[str] = tuple(FILES)) -> Tables:
    """Tables of a case with the columns of files of conditions in place of their names, as in results."""
    for name in of:
        (key, table, names), given = FILES[name], tables.get(name)
        if isinstance(given, dict) and isinstance(given.get(key), str):
            columns = read_table(folder / given[key], units_in(kind, table), names)
            tables = tables | {name: {k: v for k, v in given.items() if k != key} | columns}
    return tables


def with_file(place: str, case: Case) -> str:
    """Place of a key, with the file that it is a column of: ``operation.load of loads.csv``."""
    name, _, column = place.partition(".")
    key, _, columns = FILES.get(name, ("", None, ()))
    table = getattr(case, name) if column in columns else None
    file = getattr(table, key) if table else None
    return f"{place} of {file}" if file else place


def of_gears(path: ContactPath) -> ConditionsTable:
    """Conditions along a path of contact, where teeth carry at least `MIN_LOAD_FRACTION` of the load."""
    min_load = MIN_LOAD_FRACTION * path.load.max()
    carries = np.flatnonzero(path.load >= min_load)
    first, last = carries[0], carries[-1]
    begin, end = path.time[first], path.time[last]
    if first > 0:
        begin = np.interp(min_load, path.load[first - 1 : first + 1], path.time[first - 1 : first + 1])
    if last < len(path.load) - 1:
        end = np.interp(min_load, path.load[[last + 1, last]], path.time[[last + 1, last]])
    inside = path.time[(path.time > begin) & (path.time < end)]
    time = np.concatenate([[begin], inside, [end]])
    rho = np.interp(time, path.time, path.rho)
    u1, u2 = path.pair.speeds(rho)
    arcs = path.pair.flank_arcs(rho[0])
    from ehlpetsc.physics.variable_operation import ConditionsTable

    return ConditionsTable(
        time - begin,
        np.interp(time, path.time, path.load),
        path.pair.radius(rho),
        u1,
        u2,
        profile_offsets=(float(arcs[0]), float(arcs[1])),
    )


def _table(
    columns: dict[str, list[float]], tables: Tables, kind: str, repeat: int, unsound: Set[str]
) -> ConditionsTable | None:
    """Conditions of the columns, for missing ones the constants of the case; raises `ProfileError`.

    None: the constants are in unsound tables.
    """
    if "time" not in columns:
        raise ProfileError("no column time; allowed: one, increasing")
    if len(columns) == 1:
        raise ProfileError("no column but time; allowed: load, radius, speed 1, speed 2, one at least")
    values = {key: np.array(column) for key, column in columns.items()}
    count = len(values["time"])
    if count < 2 or any(len(column) != count for column in values.values()):
        raise ProfileError("allowed: columns of the same length, two times at least")

    def refuse(key: str, wrong: np.ndarray, allowed: str) -> None:
        for k in np.flatnonzero(wrong)[:1]:
            unit = units_in(kind, OPERATION)[key]
            raise ProfileError(f"row {k + 1}: {key} = {values[key][k]:g} {unit}: allowed: {allowed}")

    for key, column in values.items():
        refuse(key, ~np.isfinite(column), "a finite number")
    refuse("time", np.append(False, np.diff(values["time"]) <= 0.0), "increasing times")
    for key in {"load", "radius"} & set(values):
        refuse(key, values[key] <= 0.0, "above 0")
    if unsound & {"contact", "motion"}:
        return None
    constants = _constants(tables)
    missing = [key for key in COLUMNS if key not in values and key not in constants]
    if missing:
        keys = {f"contact.{key}" if key in ("load", "radius") else "motion" for key in missing}
        neither = f"neither {', '.join(missing)} nor {', '.join(sorted(keys))}"
        raise ProfileError(f"{neither}; allowed: a column of the table, or the key")
    values = {key: values.get(key, np.full(count, constants.get(key, 0.0))) for key in COLUMNS}
    if not (values["speed_1"].any() or values["speed_2"].any()):
        raise ProfileError("both speeds are zero; allowed: a speed at some time")
    from ehlpetsc.physics.variable_operation import ConditionsTable

    load, radius, u1, u2 = (values[key] for key in ("load", "radius", "speed_1", "speed_2"))
    return ConditionsTable(values["time"] - values["time"][0], load, radius, u1, u2, repeat)


def _constants(tables: Tables) -> dict[str, float]:
    """Constant conditions in the other tables of a case."""
    contact, motion = tables.get("contact", {}), tables.get("motion", {})
    constants = {key: np.ravel(contact[key])[0] for key in ("load", "radius") if key in contact}
    if "entrainment_speed" in motion:
        u, xi = motion["entrainment_speed"], motion.get("slide_roll_ratio", 0.0)
        constants |= {"speed_1": u * (1.0 + xi / 2.0), "speed_2": u * (1.0 - xi / 2.0)}
    return {key: float(value) for key, value in constants.items()}


def with_reference_state(tables: Tables, table: ConditionsTable | None, kind: str) -> Tables:
    """Tables of a case, none of them unsound, with the reference state of its conditions filled in."""
    if table is None:
        return tables
    contact, motion, time = (tables.get(name, {}) for name in ("contact", "motion", "time"))
    load, radius, u, xi = table.reference()
    radii, extent = _radii(contact, radius)
    contact, constants = contact | {"load": load, "radius": radii}, _constants(tables)
    speeds = {"speed_1": table.u1, "speed_2": table.u2}
    if any((speed != constants.get(key)).any() for key, speed in speeds.items()):
        motion = motion | {"entrainment_speed": u, "slide_roll_ratio": min(max(xi, -100.0), 100.0)}
    if "gears" in tables and "pass_shift" not in time:
        time = time | {"pass_shift": check(GEARS, tables["gears"])[0].pair.hunting_shift}
    if "travel" not in time:
        time = time | {"travel": 1.0}
        elastic = [contact.get(key) for key in ("youngs_modulus", "poisson_ratio")]
        if None not in elastic:
            modulus = reduced_modulus(*([value] * 2 if is_number(value) else value for value in elastic))
            half_width = KINDS[kind].part("geometry").half_width(load, radius, modulus, extent)
            time["travel"] = float(table.swept_length() / half_width)
    return tables | {"contact": contact, "motion": motion, "time": time}


def _radii(contact: Tables, radius: float) -> tuple[Any, float]:
    """Radii with one along [m], in the ratio of those given, and the extent of the formulas."""
    if not isinstance(contact.get("radius"), list | tuple):
        return radius, contact.get("length", 1.0)
    along, across = contact["radius"]
    return [radius, across * (radius / along)], across / along


def reversal_faults(case: Case, table: ConditionsTable) -> list[str]:
    """Fault of a domain that is not symmetric although the entrainment speed becomes negative."""
    mesh = case.mesh
    last = mesh.inlet + (mesh.nodes - 1) / mesh.points_per_half_width
    if table.entrainment.min() >= 0.0 or abs(last + mesh.inlet) < 1e-9:
        return []
    fault = f"mesh.outlet = {mesh.outlet:g}: oil enters there where the entrainment speed is negative"
    cells = whole_up(-2.0 * mesh.inlet * mesh.points_per_half_width)
    half = 0.5 * cells / mesh.points_per_half_width
    inlet = f" with mesh.inlet = {-half:.12g}" if abs(half + mesh.inlet) > 1e-9 else ""
    return [f"{fault}; allowed: {half:.12g}{inlet}, a whole number of cells with the inlet as far out"]


def given_by_gears(data: Tables, kind: str) -> list[Fault]:
    """Faults of keys beside `[gears]`, which gives their values and is of line contacts and strips."""
    if "gears" not in data:
        return []
    if KINDS[kind].is_whole:
        key = next(key for key in ("length", "radius") if key in data["contact"])  # which makes it whole
        text = f"contact.{key} = {show(data['contact'][key])}: a {kind} contact has no [gears]"
        text += f"; leave the {key} out (mesh.width: a strip), or [gears]"
        return [Fault(f"contact.{key}", text)]
    faults = []
    for table, keys in OF_GEARS.items():
        values = data.get(table)
        for key in keys if isinstance(values, dict) else ():
            if key in values:
                text = f"{table}.{key} = {show(values[key])}: follows from [gears]; leave out one of both"
                faults.append(Fault(f"{table}.{key}", text))
    return faults


def approach_faults(data: Tables, kind: str) -> list[Fault]:
    """Faults of an approach in another contact than a point's, and of loads beside it."""
    contact = data.get("contact")
    if not isinstance(contact, dict) or "approach" not in contact:
        return []
    beside = ["contact.load"] * ("load" in contact)
    beside += [f"[{name}]" for name in ("operation", "gears") if name in data]
    if "radius" in contact and kind not in CONTACT.keys["approach"].contacts:
        reason = f"of point contacts, and this is a {kind}; allowed: two radii, or contact.load"
    elif beside:
        reason = f"in place of the load, which {' and '.join(beside)} would give; leave out one of both"
    else:
        return []
    return [Fault("contact.approach", f"contact.approach = {show(contact['approach'])}: {reason}")]
