"""Compare two result files field by field: ``ehlpetsc compare A.h5 B.h5 [--rtol R] [--atol A]``.

If meshes or stored times differ, the nodes and times that both have are compared. A quantity is equal if its
maximum difference is within ``atol + rtol scale``, where the scale is the maximum magnitude in either file.
Contacts on different meshes are compared as fractions of nodes and of steps. Scalars of the solution process
(iterations, time steps, wall clock) are not compared.

Exit status: 0 equal, 1 different, 2 the files cannot be compared.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ehlpetsc.base.command_parser import CommandParser, exit_status
from ehlpetsc.base.errors import OutputError
from ehlpetsc.effects.quantities import FIELDS, STEP_SCALARS
from ehlpetsc.results.reader import Result, read_result

RTOL = 1e-6  # default of --rtol
FRAMES_PER_READ = 256
ABSCISSA_TOLERANCE = 1e-9  # of the extent: computed coordinates nearer than this are equal
NOWHERE = np.array([np.nan])  # position of what has none


@dataclass
class Difference:
    """Norms of the difference of one quantity.

    `scale`: maximum magnitude in either file. `max`, `rms`: maximum and root mean square difference; nan if
    one file has a value and the other nan. `x`, `time`: where and when the difference is greatest [m, s]; nan
    of a quantity without positions or times.
    """

    name: str
    units: str
    scale: float = 0.0
    max: float = 0.0
    rms: float = 0.0
    x: float = np.nan
    time: float = np.nan

    def same(self, rtol: float, atol: float) -> bool:
        """Whether the maximum difference is allowed."""
        return bool(self.max <= atol + rtol * self.scale)

    def relative(self, value: float) -> float:
        """Norm over the scale of the quantity."""
        return value / self.scale if self.scale else value


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

    An OutputError if the results have no nodes or no times in common, or if one has no frame.
    """
    both = one, other
    for result in both:
        if not len(result.time) or not len(result.steps("time")):
            raise OutputError(f"{result.path}: no time step in it")
    nodes, frames = common(one.x, other.x, "nodes"), common(one.time, other.time, "times")
    x, is_same_mesh = one.x[nodes[0]], len(one.x) == len(other.x) == len(nodes[0])
    for name in [name for name in FIELDS if name in one.fields and name in other.fields]:
        if name != "in_contact" or is_same_mesh:
            yield _difference(name, FIELDS[name].units, _blocks(both, name, frames, nodes), x)
            continue
        blocks = _blocks(both, name, frames, [slice(None)] * 2)
        means = ([*(v.mean(axis=1, keepdims=True) for v in two), times] for *two, times in blocks)
        yield _difference(name, "share", means, NOWHERE)
    counts = [r.contact_count[n] / len(r.steps("time")) for r, n in zip(both, nodes, strict=True)]
    yield _difference("contact_count", "share", [[*(count[None] for count in counts), NOWHERE]], x)
    rows = common(one.steps("time"), other.steps("time"), "time steps")
    times, shared = one.steps("time")[rows[0]], set(one.scalars) & set(other.scalars)
    for name in [n for n in STEP_SCALARS if STEP_SCALARS[n].compared and n in shared]:
        is_count = name == "contacts"
        sizes = [len(result.x) if is_count else 1.0 for result in both]
        columns = zip(both, rows, sizes, strict=True)
        curves = [(result.steps(name)[chosen] / size)[:, None] for result, chosen, size in columns]
        units = "share" if is_count else STEP_SCALARS[name].units
        yield _difference(f"steps/{name}", units, [[*curves, times]], NOWHERE)


def _blocks(
    both: tuple[Result, Result], name: str, frames: list[np.ndarray], nodes: list
) -> Iterator[list[np.ndarray]]:
    """Values (frames, nodes) of a field in both results, and their times, some frames at a time."""
    count = -(-len(frames[0]) // FRAMES_PER_READ)
    for pair in zip(*(np.array_split(numbers, count) for numbers in frames), strict=True):
        parts = zip(both, pair, nodes, strict=True)
        values = [result[name][block][:, chosen].astype(float) for result, block, chosen in parts]
        yield [*values, both[0].time[pair[0]]]


def _difference(name: str, units: str, blocks: Iterable[list[np.ndarray]], x: np.ndarray) -> Difference:
    """Difference of a quantity from blocks of the values (times, x) in both files, and their times."""
    square, count, scale, largest, place = 0.0, 0, 0.0, 0.0, (np.nan, np.nan)
    for *values, times in blocks:
        deviation = np.abs(values[0] - values[1])
        deviation[np.isnan(values[0]) & np.isnan(values[1])] = 0.0
        square, count = square + float(np.sum(deviation**2)), count + deviation.size
        scale = max(scale, *(float(np.nanmax(np.abs(v), initial=0.0)) for v in values))
        frame, node = np.unravel_index(deviation.argmax(), deviation.shape)  # a nan counts as the maximum
        if not deviation[frame, node] <= largest and not np.isnan(largest):
            largest, place = float(deviation[frame, node]), (float(x[node]), float(times[frame]))
    return Difference(name, units, scale, largest, float(np.sqrt(square / count)), *place)


def table(differences: Iterable[Difference], a: float, rtol: float, atol: float) -> str:
    """Lines of text, one for each difference; x in half-widths a."""
    lines = [
        f"{'quantity':<20} {'unit':<6} {'scale':>11} {'max/scale':>10} {'rms/scale':>10} {'at x/a':>8}"
        f" {'at t/us':>10}"
    ]
    for d in differences:
        x, time = ("" if np.isnan(value) else f"{value:.4f}" for value in (d.x / a, 1e6 * d.time))
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


def main(words: Sequence[str]) -> int:
    """Run the command; returns its exit status."""
    description = "Compare two result files field by field."
    parser = CommandParser("compare", description, "")
    parser.add_argument("one", metavar="A.h5")
    parser.add_argument("other", metavar="B.h5")
    parser.add_argument("--rtol", type=float, default=RTOL, help="over the scale [%(default)s]")
    parser.add_argument("--atol", type=float, default=0.0, help="in SI units [%(default)s]")
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
