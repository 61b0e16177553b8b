r"""Mixed contact through a compliant layer: roughness finer than the mesh carries before the film closes.

.. math:: p=\max(q,0)+p_c(h),

the law :math:`p_c(h)` of :mod:`ehlpetsc.physics.contact.asperities`. The unknowns are (q, h): nothing is
bounded or semismooth but cavitation, and the Reynolds equation holds at every node with the film h, its
pressure flow reduced by the layer (:func:`ehlpetsc.physics.contact.asperities.flow_factor`).

A Newton step may at most double p_c at a node, from `FREE_RISE` p0 on: the linearised law does not contain
the rise of an exponential. Where asperities carry, the solids around them determine their pressure more than
the film: near a solution a step leads them to the film of the linearised pressure, not to its own. With its
own, a dry layer of 0.1 nm converges or not with the last digit of the guess.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ehlpetsc.base.case import Contact
from ehlpetsc.base.compiled import compiled
from ehlpetsc.discretisation.contact.mixed import SeparatedContact
from ehlpetsc.discretisation.contact.node_state import (
    AMBIENT_TOLERANCE,
    NodeState,
    SurfaceLoads,
    full_of_oil,
    limit_cavitation,
    open_cavity,
)
from ehlpetsc.physics.contact.asperities import (
    CONTACT_PRESSURE,
    LayerLaw,
    asperity_pressure,
    asperity_pressures,
    asperity_separation,
    asperity_separations,
    layer_law,
    real_area_fraction,
)
from ehlpetsc.physics.scales import Scales

FREE_RISE = 0.1  # p0: asperity pressure that a Newton step may reach from anywhere
CARRIED = 0.01  # p0: from this asperity pressure on a step leads to the linearised one
LEAST = 0.5  # of the asperity pressure: asperities that lose more take the film of the step
ADVECTED = 1e-2  # p0: nodes whose asperities carry more are moved by whole nodes
EDGE_PRESSURE = 1e-3  # p0: asperity pressure at the edge of a dry first guess, and from which on they touch


@dataclass(frozen=True)
class Layer:
    """Constants of the law in p0 and a^2/R.

    `law`: see :class:`ehlpetsc.physics.contact.asperities.LayerLaw`.
    `slope_modulus`, `hardness`: E* h'_rms; infinite for elastic asperities.
    `contact_pressure`: from which on asperities count as in contact.
    """

    law: LayerLaw
    slope_modulus: float
    hardness: float
    contact_pressure: float

    @classmethod
    def of(cls, contact: Contact, scales: Scales) -> Layer:
        """Layer of the table [contact], its rms height `asperity_height` a number."""
        modulus = 0.5 * scales.E / scales.p0
        return cls(
            layer_law(contact, 0.5 * scales.E, scales.p0, scales.h),
            contact.asperity_slope * modulus,
            (contact.asperity_hardness or np.inf) / scales.p0,
            CONTACT_PRESSURE / scales.p0,
        )


class CompliantContact(SeparatedContact):
    """Oil and the asperities of a layer carry side by side.

    `smallest` is the film at which the asperities carry the yield pressure.
    """

    smallest = -np.inf

    def __init__(self, layer: Layer):
        self.layer = layer
        self.law = tuple(layer.law)
        self.minimum_film = asperity_separation(1.0, *self.law)
        self.touching_film = asperity_separation(EDGE_PRESSURE, *self.law)
        self._known: dict[int, tuple] = {}

    def _solids(self, w: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Pressure of the asperities and its slope, kept: an iteration asks for that of a film six times."""
        before, found = self._known.get(w.size, (None, None))
        if before is None or not np.array_equal(w, before):
            found = self._solids_around(w)
            self._known[w.size] = w.copy(), found
        return found

    def _solids_around(self, w: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Values as of :meth:`_solids`; known local nodes are kept, and those of other ranks computed."""
        for local, known in self._known.values():
            beside = w.size - local.size
            for first in {0, beside // 2, beside} if 0 < beside < local.size else ():
                last = first + local.size
                if np.array_equal(w[first:last], local):
                    ends = asperity_pressures(w[:first], self.law), asperity_pressures(w[last:], self.law)
                    parts = zip(ends[0], known, ends[1], strict=True)
                    return tuple(np.concatenate(part) for part in parts)
        return asperity_pressures(w, self.law)

    def state(self, q: np.ndarray, w: np.ndarray) -> NodeState:
        solids, slope = self._solids(w)
        pressure, ones = np.maximum(q, 0.0) + solids, np.ones_like(w)
        return NodeState(q, pressure, w, full_of_oil(q) * 1.0, slope, ones)

    def film(self, q: np.ndarray, w: np.ndarray) -> np.ndarray:
        """See :class:`.model.ContactModel`; without the pressure of the asperities."""
        return np.maximum(w, self.smallest)

    def contact_pressure(self, w: np.ndarray) -> np.ndarray:
        return self._solids(w)[0]

    def contact_mask(self, w: np.ndarray, reynolds_residual: np.ndarray) -> np.ndarray:
        """Nodes whose asperities carry more than `CONTACT_PRESSURE`."""
        return self.contact_pressure(w) > self.layer.contact_pressure

    def w_from_film(self, h: np.ndarray) -> np.ndarray:
        """The film itself."""
        return np.maximum(h, self.layer.law.full_contact + 1e-3 * self.layer.law.decay)

    def w_from_state(self, h: np.ndarray, contact_pressure: np.ndarray) -> np.ndarray:
        """The film; without one that at which asperities carry the pressure."""
        closed = (h <= 0.0) & (contact_pressure > 0.0)
        return np.where(closed, self._separation(contact_pressure), self.w_from_film(h))

    def _separation(self, pressure: np.ndarray) -> np.ndarray:
        return asperity_separations(np.maximum(pressure, EDGE_PRESSURE), self.law)

    def dry_start(self, pressure: np.ndarray, gap: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        film = np.maximum(gap, self.touching_film)
        return np.zeros_like(pressure), np.where(pressure > 0.0, self._separation(pressure), film)

    def start_film(self, film: float) -> float:
        """See :class:`.model.ContactModel`; at least the film at which the asperities carry p0."""
        return max(film, self.minimum_film)

    def oil_start(self, pressure: np.ndarray, h: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """See :class:`.model.ContactModel`; asperities carry as much of the pressure as they can."""
        h = np.maximum(h, self._separation(pressure))
        return pressure - self.contact_pressure(h), h

    def advected(self, interpolated: np.ndarray, shifted: np.ndarray) -> np.ndarray:
        """See :class:`.model.ContactModel`; asperities that carry are moved by whole nodes."""
        carries = self.contact_pressure(shifted) > ADVECTED
        return np.where(carries, shifted, np.maximum(interpolated, asperity_separation(ADVECTED, *self.law)))

    def pressure_change(self, now: np.ndarray, step: np.ndarray) -> float:
        """See :class:`.model.ContactModel`; linear in h."""
        return pressure_change(now, step, self.law, self.yield_pressure, self.smallest)

    def clip_step(self, now: np.ndarray, step: np.ndarray, film_after_release: float) -> None:
        limit_rise(now, step, self.law)

    def follow_pressure(self, now: np.ndarray, step: np.ndarray) -> None:
        """See :class:`.model.ContactModel`."""
        lead_to_pressure(now, step, self.law)

    def real_area_fraction(self, loads: SurfaceLoads) -> np.ndarray:
        return real_area_fraction(loads.contact_pressure, self.layer.slope_modulus, self.layer.hardness)


@compiled
def pressure_change(now: np.ndarray, step: np.ndarray, law: tuple, limit: float, smallest: float) -> float:
    """Largest change of total pressure; where it stays at `limit`, of the pressure of the solids."""
    largest = 0.0
    for i in range(len(now)):
        q, w, new_q = now[i, 0], now[i, 1], now[i, 0] - step[i, 0]
        solids, slope = asperity_pressure(max(w, smallest), *law)
        rise = 0.0 if w < smallest else max(-slope * step[i, 1], -solids)
        total = min(max(q, 0.0) + solids, limit)
        new_total = min(max(new_q, 0.0) + solids + rise, limit)
        change = abs(new_total - total)
        if min(total, new_total) > limit - AMBIENT_TOLERANCE:
            change = abs(min(solids + rise, limit) - solids)
        largest = max(largest, change)
    return largest


@compiled
def lead_to_pressure(now: np.ndarray, step: np.ndarray, law: tuple) -> None:
    """Change steps in place, where asperities carry, to the film of the linearised pressure."""
    carrying = asperity_separation(CARRIED, *law)
    for i in range(len(now)):
        h = now[i, 1]
        if h < carrying:
            solids, slope = asperity_pressure(h, *law)
            linear = solids - slope * step[i, 1]
            if linear > LEAST * solids:
                step[i, 1] = h - asperity_separation(linear, *law)


@compiled
def limit_rise(now: np.ndarray, step: np.ndarray, law: tuple) -> None:
    """Limit steps in place where a cavity fills or empties, or where p_c would more than double."""
    film = asperity_separation(FREE_RISE, *law)
    for i in range(len(now)):
        h = now[i, 1]
        step[i, 0] = limit_cavitation(now[i, 0], open_cavity(now[i, 0], step[i, 0]))
        if h - step[i, 1] < film and step[i, 1] > 0.0:  # asperities carry more
            highest = max(2.0 * asperity_pressure(h, *law)[0], FREE_RISE)
            step[i, 1] = min(step[i, 1], h - asperity_separation(highest, *law))
