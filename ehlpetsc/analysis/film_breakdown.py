"""Film breakdown at the collisions of a series: film and pressure from member to member."""

import numpy as np


def selected(points, count):
    """At most `count` contact points, in turn from the groups with breakdown at the same member."""
    groups = {}
    for point in points:
        groups.setdefault(int(np.argmax(np.asarray(point.film) <= 0.0)), []).append(point)
    turns = [(turn, first, point) for first, group in groups.items() for turn, point in enumerate(group)]
    return [point for *_, point in sorted(turns, key=lambda t: t[:2])[:count]]


def ranked(collisions):
    """Numbers of the collisions in the order in which they are drawn.

    First `contact_points` in their order, then collisions by falling number of members in contact and
    falling pressure.
    """
    first = [id(c) for c in contact_points(collisions)]

    def rank(number):
        c = collisions[number]
        position = first.index(id(c)) if id(c) in first else len(first)
        return position, -sum(c.touching), -max(c.pressure)

    return sorted(range(len(collisions)), key=rank)


def slope_jumps(values, film):
    r"""Relative change of the slope of a film over a value, from interval to interval, as it falls to zero.

    Slopes :math:`s_k=(h_k-h_{k+1})/|v_k-v_{k+1}|` of the intervals down to the first h = 0; the last slope,
    cut off at h = 0, is a lower bound. If the last change is 0 or less, the straight line through the last
    two films reaches zero before the first member in contact, that is, contact occurs as extrapolated.

    Parameters
    ----------
    values, film : sequence of float
        From the thickest film on. Over the viscosity even smooth films become steeper, as eta0^0.7; over the
        smooth film of each member they do not.

    Returns
    -------
    ndarray, shape (number of films before contact - 1,)
        :math:`s_{k+1}/s_k-1`.

    Raises
    ------
    ValueError
        Fewer than two films before contact, or no contact.
    """
    film = np.asarray(film)
    end = int(np.argmax(film <= 0.0)) + 1
    if film.min() > 0.0 or end < 3:
        raise ValueError("two films before contact are needed")
    slopes = -np.diff(film[:end]) / np.abs(np.diff(values[:end]))
    return slopes[1:] / slopes[:-1] - 1.0


def pressure_steps(film, pressure):
    """Relative changes of the pressure from member to member after film breakdown, shape (n,)."""
    film, pressure = np.asarray(film), np.asarray(pressure)
    if film.min() > 0.0:
        return np.empty(0)
    after = pressure[int(np.argmax(film <= 0.0)) :]
    return np.diff(after) / after[:-1]


def contact_points(collisions, films=2):
    """Collisions with film breakdown: the first `films` members or more in full film, the others in contact.

    In the order of the distance of the breakdown from the middle of the series, then of falling pressure.
    """

    def full_films(c):
        film = np.asarray(c.film)
        full = int(np.argmax(film <= 0.0)) if film.min() <= 0.0 else 0
        return full if full >= films and (film[full:] <= 0.0).all() and full < len(film) - 1 else 0

    points = [c for c in collisions if full_films(c)]
    return sorted(
        points, key=lambda c: (-abs(full_films(c) - len(c.film) // 2), c.pressure[-1]), reverse=True
    )


def smooth_films(results):
    """Minimum film [m] of each member before roughness enters."""
    return [float(result.steps("h_min")[0]) for result in results]


def breakdown(collisions, values, smooth):
    """Report on film breakdown and the pressures after it, as lines of text."""
    points = contact_points(collisions)
    if not points:
        return ["no point with two full films before contact and two members in contact after them"]
    steps = [pressure_steps(c.film, c.pressure) for c in points]
    jumps = [slope_jumps(values, c.film) for c in points]
    lines = [
        f"{len(points)} contact points with two full films or more before, and contact ever after",
        f"contact where the last two films extrapolate to: {count_of([j[-1] <= 0.0 for j in jumps])}",
        "growth of the film's slope from interval to interval before, median and largest:",
    ]
    for name, abscissa in (("swept value", values), ("smooth film", smooth)):
        before = np.concatenate([slope_jumps(abscissa, c.film)[:-1] for c in points])
        if len(before):
            lines.append(f"  against the {name} {100 * np.median(before):.1f} %, {100 * before.max():.1f} %")
    changes = np.concatenate(steps)
    return [
        *lines,
        "pressure grows once the film is gone:",
        f"  from each member to the next: {count_of([(s > 0.0).all() for s in steps])}",
        f"  from the first in contact to the last: {count_of([np.prod(1.0 + s) > 1.0 for s in steps])}",
        f"  in single changes: {count_of(changes > 0.0)}",
    ]


def count_of(flags):
    """``5 of 6 (83 %)``."""
    flags = np.asarray(flags, bool)
    return f"{flags.sum()} of {len(flags)} ({100 * flags.mean():.0f} %)"
