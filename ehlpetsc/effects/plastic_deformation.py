r"""Plastic deformation of both surfaces, left where the solids have yielded.

A step adds the depth :math:`\delta` of :mod:`ehlpetsc.discretisation.contact.yielding` at opposite points of
the surfaces: to the softer surface, or half to each if both have the same yield pressure.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ehlpetsc.base.declarations import Field, StepScalar
from ehlpetsc.effects.body_depth import BodyDepth
from ehlpetsc.surfaces.body_field import BodyFields

if TYPE_CHECKING:
    from ehlpetsc.case.tables import Case
    from ehlpetsc.discretisation.ehl_problem import Solution
    from ehlpetsc.effects.effect import Scene, Step


class PlasticRecord(NamedTuple):
    """Plastic deformation of both bodies, its hidden part; increment of the last step at the nodes [m]."""

    depth: BodyFields
    added: np.ndarray
    hidden: BodyFields


class PlasticDeformation(BodyDepth[PlasticRecord]):
    """Depth of the plastic deformation, added to the gap and kept in the bodies."""

    name = "plastic_deformation"
    record = PlasticRecord
    scalars = {
        "yielding": StepScalar(
            "1",
            "nodes that yield",
            dtype="i4",
            over_run="sum",
            summary="d",
            compared=True,
            of=lambda o: np.count_nonzero(o.state.records["plastic_deformation"].added),
        ),
        "set_volume": StepScalar(
            "m^3",
            "plastic deformation of both solids since the first pass",
            integrated=True,
            over_run="last",
            summary=".4g",
            compared=True,
            of=lambda o: o.scene.mesh_on_bodies.volume(o.state.records["plastic_deformation"].depth),
        ),
    }
    surface = {"set": Field("m", "depth of the plastic deformation at the end", ("s",))}

    def __init__(self, scene: Scene) -> None:
        super().__init__(scene)
        yield_1, yield_2 = scene.case.contact.yield_pressure or (0.0, 0.0)
        is_equal = yield_1 == yield_2
        self._fractions = (0.5, 0.5) if is_equal else (float(yield_1 < yield_2), float(yield_2 < yield_1))

    @classmethod
    def is_in(cls, case: Case) -> bool:
        """Whether the solids yield."""
        return case.contact.yield_pressure is not None

    def start(self, before: PlasticRecord | None = None, **entries: np.ndarray) -> PlasticRecord:
        """No deformation, or the deformation of the previous pass."""
        return super().start(before, added=np.zeros(self.scene.scales.grid.n), **entries)

    def accept(self, record: PlasticRecord, solution: Solution, step: Step) -> PlasticRecord:
        """Add the depth of the step to both bodies."""
        plastic = solution.nodes.plastic
        if plastic is None:
            return record
        total = self.scene.scales.h * plastic.depth
        depths = [fraction * total for fraction in self._fractions]
        depth = self.scene.mesh_on_bodies.add(record.depth, step.travelled, depths)
        return PlasticRecord(depth, total, record.hidden)
