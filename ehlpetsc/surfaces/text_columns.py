"""Columns of numbers in text files of measuring instruments, read by numpy.

Separator and decimal sign are detected; ambiguous files are refused with the key that resolves the ambiguity.
"""

from __future__ import annotations

import codecs
import io
import re
from pathlib import Path

import numpy as np

from ehlpetsc.base.errors import ProfileError

DATA = re.compile(  # a line of numbers, some of which may be missing
    r"(?=.*\d)[\s,;]*(([+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?|-?nan(\(ind\))?|n/?a|bad|\*+|-+)([\s,;]+|$))+(#.*)?",
    re.IGNORECASE,
)
UNIT_IN_HEADER = re.compile(r"[\[(/]\s*(mm|um|µm|μm|nm|m)\s*(?:[\])]|$)", re.MULTILINE)


def text_columns(
    path: Path, decimal: str | None = None, header_lines: int | None = None
) -> tuple[np.ndarray, str]:
    """Numbers of a text file, shape (columns, rows), nan for missing ones, and the lines above them.

    `decimal`: "." or ","; default: detected.
    `header_lines`: lines before the numbers; default: all lines before the first line of numbers.
    """
    text, begin, above = _decoded(path), 0, 0
    while begin < len(text):
        end = text.find("\n", begin) + 1 or len(text)
        if DATA.fullmatch(text[begin:end].strip()) if header_lines is None else above == header_lines:
            break
        begin, above = end, above + 1
    header, body = text[:begin], re.sub("#.*", "", text[begin:])
    body, separator = _with_points(body, decimal)
    columns = np.empty((0, 0))
    if re.search(r"\d", body):
        try:
            columns = np.loadtxt(io.StringIO(body), delimiter=separator, ndmin=2).T
        except ValueError:
            columns = _with_missing(body, separator, above).T
        columns = columns[~np.isnan(columns).all(axis=1)]
    if not columns.size:
        raise ProfileError("0 points; allowed: lines of numbers, x and z")
    return columns, header


def units_in(header: str) -> list[str]:
    """Units of length in brackets, or after a slash, in a header, in their order."""
    return [unit.replace("µ", "u").replace("μ", "u") for unit in UNIT_IN_HEADER.findall(header)]


def _decoded(path: Path) -> str:
    raw = path.read_bytes()
    if raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        text = raw.decode("utf-16", "replace")
    elif b"\0" in raw:
        raise ProfileError("not text; allowed: columns of numbers, x and z")
    else:
        try:
            text = raw.decode("utf-8-sig")
        except UnicodeDecodeError:  # instruments write µ and degrees in a national code page
            text = raw.decode("latin-1")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _with_points(text: str, decimal: str | None) -> tuple[str, str | None]:
    """Numbers with decimal points, and their separator; None: blanks."""
    separator = next((sign for sign in ";\t" if sign in text), None)
    if separator is None and "," in text and decimal != ",":
        in_numbers = re.search(r"\S +\S", text) and not re.search(r"(?<!\d),|,(?!\d)", text)
        if decimal or not in_numbers:
            return text, ","
    if decimal is None and "," in text and "." in text:
        raise ProfileError('its numbers contain both "," and "."; write decimal = "," or decimal = "."')
    return text.replace({",": ".", ".": ","}.get(decimal or "", ""), "").replace(",", "."), separator


def _with_missing(text: str, separator: str | None, above: int) -> np.ndarray:
    """Numbers of lines read one by one; nan for words."""
    lines = enumerate(text.split("\n"), above + 1)
    rows = {n: line.strip() for n, line in lines if line.strip(",; \t")}
    *_, width = (len(row.split(separator)) for row in rows.values())
    for n, row in rows.items():
        if len(words := row.split(separator)) != width:
            raise ProfileError(
                f"line {n}: {len(words)} numbers, the last line has {width}; allowed: as many in every line, "
                f"numbers alone below the header, or header_lines = {n} if that one belongs to it"
            )
    return np.genfromtxt(rows.values(), delimiter=separator, comments=None, ndmin=2)
