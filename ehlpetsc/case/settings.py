"""Overrides of keys of a case, by --set and by series, in its tables and its text."""

import tomllib

import tomlkit

from ehlpetsc.case.toml_text import plain, toml_text
from ehlpetsc.names import stored_name
from ehlpetsc.toml_file import MAX_KEY_PARTS


def parsed(override):
    """("a.b=value") or ("a.b", value) -> (["a", "b"], value).

    Raises
    ------
    ValueError
        The text is not a setting of a key.
    """
    if isinstance(override, tuple) and len(override) == 2 and isinstance(override[0], str):
        return override[0].split("."), plain(override[1])
    if not isinstance(override, str):
        raise ValueError(override)
    name, equals, raw = override.partition("=")
    keys = name.strip().split(".")
    if not equals or not all(keys) or len(keys) > MAX_KEY_PARTS:
        raise ValueError(override)
    try:
        table = tomllib.loads(f"value = {raw}")
    except (ValueError, RecursionError):
        table = {}
    return keys, table["value"] if list(table) == ["value"] else raw


def put(tables, keys, value):
    """Set a key in nested tables; None removes it.

    Raises
    ------
    ValueError
        The parent of the key is not a table.
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
    """Key of a surface with the name used in the tables, current or former."""
    surfaces = tables.get("surface") if len(keys) > 1 and keys[0] == "surface" else None
    if not isinstance(surfaces, dict):
        return keys
    return ["surface", stored_name(surfaces, keys[1]), *keys[2:]]


def text_with(text, settings, data, without=None):
    """TOML text with keys set and a table removed, with comments if possible.

    Parameters
    ----------
    text : str
    settings : list of (list of str, value)
    data : dict
        Tables to which the new text must be equal.
    without : str, optional
        Table to remove.
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
    except Exception:  # tomlkit fails on some dotted tables and tables out of order
        pass
    return toml_text(data)
