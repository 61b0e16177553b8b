"""Minimum film of the smooth contact, of the steady solution with which a run begins."""

from __future__ import annotations

import numpy as np

from ehlpetsc.discretisation.ehl_problem import EHLProblem
from ehlpetsc.effects.scene import Scene
from ehlpetsc.physics.film_formulas import MAX_FILM_SLOPE, inlet_opening, smooth_films
from ehlpetsc.physics.operation import Conditions

MAX_SHARE = 0.01  # of the load, on solids under a film of oil alone


def computed_over_expected(
    scene: Scene, problem: EHLProblem, baseline: tuple[np.ndarray, np.ndarray] | None
) -> float:
    """Minimum film of a smooth steady start over that of the formulas; 1 where the start is no such film.

    It is none with roughness in the contact at time 0, with solids that carry load, and on a mesh that is too
    coarse for the inlet.

    `baseline`: unknowns q and w of the steady start; None: none.
    """
    scales, fluid, conditions = scene.scales, scene.case.fluid, scene.operation.at(0.0)
    opening = inlet_opening(problem.film_scale, scene.case.mesh.points_per_half_width)
    if baseline is None or opening > MAX_FILM_SLOPE or _is_rough_at_start(scene, conditions):
        return 1.0
    q, w = baseline
    expected = smooth_films(scales, fluid, conditions)[1]
    solids, oil = problem.model.contact_pressure(w).sum(), np.maximum(q, 0.0).sum()
    if expected == 0.0 or solids > MAX_SHARE * (solids + oil):
        return 1.0
    return float(problem.model.film(q, w).min()) * scales.h / expected


def _is_rough_at_start(scene: Scene, conditions: Conditions) -> bool:
    """Whether the steady start has roughness in the Hertz contact; a rough start begins without."""
    scales, roughness, time = scene.scales, scene.roughness, scene.case.time
    if roughness is None or (time is not None and time.start == "rough"):
        return False
    heights = roughness.phi_after(scales.x * scales.a, (0.0, 0.0), scales.spacing)
    return bool(heights[scales.grid.inside(scales.size(conditions))].any())
