"""Pictures of results, each drawn into given axes; lengths in half widths, film in um, pressure in GPa."""

import matplotlib as mpl
import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.lines import Line2D

from ehlpetsc.errors import OutputError
from ehlpetsc.physics.exact_solutions import hertz_pressure
from ehlpetsc.results.series_index import series_values

ACROSS = "x/a"
PRESSURE = "pressure [GPa]"
FILM = "film thickness [µm]"
SINGLE_COLOUR = "#1f4e79"
CONTACT_COLOUR = "#d62728"
OUTSIDE = (-1.6, 1.4)  # limits of x/a worth seeing
MAP_ROWS = 1000  # rows of pixels worth drawing in a space-time map
FEW_CONTACTS = 3000  # nodes in contact in a map that would be lost as single pixels
LEGEND_ENTRIES = 10
POLYNOMIAL_ORDER = 8  # Holmes et al. 2005, figure 7 (ii)


def frame_with_most_contacts(result):
    """Index of the stored frame with most nodes in contact; of the highest pressure if there is no contact.

    Parameters
    ----------
    result : ehlpetsc.results.reader.Result
    """
    contacts, highest = result.steps("contacts"), result.steps("p_max")
    rows = np.searchsorted(result.steps("step"), result.step)
    return int(np.argmax(contacts[rows] if contacts[rows].any() else highest[rows]))


def in_contact(result, index):
    """Nodes in contact in a stored frame, of bool, shape (nx,)."""
    if "in_contact" in result:
        return result["in_contact"][index].astype(bool)
    return result.frame("film_thickness", index) <= 0.0


def default_window(results):
    """Limits of x/a without a wish: the contact and what is just outside, as far as all results reach."""
    low = max(result.x[0] / result.attrs["a"] for result in results)
    high = min(result.x[-1] / result.attrs["a"] for result in results)
    return max(low, OUTSIDE[0]), min(high, OUTSIDE[1])


def pressure_and_film(axes, results, indices, colours, window):
    """Pressure above, film below; the contacts of a single result are marked.

    The film axis ends above the thickest film inside the contact, or in view if that is elsewhere.

    Parameters
    ----------
    axes : pair of matplotlib Axes
    results : list of Result
    indices : list of int
        Stored frame of each.
    colours : list
    window : (float, float)
        Limits of x/a.
    """
    upper, lower = axes
    fine = np.linspace(*window, 801)
    p0 = results[0].attrs["p0"]
    upper.plot(fine, 1e-9 * hertz_pressure(fine, 1.0, p0), color="0.6", lw=0.8, ls="--", zorder=1)
    highest, thickest = 0.0, 1e-3
    for result, index, colour in zip(results, indices, colours, strict=True):
        x = result.x / result.attrs["a"]
        pressure, film = 1e-9 * result.frame("pressure", index), 1e6 * result.frame("film_thickness", index)
        upper.plot(x, pressure, color=colour, lw=1.1)
        lower.plot(x, film, color=colour, lw=1.1)
        shown = (x >= window[0]) & (x <= window[1])
        inside = shown & (np.abs(x) <= 1.0)
        highest = max(highest, pressure[shown].max())
        thickest = max(thickest, film[inside if inside.any() else shown].max())
        if len(results) == 1:
            touching = shown & in_contact(result, index)
            lower.plot(x[touching], film[touching], "v", color=CONTACT_COLOUR, ms=4, clip_on=False, zorder=3)
    upper.set_ylabel(PRESSURE)
    upper.set_ylim(0.0, 1.05 * highest)
    lower.set_ylabel(FILM)
    lower.set_ylim(0.0, 1.15 * thickest)
    lower.set_xlabel(ACROSS)
    lower.set_xlim(*window)


def frame_legend(axes, result, index):
    """Say what the marks of `pressure_and_film` mean."""
    handles = [Line2D([], [], color="0.6", ls="--", lw=0.8, label="Hertz")]
    if in_contact(result, index).any():
        handles.append(Line2D([], [], color=CONTACT_COLOUR, marker="v", ls="", ms=4, label="in contact"))
    axes[0].legend(handles=handles, frameon=False, loc="upper right")


def space_time_map(axes, result, window):
    """Pressure over place and time, contacts marked; returns the image for a colour bar.

    At most `MAP_ROWS` frames are drawn; contacts of the frames between them are marked all the same.

    Raises
    ------
    OutputError
        The result has one frame only.
    """
    if len(result.time) < 2:
        raise OutputError(f"{result.path}: a map over time needs more than one stored frame")
    x, time = result.x / result.attrs["a"], 1e6 * result.time
    stride = -(-len(time) // MAP_ROWS)
    part = np.flatnonzero((x >= window[0]) & (x <= window[1]))
    columns = slice(part[0], part[-1] + 1)
    x, rows = x[columns], time[::stride]
    pressure = 1e-9 * result["pressure"][: len(time) : stride, columns].astype(float)
    mesh = dict(cmap="viridis", shading="nearest", rasterized=True)
    # a few sharp peaks would darken all the rest
    image = axes.pcolormesh(x, rows, pressure, vmin=0.0, vmax=np.percentile(pressure, 99.9), **mesh)
    touching, red = _contacts(result, columns, stride), ListedColormap([CONTACT_COLOUR])
    axes.pcolormesh(x, rows, np.ma.masked_equal(touching, 0), **(mesh | {"cmap": red}))
    row, node = np.nonzero(touching)
    if len(row) < FEW_CONTACTS:
        axes.plot(x[node], rows[row], ".", color=CONTACT_COLOUR, ms=3, mew=0, rasterized=True)
    axes.set_xlabel(ACROSS)
    axes.set_ylabel("time [µs]")
    axes.set_xlim(x[0], x[-1])
    axes.set_ylim(time[0], time[-1])
    return image


def _contacts(result, columns, stride):
    """1 where a node is in contact in any of `stride` frames, a row each `stride` frames."""
    name = "in_contact" if "in_contact" in result else "film_thickness"
    rows = []
    for begin in range(0, len(result.time), stride):
        block = result[name][begin : min(begin + stride, len(result.time)), columns]
        rows.append(np.any(block if name == "in_contact" else block <= 0.0, axis=0))
    return np.array(rows, dtype=int)


def contact_rates(axes, results, colours):
    """Contacts per millisecond along the contact: raw above, a polynomial of 8th order below.

    Returns
    -------
    list of float
        Mean rate inside the Hertz contact.

    Raises
    ------
    OutputError
        A result is steady.
    """
    upper, lower = axes
    means = []
    for result, colour in zip(results, colours, strict=True):
        x, rate = result.x / result.attrs["a"], result.contact_rate()
        inside = np.abs(x) <= 1.0
        fit = np.polynomial.Polynomial.fit(x[inside], rate[inside], POLYNOMIAL_ORDER)
        smooth = np.linspace(-1.0, 1.0, 401)
        upper.plot(x, rate, color=colour, lw=0.6)
        lower.plot(smooth, fit(smooth), color=colour, lw=1.4)
        means.append(float(rate[inside].mean()))
    upper.set_ylabel("contacts per ms")
    lower.set_ylabel(f"the same, polynomial\nof order {POLYNOMIAL_ORDER}")
    lower.set_xlabel(ACROSS)
    lower.set_xlim(-1.5, 1.5)
    for panel in axes:
        panel.set_ylim(bottom=0.0)
    return means


def series_colours(results):
    """Colours and labels of several results: by the swept value where there is one, otherwise by file.

    Returns
    -------
    colours, labels : list
    key : str or None
        What is swept.
    """
    if len(results) == 1:
        return [SINGLE_COLOUR], [results[0].path.stem], None
    key, values = series_values(results)
    # the light end of the map does not show on white
    colours = [mpl.colormaps["viridis"](0.9 * i / (len(results) - 1)) for i in range(len(results))]
    labels = [f"{value:g}" for value in values] if key else [result.path.stem for result in results]
    return colours, labels, key


def series_legend(axes, colours, labels, title):
    """Legend right of the axes: all of a series or, where it is long, every so many members."""
    step = -(-len(labels) // LEGEND_ENTRIES)
    lines = [Line2D([], [], color=c, label=n) for c, n in list(zip(colours, labels, strict=True))[::step]]
    place = dict(loc="center left", bbox_to_anchor=(1.0, 0.5))
    axes.legend(handles=lines, title=title, frameon=False, fontsize="small", title_fontsize="small", **place)
