"""Checks of domain and mesh against the contact before a run."""

import math

from ehlpetsc.discretisation.contact import smallest_film
from ehlpetsc.physics.film_formulas import (
    expected_film,
    film_left_by_inlet,
    inlet_opening,
    points_for_opening,
)

MIN_FILM_LEFT = 0.95  # of the flooded film: below it the inlet is reported as too near
PROPOSED_FILM_LEFT = 0.99  # of the flooded film, with the proposed inlet
MAX_FILM_SLOPE = 0.25  # films that the gap opens from one node to the next: 5 % of the film are missing
MESH_MARGIN = 1.1  # a mesh that lacks a few percent of its points causes no warning
MAX_OPENING = 5.0  # films opened from one node to the next: no smooth film is left
MAX_INLET = 100.0  # half widths that mesh.inlet may be


def domain_warnings(case, scales):
    """Warnings of an inlet too near, or a mesh too coarse for the inlet sweep, with the cure.

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
    opening = inlet_opening(_thinnest(case, scales), case.mesh.points_per_half_width)
    if MESH_MARGIN * MAX_FILM_SLOPE < opening:
        notes.append(f"{_coarse(opening)}: the film comes out too thin; {_cure(case, scales)}")
    return notes


def domain_faults(case, scales):
    """Faults of the domain that make the result meaningless, one line each; checked before a run.

    Parameters as of `domain_warnings`.
    """
    if case.contact.yield_pressure:
        return _too_narrow(case, scales)
    if case.fluid is None or case.contact.has_contact_pressure:  # where the boundary film stays
        return []
    opening = inlet_opening(_thinnest(case, scales), case.mesh.points_per_half_width)
    if opening <= MAX_OPENING:
        return []
    points = case.mesh.points_per_half_width
    where = f"{case.path}: mesh.points_per_half_width = {points}"
    return [f"{where}: {_coarse(opening)}, which leaves no film; {_cure(case, scales)}"]


def _too_narrow(case, scales):
    """Fault of a domain too narrow to bear the load at the yield pressure."""
    pressure = min(case.contact.yield_pressure)
    needed, there = scales.load / (pressure * scales.a), case.mesh.outlet - case.mesh.inlet
    if needed < there:
        return []
    return [
        f"{case.path}: contact.yield_pressure = {1e-9 * pressure:g} GPa bears the load on {needed:.3g} half "
        f"widths or more, the domain has {there:.3g}; put mesh.inlet and mesh.outlet further out"
    ]


def _thinnest(case, scales):
    """Expected film or, where it is thicker, the film left by solids in contact [a^2/R]."""
    return max(expected_film(case, scales), smallest_film(case.contact, scales))


def _near_inlet(case, scales):
    film, inlet = expected_film(case, scales), -case.mesh.inlet
    left = film_left_by_inlet(film, inlet)
    if left >= MIN_FILM_LEFT:
        return []
    further = inlet
    while further < MAX_INLET and film_left_by_inlet(film, further) < PROPOSED_FILM_LEFT:
        further += 0.1
    return [
        f"mesh.inlet = {case.mesh.inlet:g} is too near: by Grubin's integral it leaves {100 * left:.0f} % of "
        f"the film of a flooded contact; mesh.inlet = {-math.ceil(10.0 * further) / 10.0:g} leaves "
        f"{100 * PROPOSED_FILM_LEFT:g} %"
    ]


def _coarse(opening):
    return (
        f"the mesh is too coarse for the inlet: beside the contact the gap opens by {opening:.2g} films "
        "from one node to the next"
    )


def _cure(case, scales):
    points = math.ceil(points_for_opening(_thinnest(case, scales), MAX_FILM_SLOPE))
    other = "" if case.contact.has_contact_pressure else '; or contact.model = "mixed"'
    return f"try mesh.points_per_half_width = {points}{other}"
