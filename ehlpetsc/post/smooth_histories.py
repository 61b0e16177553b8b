"""Stress histories of points that pass a smooth contact once, in units of its pressure and half-width."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from ehlpetsc.physics.contact.hertz import hertz_pressure
from ehlpetsc.post.counting import Count
from ehlpetsc.post.stresses.half_plane import stress
from ehlpetsc.post.stresses.half_space import stress_plane

DEEPEST = 1.0  # half-widths: the range of shear stress along x has its maximum at 0.50
LINE_DEPTHS, LINE_REACH, LINE_NODES = 81, 4.0, 64  # depths; half-widths either side; nodes on one
POINT_DEPTHS, POINT_REACH, POINT_NODES = 31, 2.5, 16


@lru_cache(maxsize=4)  # for both surfaces, all criteria, and the passes of a life
def unit_histories(friction: float, poisson_ratio: float, ratio: float) -> tuple[np.ndarray, np.ndarray]:
    """Depths in half-widths, and histories over p0 (depths, components, samples) of a point in the middle.

    `ratio`: b/a of a point contact; 0: a line.
    """
    solve = _in_plane if ratio else _in_line
    depths, stresses = solve(friction, poisson_ratio, ratio)
    return depths, np.pad(stresses, [(0, 0), (0, 0), (1, 1)])  # unstressed before and after


def _in_line(friction: float, poisson_ratio: float, ratio: float) -> tuple[np.ndarray, np.ndarray]:
    """Depths, and sx, sz, txz under a line contact."""
    x, depths = _nodes(LINE_REACH, LINE_NODES), np.linspace(0.0, DEEPEST, LINE_DEPTHS)
    pressure = hertz_pressure(x, 1.0, 1.0)
    return depths, np.stack(stress(x, depths, pressure, friction * pressure, poisson_ratio), axis=1)


def _in_plane(friction: float, poisson_ratio: float, ratio: float) -> tuple[np.ndarray, np.ndarray]:
    """Depths, and sx, sz, txz, sy, txy, tyz on the middle row of a point contact."""
    x, depths = _nodes(POINT_REACH, POINT_NODES), np.linspace(0.0, DEEPEST, POINT_DEPTHS)
    y = ratio * _nodes(1.0, POINT_NODES)
    pressure = np.sqrt(np.maximum(1.0 - x**2 - (y[:, None] / ratio) ** 2, 0.0))
    found = stress_plane(x, y, depths, pressure, friction * pressure, poisson_ratio)
    middle = [getattr(found, name)[:, len(y) // 2] for name in ("sx", "sz", "txz", "sy", "txy", "tyz")]
    return depths, np.stack(middle, axis=1)


def _nodes(reach: float, per_half_width: int) -> np.ndarray:
    """Nodes from -reach to reach half-widths."""
    count = round(reach * per_half_width)
    return np.arange(-count, count + 1) / per_half_width


def damages(histories: np.ndarray, residual: np.ndarray, count: Count) -> np.ndarray:
    """Damage of each of some histories (depths, components, samples) with its residual stress [Pa]."""
    length = np.array([histories.shape[-1]])
    return np.array(
        [count(one[None], length, stress)[0, 0] for one, stress in zip(histories, residual, strict=True)]
    )
