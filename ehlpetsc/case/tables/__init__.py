"""The table of keys: every key of a case file with unit, bounds, choices, default, needs and meaning.

Bounds are wide enough for any machine element in SI units and narrow enough to detect a value in GPa, mm, um.
"""

from __future__ import annotations

import importlib
import os
import sys
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from ehlpetsc.base import quantities
from ehlpetsc.base.declarations import Key, KeyTable, Refused, Required, Values
from ehlpetsc.base.toml_file import is_plain, toml_text
from ehlpetsc.case.tables.contact import CONTACT, FLUID
from ehlpetsc.case.tables.motion import GEARS, MESH, MOTION, OPERATION, TIME
from ehlpetsc.case.tables.outputs import LIFE, OUTPUT, POST, SERIES
from ehlpetsc.case.tables.surface import SURFACE
from ehlpetsc.effects import EFFECTS
from ehlpetsc.effects.effect import Effect
from ehlpetsc.physics.laws import LAWS, Law

CONDITIONS = (CONTACT, FLUID, MOTION, MESH, SURFACE, TIME, OPERATION, GEARS)
TABLES = (*CONDITIONS, *(effect.table for effect in EFFECTS if effect.table), OUTPUT, POST, LIFE, SERIES)


class Case(Values):
    """Case by tables, `case.fluid.viscosity`; a missing table is None.

    `contact` and `motion` of variable conditions contain the reference state of the scales.
    """

    @property
    def text(self) -> str:
        """TOML text with the overrides, which in the same folder defines the same case."""
        if self._text is None:  # generated when it is needed: members of a long series
            self.__dict__["_text"] = toml_text(self._tables)
        return self._text

    @property
    def path(self) -> Path:
        """Path of the case file, in whose folder profile files are."""
        return self._path

    @property
    def conditions(self) -> Any:
        """Load, radius and speeds over time (`physics.variable_operation`); None: constant."""
        return self._conditions


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


def extend(laws: Mapping[str, Law], effects: Iterable[type[Effect]]) -> None:
    """Add viscosity laws and effects of the user, with their keys and quantities, to this process."""
    LAWS.update(laws)
    for law in laws.values():
        FLUID.keys.update(law.keys)
    for effect in effects:
        EFFECTS[:] = [*(kind for kind in EFFECTS if kind.name != effect.name), effect]
        quantities.register(effect)
        if effect.table:
            CASE.keys[effect.table.name] = effect.table.key


def key_of(name: str) -> Key | None:
    """Key by its dotted name."""
    table: KeyTable | None = CASE
    key = None
    for part in str(name).split("."):
        key = table.keys.get(part) if table else None
        table = key.table if key else None
    return key


if name := os.environ.get("EHLPETSC_OWN"):  # of commands: module of the user, also in this folder
    sys.path.append(os.getcwd())
    own = importlib.import_module(name)
    extend(getattr(own, "LAWS", {}), getattr(own, "EFFECTS", ()))
