"""The table of keys: every key of a case file with unit, bounds, choices, default, needs and meaning.

Bounds are wide enough for any machine element in SI units and narrow enough to detect a value in GPa, mm, um.
"""

from __future__ import annotations

import importlib
import os
import sys
import traceback
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path

from ehlpetsc.base import quantities
from ehlpetsc.base.case import Case
from ehlpetsc.base.declarations import Key, KeyTable, Refused, Required
from ehlpetsc.base.errors import CaseError, UsageError
from ehlpetsc.base.toml_file import is_plain
from ehlpetsc.case.tables.contact import CONTACT, FLUID
from ehlpetsc.case.tables.motion import GEARS, MESH, MOTION, OPERATION, TIME
from ehlpetsc.case.tables.outputs import LIFE, OUTPUT, POST, SERIES
from ehlpetsc.case.tables.surface import SURFACE
from ehlpetsc.effects import EFFECTS
from ehlpetsc.effects.effect import Effect
from ehlpetsc.physics.oil.law import Law
from ehlpetsc.physics.oil.laws import DENSITY_LAWS, LAWS, SHEAR_LAWS

CONDITIONS = (CONTACT, FLUID, MOTION, MESH, SURFACE, TIME, OPERATION, GEARS)
TABLES = (*CONDITIONS, *(effect.table for effect in EFFECTS if effect.table), OUTPUT, POST, LIFE, SERIES)


def _petsc_options(case: Case) -> dict[str, dict[str, str]]:
    """Options as texts, as PETSc requires; true is an option without a value, false none."""
    options = {}
    for name, value in case.petsc.items():
        is_number = isinstance(value, int | float) and abs(value) < 1e300
        is_name = name and not name.startswith("-") and is_plain(name)
        if not (is_name and (is_number or isinstance(value, str) and is_plain(value))):
            raise Refused(key="petsc")
        if value is not False:
            options[name] = value if isinstance(value, str) else "" if value is True else repr(value)
    return {"petsc": options}


CASE = KeyTable(
    "",
    "keys at the top",
    {"title": Required("one line for the result file and its pictures", kind=str, max_items=1000)}
    | {table.name: table.key for table in TABLES}
    | {
        "petsc": Key(
            "PETSc options without the dash: a text, a number, true (no value) or false (not set)",
            kind=dict,
            default={},
        )
    },
    values=Case,
    complete=_petsc_options,
)


RESERVED: dict[str, dict[str, object]] = {
    "a viscosity law": dict(LAWS),
    "a density law": dict(DENSITY_LAWS),
    "a shear law": dict(SHEAR_LAWS),
    "a key of [fluid]": dict(FLUID.keys),
    "an effect": {effect.name: effect for effect in EFFECTS},
    "a table or key": dict(CASE.keys),
    "a quantity": {**quantities.FIELDS, **quantities.STEP_SCALARS, **quantities.OTHERS},
}


def extend(
    laws: Mapping[str, Law] | None = None,
    density_laws: Mapping[str, Law] | None = None,
    effects: Iterable[type[Effect]] = (),
    shear_laws: Mapping[str, Law] | None = None,
) -> None:
    """Add laws and effects of the user, with their keys and quantities, to this process.

    Raises `CaseError` where a name is that of a built-in one.
    """
    laws, density_laws, shear_laws = dict(laws or {}), dict(density_laws or {}), dict(shear_laws or {})
    effects = list(effects)
    all_laws = [*laws.values(), *density_laws.values(), *shear_laws.values()]
    keys = {name: key for law in all_laws for name, key in law.keys.items()}
    own: dict[str, Mapping[str, object]] = {
        "a viscosity law": laws,
        "a density law": density_laws,
        "a shear law": shear_laws,
        "a key of [fluid]": keys,
        "an effect": {effect.name: effect for effect in effects},
        "a table or key": {effect.table.name: effect.table for effect in effects if effect.table},
        "a quantity": {
            name: field for effect in effects for name, field in quantities.of_effect(effect).items()
        },
    }
    for kind, entries in own.items():
        for name, entry in entries.items():
            if RESERVED[kind].get(name, entry) is not entry:
                raise CaseError([f'"{name}": {kind} of this name is built in; allowed: another name'])
    LAWS.update(laws)
    DENSITY_LAWS.update(density_laws)
    SHEAR_LAWS.update(shear_laws)
    FLUID.keys.update(keys)
    for law in shear_laws.values():  # a case has one of them
        stress, *_ = law.keys
        others = (next(iter(other.keys)) for other in SHEAR_LAWS.values() if other.keys)
        left_out = [f"fluid.{name} left out" for name in others if name != stress]
        FLUID.keys[stress] = replace(law.keys[stress], needs=(*law.keys[stress].needs, *left_out))
    for effect in effects:
        EFFECTS[:] = [*(kind for kind in EFFECTS if kind.name != effect.name), effect]
        quantities.register(effect)
        if effect.table:
            CASE.keys[effect.table.name] = effect.table.key


def key_of(name: object, table: KeyTable | None = CASE) -> Key | None:
    """Key by its dotted name; None: there is none."""
    key = None
    for part in name.split(".") if isinstance(name, str) else ():
        key = table.keys.get(part) if table else None
        table = key.table if key else None
    return key


OWN_NAMES = ("LAWS", "DENSITY_LAWS", "EFFECTS", "SHEAR_LAWS")  # in the order of `extend`

if name := os.environ.get("EHLPETSC_OWN"):  # of commands: module of the user, also in this folder
    sys.path.append(os.getcwd())
    try:
        own = importlib.import_module(name)
        extend(*(getattr(own, name, {}) for name in OWN_NAMES))
    except CaseError:
        raise
    except Exception as error:  # any, of the user's module
        allowed = f"a module in this folder or on Python's path, with {', '.join(OWN_NAMES)}"
        of_last = traceback.extract_tb(error.__traceback__)[-1]
        place = f", {Path(of_last.filename).name}, line {of_last.lineno}"
        reason = error if isinstance(error, ImportError) else f"{type(error).__name__}: {error}{place}"
        raise UsageError(f"EHLPETSC_OWN = {name}: {reason}; allowed: {allowed}") from None
