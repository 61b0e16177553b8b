"""Declaration of the keys of a case file and of stored quantities: laws and effects declare their own.

A table is a :class:`KeyTable` of :class:`Key`; :mod:`ehlpetsc.case` reads, checks and explains case files by
these alone and passes on :class:`Values`. For example an effect with one key::

    COATING = KeyTable(
        "coating",
        "left out: none",
        {"thickness": Required("of both surfaces", "m", 1e-9, 1e-4)},
        needs=("[time]",),
    )
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from functools import partial
from types import SimpleNamespace
from typing import Any, NamedTuple


class Refused(ValueError):
    """Values of a table contradict each other; `key` names the one at fault, "" the whole table."""

    def __init__(self, reason: str = "", key: str = "") -> None:
        super().__init__(reason)
        self.key = key


@dataclass(frozen=True)
class Key:
    """A key of a case file; bounds and choices are those of each item of a list.

    Attributes
    ----------
    text
        Meaning, for the page of keys and for messages; symbols and equations in backticks.
    unit
        SI unit of the stored value; "": a pure number.
    point_unit
        Unit in a point contact, where it is another one.
    is_difference
        Whether a value in K is a difference of temperatures: 17 degC is then 17 K.
    kind
        float, int, bool or str; dict: a table with any keys; object: anything. With choices always str.
    default
        Value where the key is left out; None: it is stored as None.
    required
        Whether the key must be given.
    replaced_by
        Keys of the table, or tables (``"[gears]"``), that provide the value of a required key.
    many
        "": one value; "both": one for both surfaces or a list of one for each, stored as a pair (of a table:
        that of body 1, or a list of two, {} for none); "two": a list of two; "axes": one, or a list of two,
        along and across; "list"; "list or matrix", of rows.
    min_items, max_items
        Length of a list, or of a text.
    needs
        What must hold where the key is given: ``"contact.asperity_height"`` (given), ``"[time]"`` (given),
        ``'contact.model = "mixed"'``, ``"heat.roelands_s0 left out"``.
    below
        Key of the same table below which the value must be.
    words
        Texts in place of a value that follows from other tables; of a bool: further values.
    equation
        In which the key appears, where it is too long for messages.
    contacts
        Kinds of contact that have the key; (): all.
    departs
        Assumption of :mod:`ehlpetsc.case.assumptions` that does not hold where the key has another value than
        its default; "": none.
    assumes
        Assumptions without which the key is refused.
    table, variants
        Keys of the table that is the value, or of the tables by the value of their key `kind`.
    """

    text: str
    unit: str = ""
    ge: float | None = None
    le: float | None = None
    gt: float | None = None
    lt: float | None = None
    kind: type = float
    default: Any = None
    required: bool = False
    replaced_by: tuple[str, ...] = ()
    choices: Collection[str] = ()
    many: str = ""
    min_items: int = 1
    max_items: int | None = None
    needs: tuple[str, ...] = ()
    below: str = ""
    words: Collection[str] = ()
    equation: str = ""
    is_difference: bool = False
    point_unit: str = ""
    contacts: Collection[str] = ()
    departs: str = ""
    assumes: tuple[str, ...] = ()
    table: KeyTable | None = None
    variants: Mapping[str, KeyTable] | None = None

    def __post_init__(self) -> None:
        if self.choices:
            object.__setattr__(self, "kind", str)


def without_backticks(text: str) -> str:
    """Text for a terminal, without the backticks of equations."""
    return text.replace("`", "")


Required = partial(Key, required=True)


class Values(SimpleNamespace):
    """Checked values of a table as attributes (`lambda_` for the key `lambda`); a missing table is None."""

    def __init__(self, values: Mapping[str, object] | None = None) -> None:  # None: to be copied
        super().__init__(**(values or {}))

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"{name}: the values of a case do not change")

    def __eq__(self, other: object) -> bool:
        return isinstance(other, type(self)) and other.as_dict() == self.as_dict()

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.as_dict()})"

    def as_dict(self) -> dict[str, Any]:
        """Values by key, tables in it as dicts."""
        public = {key: value for key, value in vars(self).items() if key[0] != "_"}
        return {key: value.as_dict() if isinstance(value, Values) else value for key, value in public.items()}

    def copy(self, update: Mapping[str, object]) -> Any:
        """The same table with other values of some keys."""
        return type(self)(self.__dict__ | dict(update))


@dataclass(frozen=True)
class KeyTable:
    """A table of a case file.

    Attributes
    ----------
    name
        Name in the file, with dots: ``"fluid.grade"``.
    text
        Meaning, or what holds where the table is left out.
    keys
        By name; tables within are keys too.
    required
        Whether the table must be given.
    always
        Whether a missing table counts as an empty one, and not as None.
    needs
        As of `Key`.
    values
        Type of the checked values: :class:`Values` with further properties.
    complete
        Further values by key that follow from the checked ones; raises :class:`Refused`.
    """

    name: str
    text: str
    keys: dict[str, Key]
    required: bool = False
    always: bool = False
    needs: tuple[str, ...] = ()
    values: type[Values] = Values
    complete: Callable[[Any], Mapping[str, Any]] | None = field(default=None)

    @property
    def key(self) -> Key:
        """Key of this table in the one above."""
        return Key(self.text, kind=dict, required=self.required, table=self)


@dataclass(frozen=True)
class Field:
    """Metadata of a dataset.

    Attributes
    ----------
    units : str
        SI unit, "1" for a number.
    long_name : str
        Name for axes and headings.
    dims : tuple of str
        Names of the dimension scales, each in the group of the dataset or in one above it; "nodes": the axes
        of the grid.
    dtype : str
        Type on disk; fields may be stored as float32 on request.
    only : str
        Cases with the quantity, a key of `SCENES`; "": all.
    integrated : bool
        Whether it is an integral over the contact: per metre of width where that has no ends.
    of : function, optional
        Its value of an `ehlpetsc.stepping.observables.Observation`; None: an effect returns it from
        `observe`, or the simulation.
    """

    units: str
    long_name: str
    dims: tuple = ("time", "nodes")
    dtype: str = "f8"
    only: str = ""
    integrated: bool = False
    of: Callable[[Any], Any] | None = None


class Column(NamedTuple):
    """Column of progress: heading, factor from SI units, format."""

    heading: str
    factor: float
    form: str


@dataclass(frozen=True)
class StepScalar(Field):
    """Scalar of every time step.

    Attributes
    ----------
    over_run, over_series : str
        Reduction to one value, a key of `REDUCTIONS`, "": none; `over_series` by default as `over_run`.
    summary : str
        Format in the last line of a run; "": not printed.
    label : str
        Name in this line; default: name of the scalar.
    progress : Column, optional
        Column in the lines of progress.
    compared : bool
        Whether it is compared between runs, unlike scalars of the solution process.
    """

    dims: tuple = ("time",)
    over_run: str = ""
    over_series: str = ""
    summary: str = ""
    label: str = ""
    progress: Column | None = None
    compared: bool = False
