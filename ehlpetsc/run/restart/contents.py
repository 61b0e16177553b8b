"""Table of the entries of a restart file, and the check of a file against it."""

from dataclasses import dataclass

import numpy as np

from ehlpetsc.effects import EFFECTS
from ehlpetsc.names import current_name
from ehlpetsc.quantities import STEP_SCALARS

TOTAL = "total "  # before the names of totals among the attributes
RECORD = "record "  # before the names of effects whose records the file holds
MAX_NUMBER = 1e300  # of any number


@dataclass(frozen=True)
class Item:
    """One entry.

    Attributes
    ----------
    meaning : str
    dims : tuple of str
        Of an array, names of its dimensions: arrays with a name in common have the same length there.
    least, most : float
    whole : bool
        A whole number, or several.
    needed : bool
    """

    meaning: str
    dims: tuple = ()
    least: float = -MAX_NUMBER
    most: float = MAX_NUMBER
    whole: bool = False
    needed: bool = True


def _state(name, what, *dims):
    """Entries that define q and w independently of the contact model, with which a run may continue."""
    needed = not dims
    return {
        f"{name}q": Item(
            f"oil pressure in p0 or -void fraction, {what}", (*dims, "node"), -1.0, needed=needed
        ),
        f"{name}h": Item(f"film in a^2/R, {what}", (*dims, "node"), 0.0, needed=needed),
        f"{name}contact_pressure": Item(f"of the solids in p0, {what}", (*dims, "node"), 0.0, needed=needed),
    }


ARRAYS = (
    {"x": Item("nodes [m]", ("node",)), "contact_count": Item("steps in contact", ("node",), 0, whole=True)}
    | _state("", "now")
    | _state("smooth_", "steady at time 0")
    | _state("earlier_", "one and two levels ago", "level")
    | {
        "earlier_travelled": Item("way of the film at these levels [m]", ("level",), needed=False),
        "m": Item("mass per area of the film in a^2/R", ("node",), 0.0, needed=False),
        "m_older": Item("one level ago", ("node",), 0.0, needed=False),
    }
)
NUMBERS = {
    "time": Item("time [s]", least=0.0),
    "dt": Item("step that led here [s], 0: none", least=0.0),
    "step": Item("steps taken", least=0, whole=True),
    "retries": Item("halvings of the last step", least=0, whole=True),
    "h00": Item("approach in a^2/R"),
    "a": Item("half width [m]", least=1e-300),
    "p0": Item("largest pressure of Hertz [Pa]", least=1e-300),
    "h_scale": Item("a^2/R [m]", least=1e-300),
    "u1": Item("speed of surface 1 [m/s]"),
    "u2": Item("speed of surface 2 [m/s]"),
    "travelled_1": Item("way of surface 1 since time 0 [m]"),
    "travelled_2": Item("way of surface 2 since time 0 [m]"),
    "entered_inlet": Item("inlet at which profiles entered [m]"),
    "entered_outlet": Item("outlet at which profiles entered [m]"),
    "begin_1": Item("abscissa with which profile 1 entered [m]"),
    "begin_2": Item("abscissa with which profile 2 entered [m]"),
    "pass_number": Item("of the passes of both bodies over each other", least=1, whole=True),
}
TEXTS = {"case": "the case as it was run"}


def fault(arrays, attributes):
    """Reason why the content of a file is not that of a restart file; None: it is.

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
        held = arrays if name in ARRAYS else attributes
        if name not in held:
            if item.needed:
                return f"{name} ({item.meaning}) is missing"
            continue
        wrong = _fault_of(np.asarray(held[name]), item, lengths)
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
    if values.dtype.kind not in ("iu" if item.whole else "f"):
        return f"is of the type {values.dtype}"
    if values.ndim != len(item.dims):
        return f"has {values.ndim} dimensions, not {len(item.dims)}"
    for dim, length in zip(item.dims, values.shape, strict=True):
        if lengths.setdefault(dim, length) != length:
            return f"has the length {length} over {dim}, others {lengths[dim]}"
    if not np.isfinite(values).all():
        return "is not finite"
    if values.size and not item.least <= values.min() <= values.max() <= item.most:
        return (
            f"lies in {values.min():.6g} to {values.max():.6g}, allowed: {item.least:.6g} to {item.most:.6g}"
        )
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
    """Contradiction between entries; None: there is none."""
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
