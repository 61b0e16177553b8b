"""Complete stress histories of body points, collected from the frames of a result file by threads.

A point is unstressed before it enters and after it leaves: each history begins and ends with zero.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from ehlpetsc.base.compiled import compiled
from ehlpetsc.post.stresses.body_points import Passage
from ehlpetsc.post.stresses.body_stress import FRAMES_PER_BATCH, BodyStress, offset_weights

if TYPE_CHECKING:
    from ehlpetsc.post.loads import Loads

FRAMES_PER_READ = 144  # by each thread
SAMPLE_BYTES = 12  # three stresses in single precision


@compiled(error_model="python", nogil=True)
def _collect(
    stress: np.ndarray,
    begin: int,
    first: int,
    shift: np.ndarray,
    enter: np.ndarray,
    leave: np.ndarray,
    quantum: float,
    histories: np.ndarray,
) -> None:
    """Copy stresses (frames, 3, n) of frames from `begin` on into histories (points, 3, samples).

    Point by point from `first` on, rounded to a multiple of the quantum.
    """
    inverse, end = 1.0 / quantum, begin + stress.shape[0]
    for row in range(histories.shape[0]):
        j = first + row
        for frame in range(max(begin, enter[j]), min(end, leave[j] + 1)):
            node, sample = j + shift[frame], frame - enter[j] + 1
            for component in range(3):
                value = stress[frame - begin, component, node]
                histories[row, component, sample] = np.rint(value * inverse) * quantum


def runs_of_points(motion: Passage, memory: float, depths: int) -> list[np.ndarray]:
    """Split the complete points into ranges of consecutive points whose histories fit in `memory` bytes."""
    points = np.flatnonzero(motion.complete)
    room = max(1, int(memory / (SAMPLE_BYTES * depths * (motion.samples() + 2))))
    runs = []
    for stretch in np.split(points, np.flatnonzero(np.diff(points) > 1) + 1):
        runs += np.array_split(stretch, -(-stretch.size // room))
    return runs


@contextmanager
def workers(count: int) -> Iterator[Callable]:
    """Context manager of a map function on `count` threads."""
    if count == 1:
        yield map
        return
    with ThreadPoolExecutor(count) as pool:
        yield pool.map


class HistoryCollector:
    """Collector of the histories of consecutive points, which distributes them to the workers.

    A worker is a thread; the expensive parts release the GIL. Depths are in elements, `quantum` in Pa, `map_`
    is a function of :func:`workers`, `advance` is called with the number of frames.
    """

    def __init__(
        self,
        loads: Loads,
        surface: str,
        motion: Passage,
        depths: np.ndarray,
        quantum: float,
        map_: Callable = map,
        advance: Callable[[int], None] | None = None,
    ) -> None:
        self.loads, self.surface, self.motion, self.quantum = loads, surface, motion, quantum
        self.map, self.advance = map_, advance
        self.stress, self.depths = BodyStress(loads.x.size, depths), len(depths)
        self.weights = offset_weights(motion.offset)

    def __call__(self, points: np.ndarray, finish: Sequence[Callable]) -> None:
        """Process the frames of consecutive complete `points`.

        `finish` has a function for each worker, called with depth, first, last and the histories
        (points, 3, samples) of points first .. last-1, of which the first leave - enter + 3 samples count.
        """
        motion = self.motion
        histories = np.zeros((self.depths, points.size, 3, motion.samples() + 2), np.float32)
        frames = motion.enter[points].min(), motion.leave[points].max() + 1
        for begin in range(*frames, FRAMES_PER_READ * len(finish)):
            end = min(begin + FRAMES_PER_READ * len(finish), frames[1])
            loads = self.loads.read(self.surface, begin, end)
            starts = range(begin, end, FRAMES_PER_BATCH)
            list(self.map(partial(self._add_frames, loads, begin, points[0], histories), starts))
            if self.advance:
                self.advance(end - begin)
        tasks = zip(np.array_split(np.arange(points.size), len(finish)), finish, strict=True)
        list(self.map(partial(self._hand_over, points[0], histories), tasks))

    def _add_frames(
        self, loads: tuple[np.ndarray, np.ndarray], begin: int, point: int, histories: np.ndarray, first: int
    ) -> None:
        """Add the stresses of a batch of frames from `first` on, of loads from frame `begin` on."""
        m, batch = self.motion, slice(first - begin, first - begin + FRAMES_PER_BATCH)
        spectra = self.stress.transform(*(load[batch] for load in loads))
        weights = self.weights[first : first + len(spectra)]
        for depth in range(self.depths):
            fields = self.stress(depth, spectra, weights)
            _collect(fields, first, point, m.shift, m.enter, m.leave, self.quantum, histories[depth])

    def _hand_over(self, point: int, histories: np.ndarray, task: tuple[np.ndarray, Callable]) -> None:
        rows, finish = task
        if rows.size:
            first, last = rows[0], rows[-1] + 1
            for depth in range(self.depths):
                finish(depth, point + first, point + last, histories[depth, first:last])
