r"""Conduction of heat into a moving half-space, with diffusion along its surface, by sums of exponentials.

The surface temperature under a flux q is, in the frame of the body,

.. math:: T(s,t)=\frac{1}{\sqrt{k\rho c}}\int_0^t\frac{e^{\chi t'\partial_{ss}}q(s,t-t')}{\sqrt{\pi t'}}dt',
   \qquad\frac1{\sqrt{\pi t}}=\frac1\pi\int_{-\infty}^{\infty}e^{y/2}e^{-e^yt}\,dy
   \approx\sum_mw_me^{-\lambda_mt},

:math:`\chi=k/(\rho c)` (Carslaw & Jaeger 1959, sections 2.9 and 10.3). Each term obeys
:math:`\dot A_m=-\lambda_mA_m+\chi\partial_{ss}A_m+q`, and :math:`T=\sum w_mA_m/\sqrt{k\rho c}`, so that no
history is stored. In the plane :math:`\partial_{yy}` is beside :math:`\partial_{ss}`: each row of cells along
x is that of a line contact, conduction between rows and beyond the sides of a mesh in :mod:`.record`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ehlpetsc.base.compiled import compiled
from ehlpetsc.base.counts import whole_up
from ehlpetsc.effects.heat.record import Across, BodyHeat
from ehlpetsc.physics.contact.grid import Grid
from ehlpetsc.physics.flash_temperature import Solid

STEP = 1.2  # of the trapezoidal rule in y: its relative error is 2 |Gamma(1/2 + 2 pi i/STEP)|/sqrt(pi) = 8e-4
FASTEST_RESPONSE = 30.0  # rate of the fastest term times the time step
SLOWEST_RESPONSE = 0.2  # rate of the slowest term but the lumped one times the longest time
PADDING = 8.0  # diffusion lengths chi/u ahead of the mesh and behind it
LONGEST = 40.0  # diffusion times chi/u^2 after which a moving body has forgotten, besides its transit
MAX_PART = 0.25  # half-widths that a body moves in one part of a step: it misses no flux of the contact
RENUMBERED = 2.0  # cells between the distance travelled and the step by the speed
DIFFUSION_LENGTHS = 3.0  # of the longest history, across, beyond the mesh
MAX_DIFFUSION_AREA = 1e-3  # m^2: over the diffusivity the longest history of a body [s]


@lru_cache
def exponentials(shortest: float, longest: float) -> tuple[tuple[float, ...], tuple[float, ...]]:
    r"""Rates [1/s] and weights [1/s^(1/2)] of a sum of exponentials for :math:`1/\sqrt{\pi t}`.

    Trapezoidal rule in y with the step `STEP`. All terms slower than the slowest one are one more term of
    their total weight and their mean rate.

    `shortest`, `longest`: range of t [s].
    """
    high, low = np.log(FASTEST_RESPONSE / shortest), np.log(SLOWEST_RESPONSE / longest)
    count = max(int(np.ceil((high - low) / STEP)), 1) + 1
    y = high - STEP * np.arange(count)
    rates, weights = np.exp(y), STEP / np.pi * np.exp(0.5 * y)
    # geometric series of the weights and of the first moments of all slower terms
    weight_ratio, moment_ratio = np.exp(-0.5 * STEP), np.exp(-1.5 * STEP)
    weight = weights[-1] * weight_ratio / (1.0 - weight_ratio)
    rate = rates[-1] * moment_ratio / (1.0 - moment_ratio) * (1.0 - weight_ratio) / weight_ratio
    return tuple(np.append(rates, rate)), tuple(np.append(weights, weight))


@dataclass(frozen=True)
class StepWeights:
    r"""Coefficients of one time step, flux linear in time over it.

    `decay`: :math:`e^{-\lambda\Delta t}`, shape (terms,).
    `begin`, `end`: contributions of the flux at the begin and at the end of the step to A [s], shape
        (terms,).
    `response`: temperature at the end of the step per flux there [m^2 K/W], without lateral diffusion.
    """

    decay: np.ndarray
    begin: np.ndarray
    end: np.ndarray
    response: float

    @classmethod
    def of(cls, rates: np.ndarray, dt: float, effusivity: float) -> StepWeights:
        """Coefficients of a step of `dt` [s]; `rates` as of :func:`exponentials`."""
        decay, begin, end = np.empty((3, len(rates)))
        _step_weights(np.asarray(rates), dt, decay, begin, end)
        # of the kernel itself: terms faster than the fastest one act at the end of the step only
        return cls(decay, begin, end, 4.0 / 3.0 * np.sqrt(dt / np.pi) / effusivity)


@compiled
def _step_weights(
    rates: np.ndarray, dt: float, decay: np.ndarray, begin: np.ndarray, end: np.ndarray
) -> None:
    """Fill in the coefficients of :class:`StepWeights`."""
    for k in range(len(rates)):
        z = rates[k] * dt
        decay[k] = np.exp(-z)
        mean = -np.expm1(-z) / z if z > 1e-4 else 1.0 - z / 2.0  # of the kernel over the step
        first = (mean - decay[k]) / z if z > 1e-2 else 0.5 - z / 3.0 + z * z / 8.0
        begin[k], end[k] = dt * first, dt * (mean - first)


@compiled
def diffuse(a: np.ndarray, ratio: float, out: np.ndarray) -> None:
    r"""Diffuse the terms along the surface for one step: :math:`(1-\theta Z)^{-1}(1+(1-\theta)Z)`.

    Z is the second difference times `ratio`; theta = 1/2 is second order and used where that keeps
    temperatures positive, for longer steps theta rises towards 1. No heat passes the ends of the cells.

    `ratio`: chi dt/dx^2.
    """
    cells, terms = a.shape
    theta = max(0.5, 1.0 - 0.5 / ratio) if ratio > 0.0 else 0.5
    implicit, explicit = theta * ratio, (1.0 - theta) * ratio
    upper = np.empty(cells)
    for i in range(cells):
        left = implicit if i > 0 else 0.0
        right = implicit if i < cells - 1 else 0.0
        pivot = 1.0 + left + right - (left * upper[i - 1] if i > 0 else 0.0)
        over_pivot = 1.0 / pivot
        upper[i] = right * over_pivot
        before, after = max(i - 1, 0), min(i + 1, cells - 1)
        for m in range(terms):
            value = a[i, m] + explicit * (a[before, m] - 2.0 * a[i, m] + a[after, m])
            if i > 0:
                value += left * out[i - 1, m]
            out[i, m] = value * over_pivot
    for i in range(cells - 2, -1, -1):
        for m in range(terms):
            out[i, m] += upper[i] * out[i + 1, m]


@compiled
def advance_terms(
    terms: np.ndarray,
    flux: np.ndarray,
    shift: int,
    decay: np.ndarray,
    begin: np.ndarray,
    ratio: float,
    weights: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Terms at the end of a step but for the flux there.

    `terms`: at its begin, shape (cells, terms).
    `flux`: the same [W/m^2], shape (cells,).
    `shift`: cells by which the first cell has moved in the body; what it leaves behind is lost, and the body
        brings in no heat.
    `decay`, `begin`: of :class:`StepWeights`, shape (terms,).
    `ratio`: of :func:`diffuse`.
    `weights`: of the terms in the temperature, shape (terms,).

    Returns the terms, shape (cells, terms), the flux of the begin on the cells of the end, and the weighted
    sum of the terms, both of shape (cells,).
    """
    cells, count = terms.shape
    undiffused, moved = np.zeros((cells, count)), np.zeros(cells)
    for i in range(max(-shift, 0), min(cells, cells - shift)):
        moved[i] = flux[i + shift]
        for m in range(count):
            undiffused[i, m] = decay[m] * terms[i + shift, m] + moved[i] * begin[m]
    new, rise = np.empty((cells, count)), np.zeros(cells)
    diffuse(undiffused, ratio, new)
    for i in range(cells):
        for m in range(count):
            rise[i] += new[i, m] * weights[m]
    return new, moved, rise


@compiled
def add_flux(
    terms: np.ndarray, flux: np.ndarray, first: int, fraction: float, end: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Terms with the flux at the end of a step, and that flux shared out to the cells by overlap.

    `terms`: of :func:`advance_terms`, shape (cells, terms).
    `flux`: [W/m^2], shape (nodes,).
    `first`: cell of the first node.
    `fraction`: fraction of a cell by which the nodes are ahead of the cells.
    `end`: of :class:`StepWeights`, shape (terms,).
    """
    cells, count = terms.shape
    new, shared = np.empty((cells, count)), np.zeros(cells)
    for i in range(len(flux)):
        shared[first + i] += (1.0 - fraction) * flux[i]
        shared[first + i + 1] += fraction * flux[i]
    for i in range(cells):
        for m in range(count):
            new[i, m] = terms[i, m] + shared[i] * end[m]
    return new, shared


@compiled
def moving_terms(
    q: np.ndarray, rates: np.ndarray, diffusivity: float, speed: float, dx: float, out: np.ndarray
) -> None:
    r"""Steady terms under a flux at rest, of a body that moves past: :math:`uA'=-\lambda A+\chi A''+q`.

    Exact for a flux that is linear between the nodes and zero beyond them:
    :math:`A(x)=\int q(s)e^{-r_\pm|x-s|}ds/\sqrt{u^2+4\chi\lambda}`,
    :math:`r_\pm=(\sqrt{u^2+4\chi\lambda}\mp u)/(2\chi)` behind and ahead of s.

    `diffusivity`, `speed`: chi [m^2/s], u [m/s], signed.
    `dx`: spacing of the nodes [m].
    """
    n = len(q)
    for m in range(len(rates)):
        root = np.sqrt(speed * speed + 4.0 * diffusivity * rates[m])
        # without cancellation: the product of both exponents is rate/diffusivity
        steep = (root + abs(speed)) / (2.0 * diffusivity)
        flat = rates[m] / (diffusivity * steep)
        behind, ahead = (flat, steep) if speed >= 0.0 else (steep, flat)
        near, far = _linear_weights(behind * dx)
        decay, total = np.exp(-behind * dx), 0.0
        out[0, m] = 0.0
        for i in range(1, n):
            total = decay * total + dx * (far * q[i - 1] + near * q[i])
            out[i, m] = total
        near, far = _linear_weights(ahead * dx)
        decay, total = np.exp(-ahead * dx), 0.0
        for i in range(n - 2, -1, -1):
            total = decay * total + dx * (far * q[i + 1] + near * q[i])
            out[i, m] += total
        for i in range(n):
            out[i, m] /= root


@compiled
def _linear_weights(z: float) -> tuple[float, float]:
    """Integrals of exp(-z s) (1 - s) and exp(-z s) s over 0 < s < 1."""
    if z < 1e-3:
        return 0.5 - z / 6.0 + z * z / 24.0, 0.5 - z / 3.0 + z * z / 8.0
    decay = np.exp(-z)
    mean = (1.0 - decay) / z
    far = (mean - decay) / z
    return mean - far, far


class BodyStep(NamedTuple):
    """One body at the end of a step, but for the flux there.

    `body`: its terms with the flux of the begin of the step.
    `history`: temperature above bulk at the nodes without the flux at the end of the step [K], shape
        (nodes,).
    `response`: temperature per flux at the end of the step [m^2 K/W].
    `end`: contribution of that flux to the terms [s], shape (terms,).
    `fraction`: fraction of a cell by which the nodes are ahead of the cells.
    """

    body: BodyHeat
    history: np.ndarray
    response: float
    end: np.ndarray
    fraction: float


class Body:
    """Conduction into one body, in rows of cells along x.

    `speed`: of its surface at the start [m/s].
    `dt`: nominal time step [s].
    """

    def __init__(self, solid: Solid, speed: float, grid: Grid, dt: float) -> None:
        self.solid, self.n = solid, grid.shape[-1]
        self.dx, self.increment = grid.spacings[-1], grid.increments[-1]  # in m, in half-widths
        chi, speed = solid.diffusivity, abs(speed)
        length = self.n * self.dx
        slow = MAX_DIFFUSION_AREA / chi
        longest = min(length / speed + LONGEST * chi / speed**2, slow) if speed > 0.0 else slow
        self.across = Across(grid, DIFFUSION_LENGTHS * np.sqrt(chi * longest))
        self.rates, self.weights = map(np.array, exponentials(dt, max(longest, 2.0 * dt)))
        self.dt = dt
        reach = PADDING * chi / speed / self.dx if speed > 0.0 else self.n
        self.padding = int(min(np.ceil(reach), self.n)) + 2

    def steady(self, flux: np.ndarray, speed: float) -> tuple[np.ndarray, np.ndarray]:
        """Temperatures above bulk [K] at the nodes under a steady flux, and the terms of the cells.

        A mode across decays faster than the mean by its own rate.
        """
        q, across, chi = self._on_cells(flux), self.across, self.solid.diffusivity
        terms = np.empty((*q.shape, len(self.rates)))
        for mode, decay, out in zip(across.mixed(q, across.inverse), across.decay, terms, strict=True):
            moving_terms(mode, self.rates + chi * decay, chi, speed, self.dx, out)
        cells = across.mixed(terms, across.modes).reshape(-1, len(self.rates))
        rise = cells @ self.weights / self.solid.effusivity + self._tail * q.ravel()
        return self._rows(rise)[across.inner, self.padding : self.padding + self.n].ravel(), cells

    def _on_cells(self, flux: np.ndarray) -> np.ndarray:
        """Flux at the nodes on the cells of a body at its place at the start, shape (rows, cells)."""
        return np.pad(self._on_rows(flux), ((0, 0), (self.padding, self.padding + 1)))

    def _on_rows(self, flux: np.ndarray) -> np.ndarray:
        """Flux at the nodes on all rows, without any beyond the sides of the mesh, shape (rows, nodes)."""
        rows = np.zeros((self.across.rows, self.n))
        rows[self.across.inner] = flux.reshape(-1, self.n)
        return rows

    def _rows(self, values: np.ndarray) -> np.ndarray:
        return values.reshape(self.across.rows, -1, *values.shape[1:])

    @property
    def _tail(self) -> float:
        step = StepWeights.of(self.rates, self.dt, self.solid.effusivity)
        return step.response - self.weights @ step.end / self.solid.effusivity

    def record(self, flux: np.ndarray, terms: np.ndarray) -> BodyHeat:
        """Record of a steady flux."""
        return BodyHeat(-self.padding, terms, self._on_cells(flux).ravel(), self.rates, self.weights)

    def cold(self) -> BodyHeat:
        """Record of a body without heat."""
        cells = self.across.rows * (self.n + 1 + 2 * self.padding)
        zeros = np.zeros((cells, len(self.rates)))
        return BodyHeat(-self.padding, zeros, np.zeros(cells), self.rates, self.weights)

    def advance(
        self, body: BodyHeat, travelled: float, dt: float, speed: float, flux: np.ndarray
    ) -> BodyStep:
        """The body at the end of a step, in parts of at most `MAX_PART` half-widths.

        The flux in a part is linear in time at each point of the body, which passes the contact within some
        parts of a long step. Up to the last part the contact has the flux of the begin.

        `body`: at its begin.
        `travelled`: distance travelled at the end [m].
        `dt`: [s]
        `speed`: [m/s], signed.
        `flux`: at the nodes at its begin [W/m^2], shape (nodes,).
        """
        end, begin = -travelled / self.dx, body.first + self._padding_of(body)
        by_speed = -speed * dt / self.dx
        # the distance may be counted from another place now
        is_counted = abs(np.floor(end) - begin - by_speed) <= max(RENUMBERED, 0.5 * abs(by_speed))
        distance = end - begin if is_counted else by_speed
        parts = max(whole_up(abs(by_speed) * self.increment / MAX_PART), 1)
        for part in range(1, parts):
            position = end - distance * (1.0 - part / parts)
            body = self.accept(self._advance(body, position, dt / parts, by_speed / parts), flux)
        return self._advance(body, end, dt / parts, by_speed / parts)

    def _advance(self, body: BodyHeat, position: float, dt: float, moved: float) -> BodyStep:
        """The body at the end of a part of a step; `position`: of the first node in the body, in cells."""
        base, padding = int(np.floor(position)), self._padding_of(body)
        shift = base - padding - body.first
        if abs(shift - moved) > RENUMBERED:
            shift = int(np.floor(moved))
        step = StepWeights.of(body.rates, dt, self.solid.effusivity)
        area = self.solid.diffusivity * dt
        before = (self._rows(self.across.spread(values, area)) for values in (body.terms, body.flux))
        given = shift, step.decay, step.begin, area / self.dx**2, body.weights / self.solid.effusivity
        after = [advance_terms(*row, *given) for row in zip(*before, strict=True)]
        terms, flux, rise = map(np.concatenate, zip(*after, strict=True))
        body, fraction = body._replace(first=base - padding, terms=terms, flux=flux), position - base
        rises = self._rows(rise)[self.across.inner, padding : padding + self.n + 1]
        history = (1.0 - fraction) * rises[:, :-1] + fraction * rises[:, 1:]
        return BodyStep(body, history.ravel(), step.response, step.end, fraction)

    def _padding_of(self, body: BodyHeat) -> int:
        return (len(body.flux) // self.across.rows - self.n - 1) // 2

    def accept(self, step: BodyStep, flux: np.ndarray) -> BodyHeat:
        """Record with the flux at the end of the step, shape (nodes,), shared out to the cells by overlap."""
        given = self._padding_of(step.body), step.fraction, step.end
        rows = zip(self._rows(step.body.terms), self._on_rows(flux), strict=True)
        terms, shared = map(np.concatenate, zip(*(add_flux(*row, *given) for row in rows), strict=True))
        return step.body._replace(terms=terms, flux=shared)
