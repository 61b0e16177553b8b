"""The discrete problem of a point contact or a strip."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ehlpetsc.discretisation.contact import contact_model, film_scale_of
from ehlpetsc.discretisation.ehl_problem import EHLProblem, Share
from ehlpetsc.discretisation.plane.deflection import Deflection, Transposition
from ehlpetsc.discretisation.plane.reynolds import NoOil, Reynolds
from ehlpetsc.physics.scales import Scales

if TYPE_CHECKING:
    from ehlpetsc.case.tables import Case


def plane_problem(
    case: Case,
    scales: Scales,
    film_scale: float,
    share: Share,
    has_sides: tuple[bool, bool],
    bound_tolerance: float = 0.0,
    ranks: Transposition | None = None,
) -> EHLProblem:
    """Problem of the nodes of a rank, whole rows along x.

    `film_scale`: expected film in a^2/R.
    `has_sides`: whether the domain ends below and above the local rows.
    `bound_tolerance`: of the active set in a^2/R: films this close to their bound count as on it.
    `ranks`: transposition of the convolution; None: one rank.
    """
    grid, film_scale = scales.grid, film_scale_of(case, scales, film_scale)
    model = contact_model(case, scales, film_scale, bound_tolerance)
    constants = scales.stiffness, film_scale, grid.periodic
    deflection = Deflection(grid.shape, grid.steps, *constants, share.owned, ranks)
    shape = (share.last - share.first) // grid.shape[-1], grid.shape[-1]
    if case.fluid is None:
        reynolds: NoOil | Reynolds = NoOil(shape, share.owned)
    else:
        layer = case.contact.asperity_height or 0.0
        reynolds = Reynolds(scales, grid.steps, film_scale, shape, share, has_sides, layer)
    return EHLProblem(case, scales, share, model, deflection, reynolds, film_scale)
