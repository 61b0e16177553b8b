"""Compare two result files field by field: ``ehlpetsc compare A.h5 B.h5 [--rtol R] [--atol A]``.

If meshes or stored times differ, the finer result is interpolated linearly at the nodes and times of the
coarser one, in their common range. A quantity is equal if its maximum difference is within
``atol + rtol scale``, where the scale is the maximum magnitude in either file. Contacts are compared as
fractions of nodes and of steps. Scalars of the solution process (iterations, time steps, wall clock) are not
compared.

Exit status: 0 equal, 1 different, 2 the files cannot be compared.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ehlpetsc.base.command_parser import CommandParser, exit_status
from ehlpetsc.base.errors import OutputError
from ehlpetsc.effects.quantities import FIELDS, STEP_SCALARS
from ehlpetsc.results.reader import Result, read_result

RTOL = 1e-6  # default of --rtol
BLOCK_BYTES = 2**24  # of a field, read at once
ABSCISSA_TOLERANCE = 1e-9  # of the extent: computed coordinates nearer than this are equal


@dataclass
class Difference:
    """Norms of the difference of one quantity.

    Attributes
    ----------
    scale
        Maximum magnitude in either file.
    max, rms
        Maximum and root mean square difference; nan if one file has a value and the other nan.
    x, time
        Where and when the difference is greatest [m, s].
    """

    name: str
    units: str
    scale: float = 0.0
    max: float = 0.0
    rms: float = 0.0
    x: float | None = None
    time: float | None = None

    def same(self, rtol: float, atol: float) -> bool:
        """Whether the maximum difference is allowed."""
        return bool(self.max <= atol + rtol * self.scale)

    def relative(self, value: float) -> float:
        """Norm over the scale of the quantity."""
        return value / self.scale if self.scale else value


class LinearInterpolation:
    """Linear interpolation from a grid to points."""

    def __init__(self, grid: np.ndarray, points: np.ndarray) -> None:
        at = np.clip(np.searchsorted(grid, points, side="right") - 1, 0, max(len(grid) - 2, 0))
        self.left, self.right = at, np.minimum(at + 1, len(grid) - 1)
        width = np.where(self.right > at, grid[self.right] - grid[at], 1.0)
        self.weight = np.clip((points - grid[at]) / width, 0.0, 1.0)

    def __call__(self, values: np.ndarray, selection: slice = slice(None), begin: int = 0) -> np.ndarray:
        """Values at the points of `selection`, `values` starting at grid point `begin` on the first axis."""
        weight = self.weight[selection].reshape(-1, *[1] * (values.ndim - 1))
        low, high = values[self.left[selection] - begin], values[self.right[selection] - begin]
        return np.where(weight == 0.0, low, (1.0 - weight) * low + weight * high)


def common_points(one: np.ndarray, other: np.ndarray, name: str) -> np.ndarray:
    """Points of the coarser of two increasing grids in their common range; OutputError if it is empty."""
    if len(one) == len(other) == 1:  # two steady solutions, whatever their times
        return one
    slack = ABSCISSA_TOLERANCE * max(np.ptp(one), np.ptp(other))
    low, high = max(one[0], other[0]) - slack, min(one[-1], other[-1]) + slack
    inside = [grid[(grid >= low) & (grid <= high)] for grid in (one, other)]
    points = min(inside, key=len)
    if not len(points):
        raise OutputError(f"the files have no {name} in common")
    return points


def compare(one: Result, other: Result) -> Iterator[Difference]:
    """Differences of all quantities stored in both results.

    An OutputError if the results have no nodes or no times in common, or if one has no frame.
    """
    for result in (one, other):
        if not len(result.time) or not len(result.steps("time")):
            raise OutputError(f"{result.path}: no time step in it")
    x = common_points(one.x, other.x, "nodes")
    times = common_points(one.time, other.time, "times")
    same_mesh = np.array_equal(one.x, other.x)
    for name in FIELDS:
        if name in one.fields and name in other.fields:
            yield _field(one, other, name, x, times, same_mesh or name != "in_contact")
    fractions = [LinearInterpolation(r.x, x)(r.contact_count / len(r.steps("time"))) for r in (one, other)]
    yield _curves(Difference("contact_count", "share"), fractions, x=x)
    common = set(one.scalars) & set(other.scalars)
    step_times = common_points(one.steps("time"), other.steps("time"), "time steps")
    for name in [n for n in STEP_SCALARS if STEP_SCALARS[n].compared and n in common]:
        values = [_scalar(r, name, step_times) for r in (one, other)]
        units = "share" if name == "contacts" else STEP_SCALARS[name].units
        yield _curves(Difference(f"steps/{name}", units), values, time=step_times)


def _scalar(result: Result, name: str, times: np.ndarray) -> np.ndarray:
    values = result.steps(name).astype(float)
    at_times = LinearInterpolation(result.steps("time"), times)
    return at_times(values / len(result.x) if name == "contacts" else values)


def _curves(
    difference: Difference,
    values: Sequence[np.ndarray],
    x: np.ndarray | None = None,
    time: np.ndarray | None = None,
) -> Difference:
    one, other = values
    deviation = np.abs(one - other)
    deviation[np.isnan(one) & np.isnan(other)] = 0.0
    worst = int(np.argmax(deviation))  # a nan counts as the maximum
    return replace(
        difference,
        scale=float(np.nanmax(np.abs(values), initial=0.0)),
        max=float(deviation[worst]),
        rms=float(np.sqrt(np.mean(deviation**2))),
        x=None if x is None else float(x[worst]),
        time=None if time is None else float(time[worst]),
    )


def _field(
    one: Result, other: Result, name: str, x: np.ndarray, times: np.ndarray, by_node: bool
) -> Difference:
    """Difference of a field, or without `by_node` of its mean over x, read in blocks of frames."""
    difference = Difference(name, FIELDS[name].units if by_node else "share")
    readers = [_Reader(result, name, x, times) for result in (one, other)]
    block = max(1, BLOCK_BYTES // (8 * max(len(one.x), len(other.x))))
    square = 0.0
    for begin in range(0, len(times), block):
        rows = slice(begin, min(begin + block, len(times)))
        values = [reader(rows) for reader in readers]
        if not by_node:
            values = [v.mean(axis=1, keepdims=True) for v in values]
        deviation = np.abs(values[0] - values[1])
        deviation[np.isnan(values[0]) & np.isnan(values[1])] = 0.0
        square += float(np.sum(deviation**2)) / (len(times) * deviation.shape[1])
        difference.scale = max(difference.scale, *(float(np.nanmax(np.abs(v), initial=0.0)) for v in values))
        frame, node = np.unravel_index(np.argmax(deviation), deviation.shape)
        if not deviation[frame, node] <= difference.max and not np.isnan(difference.max):
            difference.max, difference.time = float(deviation[frame, node]), float(times[begin + frame])
            difference.x = float(x[node]) if by_node else None
    difference.rms = float(np.sqrt(square))
    return difference


class _Reader:
    """Field at common nodes and times, by blocks of frames."""

    def __init__(self, result: Result, name: str, x: np.ndarray, times: np.ndarray) -> None:
        self._dataset = result[name]
        self._in_time, self._in_x = (
            LinearInterpolation(result.time, times),
            LinearInterpolation(result.x, x),
        )

    def __call__(self, rows: slice) -> np.ndarray:
        first, last = self._in_time.left[rows].min(), self._in_time.right[rows].max()
        frames = self._dataset[first : last + 1].astype(float)
        return self._in_x(self._in_time(frames, rows, first).T).T


def table(differences: Iterable[Difference], a: float, rtol: float, atol: float) -> str:
    """Lines of text, one for each difference; x in half widths a."""
    lines = [
        f"{'quantity':<20} {'unit':<6} {'scale':>11} {'max/scale':>10} {'rms/scale':>10} {'at x/a':>8}"
        f" {'at t/us':>10}"
    ]
    for d in differences:
        x = "" if d.x is None else f"{d.x / a:.3f}"
        time = "" if d.time is None else f"{1e6 * d.time:.4f}"
        lines.append(
            f"{d.name:<20} {d.units:<6} {d.scale:>11.4e} {d.relative(d.max):>10.2e}"
            f" {d.relative(d.rms):>10.2e} {x:>8} {time:>10}  {'same' if d.same(rtol, atol) else 'DIFFERENT'}"
        )
    return "\n".join(lines)


def _about(result: Result) -> str:
    times, status = result.time, result.attrs["status"]
    span = f"{1e6 * times[0]:.4g} .. {1e6 * times[-1]:.4g} us"
    size = f"{len(result.x)} nodes, {len(times)} frames"
    return f"{result.path}: {result.attrs['title']}; {size}, {span}, {status}"


def _only_in_one(one: Result, other: Result) -> Iterator[str]:
    """Messages on fields that only one file has, and on different status of the runs."""
    for result, lacking in ((one, other), (other, one)):
        for name in sorted(set(result.fields) - set(lacking.fields)):
            yield f"{name} is stored in {result.path} alone"
    if one.attrs["status"] != other.attrs["status"]:
        yield f"one run is {one.attrs['status']}, the other {other.attrs['status']}"


def _tolerance(text: str) -> float:
    value = float(text)
    if not 0.0 <= value < np.inf:
        raise argparse.ArgumentTypeError(f"{text} is not a number >= 0")
    return value


def main(words: Sequence[str]) -> int:
    """Run the command; returns its exit status."""
    description = "Compare two result files field by field."
    parser = CommandParser("compare", description)
    parser.add_argument("one", metavar="A.h5")
    parser.add_argument("other", metavar="B.h5")
    parser.add_argument("--rtol", type=_tolerance, default=RTOL, help="over the scale [%(default)s]")
    parser.add_argument("--atol", type=_tolerance, default=0.0, help="in SI units [%(default)s]")
    options = parser.parse_args(words)
    return exit_status("compare", lambda: _compare_files(options))


def _compare_files(options: argparse.Namespace) -> int:
    with read_result(options.one) as one, read_result(options.other) as other:
        differences = list(compare(one, other))
        faults = list(_only_in_one(one, other))
        print(_about(one), _about(other), sep="\n")
        print(table(differences, float(one.attrs["a"]), options.rtol, options.atol))
    faults += [d.name for d in differences if not d.same(options.rtol, options.atol)]
    allowed = f"(rtol {options.rtol:g}, atol {options.atol:g})"
    print(f"different: {'; '.join(faults)} {allowed}" if faults else f"same {allowed}")
    return 1 if faults else 0
