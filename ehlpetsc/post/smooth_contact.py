r"""Damage under the smooth contact of a case: the control of the damage of its asperities.

A point of the body at the depth z passes the dry smooth contact once, under Hertz's pressure and Coulomb's
traction :math:`q=\mu p` of the mean friction of the run. Its stress history is the static stress along x,
the same at all points, and by the criterion of a rough contact it has a damage D(z). What a rough contact
adds to it is the damage of its asperities.

The contact is that of the instant with the largest pressure; both signs of the traction give the same damage.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from ehlpetsc.physics.contact.hertz import hertz_pressure
from ehlpetsc.post.stresses.half_plane import stress
from ehlpetsc.post.stresses.half_space import stress_plane
from ehlpetsc.results.post_result import SmoothContact

if TYPE_CHECKING:
    from ehlpetsc.physics import Operation
    from ehlpetsc.physics.scales import Scales
    from ehlpetsc.post.loads import Loads

DEEPEST = 1.0  # half-widths: the range of shear stress along x has its maximum at 0.50
LINE_DEPTHS, LINE_REACH, LINE_NODES = 81, 4.0, 64  # depths; half-widths either side; nodes on one
POINT_DEPTHS, POINT_REACH, POINT_NODES = 31, 2.5, 16
FRICTION_FRAMES = 16  # of which the mean friction is taken
INSTANTS = 400  # of varying conditions, among which that of the largest pressure is sought


def smooth_contact(
    loads: Loads, poisson_ratio: float, count: Callable[[np.ndarray, np.ndarray, float], np.ndarray]
) -> SmoothContact:
    """Smooth contact of the case of a result.

    `count`: results (points, columns) of histories (points, components, samples), their lengths and a
    residual stress [Pa]; the first column is the damage.
    """
    scales, table = loads.scales, loads.case.post.residual_stress
    # of a roller, in its row with the highest load
    size, p0 = (scales.grid.widening * value for value in worst_instant(scales, loads.operation))
    ratio = scales.b / scales.a if scales.geometry.is_elliptic else 0.0
    depths, unit = _unit_histories(round(mean_friction(loads), 6), poisson_ratio, ratio)
    damage = np.empty(len(depths))
    for k, history in enumerate(p0 * unit):
        residual = float(np.interp(size * depths[k], *np.transpose(table))) if table else 0.0
        damage[k] = count(history[None], np.array([history.shape[-1]]), residual)[0, 0]
    return SmoothContact(size * scales.a * depths, damage)


def worst_instant(scales: Scales, operation: Operation) -> tuple[float, float]:
    """Size of the dry contact over that of the scales, and its pressure [Pa], where this is largest."""
    times = np.linspace(0.0, operation.duration, INSTANTS) if operation.varies else [0.0]
    found = [operation.at(time) for time in times]
    worst = max(found, key=scales.dry_pressure)
    return scales.size(worst), scales.dry_pressure(worst)


def mean_friction(loads: Loads) -> float:
    """Mean friction coefficient of the stored frames, traction on surface 2 over load."""
    frames = np.unique(np.linspace(0, loads.time.size - 1, FRICTION_FRAMES).astype(int))
    surface = next(name for name in ("2", "1") if f"shear_stress_{name}" in loads.fields)
    pairs = [loads.read(surface, frame, frame + 1) for frame in frames]
    return float(np.mean([abs(shear.sum()) / pressure.sum() for pressure, shear in pairs]))


@lru_cache(maxsize=4)  # for both surfaces, all criteria, and the passes of a life
def _unit_histories(friction: float, poisson_ratio: float, ratio: float) -> tuple[np.ndarray, np.ndarray]:
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
