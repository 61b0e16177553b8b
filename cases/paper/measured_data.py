"""Measured values of cases/paper/data: CSV files with source and reading error in their first lines."""

from __future__ import annotations

import argparse
import csv
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


def parser(text: str | None, picture: str) -> argparse.ArgumentParser:
    """Parser of a script that writes a picture; `text`: its docstring."""
    formatter = argparse.RawDescriptionHelpFormatter
    words = argparse.ArgumentParser(description=text, formatter_class=formatter)
    words.add_argument("-o", "--output", default=picture, help=f"picture [{picture}]")
    return words
