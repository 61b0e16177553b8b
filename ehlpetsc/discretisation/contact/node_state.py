"""Pressures, film and separation of the nodes as functions of the two unknowns, with derivatives."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ehlpetsc.base.compiled import compiled

AMBIENT_TOLERANCE = 1e-12  # pressure in p0: the ambient one of the inlet is zero give or take this
ROUNDING = 1e-16  # p0: a smaller step of an ambient pressure has no meaning
PRESSURE_AFTER_REFILL = 1e-9  # p0: pressure of a cavity, or of a gap, in the iteration that closes it
MIN_OIL_FRACTION = 0.2  # of the oil in a cavity that one iteration must leave


def full_of_oil(q: np.ndarray) -> np.ndarray:
    """Mask of the nodes with pressure and no void; which side of zero rounding is on must not matter."""
    return q > -AMBIENT_TOLERANCE


class FaceGap(NamedTuple):
    """Gap at a face between solids that are near, last constants of :func:`.finite_volumes.flux_through`.

    `layer`: rms height of a compliant layer [m], 0 without one.
    `leaks`: whether a face next to a closed node has the mean film of both nodes.
    """

    layer: float = 0.0
    leaks: bool = False


OPEN_GAP = FaceGap()


class PlasticState(NamedTuple):
    """Plastic deformation of yielding nodes; arrays of shape (nodes,).

    `depth`: delta, by which both surfaces together yield in the step, in a^2/R.
    `yielding`: mask of the nodes that yield.
    `depth_q`, `depth_w`, `reynolds_q`, `reynolds_w`: derivatives of delta, and of
        `NodeState.reynolds_unknown`, with respect to q and w.
    `hardening`: slope of the pressure over the yield pressure in the linearised system, 0 or a small one.
    """

    depth: np.ndarray
    yielding: np.ndarray
    depth_q: np.ndarray
    depth_w: np.ndarray
    reynolds_q: np.ndarray
    reynolds_w: np.ndarray
    hardening: float = 0.0


class NodeState(NamedTuple):
    """State of the nodes at given unknowns; arrays of shape (nodes,).

    `reynolds_unknown`: unknown of the Reynolds equation: oil pressure where positive, minus the void fraction
        where negative.
    `pressure`, `film`: total pressure p; film h of the Reynolds equation.
    `p_q`, `p_w`, `h_w`: derivatives of p with respect to q and w, of h with respect to w.
    `plastic`: None where solids are elastic.
    """

    reynolds_unknown: np.ndarray
    pressure: np.ndarray
    film: np.ndarray
    p_q: np.ndarray
    p_w: np.ndarray
    h_w: np.ndarray
    plastic: PlasticState | None = None

    @property
    def separation(self) -> np.ndarray:
        """Film less the plastic deformation of the step: shape and elastic deflection."""
        return self.film if self.plastic is None else self.film - self.plastic.depth

    @property
    def separation_q(self) -> np.ndarray:
        """Derivative of the separation with respect to q."""
        return np.zeros_like(self.film) if self.plastic is None else -self.plastic.depth_q

    @property
    def separation_w(self) -> np.ndarray:
        """Derivative of the separation with respect to w."""
        return self.h_w if self.plastic is None else self.h_w - self.plastic.depth_w

    def without_derivatives(self) -> NodeState:
        """The state with empty arrays in place of derivatives."""
        none, plastic = np.empty(0), self.plastic
        if plastic is not None:
            plastic = PlasticState(plastic.depth, plastic.yielding, none, none, none, none, plastic.hardening)
        return self._replace(p_q=none, p_w=none, h_w=none, plastic=plastic)

    def derivatives(self) -> np.ndarray:
        """Derivatives with respect to q and w, shape (4, 2, nodes).

        Of pressure, Reynolds unknown, film and separation.
        """
        by = np.zeros((4, 2, len(self.film)))
        by[0, 0], by[0, 1], by[1, 0], by[2, 1], by[3, 1] = self.p_q, self.p_w, 1.0, self.h_w, self.h_w
        if self.plastic is not None:
            by[1, 0], by[1, 1] = self.plastic.reynolds_q, self.plastic.reynolds_w
            by[3, 0], by[3, 1] = self.separation_q, self.separation_w
        return by


@compiled
def directional_derivative(by: np.ndarray, nodes: np.ndarray, first: int, change: np.ndarray) -> None:
    """Fill in changes of one property with changes (nodes, 2) of q and w.

    Parameters
    ----------
    by : shape (2, all)
        One of :meth:`NodeState.derivatives`.
    nodes : shape (nodes, 2)
    first
        Index in `by` of the first node.
    change : shape (nodes,)
    """
    for i in range(len(change)):
        change[i] = by[0, first + i] * nodes[i, 0] + by[1, first + i] * nodes[i, 1]


@compiled
def open_cavity(q: float, dq: float) -> float:
    """Newton step of q, to be subtracted: ambient oil that would have a lower pressure is a cavity.

    Below zero no pressure follows q, so that smaller steps would change nothing.
    """
    if -AMBIENT_TOLERANCE < q < 0.0 and dq > ROUNDING:
        return max(dq, q + 2.0 * AMBIENT_TOLERANCE)
    return dq


@compiled
def limit_cavitation(q: float, dq: float) -> float:
    """Newton step of q, to be subtracted: a cavity that fills or empties stops at the change of phase.

    A cavity that fills gets the pressure `PRESSURE_AFTER_REFILL`. A void leaves `MIN_OIL_FRACTION` of the
    oil: at q = -1 on a closed gap every derivative is zero.
    """
    if q < 0.0 and q - dq > PRESSURE_AFTER_REFILL:
        return q - PRESSURE_AFTER_REFILL
    if q - dq < 0.0:
        return min(dq, q + 1.0 - MIN_OIL_FRACTION * (1.0 + min(q, 0.0)))
    return dq


class SurfaceLoads(NamedTuple):
    """Surface loads of an accepted solution; arrays of shape (nodes,), pressures in p0, film in a^2/R.

    `contact_mask`: nodes in contact.
    `pressure`, `contact_pressure`: total pressure, and the part of it that the solids carry (0 where the
        model does not separate them).
    `film`: film thickness.
    `oil_pressure`, `oil_mask`: pressure of the oil, and the nodes where it is known.
    `friction_pressure`: pressure under which the solids rub against each other, 0 out of contact.
    `sheared_oil`: nodes whose oil film is sheared.
    """

    contact_mask: np.ndarray
    pressure: np.ndarray
    contact_pressure: np.ndarray
    film: np.ndarray
    oil_pressure: np.ndarray
    oil_mask: np.ndarray
    friction_pressure: np.ndarray
    sheared_oil: np.ndarray
