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
        Names of the dimension scales, each beside the dataset or in a group above it.
    dtype : str
        Type on disk; the stored fields may be narrowed to float32 on request.
    only : str
        Scenes that have it, a key of `SCENES`; "": all.
    on_request : bool
        Whether a case must ask for it.
    """

    units: str
    long_name: str
    dims: tuple = _FRAME
    dtype: str = "f8"
    only: str = ""
    on_request: bool = False


@dataclass(frozen=True)
class Column:
    """Column of progress: heading, factor from SI units, format, words in the bar."""

    heading: str
    factor: float
    form: str
    bar: str = ""


@dataclass(frozen=True)
class StepScalar(Field):
    """A scalar of every time step.

    Attributes
    ----------
    over_run, over_series : str
        Reduction to one value, a key of `REDUCTIONS`, "" for none; over a series by default that over
        its runs.
    summary : str
        Format in the last line of a run; "" leaves it out.
    label : str
        Name in that line; its own by default.
    progress : Column, optional
        Its column in the lines of progress.
    compared : bool
        Whether two runs of one case must agree in it, unlike a scalar of the solution process.
    """

    dims: tuple = _STEP
    over_run: str = ""
    over_series: str = ""
    summary: str = ""
    label: str = ""
    progress: Column | None = None
    compared: bool = False
