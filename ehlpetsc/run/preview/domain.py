"""Checks of domain and mesh against the contact before a run."""

import math

from ehlpetsc.discretisation.contact import smallest_film
from ehlpetsc.physics.film_formulas import (
    expected_film,
    film_left_by_inlet,
    inlet_opening,
    points_for_opening,
)

MIN_FILM_RATIO = 0.95  # film over that of a flooded contact, below which the inlet is reported as too near
PROPOSED_FILM_RATIO = 0.99  # film over that of a flooded contact, with the proposed inlet
MAX_FILM_SLOPE = 0.25  # films by which the gap opens from node to node: the film is 5 % too thin
MESH_MARGIN = 1.1  # a mesh with a few percent too few points causes no warning
MAX_OPENING = 5.0  # films by which the gap opens from node to node: there is no smooth film
MAX_INLET = 100.0  # half widths: largest distance of the proposed inlet


def domain_warnings(case, scales):
    """Warnings of an inlet that is too near, or a mesh that is too coarse for the inlet, with the cure.

    Parameters
    ----------
    case : case.loading.Case
    scales : physics.scales.Scales

    Returns
    -------
    list of str
    """
    if case.fluid is None:
        return []
    notes = [] if case.fluid.inlet_film is not None else _near_inlet(case, scales)
    opening = inlet_opening(_smallest_expected_film(case, scales), case.mesh.points_per_half_width)
    if MESH_MARGIN * MAX_FILM_SLOPE < opening:
        notes.append(f"{_coarse(opening)}: the film comes out too thin; {_finer_mesh_hint(case, scales)}")
    return notes


def domain_faults(case, scales):
    """Faults of the domain that make the result meaningless, one message each; checked before a run.

    Parameters as in :func:`domain_warnings`.
    """
    if case.contact.yield_pressure:
        return _too_narrow(case, scales)
    if case.fluid is None or case.contact.has_contact_pressure:  # the boundary film remains
        return []
    opening = inlet_opening(_smallest_expected_film(case, scales), case.mesh.points_per_half_width)
    if opening <= MAX_OPENING:
        return []
    points = case.mesh.points_per_half_width
    where = f"{case.path}: mesh.points_per_half_width = {points}"
    return [f"{where}: {_coarse(opening)}, which leaves no film; {_finer_mesh_hint(case, scales)}"]


def _too_narrow(case, scales):
    """Fault of a domain too narrow to bear the load at the yield pressure."""
    pressure = min(case.contact.yield_pressure)
    needed, width = scales.load / (pressure * scales.a), case.mesh.outlet - case.mesh.inlet
    if needed < width:
        return []
    return [
        f"{case.path}: contact.yield_pressure = {1e-9 * pressure:g} GPa bears the load on {needed:.3g} half "
        f"widths or more, the domain has {width:.3g}; put mesh.inlet and mesh.outlet further out"
    ]


def _smallest_expected_film(case, scales):
    """Expected film or, if larger, the smallest film of the contact model [a^2/R]."""
    return max(expected_film(case, scales), smallest_film(case.contact, scales))


def _near_inlet(case, scales):
    film, inlet = expected_film(case, scales), -case.mesh.inlet
    ratio = film_left_by_inlet(film, inlet)
    if ratio >= MIN_FILM_RATIO:
        return []
    proposed = inlet
    while proposed < MAX_INLET and film_left_by_inlet(film, proposed) < PROPOSED_FILM_RATIO:
        proposed += 0.1
    return [
        f"mesh.inlet = {case.mesh.inlet:g} is too near: by Grubin's integral it leaves {100 * ratio:.0f} % "
        f"of the film of a flooded contact; mesh.inlet = {-math.ceil(10.0 * proposed) / 10.0:g} leaves "
        f"{100 * PROPOSED_FILM_RATIO:g} %"
    ]


def _coarse(opening):
    return (
        f"the mesh is too coarse for the inlet: beside the contact the gap opens by {opening:.2g} films "
        "from one node to the next"
    )


def _finer_mesh_hint(case, scales):
    points = math.ceil(points_for_opening(_smallest_expected_film(case, scales), MAX_FILM_SLOPE))
    other = "" if case.contact.has_contact_pressure else '; or contact.model = "mixed"'
    return f"try mesh.points_per_half_width = {points}{other}"
