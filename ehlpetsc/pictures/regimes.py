"""Picture of the regimes, wear or fatigue, over two keys of a series; a panel for each value of others."""

import itertools
import json

import numpy as np

from ehlpetsc.errors import OutputError
from ehlpetsc.results.atomic_write import replacing

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
        axes.set_title(", ".join(map(_setting, keys[2:], panel)), fontsize=9)
    bar = figure.colorbar(image, ax=list(grid), label="D of a cell when wear reaches it", extend="both")
    powers = np.arange(-COLOUR_DECADES, COLOUR_DECADES + 1.0)
    bar.set_ticks(powers, labels=[f"{10.0**power:g}" for power in powers])
    handles = [
        pyplot.Line2D([], [], ls="", marker=mark, mfc="none", mec=colour, mew=2.0, ms=9.0, label=label)
        for mark, colour, label in MARKS.values()
    ]
    figure.legend(handles=handles, loc="lower center", ncols=3, fontsize=8)
    solved = max(row["solved"] for row in rows)
    figure.suptitle(f"{index['title']}; {solved} solved passes of each life at most", fontsize=10)
    try:
        with replacing(path, keep_ending=True) as temporary:
            figure.savefig(temporary, dpi=130)
    finally:
        pyplot.close(figure)


def _panel(axes, keys, values, rows):
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


def _label(key):
    name, unit, _ = LABELS.get(key, (key, "", 1.0))
    return f"{name} [{unit}]" if unit else name


def _numbers(key, values):
    return [f"{value / LABELS.get(key, (key, '', 1.0))[2]:g}" for value in values]


def _setting(key, value):
    """Title of a panel: a key and its value."""
    name, unit, _ = LABELS.get(key, (key, "", 1.0))
    return f"{name} {_numbers(key, [value])[0]} {unit}".rstrip()
