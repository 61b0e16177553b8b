"""Pressure and film at an instant, drawn into axes; x in half widths, film in um, pressure in GPa."""

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from ehlpetsc.errors import OutputError
from ehlpetsc.physics.exact_solutions import hertz_pressure
from ehlpetsc.pictures.labels import (
    CONTACT_COLOUR,
    SECOND_COLOUR,
    SINGLE_COLOUR,
    SOLIDS_COLOUR,
    legend_beside,
    share_hertz_contact,
)
from ehlpetsc.results.contacts import in_contact
from ehlpetsc.results.means import both_fill, travelled
from ehlpetsc.results.reader import Result

ACROSS = "x/a"
SIDES = ("surface 1", "surface 2")
PRESSURE = "pressure [GPa]"
FILM = "film thickness [µm]"
GAP = "gap [µm]"  # without oil
WINDOW = (-1.6, 1.4)  # limits of x/a by default
HERTZ_STYLE = dict(lw=0.9, ls=":", zorder=1)
HERTZ_GREY = "0.6"
MIN_LOAD_ON_SOLIDS = 0.005  # of the load: with less the pressure determines the instant


def choose_frames(results, step=None, time=None):
    """Index of the stored frame nearest to an instant, for every result.

    Results with different speeds are compared at equal travel of the faster surface, at which asperities are
    in the same position.

    Parameters
    ----------
    results : list of ehlpetsc.results.reader.Result
    step : int, optional
        Step number in the first result.
    time : float, optional
        Time in the first result [s]. Without both, the frame of `frame_to_show` that all results reach.

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
    first = results[0]
    if time is None:
        reached = min(travel_of(result)[-1] for result in results)
        fullest = max(results, key=_load_on_solids)
        travel = travel_of(fullest)[frame_to_show(fullest, reached)]
    else:
        last = first.steps("time")[-1]
        if not first.time[0] <= time <= last * (1.0 + 1e-9):
            raise OutputError(f"{first.path}: --time {time:g}; allowed: {first.time[0]:g} to {last:.9g} s")
        travel = np.interp(time, first.steps("time"), travelled(first)) / first.attrs["a"]
    indices = []
    for result in results:
        last = travelled(result)[-1] / result.attrs["a"]
        if travel > last * (1.0 + 1e-9) + 1e-12:
            raise OutputError(f"{result.path}: ends at travel {last:.4g} a, before travel {travel:.4g} a")
        indices.append(int(np.argmin(np.abs(travel_of(result) - travel))))
    return indices


def _load_on_solids(result):
    """Sort key of results: maximum fraction of the load on the solids, then maximum pressure."""
    share = np.nanmax(result.steps("contact_share")) if "contact_share" in result.scalars else 0.0
    return (share if share > MIN_LOAD_ON_SOLIDS else 0.0), np.nanmax(result.steps("p_max"))


def travel_of(result):
    """Travel of the faster surface at the stored frames [half-widths], shape (nt,)."""
    return np.interp(result.time, result.steps("time"), travelled(result)) / result.attrs["a"]


def frame_to_show(result, reached=np.inf):
    """Index of the stored frame with the largest fraction of the load on the solids, or the highest pressure.

    The fraction is used if it ever exceeds `MIN_LOAD_ON_SOLIDS`. Frames before both surfaces fill the contact
    are used only if there are no others, because the leading edge of a profile is not typical.

    Parameters
    ----------
    result : ehlpetsc.results.reader.Result
    reached : float
        Travel [half-widths] of the last frame to consider.
    """
    allowed = travel_of(result) <= reached * (1.0 + 1e-9)
    if (filled := allowed & both_fill(result, result.time)).any():
        allowed = filled
    rows = np.searchsorted(result.steps("step"), result.step)
    values = result.steps("p_max")[rows]
    if "contact_share" in result.scalars:
        share = np.nan_to_num(result.steps("contact_share")[rows])
        values = share if share[allowed].max() > MIN_LOAD_ON_SOLIDS else values
    return int(np.argmax(np.where(allowed, np.nan_to_num(values), -1.0)))


def is_lubricated(result):
    """Whether there is oil in the contact."""
    return result.case.fluid is not None


def default_window(results):
    """Default limits of x/a: around the contact, within the domains of all results."""
    low = max(result.x[0] / result.attrs["a"] for result in results)
    high = min(result.x[-1] / result.attrs["a"] for result in results)
    return max(low, WINDOW[0]), min(high, WINDOW[1])


def instant(results, indices):
    """Text with the travel of stored frames, and step and time if they are equal; "" if steady."""
    first, index = results[0], indices[0]
    if len(first.time) == 1:
        return ""
    travel = f"travel {travel_of(first)[index]:.2f} a"
    times = np.array([result.time[k] for result, k in zip(results, indices, strict=True)])
    if np.ptp(times) > 0.5 * np.nanmax(first.steps("dt")):
        return travel
    return f"step {first.step[index]}, {1e6 * times[0]:.3f} µs, {travel}"


def pressure_and_film(axes, results, indices, colours, window):
    """Draw pressure and film; for a single result also contacts and the pressure of the solids.

    The film axis ends above the thickest film inside the contact, or in view if there is none inside.

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
    highest, thickest = 0.0, 0.0
    for number, (result, index, colour) in enumerate(zip(results, indices, colours, strict=True)):
        style = dict(color=colour, lw=1.1, ls="--" if number == 1 and len(results) == 2 else "-")
        x = result.x / result.attrs["a"]
        pressure, film = 1e-9 * result.frame("pressure", index), 1e6 * result.frame("film_thickness", index)
        upper.plot(x, pressure, **style)
        lower.plot(x, film, **style)
        in_view = (x >= window[0]) & (x <= window[1])
        inside = in_view & (np.abs(x) <= 1.0)
        highest = max(highest, pressure[in_view].max())
        thickest = max(thickest, film[inside].max(initial=0.0) or film[in_view].max())
        if len(results) == 1:
            if "contact_pressure" in result:
                solids = 1e-9 * result.frame("contact_pressure", index)
                upper.fill_between(x, 0.0, solids, color=SOLIDS_COLOUR, lw=0, zorder=1.5)
            touching = in_view & in_contact(result, index)
            if touching.any():  # an empty line would affect the layout
                lower.plot(
                    x[touching], film[touching], "v", color=CONTACT_COLOUR, ms=4, clip_on=False, zorder=3
                )
    upper.set_ylabel(PRESSURE)
    upper.set_ylim(0.0, 1.05 * highest or 1.0)
    lower.set_ylabel(FILM if any(map(is_lubricated, results)) else GAP)
    lower.set_ylim(0.0, 1.15 * thickest or 1.0)
    lower.set_xlabel(ACROSS)
    lower.set_xlim(*window)


def _hertz(axes, results, colours, window):
    """Draw the Hertz pressure, once if it is equal for all results."""
    fine = np.linspace(*window, 801)
    if share_hertz_contact(results):
        results, colours = results[:1], [HERTZ_GREY]
    for result, colour in zip(results, colours, strict=True):
        hertz = 1e-9 * hertz_pressure(fine, 1.0, result.attrs["p0"])
        axes.plot(fine, hertz, color=colour, **HERTZ_STYLE)


def x_in_mm(axes, results):
    """Add an axis in mm if all results have the same a, and the direction of flow if there is oil."""
    a = {float(result.attrs["a"]) for result in results}
    if len(a) == 1:
        scale = 1e3 * a.pop()
        above = axes.secondary_xaxis("top", functions=(lambda x: x * scale, lambda x: x / scale))
        above.tick_params(labelsize="small")
        above.set_xlabel("x [mm]", fontsize="small")
    if not any(map(is_lubricated, results)):
        return
    position = dict(xy=(0.13, 0.9), xytext=(0.02, 0.9), xycoords="axes fraction", textcoords="axes fraction")
    axes.annotate("", **position, arrowprops=dict(arrowstyle="->", color="0.35"))
    axes.text(0.14, 0.9, "flow", transform=axes.transAxes, va="center", fontsize="small", color="0.35")


def deformed_heights(result: Result, frame: int) -> tuple[np.ndarray, np.ndarray]:
    """Heights [m] of surface 2, below, and of surface 1 about their mean plane, shape (nx,).

    Both solids are assumed to deform equally: the middle of the gap is that of the undeformed rough surfaces.
    """
    time, middle = result.time[frame], np.zeros(len(result.x))
    for side, sign in (("2", 1.0), ("1", -1.0)):
        profile = result.profile(side)
        if profile is not None:
            s, z, speed = profile
            middle += 0.5 * sign * np.interp(result.x - speed * time, s, z, left=0.0, right=0.0)
    film = result.frame("film_thickness", frame)
    return middle - 0.5 * film, middle + 0.5 * film


def deformed_surfaces(axes, result, index, window):
    """Draw both deformed surfaces at an instant, solids in grey."""
    x = result.x / result.attrs["a"]
    in_view = (x >= window[0]) & (x <= window[1])
    lower, upper = (1e6 * height for height in deformed_heights(result, index))
    inside = in_view & (np.abs(x) <= 1.0)
    shown = inside if inside.any() else in_view
    bottom, top = lower[shown].min(), upper[shown].max()
    room = 0.15 * (top - bottom)
    for height, end, colour, name in (
        (upper, top + room, SECOND_COLOUR, 0),
        (lower, bottom - room, SINGLE_COLOUR, 1),
    ):
        axes.fill_between(x, height, end, color="0.85", lw=0)
        axes.plot(x, height, color=colour, lw=0.9, label=SIDES[name])
    axes.set_ylim(bottom - room, top + room)
    axes.set_ylabel("surfaces [µm]")
    legend_beside(axes)


def frame_legend(axes, result, index, colour):
    """Draw the legends of `pressure_and_film`, of the curves in view."""
    x, (low, high) = result.x / result.attrs["a"], axes[1].get_xlim()
    in_view = (x >= low) & (x <= high)
    solids = "contact_pressure" in result and result.frame("contact_pressure", index)[in_view].any()
    handles = [Line2D([], [], color=colour, lw=1.1, label="total pressure" if solids else "pressure")]
    if solids:
        handles.append(Patch(color=SOLIDS_COLOUR, label="of the solids"))
    handles.append(Line2D([], [], color=HERTZ_GREY, label="Hertz", **HERTZ_STYLE))
    legend_beside(axes[0], handles)
    films = [Line2D([], [], color=colour, lw=1.1, label="film" if is_lubricated(result) else "gap")]
    if in_contact(result, index)[in_view].any():
        films.append(Line2D([], [], color=CONTACT_COLOUR, marker="v", ls="", ms=4, label="in contact"))
    legend_beside(axes[1], films)
