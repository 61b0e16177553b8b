"""Contact models: what oil and solids do at a node, one module a law, behind one interface."""

from ehlpetsc.discretisation.contact.direct import DirectContact, DryContact
from ehlpetsc.discretisation.contact.mixed import MixedContact
from ehlpetsc.discretisation.contact.yielding import YieldingContact


def film_scale_of(case, scales, expected_film):
    """Scale of the Reynolds rows, at least the film that passes between touching solids; in a^2/R."""
    boundary_film = case.contact.boundary_film
    return expected_film if boundary_film is None else max(expected_film, boundary_film / scales.h)


def contact_model(case, scales, film_scale):
    """The contact model of a case.

    Parameters
    ----------
    case : case.loading.Case
    scales : physics.scales.Scales
    film_scale : float
        See :func:`film_scale_of`.

    Returns
    -------
    model.ContactModel
    """
    contact = case.contact
    if contact.model == "direct":
        return (DryContact if case.fluid is None else DirectContact)(contact.minimum_film / scales.h)
    boundary_film, stiffness = contact.boundary_film / scales.h, 1.0 / film_scale
    if contact.yield_pressure is None:
        return MixedContact(boundary_film, stiffness)
    return YieldingContact(boundary_film, stiffness, min(contact.yield_pressure) / scales.p0)
