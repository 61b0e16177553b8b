"""Ensembles over seeds: a dot for every run, mean and bootstrap interval."""

import numpy as np
from matplotlib.lines import Line2D

from ehlpetsc.analysis.ensemble import CONFIDENCE, bootstrap, ensembles
from ehlpetsc.errors import OutputError
from ehlpetsc.pictures.labels import SINGLE_COLOUR, UNITS, legend_beside, new_figure

RUNS_COLOUR = "0.6"
PANEL_SIZE = (3.1, 2.4)  # inches
COLUMNS = 3
PANELS = {  # scalar: label, factor from SI units
    "friction_coefficient": ("friction coefficient", 1.0),
    "film_central": ("mean central film [µm]", 1e6),
    "mean_gap_ratio": ("mean gap over the combined Rq", 1.0),
    "h_min": ("least film [µm]", 1e6),
    "p_max": ("largest pressure [GPa]", 1e-9),
    "contacts": ("nodes in contact", 1.0),
    "contact_share": ("share of the load\non the solids", 1.0),
    "contact_length": ("length in contact [µm]", 1e6),
    "thin_length": ("length of thin film [µm]", 1e6),
}


def draw_ensemble(results, _options):
    """Figure of the scalars of runs, one panel each, over the key that differs apart from seeds."""
    all_ensembles = ensembles(results)
    names = [name for name in PANELS if all(name in ensemble.scalars for ensemble in all_ensembles)]
    if not names:
        raise OutputError("no scalar that all runs have")
    rows = -(-len(names) // COLUMNS)
    figure, axes = new_figure(
        rows, COLUMNS, (PANEL_SIZE[0] * COLUMNS + 1.2, PANEL_SIZE[1] * rows), squeeze=False
    )
    abscissae, label, ticks = _abscissae(all_ensembles)
    for panel, name in zip(axes.flat, names, strict=False):
        _draw_panel(panel, all_ensembles, abscissae, name)
        panel.set_xlabel(label, fontsize="small")
        panel.set_xlim(_margins(abscissae))
        if ticks:
            rotation = 20 if max(map(len, ticks)) > 6 else 0
            panel.set_xticks(abscissae, ticks, rotation=rotation, fontsize="small")
    for panel in axes.flat[len(names) :]:
        panel.set_axis_off()
    handles = [
        Line2D([], [], color=RUNS_COLOUR, marker="o", ls="", ms=3, label="one run"),
        Line2D([], [], color=SINGLE_COLOUR, marker="o", ms=5, label=_mean_and_interval()),
    ]
    legend_beside(axes[0, -1], handles)
    figure.suptitle(results[0].attrs["title"], fontsize="medium")
    return figure


def _mean_and_interval():
    return f"mean and its\n{100 * CONFIDENCE:g} % interval\n(bootstrap)"


def _abscissae(all_ensembles):
    """Abscissas of the ensembles, their label, and tick labels if they are not numbers."""
    keys = list(all_ensembles[0].values)
    if len(keys) == 1:
        values = [ensemble.values[keys[0]] for ensemble in all_ensembles]
        if all(isinstance(value, int | float) for value in values):
            return [float(v) for v in values], UNITS.get(keys[0], keys[0]), None
    if len(all_ensembles) == 1:
        return [0.0], f"{len(next(iter(all_ensembles[0].scalars.values())))} runs", [" "]
    return list(map(float, range(len(all_ensembles)))), "", [ensemble.name for ensemble in all_ensembles]


def _margins(abscissae):
    span = (max(abscissae) - min(abscissae)) or 1.0
    return min(abscissae) - 0.3 * span, max(abscissae) + 0.3 * span


def _draw_panel(panel, all_ensembles, abscissae, name):
    label, factor = PANELS[name]
    low, high = _margins(abscissae)
    shift = 0.02 * (high - low)
    for x, ensemble in zip(abscissae, all_ensembles, strict=True):
        values = factor * ensemble.scalars[name]
        panel.plot(np.full(values.size, x - shift), values, "o", color=RUNS_COLOUR, ms=3, mew=0)
        mean, ends = values.mean(), bootstrap(values)
        panel.plot(x + shift, mean, "o", color=SINGLE_COLOUR, ms=5)
        if np.isfinite(ends).all():
            panel.vlines(x + shift, *ends, color=SINGLE_COLOUR, lw=1.6)
    panel.set_ylabel(label, fontsize="small")
    panel.grid(axis="y", lw=0.3)
