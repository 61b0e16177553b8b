"""Contact models: what oil and solids do at a node, one module a law behind one interface."""

from __future__ import annotations

from ehlpetsc.base.case import Case, Contact
from ehlpetsc.discretisation.contact.model import ContactModel
from ehlpetsc.discretisation.contact.node_state import FaceGap
from ehlpetsc.physics.scales import Scales


def film_scale_of(case: Case, scales: Scales, expected_film: float) -> float:
    """Scale of the Reynolds rows, at least the film that passes between touching solids; in a^2/R."""
    return max(expected_film, smallest_film(case.contact, scales))


def smallest_film(contact: Contact, scales: Scales) -> float:
    """Film in a^2/R that solids in contact leave: boundary film, or that of the layer under p0; 0: none."""
    if contact.asperity_height is not None:
        from ehlpetsc.discretisation.contact.compliant import CompliantContact, Layer

        return CompliantContact(Layer.of(contact, scales)).minimum_film
    return 0.0 if contact.boundary_film is None else contact.boundary_film / scales.h


def face_gap(contact: Contact) -> FaceGap:
    """Gap at a face between solids that are near; in direct contact faces leak, see `finite_volumes`."""
    return FaceGap(contact.asperity_height or 0.0, contact.model == "direct")


def contact_model(
    case: Case, scales: Scales, film_scale: float, bound_tolerance: float = 0.0
) -> ContactModel:
    """The contact model of a case.

    `film_scale`: see :func:`film_scale_of`.
    `bound_tolerance`: of the active set, in a^2/R.
    """
    contact = case.contact
    if contact.model == "direct":
        from ehlpetsc.discretisation.contact.direct import DirectContact, DryContact

        return (DryContact if case.fluid is None else DirectContact)(
            contact.minimum_film / scales.h, bound_tolerance
        )
    if contact.asperity_height is not None:
        from ehlpetsc.discretisation.contact.compliant import CompliantContact, Layer
        from ehlpetsc.discretisation.contact.yielding import CompliantYieldingContact

        layer = Layer.of(contact, scales)
        if contact.yield_pressure is None:
            return CompliantContact(layer)
        return CompliantYieldingContact(layer, min(contact.yield_pressure) / scales.p0, film_scale)
    from ehlpetsc.discretisation.contact.mixed import MixedContact
    from ehlpetsc.discretisation.contact.yielding import YieldingContact

    boundary_film, stiffness = contact.boundary_film / scales.h, 1.0 / film_scale
    if contact.yield_pressure is None:
        return MixedContact(boundary_film, stiffness)
    return YieldingContact(boundary_film, stiffness, min(contact.yield_pressure) / scales.p0)
