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
from ehlpetsc.discretisation.unknowns import q_columns, w_columns

STIFF_SLOPE = 1.0  # p0 per a^2/R: from this slope of pressure over film on, solids are stiff


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


class NodePairs:
    """Pairs of the nodes at a state.

    `compliance`: depth over the excess of yielding solids.
    """

    def __init__(self, state: NodeState, compliance: float):
        none = np.zeros(len(state.film), dtype=bool)
        self.state, self.compliance, plastic = state, compliance, state.plastic
        self.yielding = none if plastic is None else plastic.yielding
        self.by_oil = none if plastic is None else plastic.depth_q > 0.0  # q is the excess
        self.is_full = ~self.yielding & (state.p_q > 0.0)
        stiff = ~self.yielding & ~self.is_full & (state.p_w < -STIFF_SLOPE)
        self.has_film = (state.h_w > 0.0) & ~stiff  # as the second unknown

    def entries(self, derivatives: np.ndarray, stencil: np.ndarray) -> BandEntries:
        """Derivatives of the state by the pairs.

        `derivatives`: of the local Reynolds rows by their unknown and the film, as in
            `ehl_problem.Evaluation`.
        `stencil`: nodes of each row, by their index in the window, shape (local nodes, 4).
        """
        state, elastic_pressure = self.state, np.where(self.has_film, self.state.p_q, 1.0)
        hardening = 0.0 if state.plastic is None else state.plastic.hardening
        film_first = np.where(self.has_film | self.yielding, 0.0, state.h_w * self._w_by_pressure())
        return BandEntries(
            np.where(self.yielding, hardening, elastic_pressure),
            np.where(self.yielding, -self.compliance, film_first),
            np.where(self.has_film, state.h_w, 0.0),
            self._reynolds(derivatives, stencil, film_first),
        )

    def _w_by_pressure(self) -> np.ndarray:
        """Change of w with the pressure at elastic nodes without the film as an unknown."""
        return 1.0 / np.where(self.has_film | self.yielding, 1.0, self.state.p_w)

    def _q_by_film(self) -> np.ndarray:
        """Change of q with the film at the same pressure, or excess."""
        full = np.where(self.is_full, -self.state.p_w, 0.0)
        plastic = self.state.plastic
        return full if plastic is None else np.where(self.yielding, plastic.reynolds_w, full)

    def _reynolds(self, derivatives: np.ndarray, stencil: np.ndarray, film_first: np.ndarray) -> np.ndarray:
        if not (self.state.p_w.any() or self.yielding.any()):
            return derivatives
        by_unknown, by_film = q_columns(derivatives), w_columns(derivatives)
        has_film, first = self.has_film[stencil], np.where(self.yielding, 0.0, 1.0)[stencil]
        found = np.empty_like(derivatives)
        q_columns(found)[:] = np.where(has_film, by_unknown * first, by_film * film_first[stencil])
        with_film = by_film + by_unknown * self._q_by_film()[stencil]
        w_columns(found)[:] = np.where(has_film, with_film, by_unknown)
        return found

    def unknowns(self, owned: slice) -> np.ndarray:
        """q and w by both unknowns of the pairs of local nodes, shape (2, nodes, 2)."""
        state, film, by_oil = self.state, self.has_film, self.by_oil
        by_pair = np.empty((2, len(film), 2))
        (q_first, w_first), (q_second, w_second) = np.moveaxis(by_pair, 2, 1)
        inverse = self._w_by_pressure()
        q_first[:] = np.where(film | by_oil, 1.0, 0.0)
        w_first[:] = np.where(film | by_oil, 0.0, np.where(self.yielding, -self.compliance, inverse))
        q_second[:] = np.where(film, self._q_by_film(), 1.0)
        w_second[:] = np.where(film, 1.0, np.where(self.yielding, 0.0, -state.p_q * inverse))
        held = by_oil & ~film
        w_second[held] = 1.0 / state.plastic.reynolds_w[held] if held.any() else 0.0
        return by_pair[:, owned]


@compiled
def same_deflection(
    pressure: np.ndarray,
    depth: np.ndarray,
    film: np.ndarray,
    old_pressure: np.ndarray,
    old_depth: np.ndarray,
    old_film: np.ndarray,
) -> bool:
    """Whether the deflection rows of two states have the same entries."""
    for i in range(len(pressure)):
        if pressure[i] != old_pressure[i] or depth[i] != old_depth[i] or film[i] != old_film[i]:
            return False
    return True
