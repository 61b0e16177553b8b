r"""Elimination of the film from the linear system of a contact in the plane, node by node.

The row of the deflection, :math:`\delta s-\delta h_{00}-D\,\delta p=b`, gives the change of the separation s
by those of all pressures. What is left are one or two unknowns a node, by which of its quantities depend on
both of its unknowns (q, w):

* `PRESSURE`: pressure and separation are independent; unknown: the pressure, row: Reynolds.
* `VOID`: the pressure is constant (a cavity, yielding solids); unknown: that of the Reynolds equation.
* `STIFF`: as `VOID`, but the pressure follows from the separation (asperities in a cavity).
* `CONTACT`: the separation is constant (solids that touch); unknowns: pressure with the row of the
  deflection, and that of the Reynolds equation.
* `BOUND`: as `CONTACT`, without a Reynolds row (a film at its bound).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ehlpetsc.base.compiled import compiled
from ehlpetsc.discretisation.contact.node_state import NodeState

PRESSURE, VOID, STIFF, CONTACT, BOUND = range(5)
STIFF_SLOPE = 1e-3  # p0 per a^2/R: from this slope of the asperities' pressure on it counts in a cavity
# minimum of -dr/dw where solids yield: it vanishes below a rigid film, and r would not depend on the film
MIN_SLOPE = 1e-8


class Reduction(NamedTuple):
    """Changes of the quantities of each node by those of the unknowns left; arrays of shape (nodes,).

    `kind`: as in the module.
    `r_p`, `r_s`, `h_p`, `h_s`: of Reynolds unknown r and film h by pressure p and separation s.
    `p_s`: of the pressure by the separation, at `STIFF`.
    `back`: of q and w by the first (p; at `VOID` r) and the second quantity (s; at `STIFF` and `CONTACT` r),
        shape (4, nodes).
    """

    kind: np.ndarray
    r_p: np.ndarray
    r_s: np.ndarray
    h_p: np.ndarray
    h_s: np.ndarray
    p_s: np.ndarray
    back: np.ndarray


def reduction_of(state: NodeState, inactive: np.ndarray) -> Reduction:
    """Reduction of the nodes of a state; `inactive`: mask of those whose w is not in the system."""
    (p_q, p_w), (r_q, r_w), (_, h_w), (s_q, s_w) = state.derivatives()
    kind, r_w = np.full(len(p_q), PRESSURE, dtype=np.uint8), r_w.copy()
    determinant = p_q * s_w - p_w * s_q
    fixed = np.abs(determinant) < 1e-12
    kind[fixed] = VOID
    kind[fixed & (s_w != 0.0) & (np.abs(p_w) > STIFF_SLOPE)] = STIFF
    kind[fixed & (s_w == 0.0) & (p_w != 0.0)] = CONTACT
    kind[inactive] = BOUND
    of_p_and_s, of_r_and_s = kind == PRESSURE, (kind == VOID) | (kind == STIFF)
    of_p_and_r, bound = (kind == STIFF) | (kind == CONTACT), kind == BOUND
    r_w[of_r_and_s & (r_q == 0.0)] = np.minimum(r_w[of_r_and_s & (r_q == 0.0)], -MIN_SLOPE)
    by_p_s, by_r_s = inverse((p_q, p_w), (s_q, s_w), of_p_and_s), inverse((r_q, r_w), (s_q, s_w), of_r_and_s)
    back = by_p_s + inverse((p_q, p_w), (r_q, r_w), of_p_and_r)
    back += np.where(kind == VOID, by_r_s, 0.0)
    back[0, bound] = 1.0
    r_p, r_s = r_q * by_p_s[0] + r_w * by_p_s[2], r_q * by_p_s[1] + r_w * by_p_s[3]
    h_p, h_s = h_w * (by_p_s[2] + by_r_s[2]), h_w * (by_p_s[3] + by_r_s[3])
    r_p[bound] = r_q[bound]
    stiff = kind == STIFF
    p_s = np.where(stiff, p_w / np.where(stiff, s_w, 1.0), 0.0)
    return Reduction(kind, r_p, r_s, h_p, h_s, p_s, back)


@compiled
def unknowns_of(
    kind: np.ndarray, back: np.ndarray, pressure: np.ndarray, r: np.ndarray, separation: np.ndarray
) -> np.ndarray:
    """Both unknowns of some nodes, shape (nodes, 2); `kind` and `back` as of :class:`Reduction`."""
    out = np.empty((len(kind), 2))
    for i in range(len(kind)):
        first = r[i] if kind[i] == VOID else pressure[i]
        second = r[i] if kind[i] == STIFF or kind[i] == CONTACT else separation[i]
        out[i, 0] = back[0, i] * first + back[1, i] * second
        out[i, 1] = back[2, i] * first + back[3, i] * second
    return out


def inverse(first: tuple, second: tuple, nodes: np.ndarray) -> np.ndarray:
    """Derivatives of q and w by two quantities from theirs by q and w, zero but at `nodes`; (4, nodes)."""
    (a, b), (c, d) = first, second
    by = nodes / np.where(nodes, a * d - b * c, 1.0)
    return np.stack([d * by, -b * by, -c * by, a * by])
