"""Draw results: ``python3 -m ehlpetsc.plot RESULT.h5 [...]``, or the index of a series, OUTPUT.series.json.

Pressure and film of one frame, by default that with most contacts; of several files, a series, the same
instant of each in one picture. Or a map of pressure over place and time, contacts per millisecond, a movie;
of a series its collisions, or film and pressure at contact points against the swept value; of one result oil
trapped between two contacts. The ending of the file given by -o chooses the format (png, svg, pdf).

Exit status: 0 drawn, 2 bad input.
"""

import argparse
import contextlib
import re
import sys
from pathlib import Path

import matplotlib as mpl
import numpy as np

mpl.use("Agg")
from matplotlib import pyplot as plt
from matplotlib.animation import PillowWriter

from ehlpetsc.analysis import collisions, entrapment
from ehlpetsc.errors import OutputError
from ehlpetsc.plot import collision_pictures as drawing_collisions
from ehlpetsc.plot import frames as drawing
from ehlpetsc.results.series_index import from_thick_to_thin, in_order, open_all

SIZE = (7.0, 5.2)  # inches
DPI = 160
MOVIE_FRAMES = 150
MOVIE_RATE = 15  # frames per second
MOVIE_DPI = 80
AROUND_WIDTH = 0.5  # of a view around a place, half widths
COLLISION_WIDTH = 0.12
POINTS = 8  # most contact points in one picture


def choose_frames(results, step=None, time=None):
    """The same instant of every result: index of the stored frame nearest to it.

    Parameters
    ----------
    results : list of ehlpetsc.results.reader.Result
    step : int, optional
        Step number in the first result.
    time : float, optional
        Time [s]. Without either, the instant with most contacts in any of them.
    """
    if step is not None:
        time = results[0].time[results[0].nearest_frame(step=step)]
    elif time is None:
        fullest = max(results, key=lambda result: result.steps("contacts").max())
        time = fullest.time[drawing.frame_with_most_contacts(fullest)]
    return [result.nearest_frame(time=time) for result in results]


def draw_frame(results, options):
    """Figure of pressure and film at an instant."""
    indices = choose_frames(results, options.step, options.time)
    colours, labels, key = drawing.series_colours(results)
    figure, axes = _two_panels()
    drawing.pressure_and_film(axes, results, indices, colours, _window(results, options))
    if len(results) > 1:
        drawing.series_legend(axes[0], colours, labels, key)
    else:
        drawing.frame_legend(axes, results[0], indices[0])
    axes[0].set_title(_instant(results[0], indices[0]), fontsize="medium")
    return figure


def draw_map(results, options):
    """Figure of pressure over place and time, a panel each result."""
    size = (SIZE[0] * max(1.0, 0.6 * len(results)), SIZE[1])
    figure, axes = plt.subplots(1, len(results), figsize=size, squeeze=False, layout="constrained")
    for panel, result in zip(axes[0], results, strict=True):
        image = drawing.space_time_map(panel, result, _window([result], options))
        panel.set_title(result.attrs["title"] if len(results) == 1 else result.path.stem, fontsize="medium")
        figure.colorbar(image, ax=panel, label=drawing.PRESSURE, extend="max")
    return figure


def draw_contacts(results, _options):
    """Figure of the contacts per millisecond along the contact."""
    colours, labels, key = drawing.series_colours(results)
    figure, axes = _two_panels()
    means = drawing.contact_rates(axes, results, colours)
    parts = [mean / means[0] if means[0] else np.nan for mean in means]
    labels = [f"{n}: {mean:.3g} ({part:.2f})" for n, mean, part in zip(labels, means, parts, strict=True)]
    drawing.series_legend(axes[1], colours, labels, f"{key or 'file'}:\nmean in |x| < a\n(to the first)")
    axes[0].set_title(results[0].attrs["title"], fontsize="medium")
    return figure


def draw_collision(results, options):
    """Figure of collisions in all members of a series, a column each; by default of the two best to see."""
    found = collisions.find(from_thick_to_thin(results)[0])
    numbers = options.collision or collisions.ranked(found)[:2]
    if not numbers or max(numbers) >= len(found):
        raise OutputError(f"{len(found)} collisions; allowed: --collision 0 to {len(found) - 1}")
    chosen = [found[number] for number in numbers]
    colours, labels, key = drawing.series_colours(results)
    size = (SIZE[0] * max(1.0, 0.6 * len(chosen)), SIZE[1])
    panels = dict(figsize=size, squeeze=False, sharex="col", layout="constrained")
    figure, axes = plt.subplots(2, len(chosen), **panels)
    width = options.width or COLLISION_WIDTH
    drawing_collisions.collisions(axes, results, chosen, colours, width)
    drawing.series_legend(axes[0, -1], colours, labels, key)
    figure.suptitle(results[0].attrs["title"], fontsize="medium")
    return figure


def draw_points(results, _options):
    """Figure of film and pressure at the points of contact against the swept value."""
    results, values, key = from_thick_to_thin(results)
    points = collisions.spread(collisions.contact_points(collisions.find(results)), POINTS)
    if not points:
        raise OutputError("no contact point with two full films before it and two members in contact")
    figure, axes = _two_panels()
    drawing_collisions.against_value(axes, points, values, key, results[0].attrs["a"])
    axes[0].set_title(results[0].attrs["title"], fontsize="medium")
    return figure


def draw_entrapment(results, options):
    """Figure of four instants of the strongest entrapment of a result."""
    size = (1.6 * SIZE[0], SIZE[1])
    figure, axes = plt.subplots(2, 4, figsize=size, sharex="col", sharey="row", layout="constrained")
    found = entrapment.find(results[0])[0]
    drawing_collisions.entrapped(axes, results[0], found, options.width or COLLISION_WIDTH)
    figure.suptitle(results[0].attrs["title"], fontsize="medium")
    return figure


def save_movie(results, options, path):
    """Pressure and film over time as an animated GIF, at most `MOVIE_FRAMES` frames of it."""
    last = len(results[0].time) - 1
    steps = np.unique(np.linspace(0, last, min(last + 1, MOVIE_FRAMES)).round().astype(int))
    colours, labels, key = drawing.series_colours(results)
    figure, axes = _two_panels()
    limits = _movie_limits(results, steps)
    writer = PillowWriter(fps=MOVIE_RATE)
    with writer.saving(figure, str(path), dpi=MOVIE_DPI):
        for index in steps:
            indices = choose_frames(results, time=results[0].time[index])
            for panel in axes:
                panel.clear()
            drawing.pressure_and_film(axes, results, indices, colours, _window(results, options))
            if len(results) > 1:
                drawing.series_legend(axes[0], colours, labels, key)
            for panel, limit in zip(axes, limits, strict=True):
                panel.set_ylim(0.0, limit)
            axes[0].set_title(_instant(results[0], index), fontsize="medium")
            writer.grab_frame()


def _movie_limits(results, frames):
    """Upper ends of the axes [GPa, um]: all pressures, and the film inside the contact.

    A series is in order of its swept value, so that its thickest film is likely at one of the ends.
    """
    film = 1e-9
    for result in (results[0], results[-1]):
        inside = np.abs(result.x) <= result.attrs["a"]
        shown = [index for index in frames if index < len(result.time)]
        film = max(film, *(result.frame("film_thickness", index)[inside].max() for index in shown))
    pressure = max(np.nanmax(result.steps("p_max")) for result in results)
    return 1.05e-9 * pressure, 1.15e6 * film


def _two_panels():
    figure, axes = plt.subplots(2, 1, figsize=SIZE, sharex=True, layout="constrained")
    return figure, axes


def _window(results, options):
    if options.around is None:
        return drawing.default_window(results)
    half = 0.5 * (options.width or AROUND_WIDTH)
    return options.around - half, options.around + half


def _instant(result, index):
    title, step, time = result.attrs["title"], result.step[index], 1e6 * result.time[index]
    return title if len(result.time) == 1 else f"{title}: step {step}, {time:.3f} µs"


def _check(results, options):
    for result in results:
        if not len(result.time):
            raise OutputError(f"{result.path}: no frame in it")
        missing = {"pressure", "film_thickness"} - set(result.fields)
        if missing and not options.contacts:
            raise OutputError(f"{result.path}: does not store {' and '.join(sorted(missing))}")
        low, high = _window([result], options)
        x = result.x / result.attrs["a"]
        if np.count_nonzero((x >= low) & (x <= high)) < 2:
            raise OutputError(f"{result.path}: fewer than two nodes from {low:g} a to {high:g} a")


def _parser():
    parser = argparse.ArgumentParser(prog="python3 -m ehlpetsc.plot", description=__doc__.split("\n")[0])
    parser.add_argument("results", nargs="+", metavar="RESULT.h5")
    parser.add_argument("-o", "--output", type=Path, help="picture [RESULT.png, RESULT.map.png ...]")
    instant = parser.add_mutually_exclusive_group()
    instant.add_argument("--step", type=int, help="number of the time step [that with most contacts]")
    instant.add_argument("--time", type=float, help="time [s]")
    parser.add_argument("--around", type=float, metavar="X", help="place to look at closely [half widths]")
    view = f"width of the view around it [{AROUND_WIDTH}; of a collision {COLLISION_WIDTH}]"
    parser.add_argument("--width", type=float, help=view)
    kind = parser.add_mutually_exclusive_group()
    kind.add_argument("--map", action="store_true", help="pressure over place and time, contacts marked")
    kind.add_argument("--contacts", action="store_true", help="contacts per millisecond along the contact")
    numbers = "by their number in the list of python3 -m ehlpetsc.analysis.collisions [two best]"
    kind.add_argument("--collision", type=int, nargs="*", metavar="NUMBER", help=numbers)
    kind.add_argument("--points", action="store_true", help="at contact points, against the swept value")
    kind.add_argument("--entrapment", action="store_true", help="oil trapped between contacts, four instants")
    kind.add_argument("--movie", action="store_true", help="pressure and film over time, as a GIF")
    return parser


KINDS = {
    "map": draw_map,
    "contacts": draw_contacts,
    "collision": draw_collision,
    "points": draw_points,
    "entrapment": draw_entrapment,
}


def main(arguments=None):
    """Run the command; returns its exit status."""
    options = _parser().parse_args(arguments)
    kind = next((k for k in (*KINDS, "movie") if getattr(options, k) not in (None, False)), None)
    ending = ".gif" if kind == "movie" else f".{kind}.png" if kind else ".png"
    output = options.output or Path(re.sub(r"(\.series\.json|\.h5)$", "", options.results[0]) + ending)
    try:
        with contextlib.ExitStack() as stack:
            results = open_all(options.results, stack)
            _check(results, options)
            results = in_order(results)
            if kind == "movie":
                save_movie(results, options, output)
            else:
                draw = KINDS.get(kind, draw_frame)
                draw(results, options).savefig(output, dpi=DPI)
    except (OutputError, ValueError, OSError) as error:
        print(f"ehlpetsc.plot: {error}", file=sys.stderr)
        return 2
    finally:
        plt.close("all")
    print(output)
    return 0


if __name__ == "__main__":
    sys.exit(main())
