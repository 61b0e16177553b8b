"""Roughness of both surfaces as an effect: it changes the gap and has no state."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from ehlpetsc.effects.effect import Effect, NoRecord, Step

if TYPE_CHECKING:
    from ehlpetsc.base.case import Case
    from ehlpetsc.discretisation.step_inputs import StepInputs


class RoughSurfaces(Effect[NoRecord]):
    """Heights of both profiles at the nodes, subtracted from the gap."""

    name = "roughness"
    moves_with_surfaces = True

    @classmethod
    def is_in(cls, case: Case) -> bool:
        """Whether one of the surfaces has a profile."""
        return bool(case.surface.body_1 or case.surface.body_2)

    def inputs(self, record: NoRecord, inputs: StepInputs, step: Step) -> StepInputs:
        """Add the roughness at the end of the step to the gap."""
        scales = self.scene.scales
        x, rough = scales.x * scales.a, self.scene.roughness
        heights = self.scene.over_columns(
            lambda columns: scales.grid.as_rows(rough.phi_after(x, step.travelled, scales.spacing, columns))
        )
        return replace(inputs, phi=inputs.phi + heights.ravel() / scales.h)
