"""Running-in: surfaces and contact after each pass."""

from __future__ import annotations

from itertools import takewhile
from typing import TYPE_CHECKING, Any

import numpy as np

from ehlpetsc.base.quantities import OTHERS
from ehlpetsc.results.means import filled_weights, mean

if TYPE_CHECKING:
    from ehlpetsc.results.reader import Result

SHIFTED_IN_A_ROW = 10  # consecutive run-in passes required with shifted surfaces
RUN_IN = 0.01  # of the volume added by the first pass: surfaces are run in if a pass adds less
MEANS = ("contact_share", "contact_length", "contact_area", "thin_share", "friction_coefficient")


def pass_summary(result: Result) -> dict[str, Any]:
    """Roughness and depths at the end of a pass, and means over the time that both surfaces fill the contact.

    In SI units; a surface that is not stored is None.
    """
    steps, weights = result.steps, filled_weights(result)
    values = {name: mean(result, name, weights) for name in MEANS if name in result.scalars}
    summary = {name: value if np.isfinite(value) else None for name, value in values.items()}
    summary |= {"p_max": float(steps("p_max").max()), "newton": int(steps("newton").sum())}
    summary |= {name: float(steps(name)[-1]) for name in result.scalars if name.endswith("_volume")}
    summary.setdefault("set_volume", 0.0)
    return summary | {side: statistics(result, side) for side in ("1", "2")}


def heights(result: Result, side: str) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    """Body points, original heights and heights after the pass [m]; None: not stored."""
    name = f"surface/{side}"
    if f"{name}/s" not in result:
        return None
    s, z = result[f"{name}/s"][:], result[f"{name}/z"][:]
    places = [key.replace("surface", name, 1) for key in OTHERS if key.startswith("surface/")]
    depths = [result[place][:] for place in places[2:] if place in result]  # without s and z
    return s, z, z - sum(depths)


def statistics(result: Result, side: str) -> dict[str, float] | None:
    """Ra, Rq [m], Rsk and maximum indentation [m] of a surface after a pass."""
    surface = heights(result, side)
    if surface is None:
        return None
    _, z, z_after = surface
    height = z_after - z_after.mean()
    rq = float(np.sqrt((height**2).mean()))
    return {
        "ra": float(np.abs(height).mean()),
        "rq": rq,
        "rsk": float(((height / rq) ** 3).mean()) if rq > 0.0 else 0.0,
        "deepest": float((z - z_after).max()),
    }


def passes_to_run_in(rows: list[dict], in_a_row: int = 1) -> int | None:
    """First of the passes that all add less than `RUN_IN` of the first pass's volume; None: not run in.

    `rows` are the entries of the index from the first pass on, with the number "pass" and the volume "added".
    `in_a_row` such passes are required: with shifted surfaces, a pass that adds little may be an exception.
    """
    if not rows or rows[0]["pass"] != 1 or rows[0]["added"] <= 0.0:
        return None
    small = list(takewhile(lambda row: row["added"] < RUN_IN * rows[0]["added"], reversed(rows)))
    return small[-1]["pass"] if len(small) >= in_a_row else None
