"""Steady starts that fail: a guess by the solution on a coarser mesh, and cures to name."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ehlpetsc.discretisation.unknowns import Unknowns

if TYPE_CHECKING:
    from ehlpetsc.case.loading import Case
    from ehlpetsc.discretisation.ehl_problem import EHLProblem
    from ehlpetsc.physics.operation import Conditions
    from ehlpetsc.stepping.state import State


def coarser(case: Case, points: int) -> Case:
    """Case with fewer nodes per half-width, likewise across."""
    across = case.mesh.points_across
    change = {"points_per_half_width": points, "points_across": across and max(across // 2, 1)}
    return case.copy({"mesh": case.mesh.copy(change)})


def guess_of(coarse: State, by: EHLProblem, problem: EHLProblem) -> Unknowns:
    """Unknowns of a problem interpolated from the solution by another one, on other nodes."""
    h, solids = by.model.state(coarse.q, coarse.w).film, by.model.contact_pressure(coarse.w)
    q, h, solids = (by.grid.interpolated(values, problem.grid) for values in (coarse.q, h, solids))
    return Unknowns(q, problem.model.w_from_state(h, solids), coarse.unknowns.h00)


def cures(case: Case, conditions: Conditions) -> str:
    """Advice for a case without a steady start under its first conditions."""
    found = ["a finer mesh"]
    if case.fluid and case.heat and case.fluid.limiting_shear is None and conditions.sliding:
        found.append("fluid.limiting_shear, as sliding heats an oil without one beyond measure")
    if case.fluid and conditions.entrainment == 0.0:
        found.append("a slow entrainment instead of rest at the begin")
    if case.fluid and not case.contact.has_contact_pressure:
        found.append('contact.model = "mixed"')
    return f". Try {' or '.join(found)}"
