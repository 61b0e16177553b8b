"""Colours, labels and legends of one or several results."""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ehlpetsc.results.index import distinguishing_names, series_values

SINGLE_COLOUR = "#1f4e79"
SECOND_COLOUR = "#b35806"
CONTACT_COLOUR = "#d62728"
SOLIDS_COLOUR = "#e08214"
LEGEND_ENTRIES = 10
UNITS = {
    "fluid.viscosity": "viscosity [Pa s]",
    "motion.entrainment_speed": "entrainment speed [m/s]",
    "motion.slide_roll_ratio": "slide/roll ratio",
    "mesh.points_per_half_width": "nodes per half width",
}


def new_figure(rows, columns, size, **shared):
    """Figure and axes without pyplot, so that a notebook does not display the figure.

    Parameters
    ----------
    rows, columns : int
    size : (float, float)
        Inches.
    **shared
        `sharex`, `sharey`, `squeeze` and `height_ratios` of :meth:`matplotlib.figure.Figure.subplots`.
    """
    figure = Figure(figsize=size, layout="constrained")
    return figure, figure.subplots(rows, columns, **shared)


def series_colours(results):
    """Colours and labels of several results: varied value, otherwise distinguishing names.

    Returns
    -------
    colours, labels : list
    key : str or None
        Key of the series.
    """
    if len(results) == 1:
        return [SINGLE_COLOUR], [results[0].path.stem], None
    key, values = series_values(results)
    # the light end of the colour map is not visible on white
    colours = [mpl.colormaps["viridis"](0.9 * i / (len(results) - 1)) for i in range(len(results))]
    labels = [f"{value:g}" for value in values] if key else names(results)
    return colours, labels, key


def names(results):
    """Labels of results: titles if they differ, otherwise keys that differ, otherwise file names."""
    titles = [result.attrs["title"] for result in results]
    distinct = distinguishing_names(results)
    if len(set(titles)) == 1 and distinct:
        return distinct
    if len(set(titles)) == len(titles):
        return titles
    if len(set(titles)) == 1:
        return [result.path.stem for result in results]
    return [f"{title} ({result.path.stem})" for title, result in zip(titles, results, strict=True)]


def conditions(results):
    """Common speed, sliding, Hertz contact and oil of all results, in one line.

    Parameters
    ----------
    results : list of ehlpetsc.results.reader.Result
    """
    of_each = [_conditions(result) for result in results]
    return ", ".join(text for text in of_each[0] if text and all(text in other for other in of_each))


def title(results):
    """Title of the first result above the common conditions."""
    return f"{results[0].attrs['title']}\n{conditions(results)}"


def _conditions(result):
    case, attrs = result.case, result.attrs
    texts = []
    if case.operation or case.gears:
        texts.append("conditions over time")
    elif case.motion:
        texts += [
            f"u = {case.motion.entrainment_speed:g} m/s",
            f"slide/roll ratio {case.motion.slide_roll_ratio:g}",
        ]
    texts += [f"a = {1e3 * attrs['a']:.3g} mm", f"p0 = {1e-9 * attrs['p0']:.3g} GPa"]
    texts.append(f"oil {1e3 * case.fluid.viscosity:.4g} mPa s" if case.fluid else "dry")
    return texts


def share_hertz_contact(results):
    """Whether all results have the same Hertz contact."""
    contacts = np.array([(result.attrs["a"], result.attrs["p0"]) for result in results])
    return np.allclose(contacts, contacts[0], rtol=1e-9, atol=0.0)


def labels_with_hertz(labels, results):
    """Labels with the Hertz contact of each result, if these differ."""
    if share_hertz_contact(results):
        return labels
    return [
        f"{label}\na = {1e3 * r.attrs['a']:.3g} mm, p0 = {1e-9 * r.attrs['p0']:.3g} GPa"
        for label, r in zip(labels, results, strict=True)
    ]


def series_legend(axes, colours, labels, title, handles=(), dashed=False):
    """Legend right of the axes: at most `LEGEND_ENTRIES` members of a series, and `handles`.

    With `dashed` the second line is dashed, so that two equal curves are both visible.
    """
    step = -(-len(labels) // LEGEND_ENTRIES)
    lines = [Line2D([], [], color=c, label=n) for c, n in list(zip(colours, labels, strict=True))[::step]]
    if dashed:
        lines[1].set_linestyle("--")
    legend_beside(axes, [*lines, *handles], title)


def legend_beside(axes, handles=None, title=None):
    """Legend right of the axes; by default of all labelled artists."""
    handles = axes.get_legend_handles_labels()[0] if handles is None else handles
    position = dict(loc="center left", bbox_to_anchor=(1.0, 0.5))
    small = dict(fontsize="small", title_fontsize="small", frameon=False)
    axes.legend(handles=handles, title=title, **small, **position)
