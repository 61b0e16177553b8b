r"""Tables of quantities over conditions, refined until held-out points agree.

A table has lines on each axis, and values at all their crossings. Between them values are multilinear: in the
coordinate, or its logarithm where the axis has decades; of the logarithm of the quantity where that is
positive everywhere. The stated error is that of this interpolation.

Refinement begins with three lines an axis. The error of an interval follows from the line between it and its
neighbour: the change by that line over four, as the error of a linear interpolation falls with the square of
the interval. Intervals with an error above the tolerance are halved. Points between the lines, computed but
not used, then measure the error: where one is off by more, refinement continues.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import product
from typing import NamedTuple

import numpy as np

from ehlpetsc.base.errors import UsageError

FIRST_LINES = 3
HELD_OUT = 8  # points each time
DECADES = 3.0  # ratio of the ends of an axis from which on it is logarithmic
FLOOR = 0.01  # of the maximum of a quantity: smaller values have an absolute error
MAX_POINTS = 4000

Point = tuple[float, ...]
Compute = Callable[[list[Point]], np.ndarray]  # values at points, shape (points, quantities)


class Axis(NamedTuple):
    """Axis of a table: name and unit of its quantity, its ends."""

    name: str
    unit: str
    low: float
    high: float

    @property
    def is_logarithmic(self) -> bool:
        """Whether the coordinate of interpolation is the logarithm."""
        return self.low > 0.0 and self.high > DECADES * self.low

    def coordinate(self, values: np.ndarray) -> np.ndarray:
        """Coordinate of interpolation."""
        return np.log(values) if self.is_logarithmic else np.asarray(values, float)

    def value(self, coordinate: float) -> float:
        """Value at a coordinate, rounded to six digits so that files show the value that was computed."""
        return float(f"{np.exp(coordinate) if self.is_logarithmic else coordinate:.6g}")


@dataclass
class Table:
    """Values over axes.

    Attributes
    ----------
    axes, names
        Axes, names of the quantities.
    lines
        Increasing values of each axis.
    found
        Values by point, shape (quantities,), of the crossings and of the points held out.
    errors
        Largest error of each quantity at the points held out last, relative.
    """

    axes: Sequence[Axis]
    names: Sequence[str]
    lines: list[list[float]]
    found: dict[Point, np.ndarray] = field(default_factory=dict)
    errors: np.ndarray = field(default_factory=lambda: np.zeros(0))

    @property
    def points(self) -> list[Point]:
        """Crossings of the lines, the last axis fastest."""
        return list(product(*self.lines))

    @property
    def values(self) -> np.ndarray:
        """Values at the crossings, shape (lines of each axis ..., quantities)."""
        grid = np.array([self.found[point] for point in self.points])
        return grid.reshape(*map(len, self.lines), len(self.names))

    def at(self, points: Sequence[Point]) -> np.ndarray:
        """Interpolated values, shape (points, quantities)."""
        from scipy.interpolate import RegularGridInterpolator

        interpolator = RegularGridInterpolator(self._coordinates, self.logarithms)
        columns = zip(self.axes, np.array(points, float).T, strict=True)
        out = interpolator(np.stack([axis.coordinate(column) for axis, column in columns], axis=1))
        return np.where(self.positive, np.exp(out), out)

    @property
    def _coordinates(self) -> list[np.ndarray]:
        return [axis.coordinate(np.array(line)) for axis, line in zip(self.axes, self.lines, strict=True)]

    @property
    def positive(self) -> np.ndarray:
        """Whether a quantity is positive at all crossings, shape (quantities,)."""
        return (self.values > 0.0).reshape(-1, len(self.names)).all(axis=0)

    @property
    def logarithms(self) -> np.ndarray:
        """Values at the crossings, of positive quantities their logarithms."""
        values, positive = self.values, self.positive
        return np.where(positive, np.log(np.where(positive, values, 1.0)), values)

    def relative(self, error: np.ndarray) -> np.ndarray:
        """Relative errors of differences of what is interpolated; last axis: quantities."""
        largest = np.abs(self.values).reshape(-1, len(self.names)).max(axis=0)
        scale = np.where(self.positive, 1.0, np.maximum(largest, np.finfo(float).tiny))
        return np.abs(error) / scale

    def interval_errors(self) -> list[list[float]]:
        """Expected relative errors of the intervals of each axis, by the differences of the logarithms."""
        grid, found = self.logarithms, []
        for number, coordinate in enumerate(self._coordinates):
            along, errors = np.moveaxis(grid, number, 0), [0.0] * (len(coordinate) - 1)
            for k in range(1, len(coordinate) - 1):
                share = (coordinate[k] - coordinate[k - 1]) / (coordinate[k + 1] - coordinate[k - 1])
                without = (1.0 - share) * along[k - 1] + share * along[k + 1]
                error = float(self.relative(along[k] - without).max()) / 4.0
                for interval in (k - 1, k):
                    errors[interval] = max(errors[interval], error)
            found.append(errors)
        return found

    def halve(self, intervals: Sequence[tuple[int, int]]) -> None:
        """Add a line in the middle of intervals of axes."""
        for number, interval in sorted(intervals, reverse=True):
            axis, line = self.axes[number], self.lines[number]
            ends = axis.coordinate(np.array(line[interval : interval + 2]))
            line.insert(interval + 1, axis.value(float(ends.mean())))


def tabulate(
    axes: Sequence[Axis],
    names: Sequence[str],
    compute: Compute,
    tolerance: float,
    show: Callable[[str], None] = lambda text: None,
) -> Table:
    """Table whose held-out points agree with it within a relative tolerance.

    `show`: called with a line after each refinement.

    Raises `UsageError` where that takes more than `MAX_POINTS` points.
    """
    from scipy.stats import qmc

    table = Table(axes, names, [_first_lines(axis) for axis in axes])
    sequence, ends = qmc.Halton(len(axes), seed=1), [axis.coordinate(np.array(axis[2:])) for axis in axes]
    while True:
        if len(table.points) > MAX_POINTS:
            raise UsageError(
                f"{len(table.points)} points would be needed for errors within {100 * tolerance:g} %; "
                f"allowed: {MAX_POINTS}; take narrower ranges, or a larger --tolerance"
            )
        _complete(table, table.points, compute)
        intervals = [
            (e, n, k) for n, errors in enumerate(table.interval_errors()) for k, e in enumerate(errors)
        ]
        coarse = [(n, k) for e, n, k in intervals if e > tolerance]
        if not coarse:
            places = sequence.random(HELD_OUT)
            points = [
                tuple(
                    axis.value(low + x * (high - low))
                    for axis, x, (low, high) in zip(axes, at, ends, strict=True)
                )
                for at in places
            ]
            _complete(table, points, compute)
            held_out = np.array([table.found[point] for point in points])
            table.errors = _errors(table.at(points), held_out)
            show(f"{len(table.points)} points, error {100 * table.errors.max():.2g} % at {HELD_OUT} others")
            if table.errors.max() <= tolerance:
                return table
            coarse = [max(intervals)[1:]]
        table.halve(coarse)


def _first_lines(axis: Axis) -> list[float]:
    ends = axis.coordinate(np.array([axis.low, axis.high]))
    return [axis.value(float(one)) for one in np.linspace(*ends, FIRST_LINES)]


def _complete(table: Table, points: Sequence[Point], compute: Compute) -> None:
    """Compute the points that are missing."""
    if missing := [point for point in points if point not in table.found]:
        table.found.update(zip(missing, compute(missing), strict=True))


def _errors(found: np.ndarray, exact: np.ndarray) -> np.ndarray:
    """Largest relative error of each quantity, shape (points, quantities) of both."""
    floor = np.maximum(FLOOR * np.abs(exact).max(axis=0), np.finfo(float).tiny)
    return (np.abs(found - exact) / np.maximum(np.abs(exact), floor)).max(axis=0)
