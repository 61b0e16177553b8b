"""Roughness of both surfaces in the gap."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from ehlpetsc.effects.effect import Effect

if TYPE_CHECKING:
    from ehlpetsc.discretisation.ehl_problem import StepInputs
    from ehlpetsc.effects.effect import Step


class RoughSurfaces(Effect):
    """Heights of both profiles, means over the cells of the mesh, subtracted from the gap."""

    name = "roughness"
    moves_with_surfaces = True

    @classmethod
    def is_in(cls, case: Any) -> bool:
        """Whether one of the surfaces has a profile."""
        return bool(case.surface.body_1 or case.surface.body_2)

    def inputs(self, record: Any, inputs: StepInputs, step: Step) -> StepInputs:
        """Add the roughness at the end of the step to the gap."""
        scales = self.scene.scales
        heights = self.scene.roughness.phi_after(scales.x * scales.a, step.travelled, scales.dx)
        return replace(inputs, phi=inputs.phi + heights / scales.h)
