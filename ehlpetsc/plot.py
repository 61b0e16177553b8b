"""Draw results: ``python3 -m ehlpetsc.plot RESULT.h5 [...]``.

Pressure and film of one frame, by default that with most contacts; of several files, a series, the same
instant of each in one picture. Or a map of pressure over place and time, contacts per millisecond, or a
movie. The ending of the file given by -o chooses the format (png, svg, pdf).

Exit status: 0 drawn, 2 bad input.
"""
import argparse
import contextlib
import sys
from pathlib import Path

import matplotlib as mpl
import numpy as np

mpl.use("Agg")
from matplotlib import pyplot as plt
from matplotlib.animation import PillowWriter

from . import drawing
from .result import OutputError, read_result

SIZE = (7.0, 5.2)  # inches
DPI = 160
MOVIE_FRAMES = 150
MOVIE_RATE = 15  # frames per second
MOVIE_DPI = 80


def choose_frames(results, step=None, time=None):
    """The same instant of every result: index of the stored frame nearest to it.

    Parameters
    ----------
    results : list of ehlpetsc.result.Result
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
    labels = [f"{label}: {mean:.3g}" for label, mean in zip(labels, means, strict=True)]
    drawing.series_legend(axes[1], colours, labels, f"{key or 'file'}:\nmean in |x| < a")
    axes[0].set_title(results[0].attrs["title"], fontsize="medium")
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
    return options.around - options.width / 2.0, options.around + options.width / 2.0


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
    parser.add_argument("--width", type=float, default=0.5, help="width of the view around it [%(default)s]")
    kind = parser.add_mutually_exclusive_group()
    kind.add_argument("--map", action="store_true", help="pressure over place and time, contacts marked")
    kind.add_argument("--contacts", action="store_true", help="contacts per millisecond along the contact")
    kind.add_argument("--movie", action="store_true", help="pressure and film over time, as a GIF")
    return parser


def main(arguments=None):
    """Run the command; returns its exit status."""
    options = _parser().parse_args(arguments)
    kind = next((k for k in ("map", "contacts", "movie") if getattr(options, k)), None)
    ending = ".gif" if kind == "movie" else f".{kind}.png" if kind else ".png"
    output = options.output or Path(options.results[0]).with_suffix(ending)
    try:
        with contextlib.ExitStack() as stack:
            results = [stack.enter_context(read_result(path)) for path in options.results]
            _check(results, options)
            results = drawing.in_order(results)
            if kind == "movie":
                save_movie(results, options, output)
            else:
                draw = {"map": draw_map, "contacts": draw_contacts}.get(kind, draw_frame)
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
