"""In which two unknowns of a node the band is written.

The kernel of the deflection reaches far, the film's second difference does not: a band stays narrow if what
carries pressure always stands in the first place. So the band knows, at an open node, the changes of
(q, h), but where solids touch in mixed contact those of (p, p_f): the film does not change there. Where
solids yield, the pressure does not change; in the first place then stands the excess e over the yield
pressure, which the depth follows, in the second h or p_f as before, or under a void that touches q.
"""

from typing import NamedTuple

import numpy as np

from ehlpetsc.discretisation.interleaving import firsts_of_rows, seconds_of_rows


class BandEntries(NamedTuple):
    """Derivatives of a state in the band's unknowns.

    Attributes
    ----------
    p_first, separation_first, separation_second : ndarray
        Of the pressure by the first, of the separation by both unknowns of each node of the window.
    reynolds_derivatives : ndarray, shape (local nodes, 8)
        Of the local Reynolds rows by both unknowns of the nodes i-2 .. i+1.
    """

    p_first: np.ndarray
    separation_first: np.ndarray
    separation_second: np.ndarray
    reynolds_derivatives: np.ndarray

    def same_deflection(self, other):
        """Whether the deflection rows of another state are the same."""
        return all((one == two).all() for one, two in zip(self[:3], other[:3], strict=True))


def band_entries(model, relations, derivatives, stencil):
    """Entries in the band's unknowns.

    Parameters
    ----------
    model : contact_model.DirectContact or MixedContact
    relations, derivatives
        As in `ehl_problem.Evaluation`.
    stencil : ndarray of int, shape (local nodes, 4)
        Nodes of each Reynolds row, by their places in the window.
    """
    none = np.zeros_like(relations.film)
    if not model.is_mixed:
        return BandEntries(relations.p_q, none, relations.h_w, derivatives)
    touching, plastic = relations.touching, relations.plastic
    p_first, separation_first = np.where(touching, 1.0, relations.p_q), none
    blind = touching  # Reynolds' rows do not know the first unknown there
    if plastic is not None and plastic.yielding.any():
        p_first = np.where(plastic.yielding, plastic.hardening, p_first)
        separation_first = np.where(plastic.yielding, -model.compliance, 0.0)
        blind = touching | plastic.yielding
    if blind.any():
        derivatives = derivatives.copy()
        by_first, by_second = firsts_of_rows(derivatives), seconds_of_rows(derivatives)
        by_second[:] = np.where(touching[stencil], by_first, by_second)
        by_first[:] = np.where(blind[stencil], 0.0, by_first)
    return BandEntries(p_first, separation_first, relations.h_w, derivatives)


def in_unknowns(model, relations, local, solution):
    """Change the local solution, shape (local nodes, 2), from the band's unknowns to (q, w), in place."""
    if not model.is_mixed:
        return
    solid = np.flatnonzero(relations.touching[local])
    first, oil = solution[solid, 0], solution[solid, 1]
    q, p_c = oil, first - relations.p_q[local][solid] * oil
    if relations.plastic is not None:
        by_oil = relations.plastic.depth_q[local][solid] > 0.0
        yielding = relations.plastic.yielding[local][solid]
        q = np.where(by_oil, first + oil, q)
        p_c = np.where(by_oil, -oil, np.where(yielding, first, p_c))
    solution[solid, 0] = q
    solution[solid, 1] = -p_c / model.stiffness
