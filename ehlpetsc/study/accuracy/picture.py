"""Log-log picture of a study: error over wall time and over Newton iterations."""

import numpy as np

from ehlpetsc.results.atomic_write import replacing
from ehlpetsc.study.accuracy.errors import MEASURES

MARKERS = "osD^vP"
MAX_TICKS = 5  # labels of an axis that do not overlap
MANTISSAS = ((1, 1.5, 2, 3, 4, 6, 8), (1, 2, 3, 5), (1, 2, 5), (1, 3), (1,))
TITLES = {"film": "local film, max norm", "damage": "damage, decades"}


def draw(rows, path, title):
    """Draw the picture.

    Parameters
    ----------
    rows : list of dict
        Rows of :meth:`ehlpetsc.study.accuracy.table.Study.table`, the reference first.
    path : path-like
        PNG file.
    title : str
    """
    from matplotlib.figure import Figure

    measures = [m for m in MEASURES if any(row[m] > 0.0 for row in rows[1:])]
    figure = Figure(figsize=(3.4 * len(measures), 6.6), layout="constrained")
    axes = figure.subplots(2, len(measures), sharey="col", squeeze=False)
    figure.suptitle(title)
    for column, measure in enumerate(measures):
        for axis, cost in zip(axes[:, column], ("wall_s", "newton"), strict=True):
            _panel(axis, rows, measure, cost)
        axes[0, column].set_title(TITLES.get(measure, measure))
    for line, label in ((0, "wall time [s]"), (1, "Newton iterations")):
        for axis in axes[line]:
            axis.set_xlabel(label)
        axes[line, 0].set_ylabel("relative error")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.get_layout_engine().set(rect=(0.0, 0.1, 1.0, 0.9))
    figure.legend(handles, labels, loc="lower center", ncols=(len(labels) + 1) // 2, frameon=False)
    with replacing(path, keep_ending=True) as temporary:
        figure.savefig(temporary, dpi=110)


def _panel(axis, rows, measure, cost):
    from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

    base = next(r for r in rows if r["value"] == "as it is")
    varied = dict.fromkeys(r["varied"] for r in rows if r["varied"] not in ("", "reference"))
    for number, name in enumerate(varied):
        chosen = [r for r in rows if r["varied"] == name and r["converged"] == "yes"]
        chosen.sort(key=lambda r: float(r["value"]))
        axis.plot(
            [r[cost] for r in chosen],
            [_shown(r[measure]) for r in chosen],
            marker=MARKERS[number % len(MARKERS)],
            ms=4,
            lw=0.8,
            label=name,
        )
    axis.plot(base[cost], _shown(base[measure]), "k*", ms=11, label="the case as it is")
    axis.axhline(_shown(rows[0][measure]), color="0.5", ls="--", lw=0.8, label="uncertainty of the reference")
    axis.set_xscale("log")
    axis.set_yscale("log")
    for line, limits in ((axis.xaxis, axis.get_xlim()), (axis.yaxis, axis.get_ylim())):
        line.set_major_locator(FixedLocator(ticks(*limits)))
        line.set_minor_locator(NullLocator())
        line.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.grid(True, which="major", lw=0.3)


def ticks(low, high):
    """Round values for a logarithmic axis from `low` to `high`, whose labels do not overlap.

    Returns
    -------
    list of float
        At most `MAX_TICKS`, at least two.
    """
    decades = 10.0 ** np.arange(np.floor(np.log10(low)), np.ceil(np.log10(high)) + 1)
    for mantissas in MANTISSAS:
        values = [d * m for d in decades for m in mantissas if low <= d * m <= high]
        if 2 <= len(values) <= MAX_TICKS:
            return values
    if len(values) > MAX_TICKS:  # many decades: every so many of them
        return values[:: -(-len(values) // MAX_TICKS)]
    step = 10.0 ** np.floor(np.log10((high - low) / 2.0))
    step *= next(m for m in (5, 2, 1) if m * step <= (high - low) / 2.0)
    first = np.ceil(low / step - 1e-9)
    return list(np.arange(first, np.floor(high / step + 1e-9) + 1) * step)


def _shown(error):
    """Error for a logarithmic axis, not below rounding."""
    return np.nan if not np.isfinite(error) else max(error, 1e-8)
