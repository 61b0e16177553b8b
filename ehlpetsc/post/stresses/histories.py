"""Stress histories of points fixed in the body, collected from stresses at frames."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from ehlpetsc.base.compiled import compiled
from ehlpetsc.post.stresses.body_stress import BodyStress, offset_weights

if TYPE_CHECKING:
    from ehlpetsc.post.loads import Loads, Passage
    from ehlpetsc.post.stresses.block_stress import BlockStress

FRAMES_PER_READ = 144


@compiled(error_model="python", nogil=True)
def _collect(
    stress: np.ndarray, begin: int, first: int, motion: tuple, quantum: float, histories: np.ndarray
) -> None:
    """Copy stresses (frames, components, ny, n) of frames from `begin` on into histories.

    Histories (points, ny, components, samples), point by point from `first` on, rounded to a multiple of the
    quantum if it is not zero.
    """
    shift, enter, leave = motion
    inverse, end = 1.0 / quantum if quantum else 0.0, begin + stress.shape[0]
    for row in range(stress.shape[2]):
        for component in range(stress.shape[1]):
            for place in range(histories.shape[0]):  # of a row and a component: within the cache
                j = first + place
                history = histories[place, row, component]
                for frame in range(max(begin, enter[j]), min(end, leave[j] + 1)):
                    value = stress[frame - begin, component, row, j + shift[frame]]
                    rounded = np.rint(value * inverse) * quantum if quantum else value
                    history[frame - enter[j] + 1] = rounded


def runs_of_points(motion: Passage, numbers: float, numbers_per_sample: int) -> list[np.ndarray]:
    """Split the complete points into ranges of consecutive ones with at most `numbers` in their histories."""
    points = np.flatnonzero(motion.complete)
    samples = (motion.leave - motion.enter + 3)[points].max(initial=1)
    room = max(1, int(numbers / (numbers_per_sample * samples)))
    runs: list[np.ndarray] = []
    for stretch in np.split(points, np.flatnonzero(np.diff(points) > 1) + 1):
        runs += np.array_split(stretch, -(-stretch.size // room)) if stretch.size else []
    return runs


def histories(
    loads: Loads,
    surface: str,
    motion: Passage,
    stress: BodyStress | BlockStress,
    points: np.ndarray,
    quantum: float,
    dtype: type | str = np.float32,
    show: Callable[[float], None] = lambda share: None,
) -> np.ndarray:
    """Stress histories of consecutive points, multiples of `quantum` [Pa].

    `show` is called with the share of the frames of a batch after each.

    Shape (nz, points, 3, samples); of a plane (nz, points, ny, 6, samples). Of a point the first
    leave - enter + 3 samples count: it is unstressed before it enters and after it leaves, so that its
    history begins and ends with zero.
    """
    samples = int((motion.leave - motion.enter)[points].max()) + 3
    shape = len(stress.tables), points.size, *stress.rows, stress.components, samples
    found: np.ndarray = np.zeros(shape, dtype)
    by_row = found.reshape(*shape[:2], -1, *shape[-2:])
    weights, places = offset_weights(motion.offset), (motion.shift, motion.enter, motion.leave)
    start, end = motion.enter[points].min(), motion.leave[points].max() + 1
    for begin in range(start, end, FRAMES_PER_READ):
        pressure, shear = loads.read(surface, begin, min(begin + FRAMES_PER_READ, end))
        for at in range(0, len(pressure), stress.frames_at_once):
            batch = slice(at, at + stress.frames_at_once)
            spectra = stress.transform(pressure[batch], shear[batch])
            of_frames = weights[begin + at : begin + at + len(spectra)]
            for depth, rows in enumerate(by_row):
                fields = stress(depth, spectra, of_frames)
                fields = fields.reshape(*fields.shape[:2], -1, fields.shape[-1])
                _collect(fields, begin + at, points[0], places, quantum, rows)
            show(len(spectra) / (end - start))
    return found
