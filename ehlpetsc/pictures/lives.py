"""Picture of a life."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.figure import Figure, FigureBase

from ehlpetsc.pictures import style

if TYPE_CHECKING:
    from ehlpetsc.life.history import LifeBody, LifeHistory

Bands = dict[str, tuple[np.ndarray, np.ndarray]]
SHOWN_INSTANTS = 3  # instants of the life
SHOWN_DAMAGE = 0.1  # of the maximum: cells with as much are within the picture
PANELS = (  # over the passes: figure, label, factor
    ("damaged_share", "damaged share", 1.0),
    ("pitted_share", "pitted share", 1.0),
    ("wear_volume", "worn [µm²]", 1e12),
    ("friction", "friction", 1.0),
)
DAMAGE_COLOURS = dict(vmin=-3.0, vmax=0.0, cmap="magma_r")  # of log10 of the damage


def draw(life: LifeHistory, path: Path) -> None:
    """Draw a life and save the picture."""
    if not life.rows:
        raise OSError(f"{path}: not written, no pass is solved yet")
    has_rows = life.bodies[0][0].y.size > 0
    figure = Figure(figsize=(11.0, 12.0 if has_rows else 8.5), layout="constrained")
    top, bottom = figure.subfigures(2, 1, height_ratios=(3 if has_rows else 2, 1))
    chosen = style.spread(len(life.rows), SHOWN_INSTANTS)
    draw_bodies = _maps if has_rows else _sections
    draw_bodies(top, life, chosen)
    passes = life("passes")
    for axes, (name, label, unit) in zip(bottom.subplots(1, len(PANELS)), PANELS, strict=True):
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
    title = f"{life.title} ({steels})" if steels else life.title
    figure.suptitle(f"{title}\n{smooth_label(life)}")
    style.save(figure, path)


def smooth_label(life: LifeHistory) -> str:
    """Passes after which the smooth contact fails, and the depths."""
    figures, texts = life.rows[-1], []
    for k in (1, 2):
        passes, depth = figures[f"smooth_life_{k}"], 1e6 * figures[f"smooth_depth_{k}"]
        texts.append(f"{passes:.3g} passes {depth:.3g} µm deep")
    return f"smooth contact: fails after {' and '.join(dict.fromkeys(texts))}"


def draw_ensembles(title: str, ensembles: dict[str, Bands], path: Path) -> None:
    """Draw means over the lives of each ensemble and their bounds (90 %), over the passes.

    `ensembles`: by name passes (n,) and mean and bounds (3, n) of each figure.
    """
    figure, panels = style.new_figure(1, len(PANELS), (11.0, 3.2))
    colours = style.shades(len(ensembles))
    for axes, (name, label, unit) in zip(panels, PANELS, strict=True):
        for (others, bands), shade in zip(ensembles.items(), colours, strict=True):
            sides = ("",) if name == "friction" else ("1", "2")
            for side in sides:
                passes, values = bands[f"{name}_{side}".rstrip("_")]
                colour = shade if len(ensembles) > 1 else style.SURFACES.get(side, style.SINGLE)
                label_of = ", ".join(filter(None, (others, f"surface {side}" if side else "")))
                axes.plot(
                    passes, unit * values[0], "--" if side == "1" else "-", color=colour, label=label_of
                )
                axes.fill_between(passes, *(unit * values[1:]), color=colour, alpha=0.2, lw=0.0)
        axes.set(xlabel="passes", ylabel=label, xlim=(0.0, None))
    panels[0].legend(fontsize="x-small")
    style.set_title(figure, title)
    style.save(figure, path)


def _heading(life: LifeHistory, row: int, k: int) -> str:
    return f"surface {k + 1}, {life.rows[row]['passes']:,} passes"


def _sections(figure: FigureBase, life: LifeHistory, chosen: np.ndarray) -> None:
    """Cells below both profiles of a line at some instants."""
    above = figure.subplots(2, len(chosen), squeeze=False)
    for row, column in zip(chosen, above.T, strict=True):
        for k, axes in enumerate(column):
            image = under_profile(axes, life.bodies[row][k])
            axes.set_title(_heading(life, row, k), fontsize="small")
    figure.colorbar(image, ax=above, label="log10 D", shrink=0.6)


def _maps(figure: FigureBase, life: LifeHistory, chosen: np.ndarray) -> None:
    """Damage in the most damaged layer of cells and depth of pits of both surfaces of a strip."""
    axes = figure.subplots(4, len(chosen), squeeze=False, sharey="row")
    layers = [worst_layer(body) for body in life.bodies[chosen[-1]]]
    deepest = max(1e6 * body.pit.max() for body in life.bodies[chosen[-1]])
    for row, column in zip(chosen, axes.T, strict=True):
        for k, (body, layer) in enumerate(zip(life.bodies[row], layers, strict=True)):
            of_damage, of_pits = column[2 * k : 2 * k + 2]
            depth = 0.5e6 * body.edges[layer : layer + 2].sum()
            damages = _map(of_damage, body, log_damage(body)[layer], **DAMAGE_COLOURS)
            of_damage.set_title(f"{_heading(life, row, k)}, D {depth:.2g} µm deep", fontsize="small")
            pits = _map(of_pits, body, 1e6 * body.pit, vmin=0.0, vmax=deepest or 1.0, cmap="cividis")
            share = 100.0 * body.pitted_share
            of_pits.set_title(f"{body.pits} pits, {share:.2g} % of the surface", fontsize="small")
    figure.colorbar(damages, ax=axes, label="log10 D", shrink=0.5)
    figure.colorbar(pits, ax=axes, label="depth of pits [µm]", shrink=0.5)
    for one in axes[:, 0]:
        one.set_ylabel("y [µm]")
    for one in axes[-1]:
        one.set_xlabel("s [µm]")


def log_damage(body: LifeBody) -> np.ndarray:
    """log10 of the damage of the cells within the ends of the colours; nan of cells that are gone."""
    with np.errstate(divide="ignore"):
        powers = np.log10(np.where(body.is_there, body.damage, np.nan))
    return np.clip(powers, DAMAGE_COLOURS["vmin"], DAMAGE_COLOURS["vmax"])


def worst_layer(body: LifeBody) -> int:
    """Layer with the maximum damage of cells that are not gone."""
    return int(np.max(body.damage, axis=(1, 2), initial=0.0, where=body.is_there).argmax())


def _map(axes: Axes, body: LifeBody, values: np.ndarray, **limits: Any) -> ScalarMappable:
    """Map over the columns of a strip, s to the right."""
    half = 0.5 * body.widths[0]
    s, y = 1e6 * body.faces(), 1e6 * np.append(body.y - half, body.y[-1] + half)
    axes.set_facecolor("0.8")  # cells that are gone
    axes.locator_params(axis="x", nbins=5)
    return axes.pcolormesh(s, y, values, rasterized=True, **limits)


def under_profile(axes: Axes, body: LifeBody) -> ScalarMappable:
    """Damage of the cells that are left below the present profile; returns the image."""
    micro = 1e6
    # columns of one height each: cells hang below the profile as made
    s, edges = np.repeat(micro * body.faces(), 2)[1:-1], micro * body.edges
    top = micro * np.repeat(body.height, 2)
    image = axes.pcolormesh(
        np.broadcast_to(s, (len(edges), len(s))),
        top - edges[:, None],
        np.repeat(log_damage(body), 2, axis=1)[:, :-1],
        **DAMAGE_COLOURS,
    )
    present = micro * np.repeat(body.profile, 2)
    axes.fill_between(s, present, top, color="w", lw=0.0)  # the worn part of a cell that is left
    axes.plot(s, present, "k", lw=0.8)
    axes.locator_params(axis="x", nbins=5)
    most = body.damage.max(axis=1)
    deep = 1.5 * edges[1 + np.flatnonzero(most >= SHOWN_DAMAGE * most.max())[-1]]
    axes.set(xlabel="s [µm]", ylabel="height [µm]", ylim=(top.min() - deep, top.max() + 0.1 * deep))
    return image
