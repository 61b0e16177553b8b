"""Surface temperatures of body points on their way through the contact."""

from __future__ import annotations

import numpy as np

from ehlpetsc.post.loads import Loads
from ehlpetsc.post.stresses.body_points import Passage
from ehlpetsc.post.stresses.body_stress import limited_slopes
from ehlpetsc.results.post_result import PointTemperatures

FRAMES_PER_READ = 256


def point_temperatures(loads: Loads, surface: str, motion: Passage, points: int) -> PointTemperatures:
    r"""Highest and mean surface temperature of body points and their flash temperature.

    The mean is over the time at which a point is inside the Hertz contact, |x| <= a, by the trapezoidal rule
    over the stored frames; the flash temperature is the highest temperature minus that of the body.
    nan for points that did not pass the whole contact.
    """
    highest, sums, times = np.full(points, -np.inf), np.zeros(points), np.zeros(points)
    lasts = _weights(loads.time)
    for begin in range(0, loads.time.size, FRAMES_PER_READ):
        frames = np.arange(begin, min(begin + FRAMES_PER_READ, loads.time.size))
        rows = temperatures_between_nodes(loads, surface, frames, motion.offset[frames])
        for frame, values in zip(frames, rows, strict=True):
            x = loads.x[: values.size] + motion.offset[frame] * loads.dx
            first = motion.shift[frame]  # node of point 0
            node = slice(max(first, 0), min(values.size, points + first))
            point = slice(node.start - first, node.stop - first)
            duration = lasts[frame] * (np.abs(x[node]) <= loads.a)
            np.maximum(highest[point], values[node], out=highest[point])
            sums[point] += duration * values[node]
            times[point] += duration
    highest[~motion.complete] = np.nan
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = np.where(motion.complete, sums / times, np.nan)
    return PointTemperatures(highest, mean, highest - loads.bulk_temperature(surface))


def _weights(time: np.ndarray) -> np.ndarray:
    """Time weight of each frame [s]."""
    step = np.diff(time)
    return 0.5 * (np.append(step, 0.0) + np.insert(step, 0, 0.0))


def temperatures_between_nodes(
    loads: Loads, surface: str, frames: np.ndarray, offset: np.ndarray
) -> np.ndarray:
    """Temperatures (frames, nodes), `offset` (frames,) elements right of the nodes, by limited cubics.

    The last node has no following element; its temperature is returned.
    """
    rows = loads.rows(f"temperature_{surface}", frames[0], frames[-1] + 1)
    slopes = np.empty_like(rows)
    limited_slopes(rows, slopes)
    t = offset[:, None]
    left = (1.0 - t) ** 2 * ((1.0 + 2.0 * t) * rows[:, :-1] + t * slopes[:, :-1])
    right = t**2 * ((3.0 - 2.0 * t) * rows[:, 1:] - (1.0 - t) * slopes[:, 1:])
    return np.concatenate([left + right, rows[:, -1:]], axis=1)
