"""Numbers in text files: columns of measuring instruments.

Separator and decimal sign are detected; ambiguous files are refused with the key that resolves the ambiguity.
"""

from __future__ import annotations

import codecs
import csv
import io
import re
import unicodedata
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ehlpetsc.base.errors import ProfileError

NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[ed][+-]?\d+)?"
INFINITE = r"[+-]?inf(?:inity)?"  # a number that no height may be
MISSING = r"(?:-?nan(?:\(ind\))?|-?1\.#\w+|#?n/?a|bad|\*+|-+)"  # markers, besides empty cells
MOSTLY = 0.7  # numbers in the cells of a line that is not a heading
SCANNED = (2, 3)  # columns of x and z, and of x, y and z, in which empty lines part the scans
CELL = re.compile(f"(?:({NUMBER}|{INFINITE})|({MISSING})?)", re.IGNORECASE)
WITH_UNIT = re.compile(rf"(?>{NUMBER})\s*[^\W\d_/:.-]", re.IGNORECASE)  # as 0.12 um, unlike a date or a name
COMMENT = re.compile(r"(?:^|(?<=[\s,;|]))#(?!n/?a).*", re.IGNORECASE | re.MULTILINE)
SIGNS = str.maketrans({"\u2212": "-", "\u2013": "-"})  # minus and dash of word processors
UNITS = {"m": 1.0, "mm": 1e-3, "um": 1e-6, "nm": 1e-9, "angstrom": 1e-10}  # m
UNITS |= {"inch": 0.0254, "microinch": 0.0254e-6, "mil": 0.0254e-3}
UNIT_NAMES = {
    "m": ("m",),
    "mm": ("mm",),
    "um": ("um", "\u00b5m", "\u03bcm", "micron", "microns", "micrometer", "micrometre"),
    "nm": ("nm",),
    "angstrom": ("\u00c5", "ang", "angstrom", "angstroms", "\u00e5ngstr\u00f6m"),
    "inch": ("in", "in.", "inch", "inches"),
    "microinch": ("uin", "\u00b5in", "\u03bcin", "microin", "microinch", "microinches"),
    "mil": ("mil", "mils", "thou"),
}
UNIT_OF_NAME = {name.lower(): unit for unit, names in UNIT_NAMES.items() for name in names}
UNIT_IN_HEADER = re.compile(
    rf"[\[(/]\s*({'|'.join(map(re.escape, UNIT_OF_NAME))})\s*(?:[\])]|[\s;,|\"]|$)",
    re.MULTILINE | re.IGNORECASE,
)


@dataclass(frozen=True)
class Layout:
    """Layout of the file of a profile or map; missing entries are detected from the file.

    `unit`, `x_unit`: units of the heights and of x, keys of `UNITS`; default: m, x as the heights.
    `spacing`, `spacing_across`: distance of the points [m] of files without x, of the columns and of the rows
        of a matrix; the second by default as the first.
    `columns`: columns of x and z, or of z alone, from 1.
    `decimal`: "." or ",".
    `header_lines`: lines before the numbers.
    `fill_gaps`: widest gap of missing heights that is filled [m].
    `bridge_spikes`: whether the spline bridges the spikes of optical instruments.
    `mask`: file of a matrix, beside that of a map, which is not 0 where heights are missing.
    """

    unit: str | None = None
    x_unit: str | None = None
    spacing: float | None = None
    spacing_across: float | None = None
    columns: tuple | None = None
    decimal: str | None = None
    header_lines: int | None = None
    fill_gaps: float | None = None
    bridge_spikes: bool = False
    mask: str | None = None


def text_columns(
    path: Path, decimal: str | None = None, header_lines: int | None = None
) -> tuple[np.ndarray, str]:
    """Numbers of a text file, shape (columns, rows), and the lines above them.

    nan for missing numbers: empty cells and the markers `MISSING`. A column of words is nan throughout. Any
    other word is refused with its line.

    `decimal`: "." or ","; default: detected.
    `header_lines`: lines before the numbers; default: all lines before the first line of numbers.
    """
    lines = _decoded(path).translate(SIGNS).split("\n")
    above = _first_line(lines) if header_lines is None else min(header_lines, len(lines))
    header, body = "\n".join(lines[:above]), COMMENT.sub("", "\n".join(lines[above:]))
    body, separator = _with_points(_unquoted(body), decimal)
    columns, second = np.empty((0, 0)), _second_block(body, above)
    if re.search(r"\d", body):
        try:
            columns = np.loadtxt(io.StringIO(body), delimiter=separator, comments=None, ndmin=2).T
        except ValueError:
            try:
                columns = _cell_by_cell(body, separator, above).T
            except ProfileError:
                if second:
                    raise ProfileError(second) from None
                raise
        while len(columns) and np.isnan(columns[-1]).all():  # behind separators at the ends of the lines
            columns = columns[:-1]
    if second and len(columns) not in SCANNED:
        raise ProfileError(second)
    if not columns.size:
        raise ProfileError("0 points; allowed: lines of numbers, x and z")
    if header_lines is None and above:
        _check_last_heading(lines[above - 1], above, separator, len(columns))
    return columns, header


def units_in(header: str) -> list[str]:
    """Units of length in brackets, after a slash, or alone in the last line of a header, in their order."""
    header = unicodedata.normalize("NFC", header)  # an A and a ring above to one letter
    last = [word.strip("\"'").lower() for word in re.split(r"[\s,;|]+", header.rstrip().rpartition("\n")[2])]
    names = last if UNIT_OF_NAME.keys() >= set(last) else UNIT_IN_HEADER.findall(header)
    return [UNIT_OF_NAME[name.lower()] for name in names]


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


def _first_line(lines: list[str]) -> int:
    """Index of the first line of numbers; with a column of words, of the first line like the last one."""
    numbers = (k for k, line in enumerate(lines) if "1" in (kinds := _kinds(line)) and "w" not in kinds)
    first = next(numbers, None)
    if first is None:
        last = next(filter(None, map(_kinds, reversed(lines))), "")
        first = next((k for k, line in enumerate(lines) if "1" in last == _kinds(line)), len(lines))
    return first


def _kinds(line: str) -> str:
    """Kinds of the words in a line: 1 for a number, 0 for a marker of a missing one, w for another word."""
    words = re.split(r"[\s,;|]+", COMMENT.sub("", line).strip(" \t,;|"))
    found = [CELL.fullmatch(word.strip("\"'")) for word in words if word]
    return "".join("w" if match is None else "1" if match[1] else "0" for match in found)


def _unquoted(text: str) -> str:
    """Text with quoted cells as bare ones, then separated by tabs, as a comma in quotes is decimal."""
    if '"' not in text:
        return text
    outside = re.sub(r'"[^"\n]*"', "", text)
    separator = next((sign for sign in ";\t|," if sign in outside), " ")
    return "\n".join("\t".join(row) for row in csv.reader(text.split("\n"), delimiter=separator))


def _with_points(text: str, decimal: str | None) -> tuple[str, str | None]:
    """Numbers with decimal points, and their separator; None: blanks."""
    separator = next((sign for sign in ";\t|" if sign in text), None)
    if separator is None and "," in text and decimal != ",":
        in_numbers = re.search(r"\d +[-+.]?\d", text) and not re.search(r"(?<!\d),|,(?!\d)", text)
        if decimal or not in_numbers:
            return text, ","
    if decimal is None and re.search(r"\d,\d", text) and re.search(r"\d\.|\.\d", text):
        raise ProfileError('its numbers contain both "," and "."; write decimal = "," or decimal = "."')
    return text.replace({",": ".", ".": ","}.get(decimal or "", ""), "").replace(",", "."), separator


def _second_block(body: str, above: int) -> str:
    """Message on lines behind an empty line among the numbers; "": none, or as many behind every line.

    `above`: lines before the body.
    """
    filled = [n for n, line in enumerate(body.split("\n"), above + 1) if line.strip(",;| \t")]
    steps = [after - n for n, after in zip(filled[:-1], filled[1:], strict=True)]
    if not steps or min(steps) == max(steps):
        return ""
    n = next(after for after, step in zip(filled[1:], steps, strict=True) if step > min(steps))
    return (
        f"line {n}: a second block behind an empty line; allowed: one block of numbers; delete the others, "
        f"or write header_lines = {n - 1} if those above are no heights"
    )


def _cell_by_cell(text: str, separator: str | None, above: int) -> np.ndarray:
    """Numbers of lines read one by one; nan for missing ones and for columns of words."""
    lines = enumerate(text.split("\n"), above + 1)
    rows = {n: line.rstrip().lstrip(" ").split(separator) for n, line in lines if line.strip(",;| \t")}
    *_, width = map(len, rows.values())
    for n, row in rows.items():
        if len(row) != width:
            raise ProfileError(
                f"line {n}: {len(row)} numbers, the last line has {width}; allowed: as many in every line, "
                f"numbers alone below the header, or header_lines = {n} if that one belongs to it"
            )
    columns = zip(*rows.values(), strict=True)
    return np.array([_column([cell.strip(" '") for cell in cells], list(rows)) for cells in columns]).T


def _column(cells: list[str], lines: list[int]) -> list[float]:
    """Numbers of the cells of one column, in lines with these numbers."""
    found = [CELL.fullmatch(cell) for cell in cells]
    are_words = not any(match and match[1] for match in found)
    for cell, match, line in zip(cells, found, lines, strict=True):
        if match is None and (not are_words or WITH_UNIT.match(cell)):
            raise ProfileError(_no_number(cell, line))
    numbers = (match[1] if match else None for match in found)
    return [float(re.sub("[dD]", "e", number)) if number else np.nan for number in numbers]


def _check_last_heading(line: str, number: int, separator: str | None, width: int) -> None:
    """Refuse a line above the numbers that is one of them with a word in a cell behind numbers."""
    cells = [cell.strip(" \"'") for cell in line.strip().split(separator)]
    numbers = [bool(re.fullmatch(NUMBER, cell, re.IGNORECASE)) for cell in cells]
    if not len(cells) == width > 1 or not any(numbers):
        return
    word = next((cell for cell in cells if separator and WITH_UNIT.match(cell)), None)
    if word is None and numbers[0] and sum(numbers) > MOSTLY * width:
        word = next((cell for cell in cells if not CELL.fullmatch(cell)), None)
    if word:
        raise ProfileError(f"{_no_number(word, number)}, or header_lines = {number}")


def _no_number(cell: str, line: int) -> str:
    return (
        f'line {line}: "{cell[:40]}" is not a number; allowed in a cell: a number without its unit, nothing, '
        "nan, N/A, BAD, --- or ***"
    )
