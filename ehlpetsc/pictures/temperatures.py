"""Temperatures of one result: film and surfaces at an instant, the hotter surface over x and time."""

import numpy as np

from ehlpetsc.errors import OutputError
from ehlpetsc.pictures import frames
from ehlpetsc.pictures.labels import SECOND_COLOUR, SINGLE_COLOUR, conditions, new_figure
from ehlpetsc.pictures.over_time import MAX_MAP_ROWS

SIZE = (8.4, 10.0)  # inches
STEADY_SIZE = (8.4, 6.6)
COLOURS = {
    "film_temperature": ("film", "#cc3311"),
    "temperature_1": ("surface 1", SINGLE_COLOUR),
    "temperature_2": ("surface 2", SECOND_COLOUR),
}
HEIGHTS = (1, 1, 1, 1.5)
KELVIN = 273.15


def temperatures(results, window, options):
    """Figure of temperatures, pressure and film at an instant, and the hotter surface over x and time.

    Parameters
    ----------
    results : list of Result
        One.
    window : (float, float)
        Limits of x/a.
    options : argparse.Namespace
        With `step` and `time`.

    Raises
    ------
    OutputError
        More than one result, or no temperatures in it.
    """
    if len(results) > 1:
        raise OutputError(f"{len(results)} results; allowed: --temperatures of one")
    result = results[0]
    if missing := [name for name in COLOURS if name not in result.fields]:
        raise OutputError(
            f"{result.path}: does not store {', '.join(missing)}: the case needs a table [heat], and "
            "output.fields with them where it is given"
        )
    steady = len(result.time) == 1
    size, heights = (STEADY_SIZE, HEIGHTS[:3]) if steady else (SIZE, HEIGHTS)
    figure, axes = new_figure(len(heights), 1, size, sharex=True, height_ratios=heights)
    [index] = frames.choose_frames(results, options.step, options.time)
    _instant(axes[0], result, index, window)
    frames.pressure_and_film(axes[1:3], results, [index], [SINGLE_COLOUR], window)
    frames.frame_legend(axes[1:3], result, index, SINGLE_COLOUR)
    title = ": ".join(filter(None, [result.attrs["title"], frames.instant(results, [index])]))
    axes[0].set_title(f"{title}\n{conditions(results)}", fontsize="medium")
    if not steady:
        image, side = _over_time(axes[3], result, window)
        figure.colorbar(image, ax=axes[3], label=f"temperature of\nsurface {side} [K]", pad=0.01)
        axes[2].set_xlabel("")
    return figure


def _instant(axes, result, index, window):
    """Draw temperatures along the contact, in K and in degrees Celsius."""
    x = result.x / result.attrs["a"]
    shown = (x >= window[0]) & (x <= window[1])
    for name, (label, colour) in COLOURS.items():
        axes.plot(x[shown], result.frame(name, index)[shown], color=colour, lw=1.0, label=label)
    axes.set_ylabel("temperature [K]")
    celsius = axes.secondary_yaxis("right", functions=(lambda t: t - KELVIN, lambda t: t + KELVIN))
    celsius.set_ylabel("[°C]")
    axes.grid(lw=0.3)
    handles, names = axes.get_legend_handles_labels()
    axes.legend(handles, names, fontsize="small", loc="upper left")


def _over_time(axes, result, window):
    """Draw the hotter surface over x and time; returns the image and the name of the surface."""
    side = max("12", key=lambda name: np.nanmean(result.steps(f"temperature_{name}_mean")))
    x, time = result.x / result.attrs["a"], 1e6 * result.time
    shown = np.flatnonzero((x >= window[0]) & (x <= window[1]))
    columns, stride = slice(shown[0], shown[-1] + 1), -(-len(time) // MAX_MAP_ROWS)
    values = result[f"temperature_{side}"][: len(time) : stride, columns].astype(float)
    mesh = dict(cmap="inferno", shading="nearest", rasterized=True)
    image = axes.pcolormesh(x[columns], time[::stride], values, vmax=np.percentile(values, 99.9), **mesh)
    axes.set_ylabel("time [µs]")
    axes.set_xlabel(frames.ACROSS)
    axes.set_xlim(*window)
    return image, side
