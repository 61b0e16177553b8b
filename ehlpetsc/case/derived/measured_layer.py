"""``asperity_height = "measured"``: the rms height that the short cut-off removes from both profiles."""

import math
from pathlib import Path

from ehlpetsc.case.schema.validation import ValidationError
from ehlpetsc.case.tables.surface import SurfaceProfile
from ehlpetsc.errors import ProfileError
from ehlpetsc.surfaces.samples import samples

KEY = "asperity_height"
DIGITS = 6


def resolve_measured_layer(path, data):
    r"""Replace ``asperity_height = "measured"`` in the tables of a case by a number.

    .. math:: \sigma^2=\sum_{surfaces}\overline{(z-z_S)^2},

    z_S the profile after the S-filter (`short_cutoff`), both with the scale of the case.

    Parameters
    ----------
    path : path-like
        Path of the case file, in whose folder profile files are.
    data : dict
        Tables; changed in place.

    Returns
    -------
    settings : list of (list of str, value)
        Replaced settings: split keys and numbers.
    faults : list of str
    """
    contact = data.get("contact")
    if not isinstance(contact, dict) or contact.get(KEY) != "measured":
        return [], []
    series = data.get("series") if isinstance(data.get("series"), dict) else {}
    swept = [series.get("key"), *(series.get("keys") or [])]
    if any(isinstance(key, str) and key.startswith("surface.") for key in swept):
        return [], [f'contact.{KEY} = "measured": not in a series over surfaces; allowed: a number']
    surface = data.get("surface") if isinstance(data.get("surface"), dict) else {}
    tables = [table for table in surface.values() if isinstance(table, dict) and "short_cutoff" in table]
    if not tables:
        return [], [f'contact.{KEY} = "measured": needs short_cutoff in [surface.1] or [surface.2]']
    try:
        removed = [_removed(Path(path).parent, SurfaceProfile(**table)) for table in tables]
    except (ProfileError, ValidationError):  # reported by the checks of the profiles
        contact[KEY] = None
        return [], []
    contact[KEY] = float(f"{math.hypot(*removed):.{DIGITS}g}")
    return [(["contact", KEY], contact[KEY])], []


def _removed(folder, spec):
    """Rms height [m] that the short cut-off removes from one profile."""
    before = samples(folder, spec.copy(update={"short_cutoff": None}))
    return float((before.z - samples(folder, spec).z).std())
