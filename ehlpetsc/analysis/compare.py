"""Comparison of two result files field by field, at the nodes and times that both have.

A quantity is equal if its maximum difference is within ``rtol scale``, where the scale is the maximum
magnitude in either file. Scalars of the solution process (iterations, time steps, wall clock) are not
compared.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

import ehlpetsc.effects  # noqa: F401 - which adds its quantities to the table of all
from ehlpetsc.base.errors import OutputError
from ehlpetsc.base.quantities import FIELDS, STEP_SCALARS
from ehlpetsc.results.reader import Result

ABSCISSA_TOLERANCE = 1e-9  # of the extent: computed coordinates nearer than this are equal
LINE_KIND = "line"
NOWHERE = np.array([np.nan]), np.array([np.nan])
NODE_COUNTS = ("in_contact", "contacts", "contact_count")  # numbers of nodes or at nodes: of the mesh


@dataclass
class Difference:
    """Norms of the difference of one quantity.

    `scale`: maximum magnitude in either file. `max`, `rms`: maximum and root mean square difference; nan if
    one file has a value and the other nan. `x`, `y`, `time`: where and when the difference is greatest
    [m, s]; nan of a quantity without positions or times, and y in a line contact.
    """

    name: str
    units: str
    scale: float
    max: float
    rms: float
    x: float
    y: float
    time: float

    def same(self, rtol: float) -> bool:
        """Whether the maximum difference is allowed."""
        return bool(self.max <= rtol * self.scale)


def common(one: np.ndarray, other: np.ndarray, name: str) -> list[np.ndarray]:
    """Indices of the values that both of two increasing grids have; OutputError if there are none."""
    if len(one) == len(other) == 1:  # two steady solutions, whatever their times
        return [np.zeros(1, int)] * 2
    slack = ABSCISSA_TOLERANCE * max(np.ptp(one), np.ptp(other))
    nearest = np.minimum(np.searchsorted(other, one - slack), len(other) - 1)
    shared = np.abs(other[nearest] - one) <= slack
    if not shared.any():
        raise OutputError(f"the files have no {name} in common")
    return [np.flatnonzero(shared), nearest[shared]]


def compare(one: Result, other: Result) -> Iterator[Difference]:
    """Differences of all quantities stored in both results.

    An OutputError if the results have no nodes or no times in common, if one has no frame, or of contacts of
    different kinds.
    """
    both = one, other
    kinds = [result.attrs.get("kind", LINE_KIND) for result in both]
    if kinds[0] != kinds[1]:
        raise OutputError(f"a {kinds[0]} and a {kinds[1]} contact: {other.path}: allowed: two of one kind")
    for result in both:
        if not len(result.time):
            raise OutputError(f"{result.path}: no frame in it")
    nodes, frames = common_nodes(one, other), common(one.time, other.time, "times")
    x, y = (axis[nodes[0]] for axis in positions(one))
    time = one.time[frames[0]]
    skipped = () if one.contact_count.size == other.contact_count.size == len(x) else NODE_COUNTS
    for name in [name for name in FIELDS if name in one.fields and name in other.fields]:
        if name not in skipped:
            first, second = (
                r[name][:][f].reshape(len(f), -1)[:, n] for r, f, n in zip(both, frames, nodes, strict=True)
            )
            yield difference(name, one.unit(name), first, second, (x, y), time)
    rows = common(one.steps("time"), other.steps("time"), "time steps")
    shared, time = set(one.scalars) & set(other.scalars), one.steps("time")[rows[0]]
    for name in [name for name in STEP_SCALARS if STEP_SCALARS[name].compared and name in shared]:
        if name not in skipped:
            first, second = (r.steps(name)[chosen, None] for r, chosen in zip(both, rows, strict=True))
            yield difference(f"steps/{name}", one.unit(f"steps/{name}"), first, second, NOWHERE, time)


def common_nodes(one: Result, other: Result) -> list[np.ndarray]:
    """Flat indices of the nodes that both results have; OutputError if there are none."""
    nodes = common(one.x, other.x, "nodes")
    if one.y is None:
        return nodes
    rows = common(one.y, other.y, "nodes")
    both = zip((one, other), rows, nodes, strict=True)
    return [np.add.outer(row * len(result.x), node).ravel() for result, row, node in both]


def positions(result: Result) -> tuple[np.ndarray, np.ndarray]:
    """x and y [m] of all nodes, flat; y is nan in a line contact."""
    y = np.array([np.nan]) if result.y is None else result.y
    return np.tile(result.x, len(y)), np.repeat(y, len(result.x))


def difference(
    name: str,
    units: str,
    one: np.ndarray,
    other: np.ndarray,
    places: tuple[np.ndarray, np.ndarray],
    time: np.ndarray,
) -> Difference:
    """Difference of a quantity from its values (times, nodes) in both files; nan in both is none."""
    one, other = one.astype(float), other.astype(float)
    deviation = np.where(np.isnan(one) & np.isnan(other), 0.0, np.abs(one - other))
    scale = max(float(np.nanmax(np.abs(values), initial=0.0)) for values in (one, other))
    frame, node = np.unravel_index(deviation.argmax(), deviation.shape)  # a nan counts as the maximum
    norms = float(deviation[frame, node]), float(np.sqrt(np.mean(deviation**2)))
    x, y = (float(axis[node]) for axis in places)
    return Difference(name, units, scale, *norms, x, y, float(time[frame]))


def table(differences: Iterable[Difference], a: float, rtol: float) -> str:
    """Lines of text, one for each difference; x and y in half-widths a."""
    differences = list(differences)
    in_plane = not all(np.isnan(d.y) for d in differences)
    lines = [
        f"{'quantity':<20} {'unit':<6} {'scale':>11} {'max/scale':>10} {'rms/scale':>10} {'at x/a':>8}"
        f"{' ' + 'at y/a'.rjust(8) if in_plane else ''} {'at t/us':>10}"
    ]
    for d in differences:
        largest, rms = (norm / (d.scale or 1.0) for norm in (d.max, d.rms))
        x, y, time = ("" if np.isnan(value) else f"{value:.4f}" for value in (d.x / a, d.y / a, 1e6 * d.time))
        lines.append(
            f"{d.name:<20} {d.units:<6} {d.scale:>11.4e} {largest:>10.2e} {rms:>10.2e}"
            f" {x:>8}{' ' + y.rjust(8) if in_plane else ''} {time:>10}"
            f"  {'same' if d.same(rtol) else 'DIFFERENT'}"
        )
    return "\n".join(lines)
