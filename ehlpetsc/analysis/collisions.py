"""Collisions of asperities in the members of a series.

Members of a series have the same roughness, kinematics and, except for halved steps, time levels: an asperity
pair is in the same relative position in all of them at the same time. The contact nodes of all members are
entered in one map over x and time, whose connected regions are the collisions. Times, not step numbers, are
compared.

``ehlpetsc collisions OUTPUT.series.json`` lists the collisions and the dependence of film and pressure on the
varied value (Holmes et al. 2005, figure 4).
"""

import sys
from dataclasses import dataclass

import numpy as np

from ehlpetsc.analysis.film_breakdown import breakdown, smooth_films
from ehlpetsc.errors import OutputError
from ehlpetsc.results.contacts import in_contact
from ehlpetsc.results.series_index import WITH_FILM, command, from_thick_to_thin

MAX_INTERRUPTION = 2  # cells of the map: contacts with longer interruptions are different collisions
TIME_TOLERANCE = 1e-3  # of the interval between frames: times nearer than this are equal
FRAMES_PER_BLOCK = 256  # read at once


@dataclass(frozen=True)
class Collision:
    """Collision of two asperities in the members of a series.

    Attributes
    ----------
    x, time : float
        Representative point, a contact of the first member in contact [m, s]: at a time stored by most
        members, then with most members in contact, then with the highest pressure of any member.
    begin, end : float
        Times of the first and last contact in any member [s].
    touching : tuple of bool
        For each member whether the surfaces are in contact anywhere in the collision.
    film, pressure : tuple of float
        Values of each member at the point [m, Pa]; the film is 0 in contact, also with a bound above 0.
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
        The result has no frame, or neither contacts nor films.
    """
    if not len(result.time):
        raise OutputError(f"{result.path}: no frame in it")
    frames, nodes = [], []
    for begin in range(0, len(result.time), FRAMES_PER_BLOCK):
        end = min(begin + FRAMES_PER_BLOCK, len(result.time))
        frame, node = np.nonzero(in_contact(result, slice(begin, end)))
        frames.append(frame + begin)
        nodes.append(node)
    return np.concatenate(frames), np.concatenate(nodes)


def find(results):
    """Collisions of a series, in order of time.

    Parameters
    ----------
    results : list of ehlpetsc.results.reader.Result
        Members in the order of falling films.

    Returns
    -------
    list of Collision

    Raises
    ------
    OutputError
        A result has fewer than two frames, or no contacts.
    """
    if any(len(result.time) < 2 for result in results):
        raise OutputError("collisions need more than one stored frame")
    spacing = max(float(np.diff(result.x).max()) for result in results)
    interval = max(float(np.diff(result.time).max()) for result in results)
    points = [_points(result) for result in results]
    labels = _label(points, spacing, interval)
    readers = [_Reader(result) for result in results]
    collisions = []
    for label in range(1, 1 + max((int(numbers.max(initial=0)) for numbers in labels), default=0)):
        points_of_collision = [
            (t[numbers == label], x[numbers == label]) for (t, x), numbers in zip(points, labels, strict=True)
        ]
        collisions.append(_collision(points_of_collision, readers))
    return sorted(collisions, key=lambda collision: collision.time)


def _points(result):
    frames, nodes = points_in_contact(result)
    return result.time[frames], result.x[nodes]


def _label(points, spacing, interval):
    """Number of the collision of every point, an array for each member."""
    from scipy.ndimage import binary_dilation, label

    cells = [(np.rint(t / interval).astype(int), np.rint(x / spacing).astype(int)) for t, x in points]
    all_indices = [np.concatenate(indices) for indices in zip(*cells, strict=True)]
    if not len(all_indices[0]):
        return [np.empty(0, int) for _ in points]
    low = [indices.min() for indices in all_indices]
    grid = np.zeros(
        [indices.max() - lowest + 1 for indices, lowest in zip(all_indices, low, strict=True)], bool
    )
    for row, column in cells:
        grid[row - low[0], column - low[1]] = True
    numbers, _ = label(binary_dilation(grid, np.ones((2 * MAX_INTERRUPTION - 1, 3))), np.ones((3, 3)))
    return [numbers[row - low[0], column - low[1]] for row, column in cells]


class _Reader:
    """Film and pressure of one member at given x and times."""

    def __init__(self, result):
        self.result = result

    def has(self, time):
        """Whether a frame at this time is stored: meshes have only some time levels in common."""
        stored = self.result.time
        return bool(np.abs(stored - time).min() < TIME_TOLERANCE * np.diff(stored).max())

    def __call__(self, x, time):
        frame = self.result.nearest_frame(time=time)
        node = int(np.argmin(np.abs(self.result.x - x)))
        film, pressure = (float(self.result[name][frame, node]) for name in ("film_thickness", "pressure"))
        return 0.0 if in_contact(self.result, frame, node) else film, pressure


def _collision(points, readers):
    touching = tuple(bool(len(t)) for t, _ in points)
    first = touching.index(True)
    best, chosen = (-1, -1, -1.0), None
    for time, x in zip(*points[first], strict=True):
        film, pressure = zip(*(read(x, time) for read in readers), strict=True)
        rank = (sum(read.has(time) for read in readers), sum(h <= 0.0 for h in film), max(pressure))
        if rank > best:
            best, chosen = rank, (float(x), float(time), film, pressure)
    x, time, film, pressure = chosen
    times = np.concatenate([t for t, _ in points])
    return Collision(x, time, float(times.min()), float(times.max()), touching, film, pressure)


def report(results):
    """Report on the collisions of a series, as lines of text."""
    results, values, key = from_thick_to_thin(results)
    collisions = find(results)
    a = results[0].attrs["a"]
    swept = ", ".join(f"{v:g}" for v in values)
    lines = [
        f"{len(collisions)} collisions in {len(results)} members, {key} = {swept}",
        "number     x/a    time/us  touching  film/um, pressure/GPa at that point in each member",
    ]
    for number, c in enumerate(collisions):
        flags = "".join("x" if touches else "." for touches in c.touching)
        pairs = " ".join(f"{1e6 * h:.4f},{1e-9 * p:.2f}" for h, p in zip(c.film, c.pressure, strict=True))
        lines.append(f"{number:6d} {c.x / a:8.4f} {1e6 * c.time:10.3f}  {flags}  {pairs}")
    return lines + (breakdown(collisions, values, smooth_films(results)) if key in WITH_FILM else [])


def main(arguments=None):
    """Run the command; returns its exit status: 0 done, 2 bad input."""
    return command("ehlpetsc.analysis.collisions", __doc__.split("\n")[0], report, arguments)


if __name__ == "__main__":
    sys.exit(main())
