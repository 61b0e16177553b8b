"""The log-log picture of a study: error against wall time and against Newton iterations."""

import numpy as np

MARKERS = "osD^vP"
TITLES = {"film": "local film, max norm", "damage": "damage, decades"}


def draw(rows, path, title):
    """Draw the picture.

    Parameters
    ----------
    rows : list of dict
        Of :meth:`ehlpetsc.study.accuracy.Study.table`, the reference first.
    path : path-like
        PNG file.
    title : str
    """
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    measures = [
        m for m in ("h_min", "h_c", "p_max", "film", "contact", "damage") if any(r[m] > 0.0 for r in rows[1:])
    ]
    figure, axes = plt.subplots(
        2,
        len(measures),
        figsize=(3.4 * len(measures), 6.6),
        sharey="col",
        squeeze=False,
        layout="constrained",
    )
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
    figure.savefig(path, dpi=110)
    plt.close(figure)


def _panel(axis, rows, measure, cost):
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

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
    costs = [r[cost] for r in rows[1:] if r["converged"] == "yes"]
    few = max(costs) < 5.0 * min(costs)
    axis.xaxis.set_major_locator(LogLocator(subs=(1.0, 1.5, 2.0, 3.0, 4.0, 6.0) if few else (1.0, 2.0, 5.0)))
    axis.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.xaxis.set_minor_formatter(NullFormatter())
    axis.grid(True, which="major", lw=0.3)


def _shown(error):
    """Nothing below rounding on a logarithmic axis."""
    return np.nan if not np.isfinite(error) else max(error, 1e-8)
