"""Keys of `[output]`, `[series]`, `[post]` and `[life]`: stored quantities, series, fatigue, many passes."""

from __future__ import annotations

import math
import re
from typing import Any

from ehlpetsc.base.declarations import Key, KeyTable, Refused, Required, Values
from ehlpetsc.base.materials import MEAN_STRESSES
from ehlpetsc.base.quantities import DEFAULT_FIELDS, FIELDS
from ehlpetsc.case.tables.surface import AREAL

DOTTED_KEY = re.compile(r"[A-Za-z_]+(\.[A-Za-z_0-9]+)+")
MAX_MEMBERS = 10_000  # of a series
STRENGTH = ("Pa", 1e6, 1e12)
MAX_DEPTH, MAX_RESIDUAL = 100.0, 1e10  # z/a, Pa

OUTPUT_KEYS = {
    "every": Key("steps between stored fields", "", 1, 10**9, kind=int, default=1),
    "fields": Key(
        "stored fields; []: none, scalars alone",
        choices=FIELDS,
        many="list",
        min_items=0,
        default=DEFAULT_FIELDS,
    ),
    "precision": Key("of the stored fields", choices=("float64", "float32"), default="float64"),
    "xdmf": Key(
        "of a contact in the plane: RESULT.xdmf for ParaView, beside the result file",
        kind=bool,
        default=False,
        contacts=AREAL,
    ),
    "thin_film": Key("mixed contact: films below it count as thin", "boundary films", 1, 1000, default=2.0),
    "checkpoint": Key("time between restart files", "minutes", gt=0, le=1e5, default=10.0),
}
OUTPUT = KeyTable("output", "content of the result file", OUTPUT_KEYS, always=True)


def _one_or_several(series: Values) -> dict[str, Any]:
    """Refuse values that do not fit the keys of a series."""
    if (series.key is None) == (series.keys is None):
        raise Refused("needs either key or keys: one of them")
    keys, lists = (series.keys, series.values) if series.keys else ([series.key], [series.values])
    if not all(map(DOTTED_KEY.fullmatch, keys)):
        raise Refused('allowed: a key of a table, as "fluid.viscosity"', "keys" if series.keys else "key")
    if series.combine and not series.keys:
        raise Refused("combine is for several keys")
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


SERIES_KEYS = {
    "key": Key('varied key, as in "fluid.viscosity"', kind=str),
    "keys": Key("several varied keys", kind=str, many="list", min_items=2),
    "values": Required("list of values of the key; of keys, such a list for each", kind=object, many="list"),
    "combine": Key("of keys: every value with every other [grid], or in parallel", choices=("grid", "step")),
}
SERIES = KeyTable(
    "series",
    "keys varied over values; one member for each value or combination of values",
    SERIES_KEYS,
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


POST_KEYS = {
    "depths": Key("z/a", "half-widths", 0, MAX_DEPTH, many="list"),
    "b": Key(
        "fatigue strength exponent",
        gt=-2,
        lt=0,
        equation="`de/2 = (sigma_f'/E) (2N)^b + eps_f' (2N)^c`, `D` the sum of `1/N`",
    ),
    "c": Key("fatigue ductility exponent", gt=-5, lt=0),
    "cyclic_hardening": Key("`n'` of `de = ds/E + 2 (ds/(2 K'))^(1/n')`", gt=0, lt=1),
    "fatigue_strength": Key("`sigma_f'`", *STRENGTH),
    "fatigue_ductility": Key("`eps_f'`", "", 1e-6, 100),
    "cyclic_strength": Key("`K'`; left out: `sigma_f'/eps_f'^n'`", *STRENGTH),
    "life_at": Key(
        "pressure [Pa] and passes at which a smooth line contact fails, in a test or by a standard: "
        "`sigma_f'` and `K'` are scaled to them",
        many="two",
        gt=0,
    ),
    "strain": Key(
        "rule from elastic stress ranges to strains; direct: none, as in the paper",
        choices=("neuber", "glinka", "direct"),
        default="neuber",
    ),
    "criterion": Key(
        "of the damage of a life; ehlpetsc post computes it beside D, which is von-mises",
        choices=("von-mises", "fatemi-socie"),
        default="von-mises",
    ),
    "mean_stress": Key("correction for the mean stress of a cycle", choices=MEAN_STRESSES, default="none"),
    "tensile_strength": Key("of Goodman and Gerber; left out: by the hardness of `sigma_f'`", *STRENGTH),
    "walker_exponent": Key("`gamma` of Walker; left out: by the tensile strength", "", 0, 1),
    "residual": Key(
        "cycles left open in a pass: closed by the next pass, or half cycles (ASTM E1049)",
        choices=("repeat", "half"),
        default="repeat",
    ),
    "residual_stress": Key("[[z/a, Pa], ...] along the surface, depths increasing", kind=object, many="list"),
    "normal_sensitivity": Key(
        "`k` of Fatemi and Socie",
        *("", 0, 10),
        equation="`dgamma/2 (1 + k sigma_n/sigma_y) = (tau_f'/G) (2N)^b + gamma_f' (2N)^c`",
    ),
    "yield_strength": Key("`sigma_y` of Fatemi and Socie; left out: cyclic, 0.2 %", *STRENGTH),
    "torsion_limit": Key(
        "`tau_w` of Dang Van",
        *STRENGTH,
        equation="`U`, the maximum of `(tau + 3 (tau_w/sigma_w - 1/2) max(sigma_H, 0))/tau_w`",
    ),
    "bending_limit": Key("`sigma_w` of Dang Van", *STRENGTH),
}
POST = KeyTable(
    "post",
    "stresses and fatigue of both surfaces: read by ehlpetsc post, checked before the run",
    POST_KEYS,
    always=True,
    complete=_residual_rows,
)

LIFE_KEYS = {
    "passes": Key("passes of both surfaces over each other", "", 1, 1e12, default=1e6),
    "wear_jump": Key(  # less than a cell, or a jump may pass over a break-out
        "wear depth between two solved passes over the combined Rq", gt=0, le=0.25, default=0.05
    ),
    "damage_jump": Key("damage of any point between two solved passes", gt=0, le=1, default=0.1),
    "break_out": Key(
        "cells that a failed one takes out: all above it, those connected to the surface, or none",
        choices=("above", "connected", "none"),
        default="above",
    ),
    "partners": Key(
        "positions of surface 2, time.pass_shift apart, that a round solves; of gears, teeth of the wheel",
        *("", 1, 1000),
        kind=int,
        default=3,
    ),
    "max_solved": Key("solved passes after which a life ends early", "", 1, 100_000, kind=int, default=500),
}
LIFE = KeyTable("life", "surfaces over many passes, a few solved: read by ehlpetsc life", LIFE_KEYS)
