"""Whole histories of body points, gathered from the frames of a result file on one thread or more.

A point is unstressed before it enters and after it leaves: each history starts and ends with a zero.
"""

from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from functools import partial
from itertools import pairwise

import numpy as np

from ehlpetsc.compiled import compiled
from ehlpetsc.post.stresses.body_stress import BATCH, BodyStress, in_cache, parity_weights

LARGEST_KEPT = 31 << 20  # bytes of a block that malloc keeps: new pages for every batch cost a third more


@compiled(error_model="python", nogil=True)
def _places(shape, shift, first, out):
    """out (3, frames): place of the stresses of body point 0 in an array (pairs, 3, n, 2) with one axis."""
    for part in range(3):
        for k in range(out.shape[1]):
            out[part, k] = (((k >> 1) * 3 + part) * shape[2] + shift[first + k]) * 2 + (k & 1)


@compiled(error_model="python", nogil=True)
def _gather(stress, begin, end, first, last, shift, enter, leave, quantum, ring):
    """Move the stresses (pairs, 3, n, 2) of frames begin .. end-1 into histories of points first .. last-1.

    Point by point, rounded to a multiple of the quantum.
    """
    inverse = 1.0 / quantum
    flat, places = stress.reshape(-1), np.empty((3, end - begin), np.int64)
    _places(stress.shape, shift, begin, places)
    for j in range(first, last):
        history = ring[j % ring.shape[0]]
        start, stop = max(begin, enter[j]), min(end, leave[j] + 1)
        for part in range(3):
            if start == enter[j]:
                history[part, 0] = 0.0
            row, place = history[part, start - enter[j] + 1 :], places[part, start - begin :]
            for k in range(stop - start):
                row[k] = np.rint(flat[2 * j + place[k]] * inverse) * quantum
            if stop == leave[j] + 1:
                history[part, stop - enter[j] + 1] = 0.0


def blocks(motion, memory, depths, workers=1):
    """Split the complete points into runs of consecutive ones whose open histories fit in `memory` bytes.

    Returns
    -------
    list of (points, slots)
    """
    points = np.flatnonzero(motion.complete)
    room = max(1, int(memory / (12 * depths * (motion.samples() + 2))))
    runs = []
    for stretch in np.split(points, np.flatnonzero(np.diff(points) > 1) + 1):
        parts = 1 if _slots(stretch, motion, workers) <= room else -(-stretch.size // room)
        runs += [(part, _slots(part, motion, workers)) for part in np.array_split(stretch, parts)]
    return runs


def _slots(points, motion, workers):
    """Most points of a run under way in three batches: two are computed while the one before is counted."""
    step = BATCH * workers
    begins = np.arange(motion.enter[points].min(), motion.leave[points].max() + 1, step)
    enter, leave = np.sort(motion.enter[points]), np.sort(motion.leave[points])
    entered = np.searchsorted(enter, begins + 3 * step, "left")
    gone = np.searchsorted(leave, begins, "left")
    return int((entered - gone).max())


def _call(work):
    return work()


@contextmanager
def workers(count):
    """Something to use as `map` on `count` threads, which starts at once; for one thread map itself."""
    if count == 1:
        yield map
        return
    with ThreadPoolExecutor(count) as pool:
        yield pool.map


class Sweep:
    """Goes through frames and hands over the history of each point once it is whole.

    Of each batch every worker (a thread: what takes time does without Python's lock) computes the stresses of
    a part of the frames, depth by depth, and then hands over a part of the histories that are whole.

    Parameters
    ----------
    loads : ehlpetsc.post.inputs.loads.Loads
    surface : str
    motion : ehlpetsc.post.stresses.body_points.Passage
    depths : ndarray
        In elements.
    quantum : float
        Pa.
    finish : list of callable(depth, first, last, histories)
        One a worker. Gets histories (points, 3, samples) of points first .. last-1, of which the first
        leave - enter + 3 samples count.
    spread : callable
        Of :func:`workers`, as many as `finish`.
    advance : callable(frames), optional
    """

    def __init__(self, loads, surface, motion, depths, quantum, finish, spread=map, advance=None):
        self.loads, self.surface, self.motion = loads, surface, motion
        self.quantum, self.finish, self.spread, self.advance = quantum, finish, spread, advance
        self.stress = BodyStress(loads.x.size, depths, spread)
        self.depths, self.weights = len(depths), parity_weights(motion.offset)
        np.empty(LARGEST_KEPT, np.uint8)  # freed at once, which glibc takes for a hint

    def __call__(self, points, slots):
        """Go through the frames of consecutive complete `points`, `slots` (:func:`blocks`) at once."""
        enter, leave = self.motion.enter[points], self.motion.leave[points]
        rings = np.empty((self.depths, slots, 3, self.motion.samples() + 2), np.float32)
        workers, step = len(self.finish), BATCH * len(self.finish)
        computing = counting = before = ()
        for begin in range(enter.min(), leave.max() + 1, step):
            stop = min(begin + step, leave.max() + 1)
            loads = self.loads.read(self.surface, begin, stop)
            active = points[(enter < stop) & (leave >= begin)]
            parts = pairwise(np.linspace(begin, stop, workers + 1).astype(int))
            work = [partial(self._frames, loads, begin, *part, active, rings) for part in parts]
            under_way = self.spread(_call, work)
            list(computing), list(counting)
            counting = self.spread(_call, self._counts(rings, before))
            computing, before = under_way, active[self.motion.leave[active] < stop]
            if self.advance:
                self.advance(stop - begin)
        list(computing), list(counting)
        list(self.spread(_call, self._counts(rings, before)))

    def _counts(self, rings, points):
        """Each worker's share in handing over points whose histories are whole."""
        parts = np.array_split(np.asarray(points, int), len(self.finish))
        return [partial(self._hand_over, rings, *share) for share in zip(parts, self.finish, strict=True)]

    def _frames(self, loads, begin, first, last, points, rings):
        """Put the stresses of frames first .. last-1, of loads from frame `begin` on, into the histories."""
        m = self.motion
        pressure, shear = (load[first - begin : last - begin] for load in loads)
        spectra = self.stress.transform(pressure, shear)
        if not points.size:
            return
        begin, end = points[0], points[-1] + 1
        for depth, ring in enumerate(rings):
            for part in in_cache(last - first):
                fields = self.stress.paired(depth, spectra[part], self.weights[first:last][part])
                frames = first + part.start, first + part.stop
                _gather(fields, *frames, begin, end, m.shift, m.enter, m.leave, self.quantum, ring)

    def _hand_over(self, rings, points, finish):
        """Give the finished points in stretches that are consecutive in the ring."""
        slots = rings.shape[1]
        while points.size:
            slot = points[0] % slots
            count = min(points.size, slots - slot)
            for depth, ring in enumerate(rings):
                finish(depth, points[0], points[0] + count, ring[slot : slot + count])
            points = points[count:]
