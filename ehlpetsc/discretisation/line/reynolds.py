r"""Discrete Reynolds equation with mass-conserving cavitation.

.. math:: F \equiv \frac{\partial \rho h(1-\theta)}{\partial t}
   + \frac{\partial}{\partial x}\Big[\rho u h(1-\theta)
   - \frac{\rho h^3 S}{12\eta}\frac{\partial p}{\partial x}\Big] = 0

(Holmes et al. 2005, eq. (1), its sign turned), p the oil's pressure. One unknown q a node carries pressure
and cavitation: p = max(q, 0), void fraction = max(-q, 0). Lengths in x are in
half-widths, films in a^2/R, pressures in p0; F is divided by u times a film scale, so that the sum
over nodes is the relative mass defect.

Finite volumes, one node a cell: :mod:`ehlpetsc.discretisation.finite_volumes`.

Without oil the Reynolds unknown vanishes: in direct contact q is then the pressure of the solids,
complementary to the gap; in mixed contact, whose solids have a pressure of their own, q = 0.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ehlpetsc.discretisation.contact.node_state import OPEN_GAP, FaceGap
from ehlpetsc.discretisation.finite_volumes import M, balance
from ehlpetsc.discretisation.step_inputs import StepInputs, inlet, shear_constants
from ehlpetsc.discretisation.unknowns import dofs_of, n_dofs
from ehlpetsc.physics.laws import density
from ehlpetsc.physics.scales import Scales

if TYPE_CHECKING:
    from ehlpetsc.case.tables.contact import Fluid
    from ehlpetsc.discretisation.step_inputs import Oil


class Reynolds:
    """Rows of the Reynolds equation for the nodes first .. last-1 of a mesh.

    `film_scale`: divisor of F, in a^2/R.
    `first`, `last`: range of the evaluated rows.
    `start`: first node of the arrays that are passed in.
    `gap`: what solids that are near leave open at a face.

    `columns`: indices of the unknowns of the rows: q and h of the nodes i-2 .. i+1; -1: no unknown, shape
        (local nodes, 8).
    `stencil`: number of nodes in a row.
    `own`: index of q of the row's own node among its coefficients, followed by h.
    """

    stencil, own = 4, 4

    def __init__(
        self,
        scales: Scales,
        film_scale: float,
        first: int,
        last: int,
        start: int = 0,
        gap: FaceGap = OPEN_GAP,
    ):
        self.scales, self.film_scale, self.gap = scales, film_scale, gap
        n = scales.grid.n
        self.local = slice(first, last)
        self.rows = slice(max(first, 1), last)
        self.has_inlet, self.has_outlet = first == 0, last == n
        nodes = slice(max(self.rows.start - 2, 0), min(last + 1, n))  # all that the local rows need
        self.nodes, self.input_nodes = nodes, slice(nodes.start - start, nodes.stop - start)
        self.row_in_input = self.rows.start - nodes.start
        self.dx = scales.x[1] - scales.x[0]
        self.columns = self._columns(np.arange(first, last), n)

    def _columns(self, rows: np.ndarray, n: int) -> np.ndarray:
        node = rows[:, None] + np.arange(-2, 2)
        columns = dofs_of(node)
        columns[(node < 0) | (node >= n) | ((rows[:, None] == 0) & (node != 0))] = -1
        return columns.reshape(len(rows), n_dofs(self.stencil)).astype(np.int32)

    def mass_per_area(self, q: np.ndarray, h: np.ndarray, fluid: Fluid) -> np.ndarray:
        r"""Mass per area of the film, :math:`\rho h(1-\theta)`, at the nodes."""
        rho = density(np.maximum(q, 0.0) * self.scales.p0, fluid)[0]
        return rho * (1.0 + np.minimum(q, 0.0)) * h

    def properties(self, q: np.ndarray, h: np.ndarray, oil: Oil) -> np.ndarray:
        """Properties of the nodes on which the local rows depend, in the rows of :mod:`.finite_volumes`."""
        q, h = q[self.input_nodes], h[self.input_nodes]
        at = np.empty((oil.rows, len(q) + self.has_outlet))
        oil.fill(q, h, self.nodes, at)
        return at

    def face_law(self, inputs: StepInputs) -> tuple:
        """Constants of :func:`.finite_volumes.flux_through`."""
        s = self.scales
        return (
            s.p0 / (s.a * self.dx),
            s.h,
            *shear_constants(inputs, s),
            self.gap.layer,
            self.gap.leaks or inputs.leaks,
        )

    def evaluate(self, q: np.ndarray, h: np.ndarray, inputs: StepInputs) -> tuple[np.ndarray, np.ndarray]:
        """Residual F of the local rows and its derivatives.

        `q`, `h`: unknowns from the node `start` on.

        Returns the residual, shape (local nodes,), and its derivatives with respect to q and h of the nodes
        of `columns`, shape (local nodes, 8).
        """
        rows, history, law = self.rows, inputs.history, self.face_law(inputs)
        at, first = self.properties(q, h, inputs.oil), self.row_in_input
        storage = at[M, first:], at[M, first:], 0.0, 0.0
        if history is not None:
            storage = history.m[rows], history.extrapolated[rows], history.k, self.dx / history.dt
        residual = np.empty(self.local.stop - self.local.start)
        derivatives, own = np.zeros((len(residual), n_dofs(self.stencil))), self.own
        inner = slice(int(self.has_inlet), None)
        balance(at, first, law, inputs.flow_table, storage, (residual[inner], derivatives[inner]))
        if self.has_outlet:
            derivatives[-1, own + 1] += derivatives[-1, own + 3]
            derivatives[-1, own + 2 :] = 0.0
        residual /= self.film_scale
        derivatives *= 1.0 / self.film_scale
        if self.has_inlet:
            inlet_row = inlet(q[:1], h[:1], inputs.inlet_film)
            residual[:1], derivatives[:1, own], derivatives[:1, own + 1] = inlet_row
        return residual, derivatives


class NoOil:
    """Rows of the nodes first .. last-1; interface of :class:`.reynolds.Reynolds`.

    `start`: first node of the arrays that are passed in.
    """

    stencil, own = Reynolds.stencil, Reynolds.own

    def __init__(self, first: int, last: int, start: int = 0):
        self.owned, shape = slice(first - start, last - start), (last - first, n_dofs(self.stencil))
        self.columns = np.full(shape, -1, dtype=np.int32)
        self.columns[:, self.own : self.own + 2] = dofs_of(np.arange(first, last, dtype=np.int32))
        self._derivatives = np.zeros(shape)
        self._derivatives[:, self.own] = 1.0

    def mass_per_area(self, q: np.ndarray, h: np.ndarray, fluid: Fluid) -> np.ndarray:
        """Return None: there is no oil."""
        return None

    def evaluate(self, q: np.ndarray, h: np.ndarray, inputs: StepInputs) -> tuple[np.ndarray, np.ndarray]:
        return q[self.owned], self._derivatives
