"""Effects whose record is a depth of both bodies, which is added to the gap.

With a profile that is shifted in each pass (``time.pass_shift``), the depths of earlier passes enter the
contact with the heights of the profile. Ahead of the profile the body is smooth: pits without the asperities
in which they formed would disturb the steady start. Depths ahead of the profile are hidden from the gap, but
kept in the record; depths added during the pass are not hidden.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Protocol, Self, TypeVar

import numpy as np

from ehlpetsc.effects.effect import Effect
from ehlpetsc.surfaces.body_field import BodyField, BodyFields

if TYPE_CHECKING:
    from ehlpetsc.discretisation.ehl_problem import StepInputs
    from ehlpetsc.effects.effect import Step
    from ehlpetsc.surfaces.moving_surface import MovingSurface


class DepthRecord(Protocol):
    """Record with a depth, and the part of it that is not in the gap."""

    @property
    def depth(self) -> BodyFields:
        """Depth of both bodies."""

    @property
    def hidden(self) -> BodyFields:
        """Its hidden part."""

    def _replace(self, *, depth: BodyFields = ..., hidden: BodyFields = ...) -> Self: ...


D = TypeVar("D", bound=DepthRecord)


class BodyDepth(Effect[D]):
    """Effect whose record has `depth` and `hidden`, the part of the depth that is not in the gap."""

    def start(self, before: D | None = None, **entries: np.ndarray) -> D:
        """Depth zero with further entries of the record, or the record of the previous pass."""
        if before is None:
            zero = self.scene.mesh_on_bodies.zero
            return self.record(depth=zero, hidden=zero, **entries)
        return before._replace(hidden=self._ahead_of_profiles(before.depth))

    def inputs(self, record: D, inputs: StepInputs, step: Step) -> StepInputs:
        """Add both depths to the gap."""
        return replace(inputs, phi=inputs.phi + sum(self.in_gap(record, step)) / self.scene.scales.h)

    def in_gap(self, record: D, step: Step) -> list[np.ndarray]:
        """Depths of both bodies in the gap at the nodes [m]."""
        depths = self.scene.mesh_on_bodies.means(record.depth, step.travelled)
        hidden = self.scene.mesh_on_bodies.means(record.hidden, step.travelled)
        return [depth - hidden_depth for depth, hidden_depth in zip(depths, hidden, strict=True)]

    def on_surfaces(
        self, record: D, points: Sequence[np.ndarray | None]
    ) -> dict[str, Sequence[np.ndarray | None]]:
        """Depth along both surfaces."""
        return dict.fromkeys(self.surface, self.scene.mesh_on_bodies.at_points(record.depth, points))

    def _ahead_of_profiles(self, depth: BodyFields) -> BodyFields:
        """Part of the depths of earlier passes ahead of the profiles, `BodyFields`."""
        roughness, faces = self.scene.roughness, self.scene.mesh_on_bodies.faces((0.0, 0.0))
        profiles = (roughness.surface_1, roughness.surface_2) if roughness else (None, None)
        return BodyFields(*map(_ahead, depth, profiles, faces))


def _ahead(field: BodyField, profile: MovingSurface | None, faces: np.ndarray) -> BodyField:
    """Depth ahead of a profile, in excess of that of its row, the minimum in the mesh at the start."""
    if profile is None or not profile.is_moving or not profile.body_offset or not field.cells:
        return BodyField(field.spacing, 0, field.depth[..., :0])
    centres = 0.5 * (field.edges[1:] + field.edges[:-1]) - profile.body_offset
    excess = np.maximum(field.depth - field.means(faces).min(axis=-1, keepdims=True), 0.0)
    return field._replace(depth=(1.0 - profile.entered(centres)) * excess)
