"""Running in: surfaces and contact after each pass."""

import numpy as np

from ehlpetsc.quantities import OTHERS, STEP_SCALARS

DEPTHS = [name.removeprefix("surface/") for name in OTHERS if name.startswith("surface/")][2:]
SHIFTED_IN_A_ROW = 10  # passes of surfaces that are shifted from pass to pass
RUN_IN = 0.01  # of what the first pass has added: a pass that adds less changes the surfaces no more
MEANS = ("contact_share", "contact_length", "thin_share", "friction_coefficient")


def pass_summary(result, begin):
    """Roughness and depths at the end of a pass, and means over the time that both surfaces fill the contact.

    Parameters
    ----------
    result : results.reader.Result
    begin : float
        Time from which both surfaces fill the contact [s].

    Returns
    -------
    dict
        SI units; a surface is None where it is not stored.
    """
    steps = result.steps
    dt = np.where(steps("time") >= begin, steps("dt"), 0.0)
    names = [name for name in MEANS if name in result.scalars]
    found = {name: float((steps(name) * dt).sum() / dt.sum()) if dt.any() else None for name in names}
    found |= {"p_max": float(steps("p_max").max()), "newton": int(steps("newton").sum())}
    found["halved"] = int(np.count_nonzero(steps("retries")))
    found |= {name: float(steps(name)[-1]) for name in result.scalars if STEP_SCALARS[name].units == "m^2"}
    found.setdefault("set_volume", 0.0)
    return found | {side: statistics(result, side) for side in ("1", "2")}


def heights(result, side):
    """Body points, heights as made and after the pass [m]; None: not stored."""
    name = f"surface/{side}"
    if f"{name}/s" not in result:
        return None
    s, z = result[f"{name}/s"][:], result[f"{name}/z"][:]
    depths = [result[f"{name}/{depth}"][:] for depth in DEPTHS if f"{name}/{depth}" in result]
    return s, z, z - sum(depths)


def statistics(result, side):
    """Ra, Rq [m], Rsk, largest slope and deepest indentation [m] of a surface after a pass."""
    found = heights(result, side)
    if found is None:
        return None
    s, z, left = found
    height = left - left.mean()
    rq = float(np.sqrt((height**2).mean()))
    return {
        "ra": float(np.abs(height).mean()),
        "rq": rq,
        "rsk": float(((height / rq) ** 3).mean()) if rq > 0.0 else 0.0,
        "slope": float(np.abs(np.diff(left) / np.diff(s)).max()),
        "deepest": float((z - left).max()),
    }


def passes_to_run_in(rows, in_a_row=1):
    """Number of the pass from which on each adds less than `RUN_IN` of what the first one added; None: none.

    Parameters
    ----------
    rows : list of dict
        Of the passes from the first on, each with its number, "pass", and the volume it "added".
    in_a_row : int
        Passes that it takes: where the surfaces are shifted from pass to pass, one that adds little may be
        followed by others.
    """
    if not rows or rows[0]["pass"] != 1 or rows[0]["added"] <= 0.0:
        return None
    found = None
    for row in reversed(rows):
        if row["added"] >= RUN_IN * rows[0]["added"]:
            break
        found = row["pass"]
    return found if found and len(rows) - found + 1 >= in_a_row else None
