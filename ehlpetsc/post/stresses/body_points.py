"""Points fixed in a moving body: positions over time, and those that passed the whole contact."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from ehlpetsc.base.errors import PostError

NO_FLANK = np.inf, -np.inf
GRID_ROUNDING = 1e-9  # nodes: points nearer to a node are at it


class Passage(NamedTuple):
    """Passage of body points through the nodes.

    Body point j is at node j + shift[k] + offset[k] at frame k, 0 <= offset < 1. `enter` and `leave` are
    its first and last frames inside the nodes; `complete` is true if it entered and left the nodes, or if
    the contact began and ended on its flank.
    """

    shift: np.ndarray
    offset: np.ndarray
    enter: np.ndarray
    leave: np.ndarray
    complete: np.ndarray

    def positions(self, frame: int, x: np.ndarray, dx: float) -> np.ndarray:
        """Positions of all points in a frame [m]; nan beyond the nodes x."""
        node = np.arange(self.enter.size) + self.shift[frame]
        at = x[node.clip(0, x.size - 1)] + self.offset[frame] * dx
        return np.where((node >= 0) & (node < x.size), at, np.nan)


def body_points(x: np.ndarray, dx: float, travelled: Iterable[np.ndarray]) -> np.ndarray:
    """Body coordinates s, with the spacing dx, of all points that were ever among the nodes x [m].

    `travelled` are the distances of each body at each frame [m].
    """
    ends = np.array([[distance[0], distance[-1]] for distance in travelled])
    before = max(int(np.ceil(ends.max() / dx - GRID_ROUNDING)), 0)
    after = max(int(np.ceil(-ends.min() / dx - GRID_ROUNDING)), 0)
    return x[0] + dx * np.arange(-before, x.size + after)


def passage(
    s: np.ndarray, x: np.ndarray, dx: float, travelled: np.ndarray, flank: tuple[float, float] = NO_FLANK
) -> Passage:
    """Passage of the points s = s[0] + j dx of a body with x = s + travelled (nt,).

    `flank` are the points s at x = 0 at the end and at the beginning of the contact of two teeth; points
    between them need not enter or leave the nodes. PostError if the body turns back.
    """
    base = np.round((s[0] - x[0] + travelled) / dx, 9)
    shift = np.floor(base).astype(np.int64)
    j, last = np.arange(s.size), x.size - 1
    if (np.diff(base) >= 0).all():
        enter, leave = np.searchsorted(base, -j, "left"), np.searchsorted(base, last - j, "right") - 1
        complete = ((base[0] + j <= 0) | (s <= flank[1])) & ((base[-1] + j >= last) | (s >= flank[0]))
    elif (np.diff(base) <= 0).all():
        enter, leave = np.searchsorted(-base, j - last, "left"), np.searchsorted(-base, j, "right") - 1
        complete = (base[0] + j >= last) & (base[-1] + j <= 0)
    else:
        raise PostError("a surface turns back: its points would pass the contact several times")
    return Passage(shift, base - shift, enter, leave, complete)
