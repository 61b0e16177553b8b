r"""Elimination of the film from the linear system of a contact in the plane, node by node.

The row of the deflection, :math:`\delta s-\delta h_{00}-D\,\delta p=b`, gives the change of the separation s
by those of all pressures. What is left are one or two unknowns a node, by which of its quantities depend on
both of its unknowns (q, w):

* `PRESSURE`: pressure and separation are independent; unknown: the pressure, row: Reynolds.
* `VOID`: the pressure is constant (a cavity, yielding solids); unknown: that of the Reynolds equation.
* `CONTACT`: the separation follows from the pressure (solids that touch, stiff asperities in a cavity);
  unknowns: pressure with the row of the deflection, and that of the Reynolds equation.
* `BOUND`: as `CONTACT`, without a Reynolds row (a film at its bound).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ehlpetsc.discretisation.contact.node_state import NodeState

PRESSURE, VOID, CONTACT, BOUND = 0, 1, 2, 3
STIFF_SLOPE = 1e-3  # p0 per a^2/R: from this slope of the asperities' pressure on it counts in a cavity
# minimum of -dr/dw where solids yield: it vanishes below a rigid film, and r would not depend on the film
MIN_SLOPE = 1e-8


class Reduction(NamedTuple):
    """Changes of the quantities of each node by those of the unknowns left; arrays of shape (nodes,).

    `kind`: as in the module.
    `r_p`, `r_s`, `h_p`, `h_s`: of Reynolds unknown r and film h by pressure p and separation s.
    `s_p`: of the separation by the pressure, at `CONTACT` and `BOUND`.
    `back`: of q and w by the first (p; at `VOID` r) and the second quantity (s; at `CONTACT` r), shape (4,
        nodes).
    """

    kind: np.ndarray
    r_p: np.ndarray
    r_s: np.ndarray
    h_p: np.ndarray
    h_s: np.ndarray
    s_p: np.ndarray
    back: np.ndarray


def reduction_of(state: NodeState, inactive: np.ndarray) -> Reduction:
    """Reduction of the nodes of a state; `inactive`: mask of those whose w is not in the system."""
    (p_q, p_w), (r_q, r_w), (_, h_w), (s_q, s_w) = state.derivatives()
    kind, zeros = np.full(len(p_q), PRESSURE, dtype=np.uint8), np.zeros(len(p_q))
    determinant = p_q * s_w - p_w * s_q
    fixed = np.abs(determinant) < 1e-12
    carries = np.where(s_w == 0.0, p_w != 0.0, np.abs(p_w) > STIFF_SLOPE)
    kind[fixed] = VOID
    kind[fixed & carries] = CONTACT
    kind[inactive] = BOUND
    one = kind == PRESSURE
    by = 1.0 / np.where(one, determinant, 1.0)
    q_p, q_s, w_p, w_s = s_w * by, -p_w * by, -s_q * by, p_q * by
    r_p, r_s, h_p, h_s = r_q * q_p + r_w * w_p, r_q * q_s + r_w * w_s, h_w * w_p, h_w * w_s
    s_p = zeros.copy()
    void = kind == VOID  # r = r_q q + r_w w and s = s_q q + s_w w
    r_w = np.where(void & (r_q == 0.0), np.minimum(r_w, -MIN_SLOPE), r_w)
    other = 1.0 / np.where(void, r_q * s_w - r_w * s_q, 1.0)
    back = np.stack([q_p, q_s, w_p, w_s])
    back[:, void] = np.stack([s_w * other, -r_w * other, -s_q * other, r_q * other])[:, void]
    r_p[void], r_s[void], h_p[void] = 0.0, 0.0, (h_w * back[2])[void]
    h_s[void] = (h_w * back[3])[void]
    touching = kind == CONTACT  # p = p_q q + p_w w and r
    other = 1.0 / np.where(touching, p_q * r_w - p_w * r_q, 1.0)
    by_p_r = np.stack([r_w * other, -p_w * other, -r_q * other, p_q * other])
    back[:, touching] = by_p_r[:, touching]
    slope = s_w / np.where(touching & (p_w != 0.0), p_w, 1.0)
    s_p[touching] = slope[touching]
    bound = kind == BOUND
    back[:, bound] = np.array([[1.0], [0.0], [0.0], [0.0]])
    for values, of_contact, of_bound in (
        (r_p, 0.0, r_q),
        (r_s, 0.0, 0.0),
        (h_p, s_p * np.where(s_w != 0.0, h_w / np.where(s_w != 0.0, s_w, 1.0), 0.0), 0.0),
        (h_s, 0.0, 0.0),
    ):
        values[touching] = (of_contact + zeros)[touching]
        values[bound] = (of_bound + zeros)[bound]
    return Reduction(kind, r_p, r_s, h_p, h_s, s_p, back)
