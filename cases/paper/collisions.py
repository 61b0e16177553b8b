"""Collisions of asperities in a series: figures 1 to 4 and 6 of Holmes et al. (2005).

``./run_mpi.sh python cases/paper/collisions.py fig4.series.json`` lists the collisions and the dependence of
film and pressure on the varied value. ``--draw 18 28`` draws pressure and film at these collisions in all
members (figures 1 to 3 and 6), ``--points`` film and pressure at contact points over the varied value (figure
4).

Members have the same roughness, kinematics and, except for halved steps, times: an asperity pair is in the
same position in all of them at the same time. Contact nodes of all members are entered in one map over x and
time, whose connected regions are the collisions.
"""

from __future__ import annotations

import argparse
import contextlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from scipy.ndimage import binary_dilation, label

from ehlpetsc.api import Result
from ehlpetsc.pictures import style
from ehlpetsc.results.index import in_order, open_all, series_values

THINNING = ("fluid.viscosity", "motion.entrainment_speed")  # keys of which a smaller value is a thinner film
MAX_INTERRUPTION = 2  # cells of the map between two contacts of one collision
TIME_TOLERANCE = 1e-3  # of the interval between frames: times nearer than this are equal
VIEW = 0.12  # half-widths, of a picture of a collision


@dataclass(frozen=True)
class Collision:
    """Collision of two asperities; the tuples have a value for each member, from thick to thin film.

    x and time [m, s] are those of its contact point: a contact of the first member that touches, at a time
    that most members store, then with most members in contact, then with the maximum pressure.
    """

    x: float
    time: float
    touching: tuple[bool, ...]  # anywhere in the collision
    dry: tuple[bool, ...]  # at the contact point
    film: tuple[float, ...]  # there [m]
    pressure: tuple[float, ...]  # there [Pa]

    @property
    def first(self) -> int:
        """Number of members with a full film at the contact point before the first in contact."""
        return self.dry.index(True)


def open_series(paths: list[Path], stack: contextlib.ExitStack) -> tuple[list[Result], list[float], str]:
    """Results from thick to thin film (or by rising value), the varied values and their key."""
    results = in_order(open_all(paths, stack))
    key, values = series_values(results)
    if key is None:
        raise SystemExit("not a series: the cases differ in no single number")
    return (results[::-1], values[::-1], key) if key in THINNING else (results, values, key)


def contact_nodes(result: Result) -> tuple[np.ndarray, np.ndarray]:
    """Stored frames and nodes in contact, shape (n,) each."""
    return np.nonzero(result.contacts_at(slice(0, len(result.time))))


def find(results: list[Result]) -> list[Collision]:
    """Collisions of a series in the order of their times."""
    spacing = max(float(np.diff(result.x).max()) for result in results)
    interval = max(float(np.diff(result.time).max()) for result in results)
    points = [
        (result.time[frames], result.x[nodes])
        for result in results
        for frames, nodes in [contact_nodes(result)]
    ]
    cells = [np.rint([t / interval, x / spacing]).astype(int) for t, x in points]
    every = np.concatenate(cells, axis=1)
    if not every.size:
        return []
    low = every.min(axis=1, keepdims=True)
    grid = np.zeros((np.ptp(every, axis=1) + 1), bool)
    grid[tuple(every - low)] = True
    numbers, count = label(binary_dilation(grid, np.ones((2 * MAX_INTERRUPTION - 1, 3))), np.ones((3, 3)))
    labels = [numbers[tuple(cell - low)] for cell in cells]
    found = [
        _collision(results, [(t[own == k], x[own == k]) for (t, x), own in zip(points, labels, strict=True)])
        for k in range(1, count + 1)
    ]
    return sorted(found, key=lambda collision: collision.time)


def _collision(results: list[Result], points: list[tuple[np.ndarray, np.ndarray]]) -> Collision:
    touching = tuple(bool(len(t)) for t, _ in points)

    def rank(at: tuple[np.ndarray, ...]) -> tuple[int, int, float]:
        stored = (np.abs(r.time - at[0]).min() < TIME_TOLERANCE * np.diff(r.time).max() for r in results)
        _, dry, pressure = _values(results, *at)
        return sum(stored), sum(dry), max(pressure)

    time, x = max(zip(*points[touching.index(True)], strict=True), key=rank)
    film, dry, pressure = _values(results, time, x)
    return Collision(float(x), float(time), touching, dry, film, pressure)


def _values(results: list[Result], time: float, x: float) -> tuple[tuple, tuple, tuple]:
    """Film, contact and pressure of every member at the nearest node and stored time."""
    places = [(result.nearest_frame(time=time), int(np.argmin(np.abs(result.x - x)))) for result in results]
    pairs = list(zip(results, places, strict=True))
    film, pressure = (tuple(float(r[name][at]) for r, at in pairs) for name in ("film_thickness", "pressure"))
    return film, tuple(bool(r.contacts_at(*at)) for r, at in pairs), pressure


def breakdowns(collisions: list[Collision]) -> list[Collision]:
    """Collisions with two full films or more, then two members or more in contact; the middle ones first."""
    chosen = [c for c in collisions if 2 <= c.first < len(c.dry) - 1 and all(c.dry[c.first :])]
    return sorted(chosen, key=lambda c: (abs(c.first - len(c.dry) // 2), -c.pressure[-1]))


def slope_jumps(values: list[float], film: tuple[float, ...], first: int) -> np.ndarray:
    """Relative changes of the slope of the film over the values down to the first member in contact.

    The last slope is a lower bound, as the film cannot fall below its bound: where the last change is 0 or
    less, the straight line through the last two films reaches the bound before that member.
    """
    slopes = -np.diff(film[: first + 1]) / np.abs(np.diff(values[: first + 1]))
    return slopes[1:] / slopes[:-1] - 1.0


def report(collisions: list[Collision], values: list[float], key: str, a: float) -> list[str]:
    """Lines of text: the collisions, then film and pressure of those with film breakdown."""
    swept = ", ".join(f"{value:g}" for value in values)
    lines = [
        f"{len(collisions)} collisions in {len(values)} members, {key} = {swept}",
        "number     x/a    time/us  touching  film/um, pressure/GPa at the contact point in each member",
    ]
    for number, c in enumerate(collisions):
        flags = "".join("x" if touches else "." for touches in c.touching)
        pairs = " ".join(f"{1e6 * h:.4f},{1e-9 * p:.2f}" for h, p in zip(c.film, c.pressure, strict=True))
        lines.append(f"{number:6d} {c.x / a:8.4f} {1e6 * c.time:10.3f}  {flags}  {pairs}")
    points = breakdowns(collisions)
    if not points or key not in THINNING:
        return lines
    jumps = [slope_jumps(values, c.film, c.first) for c in points]
    growth = [np.diff(c.pressure[c.first :]) / c.pressure[c.first : -1] for c in points]
    before = np.concatenate([jump[:-1] for jump in jumps])
    lines += [
        f"{len(points)} contact points with two full films or more before, and contact ever after",
        f"contact where the last two films extrapolate to: {sum(jump[-1] <= 0.0 for jump in jumps)}",
        "pressure grows from the first in contact to the last: "
        f"{sum(np.prod(1.0 + g) > 1.0 for g in growth)}; to each next one: "
        f"{sum((g > 0.0).all() for g in growth)}",
    ]
    if before.size:
        shown = f"median {100 * np.median(before):.1f} %, maximum {100 * before.max():.1f} %"
        lines.append(f"change of the film's slope from interval to interval before contact: {shown}")
    return lines


def draw_collisions(results: list[Result], values: list[float], key: str, chosen: list[Collision]) -> Figure:
    """Pressure and film at collisions, one column each, a line for each member, contacts marked."""
    figure, axes = style.new_figure(2, len(chosen), (5.0 * len(chosen), 5.6), squeeze=False, sharex="col")
    a = results[0].attrs["a"]
    for (upper, lower), c in zip(axes.T, chosen, strict=True):
        for result, value, colour in zip(results, values, style.shades(len(results)), strict=True):
            frame = result.nearest_frame(time=c.time)
            view = np.abs(result.x - c.x) <= 0.5 * VIEW * a
            marked = np.flatnonzero(result.contacts_at(frame)[view]).tolist()
            look = dict(color=colour, lw=1.1, label=f"{value:g}", marker="v", ms=4, markevery=marked)
            upper.plot(result.x[view] / a, 1e-9 * result.frame("pressure", frame)[view], **look)
            lower.plot(result.x[view] / a, 1e6 * result.frame("film_thickness", frame)[view], **look)
        upper.set_title(f"{1e6 * c.time:.2f} µs", fontsize="medium")
        upper.set_ylim(bottom=0.0)
        lower.set(xlabel=style.ACROSS, ylim=(0.0, None))
    axes[0, 0].set_ylabel("pressure [GPa]")
    axes[1, 0].set_ylabel("film thickness [µm]")
    style.legend_beside(axes[0, -1], title=f"{style.LABELS.get(key, key)}\ntriangles: in contact")
    style.set_title(figure, str(results[0].attrs["title"]), style.conditions(results))
    return figure


def draw_points(results: list[Result], values: list[float], key: str, points: list[Collision]) -> Figure:
    """Film and pressure at contact points over the varied value; triangles: in contact."""
    figure, (upper, lower) = style.new_figure(2, 1, (8.4, 5.6), sharex=True)
    for number, c in enumerate(points):
        look, dry = dict(color=f"C{number}", lw=1.1, ms=4), np.array(c.dry)
        label = f"{c.x / results[0].attrs['a']:.3f} a, {1e6 * c.time:.1f} µs"
        for panel, shown in ((upper, 1e6 * np.array(c.film)), (lower, 1e-9 * np.array(c.pressure))):
            panel.plot(values, shown, "o-", markevery=np.flatnonzero(~dry).tolist(), label=label, **look)
            panel.plot(np.array(values)[dry], shown[dry], "v", **look)
    upper.set(ylabel="film thickness [µm]", ylim=(0.0, None))
    lower.set(ylabel="pressure [GPa]", xlabel=style.LABELS.get(key, key), ylim=(0.0, None), xlim=(0.0, None))
    style.legend_beside(upper, title="triangles: in contact")
    style.set_title(figure, str(results[0].attrs["title"]), style.conditions(results))
    return figure


def main(words: list[str] | None = None) -> None:
    """Run the command."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("results", nargs="+", type=Path, help="index of a series, or results")
    parser.add_argument("--draw", type=int, nargs="+", metavar="NUMBER", help="of collisions")
    parser.add_argument("--points", action="store_true", help="draw contact points over the varied value")
    parser.add_argument("-o", "--output", type=Path, default=Path("collisions.png"))
    chosen = parser.parse_args(words)
    with contextlib.ExitStack() as stack:
        results, values, key = open_series(chosen.results, stack)
        collisions, a = find(results), results[0].attrs["a"]
        print("\n".join(report(collisions, values, key, a)))
        if chosen.points:
            style.save(draw_points(results, values, key, breakdowns(collisions)[:8]), chosen.output)
        elif chosen.draw:
            shown = [collisions[number] for number in chosen.draw]
            style.save(draw_collisions(results, values, key, shown), chosen.output)


if __name__ == "__main__":
    main()
