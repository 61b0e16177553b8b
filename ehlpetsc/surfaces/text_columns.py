"""Columns of numbers in text files of measuring instruments.

Separator and decimal sign are detected from lines with numbers only; ambiguous files are refused with the key
that resolves the ambiguity. Blocks of lines with numbers only are read by numpy, others line by line.
"""

from __future__ import annotations

import codecs
import io
import itertools
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ehlpetsc.base.errors import ProfileError

MISSING = {"", "nan", "-nan", "nan(ind)", "-nan(ind)", "na", "n/a", "bad", "*", "***", "-", "--", "---"}
NUMBERS_ONLY = re.compile(r"[\d\s.,;eE+-]+")
BLOCK_OF_NUMBERS = re.compile(r"[0-9 \t\n.,;eE+-]+")
SEPARATORS_ONLY = re.compile(r"^[ ,;\t]*[,;\t][ ,;\t]*$", re.MULTILINE)
OUTER_TAB = re.compile(r"^ *\t|\t *$", re.MULTILINE)  # separates nothing
DECIMAL_COMMA = re.compile(r"(?<=\d),(?=\d)")
UNIT_IN_HEADER = re.compile(r"[\[(/]\s*(mm|um|µm|μm|nm|m)\s*(?:[\])]|$)", re.MULTILINE)
OTHER_LINE_END = re.compile("[\v\f\x1c-\x1e\x85\u2028\u2029]")
CHARACTERS_PER_BLOCK = 1 << 20


def text_columns(
    path: Path, decimal: str | None = None, header_lines: int | None = None
) -> tuple[np.ndarray, str]:
    """Numbers of a text file, one row for each line.

    Parameters
    ----------
    decimal
        "." or ","; default: detected.
    header_lines
        Lines before the numbers; default: all lines before the first line of numbers.

    Returns
    -------
    columns
        nan for a missing number, shape (n columns, n rows).
    header
        Lines before the numbers, comments included.

    Raises
    ------
    ProfileError
    """
    text = _decoded(path)
    begin = _line_begin(text, header_lines or 0)
    header = text[:begin].splitlines()
    header += [line for line in header if line.lstrip().startswith("#")]
    words = _Words.of(text, begin, decimal)
    rows, comments, above = [], [], []
    for number, block in _blocks(text, begin):
        table = words.table(block)
        if table is not None:
            blank = block[: len(block) - len(block.lstrip())]
            rows.append((number + blank.count("\n"), table))
            continue
        comments += [line for line in block.splitlines() if line.lstrip().startswith("#")]
        read = []
        for n, line in _lines(block, number):
            row = _numbers(words.split(line))
            if row is not None:
                read.append((n, row))
            elif rows or read or header_lines is not None:
                raise ProfileError(
                    f"line {n}: {line[:40]!r}; allowed: numbers alone below the header, x and z; "
                    "header_lines = the number of lines above them"
                )
            else:
                above.append(line)
        for _, group in itertools.groupby(read, lambda row: len(row[1])):
            alike = list(group)
            rows.append((alike[0][0], np.array([row for _, row in alike])))
    return _columns(rows), "\n".join([*header, *comments, *above])


def units_in(header: str) -> list[str]:
    """Units of length in brackets, or after a slash, in a header, in their order."""
    return [unit.replace("µ", "u").replace("μ", "u") for unit in UNIT_IN_HEADER.findall(header)]


def _decoded(path: Path) -> str:
    raw = path.read_bytes()
    if raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return _with_newlines(raw.decode("utf-16", "replace"))
    if b"\0" in raw:
        raise ProfileError("not text; allowed: columns of numbers, x and z")
    raw = raw.removeprefix(codecs.BOM_UTF8)  # also if the rest is not UTF-8
    try:
        text = raw.decode().replace("\ufeff", "")  # concatenated files have several
    except UnicodeDecodeError:  # instruments write µ and degrees in a national code page
        text = raw.decode("latin-1")
    return _with_newlines(text)


def _with_newlines(text: str) -> str:
    """Text with newlines in place of other line ends."""
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    return "\n".join(text.splitlines()) if OTHER_LINE_END.search(text) else text


def _line_begin(text: str, count: int) -> int:
    """Index of the beginning of the line after the first `count` lines."""
    begin = 0
    for _ in range(count):
        begin = text.find("\n", begin) + 1 or len(text)
    return begin


def _blocks(text: str, begin: int) -> Iterator[tuple[int, str]]:
    """Blocks of complete lines of about `CHARACTERS_PER_BLOCK`, with their first line numbers."""
    number = text.count("\n", 0, begin) + 1
    while begin < len(text):
        end = text.find("\n", begin + CHARACTERS_PER_BLOCK) + 1 or len(text)
        block = text[begin:end]
        yield number, block
        number, begin = number + block.count("\n"), end


def _lines(block: str, number: int) -> Iterator[tuple[int, str]]:
    """Lines with their numbers, without comments, blank lines and lines of separators only."""
    for n, line in enumerate(block.split("\n"), number):
        line = line.partition("#")[0].strip()
        if line.strip(" ,;\t"):
            yield n, line


def _holds_numbers_alone(block: str) -> bool:
    if not BLOCK_OF_NUMBERS.fullmatch(block) or "\t" in block and OUTER_TAB.search(block):
        return False
    separated = any(sign in f"\n{block}" for sign in ("\n;", "\n,", "\n "))
    return not (separated and SEPARATORS_ONLY.search(block))


def _numbers_alone(text: str, begin: int) -> Iterator[str]:
    """Numbers of many lines at once, if they contain nothing else."""
    for _, block in _blocks(text, begin):
        if _holds_numbers_alone(block):
            yield block
        else:
            yield "\n".join(line for _, line in _lines(block, 1) if NUMBERS_ONLY.fullmatch(line))


def _between_digits(text: str, begin: int) -> bool:
    """Whether every comma is between two digits."""
    blocks = (block for block in _numbers_alone(text, begin) if "," in block)
    return all(block.count(",") == len(DECIMAL_COMMA.findall(block)) for block in blocks)


@dataclass(frozen=True)
class _Words:
    """Separator and decimal sign of a file.

    Attributes
    ----------
    delimiter
        Separator for numpy; None: blanks.
    removed, comma
        Separator of thousands; decimal sign.
    """

    separator: re.Pattern
    delimiter: str | None
    removed: str = ""
    comma: str = "."

    @classmethod
    def of(cls, text: str, begin: int, decimal: str | None) -> _Words:
        """Notation of a file, from its lines with numbers only."""
        seen, blank = set(), False
        for block in _numbers_alone(text, begin):
            seen |= {sign for sign in ",;\t." if sign in block}
            blank = blank or " " in block and bool(re.search(r"\S[^\S\n]+\S", block))
        if ";" in seen:
            separator, delimiter = r"\s*;\s*", ";"
        elif "\t" in seen:
            separator, delimiter = r"[ ]*\t[ ]*", "\t"
        elif "," not in seen or decimal == "," or blank and decimal is None and _between_digits(text, begin):
            separator, delimiter = r"\s+", None
        else:
            return cls(re.compile(r"\s*,\s*|\s+"), ",", comma=",")
        if {",", "."} <= seen and decimal is None:
            raise ProfileError('its numbers contain both "," and "."; write decimal = "," or decimal = "."')
        return cls(re.compile(separator), delimiter, {",": ".", ".": ","}.get(decimal or "", ""))

    def split(self, line: str) -> list[str]:
        """Numbers of a line, with a decimal point."""
        return self.separator.split(self._with_points(line))

    def table(self, block: str) -> np.ndarray | None:
        """Numbers of a block, one row for each line; None if it must be read line by line."""
        if not _holds_numbers_alone(block) or block.isspace():
            return None
        text = self._with_points(block)
        if self.removed and not all(map(str.strip, text.rstrip("\n").split("\n"))):  # a line without a digit
            return None
        try:
            return np.loadtxt(io.StringIO(text), delimiter=self.delimiter, comments=None, ndmin=2)
        except ValueError:  # a number is missing, or lines differ
            return None

    def _with_points(self, text: str) -> str:
        if self.removed:
            text = text.replace(self.removed, "")
        return text if self.comma == "," else text.replace(",", self.comma)


def _numbers(words: list[str]) -> list[float] | None:
    """Numbers of a line, nan for missing numbers; None for an empty line or a line with other text."""
    try:
        row = [np.nan if word.lower() in MISSING else float(word) for word in words]
    except ValueError:
        return None
    return None if any("_" in word for word in words) or np.isnan(row).all() else row


def _columns(pieces: list[tuple[int, np.ndarray]]) -> np.ndarray:
    """Concatenated rows without empty columns.

    Parameters
    ----------
    pieces
        Successive rows of one length, with the line number of the first.
    """
    if not pieces:
        raise ProfileError("0 points; allowed: lines of numbers, x and z")
    width = pieces[-1][1].shape[1]
    for n, rows in pieces:
        if rows.shape[1] != width:
            raise ProfileError(
                f"line {n}: {rows.shape[1]} numbers, the last line has {width}; allowed: as many in every "
                f"line, or header_lines = {n} if that one belongs to the header"
            )
    columns = np.empty((width, sum(len(rows) for _, rows in pieces)))
    begin = 0
    for _, rows in pieces:
        columns[:, begin : begin + len(rows)] = rows.T
        begin += len(rows)
    empty = np.isnan(columns).all(axis=1)
    return columns[~empty] if empty.any() else columns
