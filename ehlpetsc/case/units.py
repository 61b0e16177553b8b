"""Values with a unit, as in ``load = "350 N/mm"``, converted to SI numbers before a case is checked."""

from ehlpetsc.case.schema.table import Table, item_type
from ehlpetsc.case.tables.surface import SYNTHETIC
from ehlpetsc.errors import CaseError
from ehlpetsc.units import UnitFault, converted

TEXT_UNITS = {"half widths", "boundary films"}  # not convertible


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


def _texts_with_unit(data, model, above=()):
    """Texts in place of numbers with a unit: keys, their table, name and unit."""
    for field in model.__fields__.values():
        name, value = field.alias, data.get(field.alias) if isinstance(data, dict) else None
        keys, unit = [*above, name], _unit(field)
        if isinstance(value, dict):
            inner = SYNTHETIC.get(str(value.get("kind"))) if name == "synthetic" else field.type_
            if isinstance(inner, type) and issubclass(inner, Table):
                yield from _texts_with_unit(value, inner, keys)
        elif unit is not None and _has_text(value):
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
    return _unit(field)


def _unit(field):
    """Unit of a key, "" of a pure number; None: not convertible."""
    type_ = item_type(field)
    unit = field.field_info.extra.get("unit", "")
    return unit if isinstance(type_, type) and issubclass(type_, float) and unit not in TEXT_UNITS else None


def _has_text(value, depth=2):
    if isinstance(value, list) and depth:
        return any(_has_text(item, depth - 1) for item in value)
    return isinstance(value, str)
