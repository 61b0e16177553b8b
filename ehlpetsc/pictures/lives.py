"""Pictures of a life and its movie; regimes of wear and fatigue of a series of lives."""

from __future__ import annotations

import itertools
import json
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ehlpetsc.base.errors import OutputError
from ehlpetsc.pictures import style
from ehlpetsc.pictures.over_time import grab, recording

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.cm import ScalarMappable

    from ehlpetsc.life.history import LifeBody, LifeHistory


SHOWN_INSTANTS = 3  # instants of the life
MIN_LOG_DAMAGE = -3.0  # log10 of the damage at the lower end of the colours


def draw(life: LifeHistory, path: Path) -> None:
    """Draw a life and save the picture."""
    if not life.rows:
        raise OSError(f"{path}: not written, no pass is solved yet")
    figure = Figure(figsize=(11.0, 8.5), layout="constrained")
    top, bottom = figure.subfigures(2, 1, height_ratios=(2, 1))
    chosen = np.unique(np.linspace(0, len(life.rows) - 1, SHOWN_INSTANTS).round().astype(int))
    above = []
    for column, row in enumerate(chosen):
        for k in range(2):
            above.append(top.add_subplot(2, len(chosen), k * len(chosen) + column + 1))
            image = under_profile(above[-1], life.bodies[row][k])
            above[-1].set_title(f"surface {k + 1}, {life.rows[row]['passes']:,} passes", fontsize="small")
    top.colorbar(image, ax=above, label="log10 D", shrink=0.6)
    passes = life("passes")
    panels = (
        ("pitted_share", "pitted share", 1.0),
        ("wear_volume", "worn [µm²]", 1e12),
        ("ra", "Ra [µm]", 1e6),
        ("friction", "friction", 1.0),
    )
    for column, (name, label, unit) in enumerate(panels):
        axes = bottom.add_subplot(1, 4, column + 1)
        if name == "friction":
            axes.plot(passes - life("jump") + 1, life(name), ".-", color=style.SINGLE)
        else:
            for side, marks in (("2", ".-"), ("1", ".--")):  # 1 dashed above 2
                line = dict(color=style.SURFACES[side], label=f"surface {side}")
                axes.plot(passes, unit * life(f"{name}_{side}"), marks, **line)
            axes.legend(fontsize="x-small")
        axes.set(xlim=(0.0, 1.05 * passes[-1]), xlabel="passes", ylabel=label)
    figure.suptitle(life.title)
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
    span = max(np.ptp(top), edges[1])
    axes.set(xlabel="s [µm]", ylabel="height [µm]", ylim=(top.min() - 4.0 * span, top.max() + 0.3 * span))
    return image


FRAMES_PER_ROUND = 3  # frames that a round is shown


def save_movie(life: LifeHistory, path: Path) -> None:
    """Write the movie.

    Parameters
    ----------
    path
        GIF, or MP4 and WebM where ffmpeg is installed.

    Raises
    ------
    OutputError
    """
    if not life.rows:
        raise OSError(f"{path}: not written, no pass is solved yet")
    figure = Figure(figsize=(9.0, 6.5), layout="constrained")
    grid = figure.subplots(3, 1, height_ratios=(3, 3, 2))
    with recording(figure, path) as writer:
        for row in range(len(life.rows)):
            _draw(figure, grid, life, row)
            for _ in range(FRAMES_PER_ROUND):
                grab(figure, writer)


def _draw(figure: Figure, grid: np.ndarray, life: LifeHistory, row: int) -> None:
    for axes in grid:
        axes.clear()
    for k, axes in enumerate(grid[:2]):
        image = under_profile(axes, life.bodies[row][k])
        axes.set_title(f"surface {k + 1}", fontsize="small")
    if row == 0:
        figure.colorbar(image, ax=list(grid[:2]), label="log10 D")
    passes = life("passes")
    for side, colour in style.SURFACES.items():
        for name, words, dashes in (("damage", "maximum D", "-"), ("pitted_share", "pitted share", "--")):
            label = f"{words}, surface {side}"
            grid[2].plot(passes, life(f"{name}_{side}"), dashes, color=colour, lw=1.0, label=label)
    grid[2].axvline(passes[row], color="k", lw=0.8)
    top = 1.05 * max(
        1.0, *(np.max(life(f"{name}_{k}")) for name in ("damage", "pitted_share") for k in (1, 2))
    )
    grid[2].set(xlabel="passes", ylabel="D, share", ylim=(0.0, min(top, 2.0)))
    grid[2].legend(fontsize="x-small", loc="upper left")
    figure.suptitle(f"{life.title}: {passes[row]:,} passes", fontsize=10)


MARKS = {  # shape, colour, label
    "fatigue": ("v", "#cc3311", "fatigue wins: pits"),
    "wear": ("o", "#0077bb", "wear wins: D stays below 1"),
    "neither": ("s", "#bbbbbb", "neither yet: no pits, but D would reach 1"),
}
LABELS = {  # of a key: its name, unit, and the unit's size
    "wear.coefficient": ("specific wear rate k", "m²/N", 1.0),
    "contact.boundary_friction": ("boundary friction", "", 1.0),
    "contact.asperity_height": ("sigma", "nm", 1e-9),
}
LEGEND = 0.08  # of the height, below the panels
COLOUR_DECADES = 2.0  # of the colours: powers of ten of the damage ahead on either side of 1


def read_index(path: Path) -> dict:
    """The index of the lives of a series.

    Raises
    ------
    OutputError
        It is none, or no life in it has begun.
    """
    try:
        index = json.loads(path.read_text())
        rows = [row for row in index["members"] if "winner" in row]
        keys = list(index["keys"])
        for row in rows:
            row["value"] = list(row["value"]) if len(keys) > 1 else [row["value"]]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise OutputError(f"{path}: not an index of lives ({error})") from None
    if not rows:
        raise OutputError(f"{path}: no life in it has begun")
    return index | {"keys": keys, "members": rows}


def draw_regimes(index: dict, path: Path) -> None:
    """Draw the index of a series of lives.

    Parameters
    ----------
    index
        As of :func:`read_index`.
    """
    keys, rows = index["keys"], index["members"]
    values = [sorted({row["value"][k] for row in rows}) for k in range(len(keys))]
    panels = list(itertools.product(*values[2:]))
    figure = Figure(figsize=(2.6 + 3.6 * len(panels), 4.2), layout="constrained")
    figure.get_layout_engine().set(rect=(0.0, LEGEND, 1.0, 1.0 - LEGEND))
    grid = figure.subplots(1, len(panels), squeeze=False, sharey=True)[0]
    for axes, panel in zip(grid, panels, strict=True):
        chosen = [row for row in rows if tuple(row["value"][2:]) == panel]
        image = _panel(axes, keys, values, chosen)
        axes.set_title(", ".join(map(_setting, keys[2:], panel)), fontsize=9)
    bar = figure.colorbar(image, ax=list(grid), label="D of a cell when wear reaches it", extend="both")
    powers = np.arange(-COLOUR_DECADES, COLOUR_DECADES + 1.0)
    bar.set_ticks(powers, labels=[f"{10.0**power:g}" for power in powers])
    handles = [
        Line2D([], [], ls="", marker=mark, mfc="none", mec=colour, mew=2.0, ms=9.0, label=label)
        for mark, colour, label in MARKS.values()
    ]
    figure.legend(handles=handles, loc="lower center", ncols=3, fontsize=8)
    solved = max(row["solved"] for row in rows)
    figure.suptitle(f"{index['title']}; {solved} solved passes of each life at most", fontsize=10)
    style.save(figure, path)


def _panel(axes: Axes, keys: list[str], values: list[list[float]], rows: list[dict]) -> ScalarMappable:
    """Cells of equal size, one for each pair of values; returns the image of the colours."""
    count = len(values[1]) if len(keys) > 1 else 1
    ahead = np.full((count, len(values[0])), np.nan)
    for row in rows:
        x = values[0].index(row["value"][0])
        y = values[1].index(row["value"][1]) if len(keys) > 1 else 0
        unworn = row["damage_ahead"] is None
        ahead[y, x] = COLOUR_DECADES if unworn else np.log10(max(row["damage_ahead"], 1e-99))
        mark, colour, _ = MARKS[row["winner"]]
        axes.plot(x, y + 0.14, mark, mfc="white", mec=colour, mew=2.0, ms=11.0)
        note = "no wear" if unworn else f"D {row['damage_ahead']:.2g}"
        if row["winner"] == "fatigue":
            note = f"first pit after\n{row['first_failure'] / 1e6:.2g} million"
        box = {"fc": "w", "ec": "none", "pad": 1}
        axes.text(x, y - 0.18, note, ha="center", va="center", fontsize=7, bbox=box)
    image = axes.imshow(
        ahead,
        origin="lower",
        aspect="auto",
        vmin=-COLOUR_DECADES,
        vmax=COLOUR_DECADES,
        cmap="RdBu_r",
        alpha=0.7,
    )
    axes.set_xticks(range(len(values[0])), _numbers(keys[0], values[0]))
    axes.set_xlabel(_label(keys[0]))
    if len(keys) > 1:
        axes.set_yticks(range(count), _numbers(keys[1], values[1]))
        axes.set_ylabel(_label(keys[1]) if axes.get_subplotspec().is_first_col() else "")
    else:
        axes.set_yticks([])
    return image


def _label(key: str) -> str:
    name, unit, _ = LABELS.get(key, (key, "", 1.0))
    return f"{name} [{unit}]" if unit else name


def _numbers(key: str, values: list[float]) -> list[str]:
    return [f"{value / LABELS.get(key, (key, '', 1.0))[2]:g}" for value in values]


def _setting(key: str, value: float) -> str:
    """Title of a panel: a key and its value."""
    name, unit, _ = LABELS.get(key, (key, "", 1.0))
    return f"{name} {_numbers(key, [value])[0]} {unit}".rstrip()
