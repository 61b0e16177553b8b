"""Metadata of a stored quantity: the entries of :mod:`ehlpetsc.quantities`."""

from dataclasses import dataclass

_FRAME = ("time", "x")
_STEP = ("time",)


@dataclass(frozen=True)
class Field:
    """Metadata of a dataset.

    Attributes
    ----------
    units : str
        SI unit, "1" for a number.
    long_name : str
        Name for axes and headings.
    dims : tuple of str
        Names of the dimension scales, each in the group of the dataset or in one above it.
    dtype : str
        Type on disk; fields may be stored as float32 on request.
    only : str
        Cases with the quantity, a key of `SCENES`; "": all.
    on_request : bool
        Whether it is stored only on request of the case.
    """

    units: str
    long_name: str
    dims: tuple = _FRAME
    dtype: str = "f8"
    only: str = ""
    on_request: bool = False


@dataclass(frozen=True)
class Column:
    """Column of progress: heading, factor from SI units, format, text of the bar."""

    heading: str
    factor: float
    form: str
    bar: str = ""


@dataclass(frozen=True)
class StepScalar(Field):
    """Scalar of every time step.

    Attributes
    ----------
    over_run, over_series : str
        Reduction to one value, a key of `REDUCTIONS`, "": none; `over_series` by default as `over_run`.
    summary : str
        Format in the last line of a run; "": not printed.
    label : str
        Name in this line; default: name of the scalar.
    progress : Column, optional
        Column in the lines of progress.
    compared : bool
        Whether it is compared between runs, unlike scalars of the solution process.
    """

    dims: tuple = _STEP
    over_run: str = ""
    over_series: str = ""
    summary: str = ""
    label: str = ""
    progress: Column | None = None
    compared: bool = False
