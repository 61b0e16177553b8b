"""Frames missing from a result, seen from the numbers of the steps, their times and the movement."""

from typing import NamedTuple

import numpy as np

from ehlpetsc.post.inputs.plausibility import LONGEST_STEP


class Gaps(NamedTuple):
    """Which frames are missing.

    Attributes
    ----------
    every : int
        Steps between frames where none is missing.
    after : ndarray of int
        Stored frames after which some are missing.
    missing : ndarray of int
        How many each time.
    """

    every: int
    after: np.ndarray
    missing: np.ndarray


def steps_between(loads):
    """Steps from each stored frame to the next, (nt - 1,): by their numbers; 1 where these are not stored."""
    if loads.step is None:
        return np.ones(max(len(loads.time) - 1, 0), int)
    return np.diff(loads.step)


def find_gaps(loads, nominal):
    """Gaps in the stored frames.

    Parameters
    ----------
    loads : ehlpetsc.post.inputs.loads.Loads
        With two frames or more.
    nominal : float
        Nodes that the faster surface moves in a time step.
    """
    between = steps_between(loads)
    moved = np.diff(loads.time) * max(map(abs, loads.speeds.values())) / loads.dx
    at_least = np.ceil(moved / (LONGEST_STEP * nominal)).astype(int)  # steps that such a movement takes
    by_movement = np.rint(moved / nominal).astype(int)
    between = np.where(at_least > between, by_movement, between)
    every = max(int(np.median(between)), 1)
    missing = np.maximum(-(-between // every) - 1, 0)
    after = np.flatnonzero(missing)
    return Gaps(every, after, missing[after])


def frames_missed(gaps, motion, nodes):
    """Frames missing while each body point was among the nodes, (points,).

    Parameters
    ----------
    gaps : Gaps
    motion : ehlpetsc.post.stresses.body_points.Passage
    nodes : int
    """
    points = motion.complete.size
    change = np.zeros(points + 1, int)
    place = motion.shift + motion.offset  # of body point 0
    for frame, missing in zip(gaps.after, gaps.missing, strict=True):
        low, high = sorted(place[frame : frame + 2])
        first = int(np.clip(np.floor(-high) + 1, 0, points))  # first point with high + j > 0
        last = int(np.clip(np.ceil(nodes - 1 - low), first, points))  # first with low + j >= nodes - 1
        change[first] += missing
        change[last] -= missing
    return np.cumsum(change[:-1])
