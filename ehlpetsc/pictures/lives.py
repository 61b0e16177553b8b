"""Picture of a life."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.figure import Figure

from ehlpetsc.pictures import style

if TYPE_CHECKING:
    from ehlpetsc.life.history import LifeBody, LifeHistory

SHOWN_INSTANTS = 3  # instants of the life
SHOWN_DAMAGE = 0.1  # of the maximum: cells with as much are within the picture
MIN_LOG_DAMAGE = -3.0  # log10 of the damage at the lower end of the colours


def draw(life: LifeHistory, path: Path) -> None:
    """Draw a life and save the picture."""
    if not life.rows:
        raise OSError(f"{path}: not written, no pass is solved yet")
    figure = Figure(figsize=(11.0, 8.5), layout="constrained")
    top, bottom = figure.subfigures(2, 1, height_ratios=(2, 1))
    chosen = style.spread(len(life.rows), SHOWN_INSTANTS)
    above = top.subplots(2, len(chosen), squeeze=False)
    for row, column in zip(chosen, above.T, strict=True):
        for k, axes in enumerate(column):
            image = under_profile(axes, life.bodies[row][k])
            axes.set_title(f"surface {k + 1}, {life.rows[row]['passes']:,} passes", fontsize="small")
    top.colorbar(image, ax=above, label="log10 D", shrink=0.6)
    passes = life("passes")
    panels = (
        ("pitted_share", "pitted share", 1.0),
        ("wear_volume", "worn [µm²]", 1e12),
        ("ra", "Ra [µm]", 1e6),
        ("friction", "friction", 1.0),
    )
    for axes, (name, label, unit) in zip(bottom.subplots(1, len(panels)), panels, strict=True):
        if name == "friction":
            axes.plot(passes - life("jump") + 1, life(name), ".-", color=style.SINGLE)
        else:
            for side, marks in (("2", ".-"), ("1", ".--")):  # 1 dashed above 2
                line = dict(color=style.SURFACES[side], label=f"surface {side}")
                axes.plot(passes, unit * life(f"{name}_{side}"), marks, **line)
            axes.legend(fontsize="x-small")
        axes.set(xlim=(0.0, 1.05 * passes[-1]), xlabel="passes", ylabel=label)
    named = tomllib.loads(life.case)["contact"].get("material") or []
    steels = ", ".join(dict.fromkeys([named] if isinstance(named, str) else named))
    figure.suptitle(f"{life.title} ({steels})" if steels else life.title)
    style.save(figure, path)


def under_profile(axes: Axes, body: LifeBody) -> ScalarMappable:
    """Damage of the cells that are left below the present profile; returns the image."""
    micro = 1e6
    damage = np.where(body.is_there, body.damage, np.nan)
    with np.errstate(divide="ignore"):
        values = np.clip(np.log10(damage), MIN_LOG_DAMAGE, 0.0)
    # columns of one height each: cells hang below the profile as made
    s, edges = np.repeat(micro * body.faces(), 2)[1:-1], micro * body.edges
    top = micro * np.repeat(body.height, 2)
    image = axes.pcolormesh(
        np.broadcast_to(s, (len(edges), len(s))),
        top - edges[:, None],
        np.repeat(values, 2, axis=1)[:, :-1],
        vmin=MIN_LOG_DAMAGE,
        vmax=0.0,
        cmap="magma_r",
    )
    present = micro * np.repeat(body.profile, 2)
    axes.fill_between(s, present, top, color="w", lw=0.0)  # the worn part of a cell that is left
    axes.plot(s, present, "k", lw=0.8)
    axes.locator_params(axis="x", nbins=5)
    most = body.damage.max(axis=1)
    deep = 1.5 * edges[1 + np.flatnonzero(most >= SHOWN_DAMAGE * most.max())[-1]]
    axes.set(xlabel="s [µm]", ylabel="height [µm]", ylim=(top.min() - deep, top.max() + 0.1 * deep))
    return image
