"""Table of the entries of a restart file, and check of a file against the table."""

from dataclasses import dataclass

import numpy as np

from ehlpetsc.effects import EFFECTS
from ehlpetsc.names import current_name
from ehlpetsc.quantities import STEP_SCALARS

TOTAL = "total "  # prefix of the names of totals among the attributes
RECORD = "record "  # prefix of the names of effects with a record in the file
MAX_NUMBER = 1e300  # largest magnitude of a number


@dataclass(frozen=True)
class Item:
    """Entry of a restart file.

    Attributes
    ----------
    meaning : str
    dims : tuple of str
        Names of the dimensions of an array; a dimension has the same length in all arrays.
    low, high : float
        Bounds of the values.
    is_integer : bool
    is_required : bool
    """

    meaning: str
    dims: tuple = ()
    low: float = -MAX_NUMBER
    high: float = MAX_NUMBER
    is_integer: bool = False
    is_required: bool = True


def _state(prefix, level, *dims):
    """Entries that define q and w independently of the contact model, which may change at a restart."""
    dims, required = (*dims, "node"), not dims
    return {
        f"{prefix}{name}": Item(f"{meaning}, {level}", dims, low, is_required=required)
        for name, meaning, low in (
            ("q", "oil pressure in p0 or -void fraction", -1.0),
            ("h", "film in a^2/R", 0.0),
            ("contact_pressure", "of the solids in p0", 0.0),
        )
    }


ARRAYS = (
    {
        "x": Item("nodes [m]", ("node",)),
        "contact_count": Item("steps in contact", ("node",), 0, is_integer=True),
    }
    | _state("", "now")
    | _state("smooth_", "steady at time 0")
    | _state("earlier_", "one and two levels ago", "level")
    | {
        "earlier_travelled": Item(
            "distance travelled by the film at these levels [m]", ("level",), is_required=False
        ),
        "m": Item("mass per area of the film in a^2/R", ("node",), 0.0, is_required=False),
        "m_older": Item("mass per area one level ago", ("node",), 0.0, is_required=False),
    }
)
NUMBERS = {
    "time": Item("time [s]", low=0.0),
    "dt": Item("last time step [s], 0: none", low=0.0),
    "step": Item("number of time steps", low=0, is_integer=True),
    "retries": Item("halvings of the last step", low=0, is_integer=True),
    "h00": Item("approach in a^2/R"),
    "a": Item("half width [m]", low=1e-300),
    "p0": Item("maximum Hertz pressure [Pa]", low=1e-300),
    "h_scale": Item("a^2/R [m]", low=1e-300),
    "u1": Item("speed of surface 1 [m/s]"),
    "u2": Item("speed of surface 2 [m/s]"),
    "travelled_1": Item("distance travelled by surface 1 since time 0 [m]"),
    "travelled_2": Item("distance travelled by surface 2 since time 0 [m]"),
    "entered_inlet": Item("inlet at which profiles entered [m]"),
    "entered_outlet": Item("outlet at which profiles entered [m]"),
    "begin_1": Item("abscissa with which profile 1 entered [m]"),
    "begin_2": Item("abscissa with which profile 2 entered [m]"),
    "pass_number": Item("number of the pass of both bodies over each other", low=1, is_integer=True),
}
TEXTS = {"case": "text of the case"}


def fault(arrays, attributes):
    """Reason why the content of a file is not that of a restart file; None if it is.

    Parameters
    ----------
    arrays : dict of str to ndarray
    attributes : dict of str to number or str
    """
    known = {*ARRAYS, *NUMBERS, *TEXTS}
    unknown = [name for name in [*arrays, *attributes] if name not in known and not _is_of_others(name)]
    if unknown:
        return f"unknown entry {min(unknown)}"
    lengths = {}
    for name, item in {**ARRAYS, **NUMBERS}.items():
        values = arrays if name in ARRAYS else attributes
        if name not in values:
            if item.is_required:
                return f"{name} ({item.meaning}) is missing"
            continue
        wrong = _fault_of(np.asarray(values[name]), item, lengths)
        if wrong:
            return f"{name} ({item.meaning}) {wrong}"
    for name, meaning in TEXTS.items():
        if not isinstance(attributes.get(name), str):
            return f"{name} ({meaning}) is missing or no text"
    return _fault_of_totals(attributes) or _inconsistency(arrays, attributes)


def _is_of_others(name):
    """Whether an entry is a total, or belongs to the record of an effect."""
    return name.startswith((TOTAL, *(f"{effect.name}." for effect in EFFECTS))) or name in {
        RECORD + effect.name for effect in EFFECTS
    }


def _fault_of(values, item, lengths):
    if values.dtype.kind not in ("iu" if item.is_integer else "f"):
        return f"is of the type {values.dtype}"
    if values.ndim != len(item.dims):
        return f"has {values.ndim} dimensions, not {len(item.dims)}"
    for dim, length in zip(item.dims, values.shape, strict=True):
        if lengths.setdefault(dim, length) != length:
            return f"has the length {length} over {dim}, others {lengths[dim]}"
    if not np.isfinite(values).all():
        return "is not finite"
    if values.size and not item.low <= values.min() <= values.max() <= item.high:
        return f"lies in {values.min():.6g} to {values.max():.6g}, allowed: {item.low:.6g} to {item.high:.6g}"
    return None


def _fault_of_totals(attributes):
    for name, value in attributes.items():
        if not name.startswith(TOTAL):
            continue
        if current_name(name.removeprefix(TOTAL)) not in STEP_SCALARS:
            return f"unknown entry {name}"
        if not isinstance(value, int | float | np.integer | np.floating) or np.isinf(value):
            plain = value.item() if isinstance(value, np.generic) else value  # numpy 2 would print its type
            return f"{name} is {plain!r}"
    return None


def _inconsistency(arrays, attributes):
    """Contradiction between entries; None if there is none."""
    x, step = arrays["x"], attributes["step"]
    if len(x) < 2 or not (np.diff(x) > 0.0).all():
        return "its nodes do not increase"
    levels = {name for name in ARRAYS if name.startswith("earlier_")} & arrays.keys()
    if levels and len(levels) < sum(name.startswith("earlier_") for name in ARRAYS):
        return "of its earlier levels some fields are missing"
    if arrays["contact_count"].max() > step + 1:
        return f"contact_count is {arrays['contact_count'].max()} after {step} steps"
    if attributes["dt"] > attributes["time"] * (1.0 + 1e-9):
        return "its last step is longer than its time"
    if "m_older" in arrays and "m" not in arrays:
        return "m_older is there and m is not"
    return None
