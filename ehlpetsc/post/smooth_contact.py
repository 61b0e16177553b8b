r"""Damage under the smooth contact of a case: the control of the damage of its asperities.

A point of the body at the depth z passes the dry smooth contact once, under Hertz's pressure and Coulomb's
traction :math:`q=\mu p` of the mean friction of the run. Its stress history is the static stress along x,
the same at all points, and by the criterion of a rough contact it has a damage D(z). What a rough contact
adds to it is the damage of its asperities.

The contact is that of the instant with the largest pressure; both signs of the traction give the same damage.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ehlpetsc.post.counting import Count
from ehlpetsc.post.smooth_histories import damages, unit_histories
from ehlpetsc.results.post_result import SmoothContact

if TYPE_CHECKING:
    from ehlpetsc.physics import Operation
    from ehlpetsc.physics.scales import Scales
    from ehlpetsc.post.loads import Loads

FRICTION_FRAMES = 16  # of which the mean friction is taken
INSTANTS = 400  # of varying conditions, among which that of the largest pressure is sought


def smooth_contact(loads: Loads, poisson_ratio: float, count: Count) -> SmoothContact:
    """Smooth contact of the case of a result."""
    scales, table = loads.scales, loads.case.post.residual_stress
    size, p0 = worst_instant(scales, loads.operation)
    ratio = scales.b / scales.a if scales.geometry.is_elliptic else 0.0
    depths, unit = unit_histories(round(mean_friction(loads), 6), poisson_ratio, ratio)
    residual = np.interp(size * depths, *np.transpose(table)) if table else np.zeros(len(depths))
    return SmoothContact(size * scales.a * depths, damages(p0 * unit, residual, count))


def worst_instant(scales: Scales, operation: Operation) -> tuple[float, float]:
    """Size of the dry contact over that of the scales, and its pressure [Pa], where this is largest."""
    times = np.linspace(0.0, operation.duration, INSTANTS) if operation.varies else [0.0]
    found = [operation.at(time) for time in times]
    worst = max(found, key=scales.dry_pressure)
    widening = scales.grid.widening  # of a roller, in its row with the highest load
    return widening * scales.size(worst), widening * scales.dry_pressure(worst)


def mean_friction(loads: Loads) -> float:
    """Mean friction coefficient of the stored frames, traction on surface 2 over load."""
    frames = np.unique(np.linspace(0, loads.time.size - 1, FRICTION_FRAMES).astype(int))
    surface = next(name for name in ("2", "1") if f"shear_stress_{name}" in loads.fields)
    pairs = [loads.read(surface, frame, frame + 1) for frame in frames]
    return float(np.mean([abs(shear.sum()) / pressure.sum() for pressure, shear in pairs]))
