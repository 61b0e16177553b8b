"""Values with a unit, as in ``load = "350 N/mm"``, converted to SI numbers before a case is checked.

Allowed for keys with a unit. The package pint converts; it is imported when a case has such a value.
"""

import importlib
import re
from functools import cache

from ehlpetsc.case.schema.table import Table
from ehlpetsc.case.tables.surface import SYNTHETIC
from ehlpetsc.errors import CaseError

VALUE = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*([^\d\s.].*|1\s*/.*)")
TEXT_UNITS = {"half widths": None, "half-widths": None, "boundary films": None, "1": None}  # not convertible
MAX_DIGITS = 15  # of a converted number: 5 um is 5e-6, not 4.9999999999999996e-06


class UnitFault(ValueError):
    """A value with a unit cannot be converted; the message states the reason."""


def in_si(path, data, model):
    """Convert the values with a unit in the tables of a case to SI units.

    Parameters
    ----------
    path : path-like
        Path of the case, for messages.
    data : dict
        Tables; their values are replaced.
    model : type
        Model of the case.

    Returns
    -------
    settings : list of (list of str, value)
        Replaced settings: split keys and numbers.

    Raises
    ------
    CaseError
    """
    settings, faults = [], []
    for keys, table, name, unit in list(_texts_with_unit(data, model)):
        try:
            table[name] = converted(table[name], unit)
            settings.append((keys, table[name]))
        except UnitFault as error:
            faults.append(f"{path}: {'.'.join(keys)} = {error}")
    if faults:
        raise CaseError(faults)
    return settings


def converted(value, unit, depth=2):
    """Number in `unit` of a text with a unit, also in lists; other values do not change.

    Raises
    ------
    UnitFault
    """
    if isinstance(value, list) and depth:
        return [converted(item, unit, depth - 1) for item in value]
    match = VALUE.fullmatch(value) if isinstance(value, str) else None
    if not match:
        return value
    number, unit_text = float(match[1]), re.sub(r"(?<=[a-zA-Zµ])(\d)", r"**\1", match[2])
    registry, errors = _registry()
    wanted = re.sub(r"(?<=[a-zA-Z])(\d)", r"**\1", unit)
    try:
        try:
            quantity = registry.Quantity(number, unit_text)  # units with offset, as degC
        except Exception:
            quantity = number * registry.parse_expression(unit_text)  # 1/GPa
        return float(f"{quantity.to(wanted).magnitude:.{MAX_DIGITS}g}")
    except errors.DimensionalityError:
        raise UnitFault(f'"{value}": not a unit of this key; allowed: one of {unit}') from None
    except Exception:  # pint raises various exceptions on texts that are not units
        raise UnitFault(f'"{value}": unknown unit; allowed: a number in {unit}, or with a unit') from None


@cache
def _registry():
    try:
        pint = importlib.import_module("pint")
    except ImportError:
        raise UnitFault(
            "a value with a unit: needs the package pint (python3-pint of Debian, or pip install pint)"
        ) from None
    return pint.UnitRegistry(cache_folder=None), pint.errors


def _texts_with_unit(data, model, above=()):
    """Texts in place of numbers with a unit: keys, their table, name and unit."""
    for field in model.__fields__.values():
        name, value = field.alias, data.get(field.alias) if isinstance(data, dict) else None
        keys, unit = [*above, name], field.field_info.extra.get("unit")
        if isinstance(value, dict):
            inner = SYNTHETIC.get(str(value.get("kind"))) if name == "synthetic" else field.type_
            if isinstance(inner, type) and issubclass(inner, Table):
                yield from _texts_with_unit(value, inner, keys)
        elif unit and unit not in TEXT_UNITS and _has_text(value):
            yield keys, data, name, unit
    if not above and isinstance(data.get("series"), dict):
        yield from _of_series(data["series"], model)


def _of_series(series, model):
    keys = [series["key"]] if "key" in series else series.get("keys")
    values = series.get("values")
    for number, key in enumerate(keys if isinstance(keys, list) else ()):
        unit = _unit_of(key, model)
        if unit is None or not isinstance(values, list) or number >= len(values):
            continue
        if "key" in series and _has_text(values):
            yield ["series", "values"], series, "values", unit
        elif "keys" in series and _has_text(values[number]):
            yield ["series", "values", str(number)], values, number, unit


def _unit_of(key, model):
    field = None
    for name in str(key).split("."):
        field = next((f for f in getattr(model, "__fields__", {}).values() if f.alias == name), None)
        if field is None:
            return None
        model = field.type_
    unit = field.field_info.extra.get("unit")
    return None if unit in TEXT_UNITS else unit


def _has_text(value, depth=2):
    if isinstance(value, list) and depth:
        return any(_has_text(item, depth - 1) for item in value)
    return isinstance(value, str)
