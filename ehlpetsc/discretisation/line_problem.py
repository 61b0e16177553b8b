"""The discrete problem of a line contact."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ehlpetsc.discretisation.contact import contact_model, film_scale_of
from ehlpetsc.discretisation.deflection import Deflection
from ehlpetsc.discretisation.ehl_problem import EHLProblem, Share
from ehlpetsc.discretisation.reynolds import NoOil, Reynolds
from ehlpetsc.physics.scales import Scales

if TYPE_CHECKING:
    from ehlpetsc.case.tables import Case


def line_problem(
    case: Case, scales: Scales, film_scale: float, first: int, last: int, bound_tolerance: float = 0.0
) -> EHLProblem:
    """Problem of the nodes first .. last-1 of a line contact.

    `film_scale`: expected film in a^2/R.
    `bound_tolerance`: of the active set in a^2/R: films this close to their bound count as on it.
    """
    grid, film_scale = scales.grid, film_scale_of(case, scales, film_scale)
    model = contact_model(case, scales, film_scale, bound_tolerance)
    deflection = Deflection(grid.n, grid.dx, first, last)
    start, layer = deflection.window.start, case.contact.asperity_height or 0.0
    if case.fluid is None:
        reynolds: NoOil | Reynolds = NoOil(first, last, start)
    else:
        reynolds = Reynolds(scales, film_scale, first, last, start, layer)
    share = Share(first, last, deflection.window, deflection.owned)
    return EHLProblem(case, scales, share, model, deflection, reynolds, film_scale)
