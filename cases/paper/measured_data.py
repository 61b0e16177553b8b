"""Measured values of cases/paper/data: CSV files with source and reading error in their first lines.

Columns ``computed``, or named after a model or an oil, hold what the script of the file computed.
"""

from __future__ import annotations

import argparse
import csv
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

import numpy as np

FOLDER = Path(__file__).parent / "data"


class Measured(NamedTuple):
    """Notes (``source``, ``figure``, ``reading error``, ``conditions``) and columns by name."""

    notes: dict[str, str]
    columns: dict[str, np.ndarray]

    def where(self, **values: float | str) -> dict[str, np.ndarray]:
        """Columns of the rows that have these values."""
        rows = np.all([self.columns[name] == value for name, value in values.items()], axis=0)
        return {name: column[rows] for name, column in self.columns.items()}


def read(file: str | Path) -> Measured:
    """Measured values of a file; of a name without a folder that of `FOLDER`.

    Lines ``# note: text`` precede the names of the columns. A column of numbers is an array of floats.
    """
    path = Path(file)
    lines = (path if path.exists() else FOLDER / path).read_text(encoding="utf-8").splitlines()
    notes = dict(line[2:].split(": ", 1) for line in lines if line.startswith("# ") and ": " in line)
    names, *rows = csv.reader(line for line in lines if line.strip() and not line.startswith("#"))
    return Measured(
        notes,
        {name.strip(): _column(values) for name, values in zip(names, zip(*rows, strict=True), strict=True)},
    )


def _column(values: tuple[str, ...]) -> np.ndarray:
    try:
        return np.array([float(value) for value in values])
    except ValueError:
        return np.array([value.strip() for value in values])


def store(name: str, **columns: Iterable[str]) -> None:
    """Add columns to a file of `FOLDER`, or replace them; its notes and other columns stay."""
    lines = (FOLDER / name).read_text(encoding="utf-8").splitlines()
    notes = [line for line in lines if line.startswith("#")]
    names, *rows = csv.reader(lines[len(notes) :])
    table = dict(zip(names, zip(*rows, strict=True), strict=True)) | columns
    with (FOLDER / name).open("w", encoding="utf-8", newline="") as file:
        file.writelines(f"{note}\n" for note in notes)
        rewritten = csv.writer(file, lineterminator="\n")
        rewritten.writerow(table)
        rewritten.writerows(zip(*table.values(), strict=True))


def parser(text: str | None, picture: str) -> argparse.ArgumentParser:
    """Parser of a script that writes a picture; `text`: its docstring."""
    formatter = argparse.RawDescriptionHelpFormatter
    words = argparse.ArgumentParser(description=text, formatter_class=formatter)
    words.add_argument("-o", "--output", default=picture, help=f"picture [{picture}]")
    return words
