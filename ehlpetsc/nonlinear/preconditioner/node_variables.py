"""In which two unknowns of a node the band is written.

The kernel of the deflection reaches far, the film's second difference does not: a band stays narrow if what
carries pressure always stands in the first place. So the band knows, at an open node, the changes of
(q, h), but where solids touch in mixed contact those of (p, q): the film does not change there.
"""

from typing import NamedTuple

import numpy as np

from ehlpetsc.discretisation.interleaving import firsts_of_rows, seconds_of_rows


class BandEntries(NamedTuple):
    """Derivatives of a state in the band's unknowns.

    Attributes
    ----------
    p_first, h_second : ndarray, shape (nx,)
        Of the pressure by the first, of the film by the second unknown of each node.
    reynolds_derivatives : ndarray, shape (local nodes, 8)
        Of the local Reynolds rows by both unknowns of the nodes i-2 .. i+1.
    """

    p_first: np.ndarray
    h_second: np.ndarray
    reynolds_derivatives: np.ndarray


def band_entries(model, relations, derivatives, stencil):
    """Entries in the band's unknowns.

    Parameters
    ----------
    model : contact_model.DirectContact or MixedContact
    relations, derivatives
        Of the state, as in `ehl_problem.Evaluation`.
    stencil : ndarray of int, shape (local nodes, 4)
        Nodes of each Reynolds row, within the mesh.
    """
    if not model.is_mixed:
        return BandEntries(relations.p_q, relations.h_w, derivatives)
    touching = relations.touching
    if touching.any():
        derivatives, solid = derivatives.copy(), touching[stencil]
        by_first, by_second = firsts_of_rows(derivatives), seconds_of_rows(derivatives)
        by_second[:] = np.where(solid, by_first, by_second)
        by_first[:] = np.where(solid, 0.0, by_first)
    return BandEntries(np.where(touching, 1.0, relations.p_q), relations.h_w, derivatives)


def in_unknowns(model, relations, local, solution):
    """Change the local solution, shape (local nodes, 2), from the band's unknowns to (q, w), in place."""
    if not model.is_mixed:
        return
    solid = np.flatnonzero(relations.touching[local])
    p, q = solution[solid, 0], solution[solid, 1]
    solution[solid, 0] = q
    solution[solid, 1] = (relations.p_q[local][solid] * q - p) / model.stiffness
