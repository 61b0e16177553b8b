"""Roughness by the kind of contact: profiles of a line, areal surfaces of points and strips."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ehlpetsc.case.tables import Case
    from ehlpetsc.physics.scales import Scales
    from ehlpetsc.surfaces.areal_roughness import ArealRoughness
    from ehlpetsc.surfaces.roughness import Roughness, SurfacePositions


def _line(case: Case, scales: Scales, positions: SurfacePositions | None) -> Roughness | None:
    from ehlpetsc.surfaces.roughness import Roughness

    return Roughness.of(case, scales, positions)


def _plane(case: Case, scales: Scales, positions: SurfacePositions | None) -> ArealRoughness | None:
    from ehlpetsc.surfaces.areal_roughness import ArealRoughness

    y, dy = scales.a * scales.grid.axes[0], scales.grid.spacings[0]
    return ArealRoughness.of(case, scales, y, dy, dy * len(y), scales.grid.periodic, positions)


ROUGHNESS = {"line": _line, "strip": _plane, "point": _plane}


def roughness_of(
    case: Case, scales: Scales, positions: SurfacePositions | None = None
) -> Roughness | ArealRoughness | None:
    """Roughness of a case of any kind of contact; None if both surfaces are smooth.

    `positions`: by default both surfaces begin to enter with their first point.
    """
    return ROUGHNESS[case.kind](case, scales, positions)
