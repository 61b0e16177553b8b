"""Error messages for a case file: file, key, value, allowed values."""

import json

from ehlpetsc.case.hints import nearest, not_modelled, slip
from ehlpetsc.case.schema.table import Needs, item_type
from ehlpetsc.case.schema.validation import ValidationError
from ehlpetsc.keys import Refused


def allowed(field):
    """Allowed values of a key, e.g. ``a number > 0 and <= 100 [m] (radius of relative curvature)``.

    Parameters
    ----------
    field : pydantic.fields.ModelField
    """
    info = field.field_info
    text = _kind(field)
    if info.extra.get("one_for_both"):
        text = f"{text}, or a list of two of them" if text.startswith("one of") else f"a number or {text}"
    text += _bounds(item_type(field))
    if "unit" in info.extra:
        text += f" [{info.extra['unit']}]"
    return f"{text} ({info.description})" if info.description else text


def _kind(field):
    one_for_both = field.field_info.extra.get("one_for_both")
    several = field.shape != 1
    choices = getattr(item_type(field) if one_for_both else field.type_, "__args__", ())
    if choices and all(isinstance(c, str) for c in choices):
        several = several and not one_for_both
        return ("a list of " if several else "one of ") + ", ".join(f'"{c}"' for c in choices)
    type_ = item_type(field)
    names = {bool: "true or false", int: "a whole number", float: "a number", str: "text"}
    name = next((n for k, n in names.items() if isinstance(type_, type) and issubclass(type_, k)), None)
    if several:
        count = len(field.sub_fields)
        if name is None:
            return "a list"
        plural = {"a number": "numbers", "a whole number": "whole numbers", "text": "texts"}.get(
            name, "values"
        )
        return f"a list of two {plural}" if count == 2 else f"a list of {plural}"
    return name or "a table"


def _bounds(type_):
    signs = (("gt", ">"), ("ge", ">="), ("lt", "<"), ("le", "<="))
    bounds = [(sign, getattr(type_, name, None)) for name, sign in signs]
    return " and".join(f" {sign} {bound:g}" for sign, bound in bounds if bound is not None)


def show(value):
    """Value as in the case file, shortened."""
    try:
        text = json.dumps(value, ensure_ascii=False, default=str)
    except ValueError:  # Python does not print an integer of thousands of digits
        text = "a number of thousands of digits"
    except RecursionError:
        text = "tables in tables without end"
    text = "nan" if text == "NaN" else text
    return shortened(text.encode(errors="backslashreplace").decode())


def shortened(text):
    """Text shortened to 60 characters."""
    return text if len(text) <= 60 else text[:57] + "..."


def describe(error, model, data, where=""):
    """Faults of a table and of all tables in it.

    Parameters
    ----------
    error : pydantic.ValidationError
    model : type
        Model of the table.
    data : dict
        Content of the table.
    where : str
        Dotted name of the table, with a dot at its end, or "".

    Returns
    -------
    list of str
        ``key = value: what is wrong; allowed: ...``
    """
    faults = []
    for wrapper in _flat(error.raw_errors):
        cause = wrapper.exc
        name = getattr(cause, "key", "") or wrapper.loc_tuple()[0]
        field = next((f for f in model.__fields__.values() if name in (f.alias, f.name)), None)
        key = where + shortened(str(name))
        value = data.get(name)
        if name == "__root__":
            faults.append(f"{where.rstrip('.') or 'case'}: {cause}")
        elif isinstance(cause, ValidationError):
            faults += describe(cause, cause.model, value, key + ".")
        elif isinstance(cause, Refused) and str(cause):
            faults.append(f"{key} = {show(value)}: {cause}")
        elif name not in data:
            faults.append(f"{key} is missing; allowed: {allowed(field)}")
        elif field is None or name != field.alias:
            unknown = f"{key} = {show(value)}: unknown key"
            if isinstance(value, dict):
                unknown = f"[{key}]: unknown table"
            hint = not_modelled(where, str(name)) or nearest(shortened(str(name)), model)
            faults.append(f"{unknown}; {hint}")
        elif isinstance(cause, Needs):
            faults.append(f"{key} = {show(value)}: needs {cause}")
        elif isinstance(value, dict) and not (
            isinstance(field.type_, type) and issubclass(field.type_, dict)
        ):
            faults.append(f"{key}: a table here; allowed: {allowed(field)}")
        else:
            faults.append(f"{key} = {show(value)}: allowed: {allowed(field)}{slip(field, value)}")
    return list(dict.fromkeys(faults))


def _flat(errors):
    """Pydantic nests the errors of list items in lists."""
    for error in errors:
        if isinstance(error, (list, tuple)):
            yield from _flat(error)
        else:
            yield error
