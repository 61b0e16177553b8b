"""Picture of the regimes: where wear wins, where fatigue, over two keys of a series, panels of others."""

import itertools
import json

import numpy as np

from ehlpetsc.errors import OutputError
from ehlpetsc.life.regimes import FATIGUE, NEITHER, WEAR
from ehlpetsc.results.atomic_write import replacing

MARKS = {FATIGUE: ("v", "#cc3311"), WEAR: ("o", "#0077bb"), NEITHER: ("s", "#bbbbbb")}
LABELS = {
    "wear.coefficient": "specific wear rate k [m²/N]",
    "contact.boundary_friction": "boundary friction",
    "contact.asperity_height": "sigma [m]",
}
LEGEND = 0.08  # of the height, below the panels
REACH = 2.0  # of the colours: powers of ten of the damage ahead on either side of 1


def read_index(path):
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


def draw_regimes(index, path):
    """Draw the index of a series of lives.

    Parameters
    ----------
    index : dict
        As of :func:`read_index`.
    path : path-like
    """
    from matplotlib import pyplot

    keys, rows = index["keys"], index["members"]
    values = [sorted({row["value"][k] for row in rows}) for k in range(len(keys))]
    panels = list(itertools.product(*values[2:]))
    figure = pyplot.figure(figsize=(2.6 + 3.6 * len(panels), 4.2), layout="constrained")
    figure.get_layout_engine().set(rect=(0.0, LEGEND, 1.0, 1.0 - LEGEND))
    grid = figure.subplots(1, len(panels), squeeze=False, sharey=True)[0]
    for axes, panel in zip(grid, panels, strict=True):
        chosen = [row for row in rows if tuple(row["value"][2:]) == panel]
        image = _panel(axes, keys, values, chosen)
        named = (f"{_label(key)} {value:g}" for key, value in zip(keys[2:], panel, strict=True))
        axes.set_title(", ".join(named), fontsize=9)
    figure.colorbar(image, ax=list(grid), label="log10 of the damage of a cell\nwhen wear reaches it")
    handles = [
        pyplot.Line2D([], [], ls="", marker=mark, mfc="none", mec=colour, mew=2.0, ms=9.0, label=label)
        for (mark, colour), label in zip(
            MARKS.values(), ("fatigue wins: pits", "wear wins: D stays below 1", "neither yet"), strict=True
        )
    ]
    figure.legend(handles=handles, loc="lower center", ncols=3, fontsize=8)
    figure.suptitle(index["title"], fontsize=10)
    try:
        with replacing(path, keep_ending=True) as beside:
            figure.savefig(beside, dpi=130)
    finally:
        pyplot.close(figure)


def _panel(axes, keys, values, rows):
    """Cells of equal size, one for each pair of values; returns the image of the colours."""
    count = len(values[1]) if len(keys) > 1 else 1
    ahead = np.full((count, len(values[0])), np.nan)
    for row in rows:
        x = values[0].index(row["value"][0])
        y = values[1].index(row["value"][1]) if len(keys) > 1 else 0
        ahead[y, x] = REACH if row["damage_ahead"] is None else np.log10(max(row["damage_ahead"], 1e-99))
        mark, colour = MARKS[row["winner"]]
        axes.plot(x, y + 0.14, mark, mfc="white", mec=colour, mew=2.0, ms=11.0)
        note = f"D {row['damage']:.2g}"
        if row["winner"] == FATIGUE:
            note = f"{row['pitted_share']:.0%} pitted,\nfrom {row['first_failure']:.1g}"
        box = {"fc": "w", "ec": "none", "pad": 1}
        axes.text(x, y - 0.18, note, ha="center", va="center", fontsize=7, bbox=box)
    image = axes.imshow(
        ahead, origin="lower", aspect="auto", vmin=-REACH, vmax=REACH, cmap="RdBu_r", alpha=0.7
    )
    axes.set_xticks(range(len(values[0])), [f"{value:g}" for value in values[0]])
    axes.set_xlabel(_label(keys[0]))
    if len(keys) > 1:
        axes.set_yticks(range(count), [f"{value:g}" for value in values[1]])
        axes.set_ylabel(_label(keys[1]))
    else:
        axes.set_yticks([])
    return image


def _label(key):
    return LABELS.get(key, key)
