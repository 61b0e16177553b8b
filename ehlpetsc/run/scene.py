"""Scene of one pass of a case, for its effects."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from ehlpetsc.case.loading import Case
from ehlpetsc.effects.effect import Scene
from ehlpetsc.physics.scales import Scales
from ehlpetsc.surfaces.roughness import SurfacePositions


def scene_of(case: Case, scales: Scales, operation: Any, pass_number: int) -> Scene:
    """Scene at the beginning of a pass, `effects.effect.Scene`.

    Parameters
    ----------
    pass_number
        From 1; `time.pass_shift` shifts surface 2 from one pass to the next.
    """
    offset_1, offset_2 = (case.conditions and case.conditions.profile_offsets) or (0.0, 0.0)
    shift = (pass_number - 1) * case.time.pass_shift if case.time else 0.0
    positions = replace(SurfacePositions.at_rest(scales), profile_offsets=(offset_1, offset_2 + shift))
    return Scene(case, scales, operation, positions)
