"""Pressure and film of an instant, drawn into given axes; x in half widths, film in um, pressure in GPa."""

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from ehlpetsc.errors import OutputError
from ehlpetsc.physics.exact_solutions import hertz_pressure
from ehlpetsc.plot.labels import CONTACT_COLOUR, SOLIDS_COLOUR, legend_beside, one_hertz
from ehlpetsc.results.contacts import in_contact

ACROSS = "x/a"
PRESSURE = "pressure [GPa]"
FILM = "film thickness [µm]"
OUTSIDE = (-1.6, 1.4)  # limits of x/a worth seeing
HERTZ_STYLE = dict(lw=0.8, ls="--", zorder=1)
HERTZ_GREY = "0.6"


def choose_frames(results, step=None, time=None):
    """The same instant of every result: index of the stored frame nearest to it.

    Parameters
    ----------
    results : list of ehlpetsc.results.reader.Result
    step : int, optional
        Step number in the first result.
    time : float, optional
        Time [s]. Without either, the instant with most contacts in any of them.

    Raises
    ------
    OutputError
        A result does not reach the step or time.
    """
    if step is not None:
        last = int(results[0].steps("step")[-1])
        if not results[0].step[0] <= step <= last:
            raise OutputError(f"{results[0].path}: --step {step}; allowed: {results[0].step[0]} to {last}")
        time = results[0].time[results[0].nearest_frame(step=step)]
    elif time is not None:
        for result in results:
            last = result.steps("time")[-1]
            if not result.time[0] <= time <= last * (1.0 + 1e-9):
                raise OutputError(
                    f"{result.path}: --time {time:g}; allowed: {result.time[0]:g} to {last:.9g} s"
                )
    else:
        fullest = max(results, key=lambda result: result.steps("contacts").max())
        time = fullest.time[frame_with_most_contacts(fullest)]
    return [result.nearest_frame(time=time) for result in results]


def frame_with_most_contacts(result):
    """Index of the stored frame with most nodes in contact; of the highest pressure if there is no contact.

    Parameters
    ----------
    result : ehlpetsc.results.reader.Result
    """
    contacts, highest = result.steps("contacts"), result.steps("p_max")
    rows = np.searchsorted(result.steps("step"), result.step)
    return int(np.argmax(contacts[rows] if contacts[rows].any() else highest[rows]))


def default_window(results):
    """Limits of x/a without a wish: the contact and what is just outside, as far as all results reach."""
    low = max(result.x[0] / result.attrs["a"] for result in results)
    high = min(result.x[-1] / result.attrs["a"] for result in results)
    return max(low, OUTSIDE[0]), min(high, OUTSIDE[1])


def instant(result, index):
    """Step and time of a stored frame in words; nothing of a steady result."""
    if len(result.time) == 1:
        return ""
    return f"step {result.step[index]}, {1e6 * result.time[index]:.3f} µs"


def pressure_and_film(axes, results, indices, colours, window):
    """Pressure above, film below; of a single result its contacts and what the solids carry of the pressure.

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
    _hertz(upper, results, colours, window)
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
            if "contact_pressure" in result:
                solids = 1e-9 * result.frame("contact_pressure", index)
                upper.fill_between(x, 0.0, solids, color=SOLIDS_COLOUR, lw=0, zorder=1.5)
            touching = shown & in_contact(result, index)
            lower.plot(x[touching], film[touching], "v", color=CONTACT_COLOUR, ms=4, clip_on=False, zorder=3)
    upper.set_ylabel(PRESSURE)
    upper.set_ylim(0.0, 1.05 * highest)
    lower.set_ylabel(FILM)
    lower.set_ylim(0.0, 1.15 * thickest)
    lower.set_xlabel(ACROSS)
    lower.set_xlim(*window)


def _hertz(axes, results, colours, window):
    """Hertz's pressure, once where all results share it."""
    fine = np.linspace(*window, 801)
    if one_hertz(results):
        results, colours = results[:1], [HERTZ_GREY]
    for result, colour in zip(results, colours, strict=True):
        hertz = 1e-9 * hertz_pressure(fine, 1.0, result.attrs["p0"])
        axes.plot(fine, hertz, color=colour, **HERTZ_STYLE)


def frame_legend(axes, result, index, colour):
    """Say beside the panels what the lines and marks of `pressure_and_film` mean."""
    solids = "contact_pressure" in result
    handles = [Line2D([], [], color=colour, lw=1.1, label="oil and solids" if solids else "pressure")]
    if solids:
        handles.append(Patch(color=SOLIDS_COLOUR, label="on the solids"))
    handles.append(Line2D([], [], color=HERTZ_GREY, label="Hertz", **HERTZ_STYLE))
    legend_beside(axes[0], handles)
    films = [Line2D([], [], color=colour, lw=1.1, label="film")]
    if in_contact(result, index).any():
        films.append(Line2D([], [], color=CONTACT_COLOUR, marker="v", ls="", ms=4, label="in contact"))
    legend_beside(axes[1], films)
