"""Direct contact (Holmes et al. 2005): w is the film h, bounded below.

At the bound the pressure of the oil is that of the solids too, and the Reynolds equation is dropped:
:math:`h\\ge h_b`, :math:`F\\ge0`, :math:`(h-h_b)F=0`.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ehlpetsc.base.compiled import compiled
from ehlpetsc.discretisation.contact.model import ContactModel
from ehlpetsc.discretisation.contact.node_state import (
    AMBIENT_TOLERANCE,
    PRESSURE_AFTER_REFILL,
    NodeState,
    SurfaceLoads,
    limit_cavitation,
)


class DirectContact(ContactModel):
    """Film bounded below by `bound`, with oil between the solids.

    `bound`, `tolerance`: in a^2/R; films this close to the bound count as on it.
    """

    starts_unconstrained = True
    lowest_pressure = 0.0

    def __init__(self, bound: float, tolerance: float = 0.0):
        self.lower_bound = self.minimum_film = bound
        self.bound_tolerance, self._closed = tolerance, bound + tolerance

    def pressure(self, q: np.ndarray, w: np.ndarray) -> np.ndarray:
        return np.maximum(q, self.lowest_pressure)

    def state(self, q: np.ndarray, w: np.ndarray) -> NodeState:
        p_q = np.where(q > self.lowest_pressure - AMBIENT_TOLERANCE, 1.0, 0.0)
        zeros, ones = np.zeros(len(w)), np.ones(len(w))
        return NodeState(q, self.pressure(q, w), w, p_q, zeros, ones)

    def contact_pressure(self, w: np.ndarray) -> np.ndarray:
        """Not separated from the oil's: zero."""
        return np.zeros_like(w)

    def contact_mask(self, w: np.ndarray, reynolds_residual: np.ndarray) -> np.ndarray:
        """Nodes without a Reynolds equation: at the bound, or within its tolerance with F > 0."""
        at_bound = w <= self.lower_bound
        return at_bound | ((w <= self._closed) & (reynolds_residual > 0.0))

    def w_from_film(self, h: np.ndarray) -> np.ndarray:
        return np.maximum(h, self.lower_bound)

    def w_from_state(self, h: np.ndarray, contact_pressure: np.ndarray) -> np.ndarray:
        """The film, whatever pressure the solids have."""
        return self.w_from_film(h)

    def dry_start(self, pressure: np.ndarray, gap: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return pressure, gap

    def advected(self, interpolated: np.ndarray, shifted: np.ndarray) -> np.ndarray:
        return interpolated

    def linearised(self, state: NodeState, owned: slice, ranks_sum: Callable) -> NodeState:
        """A node in contact and cavitated at once would leave its deflection row without an entry for q."""
        return state._replace(p_q=np.where(state.film <= self._closed, 1.0, state.p_q))

    def pressure_change(self, now: np.ndarray, step: np.ndarray) -> float:
        return pressure_change(now, step, self.lower_bound, self.lowest_pressure)

    def clip_step(self, now: np.ndarray, step: np.ndarray, film_after_release: float) -> None:
        released = self._closed + max(film_after_release, self.bound_tolerance)
        clip_cavities(now, step, self._closed, released)

    def check(
        self, w: np.ndarray, reynolds_residual: np.ndarray, tolerance: float
    ) -> tuple[str | None, np.ndarray]:
        bound, residual = self.lower_bound, reynolds_residual
        if w.min() < bound - self.bound_tolerance:
            return f"a film is {w.min() - bound:.2g} a^2/R below its bound", residual
        mask = self.contact_mask(w, residual)
        worst = -residual[mask].min(initial=0.0)
        if not worst <= tolerance:
            return f"where solids touch a residual is -{worst:.2e}, allowed: {tolerance:.1e}", residual
        return None, np.where(mask, 0.0, residual)

    def surface_loads(
        self, q: np.ndarray, w: np.ndarray, h: np.ndarray, reynolds_residual: np.ndarray
    ) -> SurfaceLoads:
        """See :class:`.model.ContactModel`.

        The shear of a film within the tolerance of the bound would be rounding: solids rub there.
        """
        mask, pressure = self.contact_mask(w, reynolds_residual), self.pressure(q, w)
        rubbing = h <= self._closed
        return SurfaceLoads(
            mask,
            pressure,
            np.zeros_like(pressure),
            np.where(mask, self.lower_bound, h),
            pressure,
            ~mask,
            np.where(rubbing, pressure, 0.0),
            ~rubbing,
        )


class DryContact(DirectContact):
    """Direct contact without oil: q is the pressure itself, complementary to the gap."""

    starts_unconstrained = False
    lowest_pressure = -np.inf

    def clip_step(self, now: np.ndarray, step: np.ndarray, film_after_release: float) -> None:
        close_overlaps(now, step, self.lower_bound)


@compiled
def pressure_change(now: np.ndarray, step: np.ndarray, bound: float, lowest: float) -> float:
    """Largest change of pressure max(q, lowest), but at nodes that stay in contact: there is no viscosity."""
    largest = 0.0
    for i in range(len(now)):
        q, h, dq, dh = now[i, 0], now[i, 1], step[i, 0], step[i, 1]
        if h > bound or h - dh > bound:
            largest = max(largest, abs(max(q - dq, lowest) - max(q, lowest)))
    return largest


@compiled
def clip_cavities(now: np.ndarray, step: np.ndarray, closed: float, released: float) -> None:
    """Limit steps in place where a cavity fills or empties; a void does not hold touching solids apart.

    Solids that would be pulled although they already touch without pressure get the film `released`: without
    oil between them F is zero but for rounding, whose sign must not keep them in contact.

    `closed`: film up to which solids touch.
    """
    for i in range(len(now)):
        q, dq = now[i, 0], step[i, 0]
        step[i, 0] = limit_cavitation(q, dq)
        if q - dq < 0.0 and now[i, 1] - step[i, 1] <= closed:
            step[i, 0] = q - PRESSURE_AFTER_REFILL
            if step[i, 1] == 0.0 and q < 2.0 * PRESSURE_AFTER_REFILL:
                step[i, 1] = now[i, 1] - released


@compiled
def close_overlaps(now: np.ndarray, step: np.ndarray, bound: float) -> None:
    """Give nodes of a dry contact a pressure, in place, where the step would make solids overlap.

    SNES puts h = 0 there and then goes by the sign of F = p, which would be rounding.
    """
    for i in range(len(now)):
        if now[i, 1] - step[i, 1] < bound:
            step[i, 0] = min(step[i, 0], now[i, 0] - PRESSURE_AFTER_REFILL)
