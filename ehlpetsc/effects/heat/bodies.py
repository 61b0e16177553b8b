"""Temperatures of both bodies at the nodes, by sums of exponentials kept on cells of each body."""

from typing import NamedTuple

import numpy as np

from ehlpetsc.effects.heat.body_heat import BodyHeat
from ehlpetsc.effects.heat.half_space_conduction import (
    StepWeights,
    add_flux,
    advance_terms,
    exponentials,
    moving_terms,
)

PADDING = 8.0  # diffusion lengths chi/u ahead of the mesh and behind it
LONGEST = 40.0  # diffusion times chi/u^2 after which a moving body has forgotten, besides its transit
RENUMBERED = 2.0  # cells between the distance travelled and the step by the speed
MAX_DIFFUSION_AREA = 1e-3  # m^2: over the diffusivity the longest history of a body [s]


class BodyStep(NamedTuple):
    """One body at the end of a step, but for the flux there.

    Attributes
    ----------
    body : BodyHeat
        Its terms with the flux of the begin of the step.
    history : ndarray, shape (nx,)
        Temperature above bulk at the nodes without the flux at the end of the step [K].
    response : float
        Temperature per flux at the end of the step [m^2 K/W].
    end : ndarray, shape (terms,)
        Contribution of that flux to the terms [s].
    fraction : float
        Fraction of a cell by which the nodes are ahead of the cells.
    """

    body: BodyHeat
    history: np.ndarray
    response: float
    end: np.ndarray
    fraction: float


class Body:
    """Conduction into one body.

    Parameters
    ----------
    solid : effects.heat.body_heat.Solid
    speed : float
        Of its surface at the start [m/s].
    scales : physics.scales.Scales
    dt : float
        Nominal time step [s].
    """

    def __init__(self, solid, speed, scales, dt):
        self.solid, self.n, self.dx = solid, scales.nx, scales.dx
        chi, speed = solid.diffusivity, abs(speed)
        length = self.n * self.dx
        slow = MAX_DIFFUSION_AREA / chi
        longest = min(length / speed + LONGEST * chi / speed**2, slow) if speed > 0.0 else slow
        self.rates, self.weights = map(np.array, exponentials(dt, max(longest, 2.0 * dt)))
        self.dt = dt
        self._weights_of = None, None, None  # rates and step, and the weights of the step
        reach = PADDING * chi / speed / self.dx if speed > 0.0 else self.n
        self.padding = int(min(np.ceil(reach), self.n)) + 2

    def steady(self, flux, speed):
        """Temperatures above bulk [K] at the nodes under a steady flux, and the terms of the cells."""
        q = np.pad(flux, (self.padding, self.padding + 1))
        terms = np.empty((len(q), len(self.rates)))
        moving_terms(q, self.rates, self.solid.diffusivity, speed, self.dx, terms)
        rise = terms @ self.weights / self.solid.effusivity + self._tail * q
        return rise[self.padding : self.padding + self.n], terms

    @property
    def _tail(self):
        step = StepWeights.of(self.rates, self.weights, self.dt, self.solid.effusivity)
        return step.response - self.weights @ step.end / self.solid.effusivity

    def record(self, flux, terms):
        """Record of a steady flux."""
        q = np.pad(flux, (self.padding, self.padding + 1))
        return BodyHeat(-self.padding, terms, q, self.rates, self.weights)

    def cold(self):
        """Record of a body without heat."""
        cells = self.n + 1 + 2 * self.padding
        zeros = np.zeros((cells, len(self.rates)))
        return BodyHeat(-self.padding, zeros, np.zeros(cells), self.rates, self.weights)

    def advance(self, body, travelled, dt, speed):
        """The body at the end of a step.

        Parameters
        ----------
        body : BodyHeat
            At its begin.
        travelled : float
            Distance travelled at the end [m].
        dt : float
            [s]
        speed : float
            [m/s], signed.

        Returns
        -------
        BodyStep
        """
        cells = len(body.flux)
        position = -travelled / self.dx
        base = int(np.floor(position))
        padding = (cells - self.n - 1) // 2
        shift = base - padding - body.first
        moved = -speed * dt / self.dx
        if abs(shift - moved) > RENUMBERED:  # the distance is counted from another place now
            shift = int(np.floor(moved))
        step = self._step_weights(body, dt)
        ratio = self.solid.diffusivity * dt / self.dx**2
        terms, flux, rise = advance_terms(
            body.terms, body.flux, shift, step.decay, step.begin, ratio, body.weights / self.solid.effusivity
        )
        body, fraction = body._replace(first=base - padding, terms=terms, flux=flux), position - base
        here, next_one = rise[padding : padding + self.n], rise[padding + 1 : padding + self.n + 1]
        history = (1.0 - fraction) * here + fraction * next_one
        return BodyStep(body, history, step.response, step.end, fraction)

    def _step_weights(self, body, dt):
        rates, step, _ = self._weights_of
        if rates is not body.rates or step != dt:
            weights = StepWeights.of(body.rates, body.weights, dt, self.solid.effusivity)
            self._weights_of = body.rates, dt, weights
        return self._weights_of[2]

    def accept(self, step, flux):
        """Record with the flux at the end of the step, shape (nx,), shared out to the cells by overlap."""
        body = step.body
        padding = (len(body.flux) - self.n - 1) // 2
        terms, shared = add_flux(body.terms, np.ascontiguousarray(flux), padding, step.fraction, step.end)
        return body._replace(terms=terms, flux=shared)
