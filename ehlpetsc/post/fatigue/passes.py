r"""Damage over several passes of the same points: mean, scatter and passes to failure by Miner's sum.

In each pass the surface is in contact with another part of the other surface. After M passes
:math:`\sum_m D_m = M\bar D`, and failure is expected after :math:`1/\bar D` passes (Palmgren-Miner).
"""

from typing import NamedTuple

import numpy as np


class Passes(NamedTuple):
    """Statistics of each point over several passes.

    Attributes
    ----------
    mean, deviation, largest : ndarray
        Statistics of D over the passes; deviation with n - 1, nan for one pass.
    count : ndarray of int
        Number of passes of each point.
    life : ndarray
        Passes to failure 1/mean; infinite without damage.
    """

    mean: np.ndarray
    deviation: np.ndarray
    largest: np.ndarray
    count: np.ndarray
    life: np.ndarray


def pass_statistics(damages):
    """Statistics over passes.

    Parameters
    ----------
    damages : array_like, shape (passes, ...)
        D of each pass; nan for points that did not pass.

    Returns
    -------
    Passes
        Arrays of shape (...); nan without passes.

    Raises
    ------
    ValueError
        No passes, a negative damage.
    """
    damages = np.asarray(damages, float)
    if damages.ndim == 0 or not len(damages):
        raise ValueError("there must be one pass or more")
    if (damages < 0).any():
        raise ValueError("damages must not be negative")
    passed = ~np.isnan(damages)
    count = passed.sum(axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        mean = np.where(passed, damages, 0).sum(axis=0) / count
        squares = np.where(passed, (damages - mean) ** 2, 0).sum(axis=0)
        deviation = np.where(count > 1, np.sqrt(squares / (count - 1)), np.nan)
        largest = np.where(count > 0, np.where(passed, damages, -np.inf).max(axis=0), np.nan)
        return Passes(mean, deviation, largest, count, 1 / mean)


def fold(s, damage, stretch):
    """Passes of the same points within one result, for a body with the period `stretch`.

    Parameters
    ----------
    s : ndarray, shape (ns,)
        Uniform body coordinates, m.
    damage : ndarray, shape (..., ns)
        nan where a point did not pass.
    stretch : float
        m; rounded to whole spacings of s.

    Returns
    -------
    ndarray, shape (passes, ..., points)
        Of the points s[0] .. s[0] + stretch, the earliest pass first (points of larger s come first).

    Raises
    ------
    ValueError
        The stretch is shorter than a spacing or longer than s.
    """
    points = int(round(stretch / (s[1] - s[0]))) if np.isfinite(stretch) else 0
    if not 1 <= points <= s.size:
        raise ValueError(f"a stretch of {stretch:g} m does not fit the {s[-1] - s[0]:g} m that were computed")
    number = -(-s.size // points)
    padded = np.full((*damage.shape[:-1], number * points), np.nan)
    padded[..., : s.size] = damage
    rows = padded.reshape(*damage.shape[:-1], number, points)
    rows = np.moveaxis(rows, -2, 0)[::-1]
    passed = ~np.isnan(rows).reshape(number, -1).all(axis=1)
    return rows[passed]


def largest_near(s, damage, positions, distance):
    """Maximum damage within a distance of each position along the surface.

    Parameters
    ----------
    s : ndarray, shape (ns,)
        Rising body coordinates, m.
    damage : ndarray, shape (..., ns)
        nan for points that did not pass, which are ignored.
    positions : ndarray, shape (n,)
    distance : float
        m; the nearest point always counts.

    Returns
    -------
    ndarray, shape (..., n)
    """
    finite = np.where(np.isnan(damage), -np.inf, damage)
    out = np.empty((*damage.shape[:-1], len(positions)))
    for k, position in enumerate(positions):
        first = np.searchsorted(s, position - distance, "left")
        last = np.searchsorted(s, position + distance, "right")
        nearest = int(np.abs(s - position).argmin())
        out[..., k] = finite[..., min(first, nearest) : max(last, nearest + 1)].max(axis=-1)
    return np.where(np.isinf(out), np.nan, out)
