"""Frames missing from a result, by the numbers of the steps and their times."""

from typing import NamedTuple

import numpy as np

from ehlpetsc.post.inputs.consistency import MAX_STEP


class Gaps(NamedTuple):
    """Positions and numbers of missing frames.

    Attributes
    ----------
    every : int
        Steps between frames without gaps.
    after : ndarray of int
        Stored frames before a gap.
    missing : ndarray of int
        Number of missing frames in each gap.
    """

    every: int
    after: np.ndarray
    missing: np.ndarray


def find_gaps(loads):
    """Gaps in the stored frames (at least two) of :class:`ehlpetsc.post.inputs.loads.Loads`."""
    between = np.diff(loads.step)
    if loads.dt:
        steps = np.diff(loads.time) / loads.dt
        at_least = np.ceil(steps / MAX_STEP).astype(int)  # steps that such a time takes
        between = np.where(at_least > between, np.rint(steps).astype(int), between)
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
    position = motion.shift + motion.offset  # of body point 0
    for frame, missing in zip(gaps.after, gaps.missing, strict=True):
        low, high = sorted(position[frame : frame + 2])
        first = int(np.clip(np.floor(-high) + 1, 0, points))  # first point with high + j > 0
        last = int(np.clip(np.ceil(nodes - 1 - low), first, points))  # first with low + j >= nodes - 1
        change[first] += missing
        change[last] -= missing
    return np.cumsum(change[:-1])
