"""Keys of `[output]`, `[series]`, `[post]` and `[life]`: stored quantities, series, fatigue, many passes."""

from __future__ import annotations

import math
import re
from typing import Any

from ehlpetsc.keys import Key, KeyTable, Refused, Values
from ehlpetsc.quantities import FIELDS, STORED

DOTTED_KEY = re.compile(r"[A-Za-z_]+(\.[A-Za-z_0-9]+)+")
MAX_MEMBERS = 10_000  # of a series
MAX_DEPTH, MAX_RESIDUAL = 100.0, 1e10  # z/a, Pa

OUTPUT = KeyTable(
    "output",
    "content of the result file",
    {
        "every": Key("steps between stored fields", int, ge=1, le=10**9, default=1),
        "fields": Key("stored fields", str, choices=tuple(FIELDS), many="list", default=STORED),
        "precision": Key("of the stored fields", str, choices=("float64", "float32"), default="float64"),
        "thin_film": Key(
            "mixed contact: films below it count as thin", unit="boundary films", ge=1, le=1000, default=2.0
        ),
        "checkpoint": Key("time between restart files", unit="minutes", gt=0, le=1e5, default=10.0),
    },
    always=True,
)


def _one_or_several(series: Values) -> dict[str, Any]:
    """Refuse values that do not fit the keys of a series."""
    keys, lists = series.keys, series.values
    for name in ("key", "keys"):
        given = [series.key] if name == "key" else keys
        if getattr(series, name) is not None and not all(map(DOTTED_KEY.fullmatch, given)):
            raise Refused(key=name)
    if (series.key is None) == (keys is None):
        raise Refused("needs either key or keys: one of them")
    if keys is None:
        if series.combine:
            raise Refused("combine is for several keys")
        members = len(lists)
    else:
        if len(set(keys)) < len(keys):
            raise Refused("keys: the same one twice")
        if len(lists) != len(keys) or not all(isinstance(entries, list) and entries for entries in lists):
            raise Refused(f"values: allowed: {len(keys)} lists of values, one for each of the keys")
        counts = [len(entries) for entries in lists]
        if series.combine == "step" and len(set(counts)) > 1:
            shown = ", ".join(map(str, counts))
            raise Refused(f'values: lists of {shown}; allowed with combine = "step": lists of one length')
        members = counts[0] if series.combine == "step" else math.prod(counts)
    if members > MAX_MEMBERS:
        raise Refused(f"{members} members; allowed: at most {MAX_MEMBERS}")
    return {}


SERIES = KeyTable(
    "series",
    "keys varied over values; one member for each value or combination of values",
    {
        "key": Key('varied key, as in "fluid.viscosity"', str),
        "keys": Key("several varied keys", str, many="list", min_items=2),
        "values": Key(
            "list of values of the key; of keys, such a list for each", object, many="list", required=True
        ),
        "combine": Key(
            "of keys: every value with every other [grid], or the first ones, the second ones ...",
            str,
            choices=("grid", "step"),
        ),
    },
    complete=_one_or_several,
)


def _residual_rows(post: Values) -> dict[str, Any]:
    """Residual stress as pairs of numbers, depths increasing."""
    if post.residual_stress is None:
        return {}
    rows, previous = [], -1.0
    for row in post.residual_stress:
        is_pair = isinstance(row, list) and len(row) == 2 and all(type(item) in (int, float) for item in row)
        depth, stress = row if is_pair else (-1.0, 0.0)
        if not (0.0 <= depth <= MAX_DEPTH and depth > previous and abs(stress) <= MAX_RESIDUAL):
            raise Refused(key="residual_stress")
        rows.append((float(depth), float(stress)))
        previous = depth
    return {"residual_stress": rows}


def _strength(text: str, **more: Any) -> Key:
    return Key(text, unit="Pa", ge=1e6, le=1e12, **more)


POST = KeyTable(
    "post",
    "stresses and fatigue of both surfaces: read by ehlpetsc post, checked before the run",
    {
        "depths": Key("z/a", unit="half widths", ge=0, le=MAX_DEPTH, many="list"),
        "b": Key(
            "fatigue strength exponent",
            gt=-2,
            lt=0,
            equation="de/2 = (sigma_f'/E) (2N)^b + eps_f' (2N)^c, D = sum of 1/N",
        ),
        "c": Key("fatigue ductility exponent", gt=-5, lt=0),
        "cyclic_hardening": Key("n'", gt=0, lt=1, equation="de = ds/E + 2 (ds/(2 K'))^(1/n')"),
        "fatigue_strength": _strength("sigma_f'"),
        "fatigue_ductility": Key("eps_f'", ge=1e-6, le=100),
        "cyclic_strength": _strength("K'; left out: sigma_f'/eps_f'^n'"),
        "strain": Key(
            "rule from elastic stress ranges to strains; direct: none, as in the paper",
            str,
            choices=("neuber", "glinka", "direct"),
            default="neuber",
        ),
        "residual_stress": Key(
            "[[z/a, Pa], ...], stress along the surface, depths increasing", object, many="list"
        ),
        "normal_sensitivity": Key(
            "k of Fatemi and Socie",
            ge=0,
            le=10,
            equation="dgamma/2 (1 + k sigma_n/sigma_y) = (tau_f'/G) (2N)^b + gamma_f' (2N)^c",
        ),
        "yield_strength": _strength("of Fatemi and Socie; left out: cyclic, 0.2 %"),
        "torsion_limit": _strength(
            "of Dang Van",
            equation="U = max of (tau + 3 (tau_w/sigma_w - 1/2) max(sigma_H, 0))/tau_w, "
            "tau_w in torsion, sigma_w in bending",
        ),
        "bending_limit": _strength("of Dang Van"),
    },
    always=True,
    complete=_residual_rows,
)

LIFE = KeyTable(
    "life",
    "surfaces over many passes, a few of them solved: read by ehlpetsc life",
    {
        "passes": Key("passes of both surfaces over each other", ge=1, le=1e12, default=1e6),
        "wear_jump": Key(
            "wear depth between two solved passes over the combined Rq", gt=0, le=1, default=0.05
        ),
        "damage_jump": Key("damage of any point between two solved passes", gt=0, le=1, default=0.1),
        "break_out": Key(
            "a failed cell breaks out with all cells above it; only where failed cells reach the surface; or "
            "not at all: counted",
            str,
            choices=("above", "connected", "none"),
            default="above",
        ),
        "partners": Key(
            "positions of surface 2, time.pass_shift apart, that a round solves; of gears, teeth of the "
            "wheel: as many as a pinion tooth meets at most",
            int,
            ge=1,
            le=1000,
            default=4,
        ),
        "max_solved": Key("solved passes after which a life ends early", int, ge=1, le=100_000, default=500),
    },
)
