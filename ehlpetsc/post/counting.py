"""Damage of stress histories by a criterion of damage, with the constants of a case."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from ehlpetsc.post.fatigue.accumulate import count_damage

if TYPE_CHECKING:
    from ehlpetsc.base.case import Case
    from ehlpetsc.post.criteria.planes import Criteria
    from ehlpetsc.post.fatigue.strain_life import Material

Count = Callable[[np.ndarray, np.ndarray, float], np.ndarray]
"""Results (points, columns), the damage first, of histories (points, components, samples), their lengths
(points,) and a residual stress [Pa]."""


def count_of(
    case: Case, material: Material, constants: Criteria, criterion: str, share: float = 1.0
) -> Count:
    """Count of "von-mises", the damage of the paper, or "fatemi-socie".

    `share`: of the points of a plane, the worst ones, whose critical planes are sought.
    """
    common = {"material": material, "strain": case.post.strain, "cycle_residual": case.post.residual}
    if criterion == "von-mises":
        return partial(count_damage, mean_stress=case.post.mean_stress, **common)
    from ehlpetsc.post.criteria.critical_plane import count_on_planes  # slow to compile: only if requested

    return partial(count_on_planes, constants=constants, share=share, **common)
