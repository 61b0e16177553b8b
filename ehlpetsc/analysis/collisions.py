"""Collisions of asperities in the members of a series: found and listed.

Members of a series share roughness, kinematics and, but for halved steps, time levels: an asperity pair
is in the same relative position in all of them at the same time. Nodes in contact of all members are
put into one map of place and time; what hangs together there is one collision. Times, not step numbers, are
compared.

``ehlpetsc collisions OUTPUT.series.json`` lists them and says how film and
pressure go with the swept value (Holmes et al. 2005, figure 4).
"""

import sys
from dataclasses import dataclass

import numpy as np

from ehlpetsc.analysis.film_breakdown import breakdown, smooth_films
from ehlpetsc.errors import OutputError
from ehlpetsc.results.contacts import in_contact
from ehlpetsc.results.series_index import WITH_FILM, command, from_thick_to_thin

BRIDGED = 2  # cells of the map over which a contact that flickers is still the same
TIME_TOLERANCE = 1e-3  # of the interval between frames: times nearer than this are the same
BLOCK = 256  # frames read at a time


@dataclass(frozen=True)
class Collision:
    """One collision.

    Attributes
    ----------
    x, time : float
        A point of contact of the member that touches first of all [m, s]: of those at times that most members
        have stored the one at which most touch, and of these the one with the highest pressure in any.
    begin, end : float
        Times of the first and last contact in any member [s].
    touching : tuple of bool
        For each member whether its surfaces touch anywhere in the collision.
    film, pressure : tuple of float
        At the point, for each member [m, Pa]; the film is 0 in contact, whatever its bound.
    """

    x: float
    time: float
    begin: float
    end: float
    touching: tuple
    film: tuple
    pressure: tuple


def points_in_contact(result):
    """Stored frames and nodes in contact: two arrays of int, shape (n,).

    Raises
    ------
    OutputError
        The result holds no frame, or neither contacts nor films.
    """
    if not len(result.time):
        raise OutputError(f"{result.path}: no frame in it")
    frames, nodes = [], []
    for begin in range(0, len(result.time), BLOCK):
        frame, node = np.nonzero(in_contact(result, slice(begin, min(begin + BLOCK, len(result.time)))))
        frames.append(frame + begin)
        nodes.append(node)
    return np.concatenate(frames), np.concatenate(nodes)


def find(results):
    """Collisions of a series, in order of time.

    Parameters
    ----------
    results : list of ehlpetsc.results.reader.Result
        In the order in which members are to touch: the one that touches last first, as the thickest film.

    Returns
    -------
    list of Collision

    Raises
    ------
    OutputError
        A result holds fewer than two frames, or no contacts.
    """
    if any(len(result.time) < 2 for result in results):
        raise OutputError("collisions need more than one stored frame")
    spacing = max(float(np.diff(result.x).max()) for result in results)
    interval = max(float(np.diff(result.time).max()) for result in results)
    points = [_points(result) for result in results]
    labels = _label(points, spacing, interval)
    at = [_Reader(result) for result in results]
    found = []
    for label in range(1, 1 + max((int(part.max(initial=0)) for part in labels), default=0)):
        parts = [(t[own == label], x[own == label]) for (t, x), own in zip(points, labels, strict=True)]
        found.append(_collision(parts, at))
    return sorted(found, key=lambda collision: collision.time)


def _points(result):
    frames, nodes = points_in_contact(result)
    return result.time[frames], result.x[nodes]


def _label(points, spacing, interval):
    """Number of the collision of every point, an array for each member."""
    from scipy.ndimage import binary_dilation, label

    cells = [(np.rint(t / interval).astype(int), np.rint(x / spacing).astype(int)) for t, x in points]
    every = [np.concatenate(part) for part in zip(*cells, strict=True)]
    if not len(every[0]):
        return [np.empty(0, int) for _ in points]
    low = [part.min() for part in every]
    grid = np.zeros([part.max() - least + 1 for part, least in zip(every, low, strict=True)], bool)
    for row, column in cells:
        grid[row - low[0], column - low[1]] = True
    numbers, _ = label(binary_dilation(grid, np.ones((2 * BRIDGED - 1, 3))), np.ones((3, 3)))
    return [numbers[row - low[0], column - low[1]] for row, column in cells]


class _Reader:
    """Film and pressure of one member at given x and times."""

    def __init__(self, result):
        self.result = result

    def has(self, time):
        """Whether a frame at this very time is stored: meshes share only some of their levels."""
        stored = self.result.time
        return bool(np.abs(stored - time).min() < TIME_TOLERANCE * np.diff(stored).max())

    def __call__(self, x, time):
        frame = self.result.nearest_frame(time=time)
        node = int(np.argmin(np.abs(self.result.x - x)))
        film, pressure = (float(self.result[name][frame, node]) for name in ("film_thickness", "pressure"))
        return 0.0 if in_contact(self.result, frame, node) else film, pressure


def _collision(parts, at):
    touching = tuple(bool(len(t)) for t, _ in parts)
    first = touching.index(True)
    best, chosen = (-1, -1, -1.0), None
    for time, x in zip(*parts[first], strict=True):
        film, pressure = zip(*(read(x, time) for read in at), strict=True)
        rank = (sum(read.has(time) for read in at), sum(h <= 0.0 for h in film), max(pressure))
        if rank > best:
            best, chosen = rank, (float(x), float(time), film, pressure)
    x, time, film, pressure = chosen
    times = np.concatenate([t for t, _ in parts])
    return Collision(x, time, float(times.min()), float(times.max()), touching, film, pressure)


def report(results):
    """Report on the collisions of a series, as lines of text."""
    results, values, key = from_thick_to_thin(results)
    found = find(results)
    a = results[0].attrs["a"]
    swept = ", ".join(f"{v:g}" for v in values)
    lines = [
        f"{len(found)} collisions in {len(results)} members, {key} = {swept}",
        "number     x/a    time/us  touching  film/um, pressure/GPa at that point in each member",
    ]
    for number, c in enumerate(found):
        marks = "".join("x" if touches else "." for touches in c.touching)
        pairs = " ".join(f"{1e6 * h:.4f},{1e-9 * p:.2f}" for h, p in zip(c.film, c.pressure, strict=True))
        lines.append(f"{number:6d} {c.x / a:8.4f} {1e6 * c.time:10.3f}  {marks}  {pairs}")
    return lines + (breakdown(found, values, smooth_films(results)) if key in WITH_FILM else [])


def main(arguments=None):
    """Run the command; returns its exit status: 0 done, 2 bad input."""
    return command("ehlpetsc.analysis.collisions", __doc__.split("\n")[0], report, arguments)


if __name__ == "__main__":
    sys.exit(main())
