"""Pressure over x and time, drawn into axes."""

import numpy as np
from matplotlib.colors import ListedColormap

from ehlpetsc.errors import OutputError
from ehlpetsc.pictures.frames import ACROSS
from ehlpetsc.pictures.labels import CONTACT_COLOUR
from ehlpetsc.results.contacts import in_contact
from ehlpetsc.results.means import travelled

MAX_MAP_ROWS = 1000  # rows of pixels of a space-time map
MAX_MARKED_CONTACTS = 3000  # nodes in contact marked by dots, because single pixels would not be visible
COLOUR_PERCENTILE = 99.9  # of pressure: upper end of the colours, without a few sharp peaks


def space_time_map(axes, result, window, highest):
    """Draw pressure over x and time with contacts marked; returns the image for a colour bar.

    At most `MAX_MAP_ROWS` frames are drawn; contacts of the frames between them are also marked.

    Parameters
    ----------
    axes : matplotlib Axes
    result : Result
    window : (float, float)
        Limits of x/a.
    highest : float
        Pressure [GPa] at the upper end of the colours.

    Raises
    ------
    OutputError
        The result has one frame only.
    """
    x, time, pressure, columns, stride = _pressures(result, window)
    rows = time[::stride]
    mesh = dict(cmap="viridis", shading="nearest", rasterized=True)
    image = axes.pcolormesh(x, rows, pressure, vmin=0.0, vmax=highest, **mesh)
    touching, red = _contacts(result, columns, stride), ListedColormap([CONTACT_COLOUR])
    axes.pcolormesh(x, rows, np.ma.masked_equal(touching, 0), **(mesh | {"cmap": red}))
    row, node = np.nonzero(touching)
    if len(row) < MAX_MARKED_CONTACTS:
        axes.plot(x[node], rows[row], ".", color=CONTACT_COLOUR, ms=3, mew=0, rasterized=True)
    scale = travelled(result)[-1] / result.attrs["a"] / max(time[-1], 1e-30)
    constant = "steps/displacement_1" not in result
    axes.set_xlabel(ACROSS)
    axes.set_ylabel("time [µs]")
    if constant and scale > 0.0:
        travel = axes.secondary_yaxis("right", functions=(lambda t: t * scale, lambda x: x / scale))
        travel.set_ylabel("travel [a]")
    axes.set_xlim(x[0], x[-1])
    axes.set_ylim(time[0], time[-1])
    return image


def colour_limit(results, window):
    """Pressure [GPa] at the upper end of the colours of all results."""
    return max(float(np.percentile(_pressures(result, window)[2], COLOUR_PERCENTILE)) for result in results)


def _pressures(result, window):
    """x/a and time [us] in view, pressure [GPa] of the drawn frames, their columns and stride."""
    if len(result.time) < 2:
        raise OutputError(f"{result.path}: a map over time needs more than one stored frame")
    x, time = result.x / result.attrs["a"], 1e6 * result.time
    stride = -(-len(time) // MAX_MAP_ROWS)
    in_view = np.flatnonzero((x >= window[0]) & (x <= window[1]))
    columns = slice(in_view[0], in_view[-1] + 1)
    pressure = 1e-9 * result["pressure"][: len(time) : stride, columns].astype(float)
    return x[columns], time, pressure, columns, stride


def _contacts(result, columns, stride):
    """1 where a node is in contact in any of `stride` frames, one row for every `stride` frames."""
    last = len(result.time)
    blocks = (slice(begin, min(begin + stride, last)) for begin in range(0, last, stride))
    return np.array([in_contact(result, block, columns).any(axis=0) for block in blocks], dtype=int)
