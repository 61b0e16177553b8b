"""Base class of the tables of a case file: frozen, no unknown keys, the types of TOML."""

import re

from ehlpetsc.case.schema.validation import BaseModel, Extra, validator


class Needs(ValueError):
    """A key requires other keys, which the message names."""


def is_of(kind, value):
    """Whether a value has a type of TOML: an integer is a number, true and false are not."""
    if isinstance(value, bool):
        return kind is bool
    return isinstance(value, (int, float) if kind is float else kind)


def is_plain(text):
    """Whether a text is one line of UTF-8 without control characters, as HDF5 and PETSc need."""
    return text.isprintable() or not re.search(r"[\x00-\x1f\x7f\ud800-\udfff]", text)


class Table(BaseModel):
    """Table of the case file: frozen, no unknown keys, no silent conversions."""

    class Config:
        extra = Extra.forbid
        allow_mutation = False
        allow_population_by_field_name = False

    @validator("*", pre=True)
    def _no_conversion(cls, value, field):
        kind = next((k for k in (bool, int, float, str, dict) if _subclass(item_type(field), k)), None)
        if value is None or kind is None:  # None: key is missing
            return value
        for item in value if isinstance(value, list) and kind is not dict else [value]:
            if not is_of(kind, item):
                raise TypeError(f"{kind.__name__} expected")
            if kind is str and not is_plain(item):
                raise ValueError("control characters, or no UTF-8")
            if kind is float and not -1e308 < item < 1e308:  # nan compares false
                raise ValueError("not finite")
        return value


def _subclass(type_, kind):
    return isinstance(type_, type) and issubclass(type_, (BaseModel, dict) if kind is dict else kind)


def item_type(field):
    """Type of a key, or of the items of a list."""
    return field.sub_fields[0].type_ if field.sub_fields and field.shape != 1 else field.type_
