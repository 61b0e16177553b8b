r"""The two unknowns of each node in the band, in place of q and w.

The kernel of the deflection reaches far, the second difference of the film does not: a band stays narrow if
pressure depends on the first unknown of each node alone. Hence

* the first one is the pressure; where solids yield the excess over the yield pressure, which the depth
  follows; under a void q, which pressure does not depend on;
* the second one is the film; where solids hold it, or are stiff under a void, the unknown of the Reynolds
  equation.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ehlpetsc.base.compiled import compiled
from ehlpetsc.discretisation.contact.node_state import NodeState

STIFF_LINE_SLOPE = 1.0  # p0 per a^2/R: from this slope of pressure over film on, solids are stiff


class BandEntries(NamedTuple):
    """Derivatives of a state by the pairs of the band.

    `p_first`, `separation_first`, `separation_second`: of the pressure by the first, of the separation by
        both unknowns of each node of the window.
    `reynolds_derivatives`: of the local Reynolds rows by both unknowns of the nodes i-2 .. i+1, shape (local
        nodes, 8).
    """

    p_first: np.ndarray
    separation_first: np.ndarray
    separation_second: np.ndarray
    reynolds_derivatives: np.ndarray


def node_pairs(
    state: NodeState, compliance: float, derivatives: np.ndarray, stencil: np.ndarray
) -> tuple[BandEntries, np.ndarray]:
    """Derivatives of a state by the pairs of its nodes; q and w by both unknowns, shape (2, nodes, 2).

    `compliance`: depth over the excess of yielding solids.
    `derivatives`: of the local Reynolds rows by their unknown and the film, as in `ehl_problem.Evaluation`.
    `stencil`: nodes of each row, by their index in the window, shape (local nodes, 4).
    """
    zeros, plastic = np.zeros(len(state.film)), state.plastic
    depth: tuple = (zeros > 0.0, zeros, zeros, 0.0)
    if plastic is not None:
        depth = plastic.yielding, plastic.depth_q, plastic.reynolds_w, plastic.hardening
    *entries, unknowns = by_pairs((state.p_q, state.p_w, state.h_w), depth, compliance, derivatives, stencil)
    return BandEntries(*entries), unknowns


@compiled
def by_pairs(
    state: tuple, depth: tuple, compliance: float, derivatives: np.ndarray, stencil: np.ndarray
) -> tuple:
    """Rows as of :func:`node_pairs`, from the arguments of :func:`choose_pairs`."""
    n = len(state[0])
    deflection, unknowns = np.empty((3, n)), np.empty((2, n, 2))
    has_film, rows, out = np.empty(n, dtype=np.bool_), np.empty((3, n)), np.empty_like(derivatives)
    choose_pairs(state, depth, compliance, (deflection, unknowns, has_film, rows))
    reynolds_by_pairs(derivatives, stencil, has_film, rows, out)
    return deflection[0], deflection[1], deflection[2], out, unknowns


@compiled
def choose_pairs(state: tuple, depth: tuple, compliance: float, found: tuple) -> None:
    """Choose the pair of each node.

    `state`: p_q, p_w, h_w of `NodeState`. `depth`: yielding, depth_q, reynolds_w, hardening of it.
    `found`: filled in: the first three of `BandEntries`; q and w by the pairs; whether the film is the second
        unknown; changes of the Reynolds unknown and of the film with the first one, of the Reynolds unknown
        with the film.
    """
    (p_qs, p_ws, h_ws), (yielding, depth_q, reynolds_w, hardening) = state, depth
    deflection, unknowns, has_film, rows = found
    for i in range(len(p_qs)):
        p_q, p_w, h_w, yields, by_oil = p_qs[i], p_ws[i], h_ws[i], yielding[i], depth_q[i] > 0.0
        is_full = p_q > 0.0 and not yields
        film = h_w > 0.0 and (yields or is_full or p_w >= -STIFF_LINE_SLOPE)
        w_by_pressure = 1.0 if film or yields else 1.0 / p_w
        film_first = 0.0 if film or yields else h_w * w_by_pressure
        q_by_film = reynolds_w[i] if yields else (-p_w if is_full else 0.0)
        has_film[i], rows[0, i], rows[1, i], rows[2, i] = film, 0.0 if yields else 1.0, film_first, q_by_film
        deflection[0, i] = hardening if yields else (p_q if film else 1.0)
        deflection[1, i] = -compliance if yields else film_first
        deflection[2, i] = h_w if film else 0.0
        if film:
            unknowns[0, i, 0], unknowns[0, i, 1] = 1.0, 0.0
            unknowns[1, i, 0], unknowns[1, i, 1] = q_by_film, 1.0
            continue
        unknowns[0, i, 0], unknowns[1, i, 0] = (1.0 if by_oil else 0.0), 1.0
        if by_oil:
            unknowns[0, i, 1], unknowns[1, i, 1] = 0.0, 1.0 / reynolds_w[i]
        elif yields:
            unknowns[0, i, 1], unknowns[1, i, 1] = -compliance, 0.0
        else:
            unknowns[0, i, 1], unknowns[1, i, 1] = w_by_pressure, -p_q * w_by_pressure


@compiled
def reynolds_by_pairs(
    derivatives: np.ndarray, stencil: np.ndarray, has_film: np.ndarray, rows: np.ndarray, out: np.ndarray
) -> None:
    """Fill in the derivatives of the Reynolds rows by the pairs, see :func:`choose_pairs`."""
    for i in range(stencil.shape[0]):
        for k in range(stencil.shape[1]):
            j, by_unknown, by_film = stencil[i, k], derivatives[i, 2 * k], derivatives[i, 2 * k + 1]
            if has_film[j]:
                out[i, 2 * k], out[i, 2 * k + 1] = by_unknown * rows[0, j], by_film + by_unknown * rows[2, j]
            else:
                out[i, 2 * k], out[i, 2 * k + 1] = by_film * rows[1, j], by_unknown


@compiled
def same_deflection(now: tuple, before: tuple) -> bool:
    """Whether the deflection rows of two states have the same entries."""
    (pressure, depth, film), (old_pressure, old_depth, old_film) = now, before
    for i in range(len(pressure)):
        if pressure[i] != old_pressure[i] or depth[i] != old_depth[i] or film[i] != old_film[i]:
            return False
    return True
