"""Scene of a run: case, scales, operation, and surfaces that are loaded when first used."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from ehlpetsc.base.quantities import FIELDS, STEP_SCALARS, of_case

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    import numpy as np

    from ehlpetsc.base.case import Case
    from ehlpetsc.base.declarations import Field
    from ehlpetsc.physics import Operation
    from ehlpetsc.physics.scales import Scales
    from ehlpetsc.surfaces.motion.body_field import MeshOnBodies
    from ehlpetsc.surfaces.motion.roughness import Roughness


@dataclass(frozen=True)
class Scene:
    """Quantities that are fixed over a run.

    `begin`: abscissas at which both profiles begin to enter at time 0 [m].
    `columns`: divides work over the nodes among the ranks, `nonlinear.ranks.Columns`; None: one rank.
    """

    case: Case
    scales: Scales
    operation: Operation
    begin: tuple[float, float]
    columns: Callable[[Callable[[slice], np.ndarray]], np.ndarray] | None = None

    @classmethod
    def of_pass(
        cls, case: Case, scales: Scales, operation: Operation, number: float, columns: Any = None
    ) -> Scene:
        """Scene at the beginning of a pass, from 1: `time.pass_shift` shifts surface 2 from pass to pass.

        `number`: of a life with a fraction, as its partners drift.
        """
        offset_1, offset_2 = (case.conditions and case.conditions.profile_offsets) or (0.0, 0.0)
        shift = (number - 1) * (case.time.pass_shift or 0.0) if case.time else 0.0
        return cls(case, scales, operation, (offset_1, offset_2 + shift), columns)

    def over_columns(self, compute: Callable[[slice], np.ndarray]) -> np.ndarray:
        """Array over all nodes, of which each rank computes some columns along x, its last axis; collective.

        `compute`: of a slice of columns.
        """
        if self.columns is None:
            return compute(slice(0, self.scales.grid.shape[-1]))
        return self.columns(compute)

    @cached_property
    def quantities(self) -> tuple[dict[str, Callable], dict[str, Callable]]:
        """Functions of the fields and of the scalars of a step that the case has, by name."""
        tables: tuple[Mapping[str, Field], ...] = (FIELDS, STEP_SCALARS)
        fields, scalars = (
            {name: of for name in of_case(table, self.case) if (of := table[name].of)} for table in tables
        )
        return fields, scalars

    @cached_property
    def roughness(self) -> Roughness | None:
        """Profiles of both surfaces, `surfaces.motion.roughness.Roughness`; None where both are smooth."""
        if not (self.case.surface.body_1 or self.case.surface.body_2):
            return None
        from ehlpetsc.surfaces.motion.roughness import Roughness

        return Roughness.of(self.case, self.scales, self.begin)

    @cached_property
    def rq(self) -> float:
        """See :func:`combined_rq`."""
        return combined_rq(self.case, self.roughness)

    @cached_property
    def mesh_on_bodies(self) -> MeshOnBodies:
        """Cells of the mesh in both bodies, `surfaces.motion.body_field.MeshOnBodies`."""
        from ehlpetsc.surfaces.motion.body_field import MeshOnBodies
        from ehlpetsc.surfaces.motion.roughness import directed_speeds

        pairs = zip(self.begin, directed_speeds(self.case, self.scales), strict=True)
        return MeshOnBodies(self.scales, [-begin if speed > 0.0 else begin for begin, speed in pairs])


def combined_rq(case: Case, roughness: Roughness | None) -> float:
    """Root mean square height of both profiles and the layer of asperities [m]; 0: smooth."""
    return math.hypot(roughness.rq if roughness else 0.0, case.contact.asperity_height or 0.0)
