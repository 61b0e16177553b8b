"""Pictures of collisions: over a series, against the swept value, and of lubricant entrapment."""

import numpy as np

from ehlpetsc.analysis import entrapment
from ehlpetsc.plot.frames import ACROSS, FILM, PRESSURE, pressure_and_film
from ehlpetsc.plot.labels import CONTACT_COLOUR, SINGLE_COLOUR, UNITS, legend_beside
from ehlpetsc.results.contacts import in_contact

COLOURS = ("#1f77b4", "#ff7f0e", "#2ca02c", "#d62728", "#9467bd", "#8c564b", "#17becf", "#7f7f7f")


def collisions(axes, results, found, colours, width):
    """Pressure above and film below at each collision, a column each; contacts of every member marked.

    Parameters
    ----------
    axes : ndarray of matplotlib Axes, shape (2, n)
    results : list of Result
    found : list of ehlpetsc.analysis.collisions.Collision
    colours : list
    width : float
        Of the view [half widths].
    """
    a = results[0].attrs["a"]
    for column, collision in enumerate(found):
        window = (collision.x / a - width / 2.0, collision.x / a + width / 2.0)
        frames = [result.nearest_frame(time=collision.time) for result in results]
        upper, lower = axes[:, column]
        pressure_and_film((upper, lower), results, frames, colours, window)
        thickest, highest = 0.0, 0.0
        for result, frame, colour in zip(results, frames, colours, strict=True):
            x, film = result.x / a, 1e6 * result.frame("film_thickness", frame)
            pressure = 1e-9 * result.frame("pressure", frame)
            shown = (x >= window[0]) & (x <= window[1])
            touching = shown & in_contact(result, frame)
            upper.plot(x[touching], pressure[touching], "v", color=colour, ms=4)
            if touching.any():  # an empty line that is not clipped would count for the layout
                lower.plot(x[touching], film[touching], "v", color=colour, ms=4, clip_on=False)
            thickest, highest = max(thickest, film[shown].max()), max(highest, pressure[shown].max())
        lower.set_ylim(0.0, 1.05 * thickest)
        upper.set_ylim(0.0, 1.05 * highest)
        upper.set_title(f"{1e6 * collision.time:.3f} µs", fontsize="medium")
        lower.locator_params(axis="x", nbins=5)
        if column:
            upper.set_ylabel("")
            lower.set_ylabel("")


def against_value(axes, points, values, key, a):
    """Film above and pressure below at contact points, against the swept value; one line a point."""
    upper, lower = axes
    for point, colour in zip(points, COLOURS, strict=False):
        film, pressure = 1e6 * np.array(point.film), 1e-9 * np.array(point.pressure)
        label = f"{point.x / a:.3f} a, {1e6 * point.time:.2f} µs"
        upper.plot(values, film, "o-", color=colour, ms=3, lw=1.1, label=label)
        lower.plot(values, pressure, "-", color=colour, lw=1.1)
        dry = film <= 0.0
        lower.plot(np.array(values)[dry], pressure[dry], "v", color=colour, ms=4)
        lower.plot(np.array(values)[~dry], pressure[~dry], "o", color=colour, ms=3)
    upper.set_ylabel(FILM)
    lower.set_ylabel(PRESSURE)
    lower.set_xlabel(UNITS.get(key, key))
    lower.plot([], [], "o", color="0.4", ms=3, label="film")
    lower.plot([], [], "v", color="0.4", ms=4, label="contact")
    legend_beside(upper)
    legend_beside(lower)
    for panel in axes:
        panel.set_ylim(bottom=0.0)
    lower.set_xlim(left=0.0)


def entrapped(axes, result, found, width):
    """Pressure above, the deformed surfaces below, at instants around an entrapment: a column each.

    Parameters
    ----------
    axes : ndarray of matplotlib Axes, shape (2, n)
    result : Result
    found : ehlpetsc.analysis.entrapment.Entrapment
    width : float
        Of the view [half widths].
    """
    a, highest = result.attrs["a"], 0.0
    x = result.x / a
    for column, (frame, place) in enumerate(entrapment.instants(result, found, count=axes.shape[1])):
        upper, lower = axes[:, column]
        shown = np.abs(result.x - place) <= 0.5 * width * a
        pressure, touching = 1e-9 * result.frame("pressure", frame), in_contact(result, frame) & shown
        slow, fast = (1e6 * height for height in entrapment.surfaces(result, frame))
        upper.plot(x[shown], pressure[shown], color=SINGLE_COLOUR, lw=1.1)
        upper.plot(x[touching], pressure[touching], "v", color=CONTACT_COLOUR, ms=4)
        lower.fill_between(x[shown], slow[shown], slow[shown].min() - 0.05, color="0.75", lw=0)
        lower.fill_between(x[shown], fast[shown], fast[shown].max() + 0.05, color="0.75", lw=0)
        lower.plot(x[shown], slow[shown], color=SINGLE_COLOUR, lw=1.0)
        lower.plot(x[shown], fast[shown], color="#b35806", lw=1.0)
        lower.plot(x[touching], slow[touching], "v", color=CONTACT_COLOUR, ms=4)
        upper.set_title(
            f"({'i' * (column + 1) if column < 3 else 'iv'}) {1e6 * result.time[frame]:.2f} µs",
            fontsize="medium",
        )
        lower.set_xlabel(ACROSS)
        lower.locator_params(axis="x", nbins=4)
        lower.set_xlim(place / a - width / 2.0, place / a + width / 2.0)
        highest = max(highest, pressure[shown].max())
    for upper in axes[0]:
        upper.set_ylim(0.0, 1.05 * highest)
    axes[0, 0].set_ylabel(PRESSURE)
    axes[1, 0].set_ylabel("surfaces [µm]")
