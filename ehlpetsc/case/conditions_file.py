"""CSV tables of conditions over time, read by the names of the columns."""

from __future__ import annotations

from pathlib import Path

from ehlpetsc.case.tables.motion import COLUMNS, OPERATION
from ehlpetsc.units import UnitFault, factor

SI = {key: OPERATION.keys[key].unit for key in COLUMNS}
MAX_TABLE_BYTES = 2**26


class TableFault(Exception):
    """A table of conditions cannot be used; the message names the reason and the line."""


def read_table(path: Path) -> tuple[dict[str, list[float]], list[int]]:
    """Columns of a CSV file in SI units, by key of `COLUMNS`, and the line number of each row.

    Raises `TableFault`.
    """
    rows = [(k, line.partition("#")[0].strip()) for k, line in enumerate(_text(path).splitlines(), 1)]
    rows = [(k, line) for k, line in rows if line]
    if not rows:
        raise TableFault("no lines; allowed: a line of column names and one line a time")
    separator = next((sign for sign in ";,\t" if sign in rows[0][1]), None)
    head, keys, factors = rows[0], None, {}
    if not _numbers(head[1], separator):
        factors, rows = _factors(*head, separator), rows[1:]
        keys = list(factors)
    columns, lines = [], []
    for number, line in rows:
        values = _numbers(line, separator)
        if keys is None and len(values) == len(COLUMNS):
            keys = list(COLUMNS)
        if keys is None:
            names = ", ".join(names[0] for names in COLUMNS.values())
            raise TableFault(f"line {number}: no column names; allowed: a first line with some of {names}")
        if len(values) != len(keys):
            raise TableFault(f"line {number}: {shown(line)}: allowed: {len(keys)} numbers")
        columns.append(values)
        lines.append(number)
    return {
        key: [row[k] * factors.get(key, 1.0) for row in columns] for k, key in enumerate(keys or ())
    }, lines


def shown(line: str) -> str:
    """Line of a file, shortened for messages."""
    return line if len(line) <= 40 else line[:37] + "..."


def _text(path: Path) -> str:
    try:
        if path.stat().st_size > MAX_TABLE_BYTES:
            raise TableFault(f"larger than {MAX_TABLE_BYTES >> 20} MB; allowed: a table of conditions")
        return path.read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise TableFault(f"not UTF-8 text (byte {error.start}); allowed: a CSV table") from None
    except FileNotFoundError:
        raise TableFault(f"no such file: {path}") from None
    except (OSError, ValueError) as error:
        raise TableFault(f"cannot be read: {getattr(error, 'strerror', None) or error}") from None


def _numbers(line: str, separator: str | None) -> list[float]:
    """Numbers of a line; empty if an entry is not a number."""
    words = [word.strip() for word in line.split(separator)]
    if separator == ";":
        words = [word.replace(",", ".") for word in words]
    try:
        return [float(word) for word in words]
    except ValueError:
        return []


def _factors(number: int, line: str, separator: str | None) -> dict[str, float]:
    """Factor to SI units of each column named in a line, by key; units are in brackets: ``time [us]``."""
    key_by_name = {name: key for key, names in COLUMNS.items() for name in names}
    factors = {}
    for word in line.split(separator):
        name, _, unit = word.strip(" \"'").replace("(", "[").partition("[")
        unit = unit.rstrip(")] ")
        key = key_by_name.get(" ".join(name.lower().replace("_", " ").split()))
        if key is None:
            allowed = ", ".join(names[0] for names in COLUMNS.values())
            raise TableFault(f"line {number}: column {shown(name.strip())!r}: allowed: {allowed}")
        if key in factors:
            raise TableFault(f"line {number}: a column twice")
        try:
            factors[key] = factor(unit or SI[key], SI[key])
        except UnitFault as fault:
            raise TableFault(f"line {number}: column {shown(word.strip())!r}: {fault}") from None
    return factors
