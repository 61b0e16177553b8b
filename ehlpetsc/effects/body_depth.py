"""Effects whose record is a depth of both bodies, which is added to the gap.

A profile that begins further on in each pass (``time.pass_shift``) brings the depths of earlier passes in
with its heights. Ahead of it the body is smooth: pits without the asperities that got them would disturb the
steady start. What lies ahead is hidden from the gap, not removed; what the pass itself adds there is seen.
"""

from dataclasses import replace

import numpy as np

from ehlpetsc.effects.effect import Effect
from ehlpetsc.surfaces.body_field import BodyField, BodyFields


class BodyDepth(Effect):
    """Effect with a record that has `depth` and `hidden`, its part that the gap does not see."""

    def inputs(self, record, inputs, step):
        """Add both depths to the gap."""
        return replace(inputs, phi=inputs.phi + sum(self.in_gap(record, step)) / self.scene.scales.h)

    def in_gap(self, record, step):
        """Depths of both bodies that the gap sees at the nodes [m], shape (nx,) each."""
        seen = self.scene.mesh_on_bodies.means(record.depth, step.travelled)
        hidden = self.scene.mesh_on_bodies.means(record.hidden, step.travelled)
        return [depth - ahead for depth, ahead in zip(seen, hidden, strict=True)]

    def on_surfaces(self, record, points):
        """Depth along both surfaces."""
        return {name: self.scene.mesh_on_bodies.at_points(record.depth, points) for name in self.surface}

    def ahead_of_profiles(self, depth):
        """Part of the depths of earlier passes that the profiles have yet to bring in, as `BodyFields`.

        Parameters
        ----------
        depth : BodyFields
        """
        roughness, faces = self.scene.roughness, self.scene.mesh_on_bodies.faces((0.0, 0.0))
        profiles = (roughness.surface_1, roughness.surface_2) if roughness else (None, None)
        return BodyFields(*map(_ahead, depth, profiles, faces))


def _ahead(field, profile, faces):
    """Depth ahead of a profile beyond the least one under the mesh at the start, whose faces are given."""
    if profile is None or not profile.is_moving or not profile.body_offset or not len(field.depth):
        return BodyField(field.spacing, 0, np.zeros(0))
    middles = 0.5 * (field.edges[1:] + field.edges[:-1]) - profile.body_offset
    beyond = np.maximum(field.depth - field.means(faces).min(), 0.0)
    return field._replace(depth=(1.0 - profile.entered(middles)) * beyond)
