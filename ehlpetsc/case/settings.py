"""Overrides of the keys of a case, by -ehl_set and by series, in its tables and its text."""

import tomllib

import tomlkit

from ehlpetsc.case.toml_text import plain, toml_text
from ehlpetsc.names import stored_name
from ehlpetsc.toml_file import MAX_PARTS


def parsed(override):
    """("a.b=value") or ("a.b", value) -> (["a", "b"], value).

    Raises
    ------
    ValueError
        It is no setting of a key.
    """
    if isinstance(override, tuple) and len(override) == 2 and isinstance(override[0], str):
        return override[0].split("."), plain(override[1])
    if not isinstance(override, str):
        raise ValueError(override)
    name, equals, raw = override.partition("=")
    keys = name.strip().split(".")
    if not equals or not all(keys) or len(keys) > MAX_PARTS:
        raise ValueError(override)
    try:
        found = tomllib.loads(f"value = {raw}")
    except (ValueError, RecursionError):
        found = {}
    return keys, found["value"] if list(found) == ["value"] else raw


def put(tables, keys, value):
    """Set a key in nested tables; None takes it out.

    Raises
    ------
    ValueError
        The parent of the key is no table.
    """
    keys = _as_spelled(tables, keys)
    for key in keys[:-1]:
        tables = tables.setdefault(key, {})
        if not isinstance(tables, dict):
            raise ValueError(key)
    if value is None:
        tables.pop(keys[-1], None)
    else:
        tables[keys[-1]] = value


def _as_spelled(tables, keys):
    """Key of a surface under its name in the tables, the current or the former one."""
    surfaces = tables.get("surface") if len(keys) > 1 and keys[0] == "surface" else None
    if not isinstance(surfaces, dict):
        return keys
    return ["surface", stored_name(surfaces, keys[1]), *keys[2:]]


def text_with(text, settings, data, without=None):
    """The TOML text with keys set and a table left out, comments kept where that can be.

    Parameters
    ----------
    text : str
    settings : list of (list of str, value)
    data : dict
        The tables as they are to be: what the text must say in the end.
    without : str, optional
        Table to be left out.
    """
    if not settings and without is None:
        return text
    try:
        document = tomlkit.parse(text)
        for keys, value in settings:
            put(document, keys, value)
        if without:
            document.remove(without)
        edited = tomlkit.dumps(document)
        if tomllib.loads(edited) == data:
            return edited
    except Exception:  # dotted tables, tables out of order: tomlkit edits some of them wrong, each in its way
        pass
    return toml_text(data)
