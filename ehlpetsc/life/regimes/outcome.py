"""Winning mechanism of a life, and its figures for the index."""

import numpy as np

WEAR, FATIGUE, NEITHER = "wear", "fatigue", "neither"


def winner(life):
    """Mechanism that wins a life: "fatigue", "wear" or "neither".

    Fatigue: cells at the surface have broken out, or failed if `pits` is false. Wear: none has, and at the
    rates of the last solved round every cell reaches the surface with a damage below 1. Neither: damage would
    reach 1 after the end of the life.

    Parameters
    ----------
    life : history.LifeHistory
    """
    if any(life(f"pits_{k}")[-1] for k in (1, 2)):
        return FATIGUE
    ahead = max(life(f"damage_ahead_{k}")[-1] for k in (1, 2))
    return WEAR if ahead < 1.0 else NEITHER


def outcome(life):
    """Figures of a life for the index.

    Parameters
    ----------
    life : history.LifeHistory

    Returns
    -------
    dict
        "winner", "passes" and "solved"; of both surfaces the largest pitted share and damage; "worn_depth",
        the mean of the columns that are worn most [m]; "ra_change" of surface 1; "first_failure" in passes,
        None where no cell fails; "damage_ahead" as of `body.LifeBody.damage_ahead`, None without wear.
    """
    last, bodies = life.rows[-1], life.bodies[-1]
    new = float(np.abs(bodies[0].height - bodies[0].height.mean()).mean())
    return {
        "winner": winner(life),
        "passes": last["passes"],
        "solved": life.solved,
        "first_failure": _number(life.first_failure),
        "pitted_share": max(last["pitted_share_1"], last["pitted_share_2"]),
        "damage": max(max(life("damage_1")), max(life("damage_2"))),
        "damage_ahead": _number(max(last["damage_ahead_1"], last["damage_ahead_2"])),
        "worn_depth": max(float(body.wear.mean()) for body in bodies),
        "ra_change": last["ra_1"] / new - 1.0 if new else None,
        "friction": last["friction"],
    }


def _number(value):
    """A number for JSON; None: infinite."""
    return float(value) if np.isfinite(value) else None
