"""Steady start from the solution on a coarser mesh; advice for a case without a steady start."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ehlpetsc.discretisation.unknowns import Unknowns
from ehlpetsc.stepping.state import State

if TYPE_CHECKING:
    from ehlpetsc.case.tables import Case
    from ehlpetsc.discretisation.ehl_problem import EHLProblem
    from ehlpetsc.physics.operation import Conditions
    from ehlpetsc.physics.scales import Scales

RIGID_FILM = 1000.0  # a^2/R: below a thicker film solids hardly deform
SOFT_LAYER = 0.1  # beta E* over p0: a node of a softer layer has no asperity pressure or all of it


def coarser(case: Case, ramp: str | None = None) -> Case:
    """Steady case with half as many nodes per half-width, likewise across; smooth if its steady start is.

    `ramp`: `time.ramp` of a case that is neither steady nor smooth.
    """
    along, across = case.mesh.points_per_half_width, case.mesh.points_across
    change = {"points_per_half_width": along // 2, "points_across": across and max(across // 2, 1)}
    tables = {"mesh": case.mesh.copy(change)}
    if ramp is not None:
        tables["time"] = case.time.copy({"ramp": ramp})
    elif case.time is not None and case.time.start == "rough":
        tables |= {"time": None, "surface": case.surface.copy({"body_1": None, "body_2": None})}
    return case.copy(tables)


def guess_of(coarse: State, by: EHLProblem, problem: EHLProblem) -> Unknowns:
    """Unknowns of a problem interpolated from the solution by another one, on other nodes."""
    h, solids = by.model.state(coarse.q, coarse.w).film, by.model.contact_pressure(coarse.w)
    q, h, solids = (by.grid.interpolated(values, problem.grid) for values in (coarse.q, h, solids))
    return Unknowns(q, problem.model.w_from_state(h, solids), coarse.unknowns.border)


def cures(case: Case, scales: Scales, conditions: Conditions, film: float) -> str:
    """Advice for a case without a steady start under its first conditions; expected film in a^2/R."""
    if film > RIGID_FILM:
        return (
            f". The film, {film:.0f} a^2/R, is far thicker than solids deform, and the pressure wider than "
            "the domain. Try a higher load or a lower speed"
        )
    found = ["a finer mesh"]
    if case.fluid and case.heat and case.fluid.limiting_shear is None and conditions.sliding:
        found.append("fluid.limiting_shear, as sliding heats an oil without one beyond measure")
    if case.fluid and conditions.entrainment == 0.0:
        found.append("a slow entrainment instead of rest at the begin")
    if case.fluid and not case.contact.has_contact_pressure:
        found.append('contact.model = "mixed"')
    if case.contact.asperity_height and not case.contact.adsorbed_film:
        found.append("contact.adsorbed_film = 1e-9, without which the film in the layer may vanish")
    beta = case.contact.asperity_stiffness
    if beta and 0.5 * scales.E * beta < SOFT_LAYER * scales.p0:
        found.append(f"contact.asperity_stiffness above {beta:.2g}, as the Hertz pressure flattens the layer")
    return f". Try {' or '.join(found)}"
