"""Collisions of asperities and lubricant entrapment, drawn into axes."""

import numpy as np

from ehlpetsc.analysis import entrapment
from ehlpetsc.plot.labels import CONTACT_COLOUR, SECOND_COLOUR, SINGLE_COLOUR, UNITS, legend_beside
from ehlpetsc.plot.panels.frames import ACROSS, FILM, PRESSURE, pressure_and_film
from ehlpetsc.results.contacts import in_contact

COLOURS = ("#1f77b4", "#ff7f0e", "#2ca02c", "#d62728", "#9467bd", "#8c564b", "#17becf", "#7f7f7f")


def draw_collisions(axes, results, collisions, colours, width):
    """Draw pressure and film at each collision, one column each, with the contacts of every member.

    Parameters
    ----------
    axes : ndarray of matplotlib Axes, shape (2, n)
    results : list of Result
    collisions : list of ehlpetsc.analysis.collisions.Collision
    colours : list
    width : float
        Of the view [half widths].
    """
    a = results[0].attrs["a"]
    for column, collision in enumerate(collisions):
        window = (collision.x / a - width / 2.0, collision.x / a + width / 2.0)
        frames = [result.nearest_frame(time=collision.time) for result in results]
        upper, lower = axes[:, column]
        pressure_and_film((upper, lower), results, frames, colours, window)
        thickest, highest = 0.0, 0.0
        for result, frame, colour in zip(results, frames, colours, strict=True):
            x, film = result.x / a, 1e6 * result.frame("film_thickness", frame)
            pressure = 1e-9 * result.frame("pressure", frame)
            in_view = (x >= window[0]) & (x <= window[1])
            touching = in_view & in_contact(result, frame)
            upper.plot(x[touching], pressure[touching], "v", color=colour, ms=4)
            if touching.any():  # an unclipped empty line would affect the layout
                lower.plot(x[touching], film[touching], "v", color=colour, ms=4, clip_on=False)
            thickest, highest = max(thickest, film[in_view].max()), max(highest, pressure[in_view].max())
        lower.set_ylim(0.0, 1.05 * thickest)
        upper.set_ylim(0.0, 1.05 * highest)
        upper.set_title(f"{1e6 * collision.time:.3f} µs", fontsize="medium")
        lower.locator_params(axis="x", nbins=5)
        if column:
            upper.set_ylabel("")
            lower.set_ylabel("")


def draw_contact_points(axes, points, values, key, a):
    """Draw film and pressure at contact points over the varied value, one line for each point."""
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


def draw_entrapment(axes, result, event, width):
    """Draw pressure and the deformed surfaces at instants around an entrapment, one column each.

    Parameters
    ----------
    axes : ndarray of matplotlib Axes, shape (2, n)
    result : Result
    event : ehlpetsc.analysis.entrapment.Entrapment
    width : float
        Of the view [half widths].
    """
    a, highest = result.attrs["a"], 0.0
    x = result.x / a
    for column, (frame, centre) in enumerate(entrapment.instants(result, event, count=axes.shape[1])):
        upper, lower = axes[:, column]
        in_view = np.abs(result.x - centre) <= 0.5 * width * a
        pressure, touching = 1e-9 * result.frame("pressure", frame), in_contact(result, frame) & in_view
        surface_2, surface_1 = (1e6 * height for height in entrapment.surfaces(result, frame))
        upper.plot(x[in_view], pressure[in_view], color=SINGLE_COLOUR, lw=1.1)
        upper.plot(x[touching], pressure[touching], "v", color=CONTACT_COLOUR, ms=4)
        for height, solid_end, colour in (
            (surface_2, surface_2[in_view].min() - 0.05, SINGLE_COLOUR),
            (surface_1, surface_1[in_view].max() + 0.05, SECOND_COLOUR),
        ):
            lower.fill_between(x[in_view], height[in_view], solid_end, color="0.75", lw=0)
            lower.plot(x[in_view], height[in_view], color=colour, lw=1.0)
        lower.plot(x[touching], surface_2[touching], "v", color=CONTACT_COLOUR, ms=4)
        upper.set_title(
            f"({'i' * (column + 1) if column < 3 else 'iv'}) {1e6 * result.time[frame]:.2f} µs",
            fontsize="medium",
        )
        lower.set_xlabel(ACROSS)
        lower.locator_params(axis="x", nbins=4)
        lower.set_xlim(centre / a - width / 2.0, centre / a + width / 2.0)
        highest = max(highest, pressure[in_view].max())
    for upper in axes[0]:
        upper.set_ylim(0.0, 1.05 * highest)
    axes[0, 0].set_ylabel(PRESSURE)
    axes[1, 0].set_ylabel("surfaces [µm]")
