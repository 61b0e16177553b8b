"""Lines on a life: its smooth contact, and where passes and depths leave the range of the results."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from ehlpetsc.post.level import standard_line

if TYPE_CHECKING:
    from ehlpetsc.case.tables import Case
    from ehlpetsc.life.body import LifeBody
    from ehlpetsc.life.history import LifeHistory
    from ehlpetsc.life.one_pass import OfBody
    from ehlpetsc.results.post_result import SmoothContact

SMOOTH_FIGURES = ("smooth_pressure", *(f"smooth_{name}_{k}" for k in (1, 2) for name in ("life", "depth")))


def smooth_figures(contacts: Sequence[SmoothContact], passes_2: float, pressure: float) -> dict[str, float]:
    """Passes of body 1 after which the smooth contact fails in each body, where [m], and its pressure [Pa].

    `passes_2`: passes of body 2 for each one of body 1.
    """
    found = {"smooth_pressure": pressure}
    for k, (contact, factor) in enumerate(zip(contacts, (1.0, passes_2), strict=True), 1):
        found |= {f"smooth_life_{k}": contact.life / factor, f"smooth_depth_{k}": contact.depth}
    return found


def smooth_lines(figures: dict[str, float]) -> Iterator[str]:
    """Lines on the smooth contact. `figures`: of :func:`smooth_figures`."""
    for k in (1, 2):
        life, depth = (figures[f"smooth_{name}_{k}"] for name in ("life", "depth"))
        yield f"smooth contact: smooth_life_{k}={life:.4g} passes smooth_depth_{k}={depth:.3g} m"
    yield standard_line(figures["smooth_pressure"])


def depth_lines(bodies: Sequence[OfBody], figures: dict[str, float]) -> Iterator[str]:
    """Lines on depths that do not include the worst one.

    `bodies`: of a solved pass. `figures`: of :func:`smooth_figures`.
    """
    for k, body in enumerate(bodies, 1):
        last, depth = body.depths[-1], figures[f"smooth_depth_{k}"]
        if body.damage.reshape(len(body.depths), -1).max(axis=1).argmax() == len(body.depths) - 1:
            yield (
                f"limit: D of surface {k} still rises at the last of post.depths, {last:.3g} m: cells below "
                "fail before"
            )
        if last < depth:
            yield (
                f"note: post.depths end {last:.3g} m below surface {k}, where the smooth contact fails "
                f"{depth:.3g} m deep"
            )


def limits(life: LifeHistory) -> Iterator[str]:
    """Lines on results of a life, at its last row, beyond the smooth contact's life or the last cell."""
    if not life.rows:
        return
    for k, body in enumerate(life.bodies[-1], 1):
        end, depth = (life.rows[-1][f"smooth_{name}_{k}"] for name in ("life", "depth"))
        if life.done > end:
            yield (
                f"limit: of {life.done:.4g} passes those after {end:.4g} exceed the life of the smooth "
                f"contact, which fails {depth:.3g} m below surface {k}"
            )
        if is_pit_cut(body):
            yield (
                f"limit: a pit of surface {k} reaches the last cell, {body.edges[-1]:.3g} m deep: its depth "
                "is that of post.depths"
            )


def wear_lines(life: LifeHistory, case: Case) -> Iterator[str]:
    """Lines on the wear rates of a life: of the load of the solids and of the whole load; limiting ones."""
    share = life.rows[0]["contact_share"] if life.rows else 0.0
    if case.wear is None or not share:  # nothing is worn where the solids carry nothing
        return
    of_solids = case.wear.coefficient or [k / share for k in case.wear.load_coefficient]
    for k, coefficient in enumerate(of_solids, 1):
        yield (
            f"wear, surface {k}: k = {coefficient:.3g} m^2/N of the load of the solids, "
            f"{coefficient * share:.3g} of the whole load; the solids carry {100 * share:.3g} % of it"
        )
        if case.life.break_out == "none" and len(life.rows) > 1:
            before, last = life(f"damage_{k}")[-2:]
            limit = coefficient * life.limiting_wear(k)
            yield (
                f"wear keeps surface {k} from failing from k = {limit:.3g} m^2/N on; D changed by "
                f"{100 * (last / before - 1):.2g} % in the last round"
            )


def is_pit_cut(body: LifeBody) -> bool:
    """Whether a pit ends with the last cell."""
    return bool(np.any((body.pit > 0.0) & (body.recession >= body.edges[-1] * (1.0 - 1e-9))))
