r"""Elimination of the film from the linear system of a contact in the plane, node by node.

The row of the deflection, :math:`\delta s-\delta h_{00}-D\,\delta p=b`, gives the change of the separation s
by those of all pressures. What is left is one unknown v a node, by which of its quantities depend on both of
its unknowns (q, w):

* `PRESSURE`: pressure and separation are independent; v: the pressure, row: Reynolds.
* `VOID`: the pressure is constant (a cavity, yielding solids); v: the unknown r of the Reynolds equation.
* `STIFF`: as `VOID`, but the pressure follows from the separation (asperities in a cavity).
* `CONTACT`: the separation is constant (solids that touch); v: r, and the pressure follows from the row of
  the deflection.
* `BOUND`: as `CONTACT`, without a Reynolds row (a film at its bound); v: the pressure.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ehlpetsc.base.compiled import compiled

PRESSURE, VOID, STIFF, CONTACT, BOUND = range(5)
STIFF_SLOPE = 1e-3  # p0 per a^2/R: from this slope of the asperities' pressure on it counts in a cavity
# minimum of -dr/dw where solids yield: it vanishes below a rigid film, and r would not depend on the film
MIN_SLOPE = 1e-8


class Reduction(NamedTuple):
    """Changes of the quantities of each node by v and the separation; arrays of shape (nodes,).

    `kind`: as in the module.
    `r_v`, `r_s`, `h_v`, `h_s`: of r and the film h by v and the separation s.
    `p_s`: of the pressure by the separation, at `STIFF`.
    `back`: of q and w by the first (p; at `VOID` r) and the second quantity (s; at `STIFF` and `CONTACT` r),
        shape (4, nodes).
    """

    kind: np.ndarray
    r_v: np.ndarray
    r_s: np.ndarray
    h_v: np.ndarray
    h_s: np.ndarray
    p_s: np.ndarray
    back: np.ndarray


def reduction_of(derivatives: np.ndarray, inactive: np.ndarray) -> Reduction:
    """Reduction of some nodes.

    `derivatives`: of :meth:`.contact.node_state.NodeState.derivatives`.
    `inactive`: mask of the nodes whose w is not in the system.
    """
    kind, changes = np.empty(len(inactive), dtype=np.uint8), np.zeros((5, len(inactive)))
    back = np.zeros((4, len(inactive)))
    reduce_nodes(derivatives, inactive, kind, changes, back)
    return Reduction._make((kind, *changes, back))


@compiled
def reduce_nodes(
    by: np.ndarray, inactive: np.ndarray, kind: np.ndarray, changes: np.ndarray, back: np.ndarray
) -> None:
    """Fill in the fields of a :class:`Reduction`; `changes`: r_v .. p_s, zeros, and `back`, zeros."""
    for i in range(len(kind)):
        (p_q, p_w), (r_q, r_w) = (by[0, 0, i], by[0, 1, i]), (by[1, 0, i], by[1, 1, i])
        h_w, s_q, s_w = by[2, 1, i], by[3, 0, i], by[3, 1, i]
        kind[i] = kind_of_node(p_q, p_w, s_q, s_w, inactive[i])
        if kind[i] == BOUND:
            changes[0, i], back[0, i] = r_q, 1.0
            continue
        if kind[i] == PRESSURE:
            of = inverse(p_q, p_w, s_q, s_w)
            changes[0, i], changes[1, i] = r_q * of[0] + r_w * of[2], r_q * of[1] + r_w * of[3]
        elif kind[i] == CONTACT:
            changes[0, i] = 1.0
            of = inverse(p_q, p_w, r_q, r_w)
            back[0, i], back[1, i], back[2, i], back[3, i] = of
            continue
        else:
            if r_q == 0.0:
                r_w = min(r_w, -MIN_SLOPE)
            of = inverse(r_q, r_w, s_q, s_w)
        changes[2, i], changes[3, i] = h_w * of[2], h_w * of[3]
        if kind[i] != PRESSURE:
            changes[0, i] = 1.0
        if kind[i] == STIFF:
            changes[4, i], of = p_w / s_w, inverse(p_q, p_w, r_q, r_w)
        back[0, i], back[1, i], back[2, i], back[3, i] = of


@compiled
def kind_of_node(p_q: float, p_w: float, s_q: float, s_w: float, is_inactive: bool) -> int:
    """Kind of a node by the derivatives of pressure and separation by q and w."""
    if is_inactive:
        return BOUND
    if abs(p_q * s_w - p_w * s_q) >= 1e-12:
        return PRESSURE
    if s_w != 0.0:
        return STIFF if abs(p_w) > STIFF_SLOPE else VOID
    return CONTACT if p_w != 0.0 else VOID


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


@compiled
def inverse(a: float, b: float, c: float, d: float) -> tuple[float, float, float, float]:
    """Derivatives of q and w by two quantities from theirs, (a, b) and (c, d)."""
    by = 1.0 / (a * d - b * c)
    return d * by, -b * by, -c * by, a * by
