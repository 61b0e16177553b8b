"""Columns of numbers out of a text file as measuring instruments write them.

Separator and decimal sign are found from the lines that hold nothing but numbers; what could be read in two
ways is refused with the key that settles it.
"""

import codecs
import re

import numpy as np

from ehlpetsc.errors import ProfileError

MISSING = {"", "nan", "-nan", "nan(ind)", "-nan(ind)", "na", "n/a", "bad", "*", "***", "-", "--", "---"}
NUMBERS_ONLY = re.compile(r"[\d\s.,;eE+-]+")
DECIMAL_COMMA = re.compile(r"(?<=\d),(?=\d)")
UNIT_IN_HEADER = re.compile(r"[\[(/]\s*(mm|um|µm|μm|nm|m)\s*(?:[\])]|$)", re.MULTILINE)


def text_columns(path, decimal=None, header_lines=None):
    """Numbers of a text file, a row each line.

    Parameters
    ----------
    path : pathlib.Path
    decimal : str, optional
        "." or ","; left out: found from the file.
    header_lines : int, optional
        Lines before the numbers; left out: all lines before the first one of numbers.

    Returns
    -------
    columns : ndarray, shape (n columns, n rows)
        nan where a number is missing.
    header : str
        Lines before the numbers, comments among them.

    Raises
    ------
    ProfileError
    """
    lines = list(enumerate(_decoded(path).splitlines(), 1))
    header = [line for _, line in lines[: header_lines or 0]]
    header += [line for _, line in lines if line.lstrip().startswith("#")]
    lines = [(n, line.partition("#")[0].strip()) for n, line in lines[header_lines or 0 :]]
    lines = [(n, line) for n, line in lines if line.strip(" ,;\t")]
    split = _splitter([line for _, line in lines if NUMBERS_ONLY.fullmatch(line)], decimal)
    rows = []
    for n, line in lines:
        row = _numbers(split(line))
        if row is None and not rows and header_lines is None:
            header.append(line)
        elif row is None:
            raise ProfileError(
                f"line {n}: {line[:40]!r}; allowed: numbers alone below the header, x and z; "
                "header_lines = the number of lines above them"
            )
        else:
            rows.append((n, row))
    return _without_empty_columns(rows), "\n".join(header)


def units_in(header):
    """Units of length named in brackets, or behind a slash, in a header, in their order."""
    return [unit.replace("µ", "u").replace("μ", "u") for unit in UNIT_IN_HEADER.findall(header)]


def _decoded(path):
    raw = path.read_bytes()
    if raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return raw.decode("utf-16", "replace")
    if b"\0" in raw:
        raise ProfileError("not text; allowed: columns of numbers, x and z")
    raw = raw.removeprefix(codecs.BOM_UTF8)  # also before what is not UTF-8 then
    try:
        return raw.decode().replace("\ufeff", "")  # files put together have more of them
    except UnicodeDecodeError:  # instruments write µ and degrees in the code page of their country
        return raw.decode("latin-1")


def _splitter(lines, decimal):
    """Function that takes a line apart into numbers written with a point."""
    comma = any("," in line for line in lines)
    if any(";" in line for line in lines):
        pattern = r"\s*;\s*"
    elif any("\t" in line for line in lines):
        pattern = r"[ ]*\t[ ]*"
    elif not comma or decimal == "," or decimal is None and _decimal_comma(lines):
        pattern = r"\s+"
    else:
        return lambda line: re.split(r"\s*,\s*|\s+", line)
    separator = re.compile(pattern)
    if comma and any("." in line for line in lines) and decimal is None:
        raise ProfileError('both "," and "." stand in its numbers; write decimal = "," or decimal = "."')
    if decimal == ",":
        return lambda line: [word.replace(".", "").replace(",", ".") for word in separator.split(line)]
    if decimal == ".":
        return lambda line: [word.replace(",", "") for word in separator.split(line)]
    return lambda line: [word.replace(",", ".") for word in separator.split(line)]


def _decimal_comma(lines):
    """Whether blanks separate the numbers and every comma stands between two digits."""
    blank = any(re.search(r"\s", line) for line in lines)
    return blank and all(line.count(",") == len(DECIMAL_COMMA.findall(line)) for line in lines)


def _numbers(words):
    """Numbers of a line, nan for missing ones; None where anything else stands in it or nothing at all."""
    try:
        row = [np.nan if word.lower() in MISSING else float(word) for word in words]
    except ValueError:
        return None
    return None if any("_" in word for word in words) or np.isnan(row).all() else row


def _without_empty_columns(rows):
    if not rows:
        raise ProfileError("0 points; allowed: lines of numbers, x and z")
    width = len(rows[-1][1])
    for n, row in rows:
        if len(row) != width:
            raise ProfileError(
                f"line {n}: {len(row)} numbers, the last line has {width}; allowed: as many in every line, "
                f"or header_lines = {n} if that one belongs to the header"
            )
    columns = np.array([row for _, row in rows]).T
    return columns[~np.isnan(columns).all(axis=1)]
