r"""Mixed contact: oil and solids carry side by side, the solids rigidly from the boundary film on.

The solids have a pressure p_c of their own, :math:`p=p_f+p_c`, complementary to the film over the boundary
film :math:`h_b`,

.. math:: h-h_b\ge0,\quad p_c\ge0,\quad p_c(h-h_b)=0,

which the sign of w carries: :math:`h=h_b+\max(w,0)`, :math:`p_c=K\max(-w,0)`. All three hold exactly at any
w, and the Reynolds equation holds at every node.
"""

from __future__ import annotations

import numpy as np

from ehlpetsc.base.compiled import compiled
from ehlpetsc.discretisation.contact.model import ContactModel
from ehlpetsc.discretisation.contact.node_state import (
    AMBIENT_TOLERANCE,
    PRESSURE_AFTER_REFILL,
    NodeState,
    SurfaceLoads,
    full_of_oil,
    limit_cavitation,
)


class SeparatedContact(ContactModel):
    """Models in which oil and solids have a pressure each: outputs that they share."""

    def surface_loads(
        self, q: np.ndarray, w: np.ndarray, h: np.ndarray, reynolds_residual: np.ndarray
    ) -> SurfaceLoads:
        mask, pressure = self.contact_mask(w, reynolds_residual), self.state(q, w).pressure
        solids, everywhere = self.contact_pressure(w), np.ones(len(w), dtype=bool)
        oil = pressure - solids
        return SurfaceLoads(mask, pressure, solids, h, oil, everywhere, solids, everywhere)


class MixedContact(SeparatedContact):
    """Rigid complementarity between the pressure of the solids and the film over the boundary film.

    `boundary_film`: h_b in a^2/R.
    `stiffness`: K, p0 per a^2/R: a scale between the two meanings of w, which no answer depends on.
    """

    def __init__(self, boundary_film: float, stiffness: float):
        self.boundary_film = self.minimum_film = boundary_film
        self.stiffness = stiffness

    def state(self, q: np.ndarray, w: np.ndarray) -> NodeState:
        mask, pressure = w < 0.0, np.maximum(q, 0.0) + self._carried(w)
        p_w, h_w = np.where(mask, -self.stiffness, 0.0), np.where(mask, 0.0, 1.0)
        film = self.boundary_film + np.maximum(w, 0.0)
        return NodeState(q, pressure, film, full_of_oil(q) * 1.0, p_w, h_w)

    def _carried(self, w: np.ndarray) -> np.ndarray:
        return self.stiffness * np.maximum(-w, 0.0)

    def contact_pressure(self, w: np.ndarray) -> np.ndarray:
        """Pressure of the solids in p0, at most the yield pressure."""
        return np.minimum(self._carried(w), self.yield_pressure)

    def contact_mask(self, w: np.ndarray, reynolds_residual: np.ndarray) -> np.ndarray:
        return w < 0.0

    def w_from_film(self, h: np.ndarray) -> np.ndarray:
        """See :class:`.model.ContactModel`; zero where the film is below the boundary film."""
        return np.maximum(h - self.boundary_film, 0.0)

    def w_from_state(self, h: np.ndarray, contact_pressure: np.ndarray) -> np.ndarray:
        return np.where(contact_pressure > 0.0, -contact_pressure / self.stiffness, self.w_from_film(h))

    def advected(self, interpolated: np.ndarray, shifted: np.ndarray) -> np.ndarray:
        """See :class:`.model.ContactModel`; solids that touch are moved by whole nodes."""
        return np.where(shifted < 0.0, shifted, interpolated)

    def pressure_change(self, now: np.ndarray, step: np.ndarray) -> float:
        return pressure_change(now, step, self.stiffness, self.yield_pressure)

    def clip_step(self, now: np.ndarray, step: np.ndarray, film_after_release: float) -> None:
        limit_contact_switch(now, step, self.stiffness, film_after_release)


@compiled
def pressure_change(now: np.ndarray, step: np.ndarray, stiffness: float, limit: float) -> float:
    """Largest change of total pressure, bounded by `limit`; where it stays there, of that of the solids.

    A node that crosses between gap and contact stops there.
    """
    largest = 0.0
    for i in range(len(now)):
        new_q, new_w = now[i, 0] - step[i, 0], now[i, 1] - step[i, 1]
        solids = min(stiffness * max(-now[i, 1], 0.0), limit)
        new_solids = min(stiffness * max(-new_w, 0.0), limit) if now[i, 1] < 0.0 else 0.0
        total = min(max(now[i, 0], 0.0) + solids, limit)
        new_total = min(max(new_q, 0.0) + new_solids, limit)
        change = abs(new_total - total)
        if min(total, new_total) > limit - AMBIENT_TOLERANCE:
            change = abs(new_solids - solids)
        largest = max(largest, change)
    return largest


@compiled
def limit_contact_switch(
    now: np.ndarray, step: np.ndarray, stiffness: float, film_after_release: float
) -> None:
    """Limit steps in place where solids come to touch or separate: both stop just beyond.

    Solids that touch begin with `PRESSURE_AFTER_REFILL`; those that separate with at most
    `film_after_release`: their derivatives are those of the other side.
    """
    for i in range(len(now)):
        w, dw = now[i, 1], step[i, 1]
        step[i, 0] = limit_cavitation(now[i, 0], step[i, 0])
        if w >= 0.0 and w - dw < 0.0:
            step[i, 1] = w + PRESSURE_AFTER_REFILL / stiffness
        elif w < 0.0 and w - dw > film_after_release:
            step[i, 1] = w - film_after_release
