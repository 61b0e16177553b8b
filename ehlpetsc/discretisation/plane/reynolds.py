r"""Discrete Reynolds equation with mass-conserving cavitation in the plane.

.. math:: F\equiv\frac{\partial\rho h(1-\theta)}{\partial t}+\frac{\partial}{\partial x}\Big[\rho\bar
   uh(1-\theta)- M_x\frac{\partial p}{\partial x}\Big]-\frac{\partial}{\partial y}\Big[M_y\frac{\partial
   p}{\partial y}\Big]=0

Unknowns, scales and cavitation as in :mod:`ehlpetsc.discretisation.line.reynolds`; the sum of F over the
nodes is the mass defect over that of a film `film_scale` that enters over a half-width across. Beyond the
outlet and, in a point contact, beyond the sides the oil has ambient pressure and the film of the last node. A
strip is periodic across.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ehlpetsc.base.declarations import Values
from ehlpetsc.discretisation.contact import contact_model, face_gap, film_scale_of
from ehlpetsc.discretisation.contact.node_state import OPEN_GAP, FaceGap
from ehlpetsc.discretisation.ehl_problem import EHLProblem, Share
from ehlpetsc.discretisation.finite_volumes import (
    DP,
    FLUIDITY,
    LN_ETA_P,
    RHO,
    RHO_P,
    P,
)
from ehlpetsc.discretisation.plane.deflection import Deflection, Transposition
from ehlpetsc.discretisation.plane.finite_volumes import OWN, STENCIL, balance, product
from ehlpetsc.discretisation.step_inputs import Oil, StepInputs, inlet, shear_constants
from ehlpetsc.discretisation.unknowns import n_dofs
from ehlpetsc.physics.laws import density
from ehlpetsc.physics.scales import Scales

if TYPE_CHECKING:
    from ehlpetsc.case.tables import Case
    from ehlpetsc.case.tables.contact import Fluid


AMBIENT = np.array([P, DP, RHO, RHO_P, FLUIDITY, LN_ETA_P])  # properties that depend on the pressure


class Reynolds:
    """Rows of the Reynolds equation of the local nodes.

    `shape`: local rows, nodes along x.
    `share`: local nodes.
    `has_sides`: whether the domain ends below the first, above the last local row.
    `gap`: what solids that are near leave open at a face.
    """

    stencil, own = STENCIL, OWN

    def __init__(
        self,
        scales: Scales,
        spacings: Sequence[float],
        film_scale: float,
        shape: tuple[int, int],
        share: Share,
        has_sides: tuple[bool, bool],
        gap: FaceGap = OPEN_GAP,
    ):
        self.scales, self.film_scale, self.gap = scales, film_scale, gap
        (self.dy, self.dx), self.shape, self.has_sides = spacings, shape, has_sides
        self.rows, self.owned, self.window = share.local, share.owned, share.window

    def mass_per_area(self, q: np.ndarray, h: np.ndarray, fluid: Values) -> np.ndarray:
        r"""Mass per area of the film, :math:`\rho h(1-\theta)`, at the nodes."""
        rho = density(np.maximum(q, 0.0) * self.scales.p0, fluid)[0]
        return rho * (1.0 + np.minimum(q, 0.0)) * h

    def properties(self, q: np.ndarray, h: np.ndarray, oil: Oil) -> np.ndarray:
        """Nodal properties of the rows of the window, with a node beyond the outlet and rows beyond the
        sides.

        Shape (properties, (n_y + 2) (n_x + 1)). Beyond the sides the oil is that beyond the outlet, under
        the film of the last row.
        """
        (n_y, n_x), (has_lower, has_upper), rows = self.shape, self.has_sides, len(q) // self.shape[1]
        flat = np.empty((oil.rows, len(q) + rows))
        oil.fill(q, h, self.window, flat)
        at = np.empty((oil.rows, n_y + 2, n_x + 1))
        inner = at[:, int(has_lower) : n_y + 2 - int(has_upper)]
        inner[:, :, :n_x] = flat[:, : len(q)].reshape(oil.rows, rows, n_x)
        inner[:, :, n_x] = flat[:, len(q) :]
        for has_side, beyond, last in ((has_lower, 0, 1), (has_upper, -1, -2)):
            if has_side:
                at[:, beyond] = at[:, last]
                at[AMBIENT, beyond] = at[AMBIENT, last, n_x:]
        return at.reshape(oil.rows, -1)

    def evaluate(self, q: np.ndarray, h: np.ndarray, inputs: StepInputs) -> tuple[np.ndarray, np.ndarray]:
        """Residual F of the local rows, shape (local nodes,), and its derivatives, (local nodes, 12)."""
        (n_y, n_x), s, history = self.shape, self.scales, inputs.history
        at = self.properties(q, h, inputs.oil)
        constants = s.h, *shear_constants(inputs, s), self.gap.layer, self.gap.leaks or inputs.leaks
        laws = tuple((s.p0 / (s.a * spacing), *constants) for spacing in (self.dx, self.dy))
        nothing = np.zeros(n_y * n_x)
        storage = nothing, nothing, 0.0, 0.0
        if history is not None:
            rate = self.dx * self.dy / history.dt
            storage = history.m[self.rows], history.extrapolated[self.rows], history.k, rate
        residual, derivatives = np.zeros(n_y * n_x), np.zeros((n_y * n_x, n_dofs(STENCIL)))
        weights, rows = (self.dy, self.dx), (residual, derivatives)
        balance(at, self.shape, laws, inputs.flow, inputs.flow_table, storage, weights, rows)
        self._beyond_edges(derivatives.reshape(n_y, n_x, -1))
        residual *= 1.0 / self.film_scale
        derivatives *= 1.0 / self.film_scale
        first = slice(None, None, n_x)
        inlet_rows = inlet(q[self.owned][first], h[self.owned][first], inputs.inlet_film)
        residual[first], derivatives[first, OWN], derivatives[first, OWN + 1] = inlet_rows
        return residual, derivatives

    def _beyond_edges(self, derivatives: np.ndarray) -> None:
        """Add derivatives by the film beyond an edge to those of the film of the last node."""
        own, has_lower, has_upper = slice(OWN, OWN + 2), *self.has_sides
        for part, at in (
            (derivatives[:, -1], 6),
            (derivatives[0], 8) if has_lower else (derivatives[:0], 8),
            (derivatives[-1], 10) if has_upper else (derivatives[:0], 10),
        ):
            if len(part):
                part[..., own.start + 1] += part[..., at + 1]
                part[..., at : at + 2] = 0.0

    def product(self, derivatives: np.ndarray, v_q: np.ndarray, v_h: np.ndarray, first: int) -> np.ndarray:
        """Derivatives of the local rows times a vector of the window, whose local nodes begin at `first`."""
        out = np.empty(len(derivatives))
        product(derivatives, v_q, v_h, self.shape[1], first, out)
        return out


class NoOil:
    """Rows of a dry contact: the Reynolds unknown vanishes, in direct contact it is the pressure of the
    solids.

    `owned`: local nodes in the window.
    """

    stencil, own = STENCIL, OWN

    def __init__(self, shape: tuple[int, int], owned: slice):
        self.shape, self.owned = shape, owned
        self._derivatives = np.zeros((shape[0] * shape[1], n_dofs(STENCIL)))
        self._derivatives[:, OWN] = 1.0

    def mass_per_area(self, q: np.ndarray, h: np.ndarray, fluid: Fluid) -> None:
        """Return None: there is no oil."""

    def evaluate(self, q: np.ndarray, h: np.ndarray, inputs: StepInputs) -> tuple[np.ndarray, np.ndarray]:
        """See :class:`Reynolds`."""
        return q[self.owned], self._derivatives

    def product(self, derivatives: np.ndarray, v_q: np.ndarray, v_h: np.ndarray, first: int) -> np.ndarray:
        """See :class:`Reynolds`."""
        return derivatives[:, OWN] * v_q[self.owned] + derivatives[:, OWN + 1] * v_h[self.owned]


def plane_problem(
    case: Case,
    scales: Scales,
    film_scale: float,
    share: Share,
    has_sides: tuple[bool, bool],
    bound_tolerance: float = 0.0,
    ranks: Transposition | None = None,
) -> EHLProblem:
    """Problem of the nodes of a rank, whole rows along x.

    `film_scale`: expected film in a^2/R.
    `has_sides`: whether the domain ends below and above the local rows.
    `bound_tolerance`: of the active set in a^2/R: films this close to their bound count as on it.
    `ranks`: transposition of the convolution; None: one rank.
    """
    grid, film_scale = scales.grid, film_scale_of(case, scales, film_scale)
    model = contact_model(case, scales, film_scale, bound_tolerance)
    constants = scales.stiffness, film_scale, grid.periodic
    deflection = Deflection(grid.shape, grid.steps, *constants, share.owned, ranks)
    shape = (share.last - share.first) // grid.shape[-1], grid.shape[-1]
    if case.fluid is None:
        reynolds: NoOil | Reynolds = NoOil(shape, share.owned)
    else:
        gap = face_gap(case.contact)
        reynolds = Reynolds(scales, grid.steps, film_scale, shape, share, has_sides, gap)
    return EHLProblem(case, scales, share, model, deflection, reynolds, film_scale)
