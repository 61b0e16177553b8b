"""Contact nodes of a result file, as stored or from the films."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ehlpetsc.base.errors import OutputError
from ehlpetsc.physics.asperities import CONTACT_PRESSURE, asperity_separation, layer_law
from ehlpetsc.physics.scales import reduced_modulus

if TYPE_CHECKING:
    from ehlpetsc.case.tables.contact import Contact
    from ehlpetsc.results.reader import Result

BOUND_TOLERANCE = 1e-6  # of the bound: films may be stored in single precision


def film_at_contact(result: Result) -> float:
    """Film [m] at contact nodes; -inf without contact.

    Minimum film of the steps with contacts: in direct contact ``contact.minimum_film``, in mixed contact
    ``contact.boundary_film``, also if the case has their defaults; with a compliant layer, the film at which
    its asperities carry the pressure above which nodes count as in contact.
    """
    contact = result.case.contact
    if contact.asperity_height is not None:
        return layer_film(contact)
    touching = result.steps("contacts") > 0
    return float(result.steps("h_min")[touching].min()) if touching.any() else -np.inf


def layer_film(contact: Contact) -> float:
    """Film [m] at which a compliant layer carries `CONTACT_PRESSURE`; `contact`: table of a case."""
    modulus = 0.5 * reduced_modulus(contact.youngs_modulus, contact.poisson_ratio)
    return asperity_separation(CONTACT_PRESSURE, *layer_law(contact, modulus))


def in_contact(result: Result, frames: int | slice, nodes: int | slice = slice(None)) -> np.ndarray:
    """Whether nodes are in contact, as stored, or from films at their bound; shape of the frames and nodes.

    An OutputError if the result has neither contacts nor films.
    """
    if "in_contact" in result:
        return np.asarray(result["in_contact"][frames, nodes], dtype=bool)
    if "film_thickness" not in result:
        raise OutputError(f"{result.path}: stores neither in_contact nor film_thickness")
    return result["film_thickness"][frames, nodes] <= film_at_contact(result) * (1.0 + BOUND_TOLERANCE)
