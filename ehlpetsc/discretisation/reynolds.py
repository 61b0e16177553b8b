r"""Discrete Reynolds equation with mass-conserving cavitation, on any number of rows of nodes along x.

.. math:: F\equiv\frac{\partial\rho h(1-\theta)}{\partial t}+\frac{\partial}{\partial x}\Big[\rho\bar
   uh(1-\theta)- M_x\frac{\partial p}{\partial x}\Big]-\frac{\partial}{\partial y}\Big[M_y\frac{\partial
   p}{\partial y}\Big]=0,\qquad M_x=\frac{\rho h^3S}{12\eta}

(Holmes et al. 2005, eq. (1), its sign turned), p the oil's pressure. One unknown q a node carries pressure
and cavitation: p = max(q, 0), void fraction = max(-q, 0). Lengths are in half-widths, films in a^2/R,
pressures in p0; F is divided by u times a film scale, so that the sum over nodes is the relative mass defect
(in the plane over that of a film that enters over a half-width across).

Finite volumes, one node a cell: :mod:`ehlpetsc.discretisation.finite_volumes` along x,
:mod:`ehlpetsc.discretisation.plane.cross_flow` across. Beyond the outlet and, in a point contact, beyond the
sides the oil has ambient pressure and the film of the last node; beside a part of a contact those of its
surroundings. A strip is periodic across.

Without oil the Reynolds unknown vanishes: in direct contact q is then the pressure of the solids,
complementary to the gap; in mixed contact, whose solids have a pressure of their own, q = 0.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ehlpetsc.discretisation.contact.node_state import OPEN_GAP, FaceGap
from ehlpetsc.discretisation.finite_volumes import (
    ALONG,
    DP,
    FLUIDITY,
    LN_ETA_P,
    Q_ABOVE,
    Q_BELOW,
    Q_OWN,
    RHO,
    RHO_P,
    STENCIL,
    P,
    balance,
    reynolds_product,
)
from ehlpetsc.discretisation.step_inputs import (
    StepInputs,
    face_speeds,
    inlet,
    row_speeds,
    shear_constants,
)
from ehlpetsc.discretisation.unknowns import Share, n_dofs
from ehlpetsc.physics.contact.grid import Grid
from ehlpetsc.physics.oil.laws import density
from ehlpetsc.physics.scales import Scales

if TYPE_CHECKING:
    from ehlpetsc.base.case import Fluid
    from ehlpetsc.discretisation.step_inputs import Oil

BLOCK = 8192  # nodes whose properties are computed at a time, to be put in place
OF_PRESSURE = np.array([P, DP, RHO, RHO_P, FLUIDITY, LN_ETA_P])  # properties that depend on the pressure


def part_of(nodes: slice | np.ndarray, block: slice) -> slice | np.ndarray:
    """Some of the nodes by their places among them."""
    if isinstance(nodes, slice):
        return slice(nodes.start + block.start, nodes.start + block.stop)
    return nodes[block]


class NoOil:
    """Reynolds' rows of a dry contact: q of the node itself.

    `share`: local nodes: a part of a row, or whole rows.
    """

    def __init__(self, grid: Grid, share: Share):
        self.local, self.owned, self.n_x = share.local, share.owned, grid.shape[-1]
        self.size = share.last - share.first
        self.width = n_dofs(ALONG if len(grid.axes) == 1 else STENCIL)

    def mass_per_area(self, q: np.ndarray, h: np.ndarray, fluid: Fluid) -> np.ndarray | None:
        r"""Mass per area of the film, :math:`\rho h(1-\theta)`, at the nodes; None without oil."""
        return None

    def evaluate(self, q: np.ndarray, h: np.ndarray, inputs: StepInputs) -> tuple[np.ndarray, np.ndarray]:
        """Residual of the local rows, shape (local nodes,), and its derivatives.

        `q`, `h`: of the window.

        Derivatives: with respect to q and h of the nodes of :mod:`.finite_volumes`, shape (local nodes, 8),
        in the plane (local nodes, 12).
        """
        derivatives = np.zeros((self.size, self.width))
        derivatives[:, Q_OWN] = 1.0
        return q[self.owned], derivatives

    def product(self, derivatives: np.ndarray, v: np.ndarray, first: int) -> np.ndarray:
        """Derivatives of the local rows times changes of q and h, shape (window, 2).

        `first`: index of the first local node in the window.
        """
        out = np.empty(len(derivatives))
        reynolds_product(derivatives, v, self.n_x, first, out)
        return out


class Reynolds(NoOil):
    """Rows of the Reynolds equation of the local nodes.

    `film_scale`: divisor of F, in a^2/R.
    `has_sides`: whether the domain ends below the first, above the last local row; of a line left out.
    `gap`: what solids that are near leave open at a face.

    `shape`: local rows, local nodes along x.
    """

    def __init__(
        self,
        scales: Scales,
        film_scale: float,
        share: Share,
        has_sides: tuple[bool, bool] | None = None,
        gap: FaceGap = OPEN_GAP,
    ):
        grid = scales.grid
        super().__init__(grid, share)
        self.scales, self.film_scale, self.gap, self.has_sides = scales, film_scale, gap, has_sides
        self._speeds: tuple[tuple, tuple[np.ndarray, np.ndarray]] | None = None
        self.given = grid.surroundings.sides
        self.dx, self.dy, self.cell = grid.dx, 1.0 if has_sides is None else grid.increments[0], grid.cell
        rows = max(self.size // self.n_x, 1)
        self.shape = n_y, n_x = rows, self.size // rows
        self.first_row, begin = divmod(share.first, self.n_x)
        self.has_inlet, self.has_outlet = begin == 0, begin + n_x == self.n_x
        cells, inlets, behind = n_x - self.has_inlet, int(self.has_inlet), begin > 1
        if has_sides is not None:
            from ehlpetsc.discretisation.plane.cross_flow import add_across

            self._add_across = add_across
            self.input_nodes, self.nodes = slice(None), share.window
            self.layout = n_y, cells, n_x + 1 + inlets, n_x + 1, inlets, n_x, behind
            return
        start, stop = max(share.owned.start - 2, 0), min(share.owned.stop + 1, share.window_size)
        self.input_nodes = slice(start, stop)  # all that the local rows need
        self.nodes = slice(share.window.start + start, share.window.start + stop)
        self.layout = 1, cells, share.owned.start - start + inlets, 0, inlets, 0, behind

    def mass_per_area(self, q: np.ndarray, h: np.ndarray, fluid: Fluid) -> np.ndarray:
        """See :class:`NoOil`."""
        rho = density(np.maximum(q, 0.0) * self.scales.p0, fluid)[0]
        return rho * (1.0 + np.minimum(q, 0.0)) * h

    def properties(self, q: np.ndarray, h: np.ndarray, oil: Oil) -> np.ndarray:
        """Properties of the nodes on which the local rows depend, in the rows of :mod:`.finite_volumes`.

        Of a line with a node beyond the outlet. In the plane with one in each row and with rows beyond the
        sides, shape (properties, (n_y + 2) (n_x + 1)), where the oil is that beyond the outlet, under the
        film of the last row.
        """
        q, h = q[self.input_nodes], h[self.input_nodes]
        if self.has_sides is None:
            at = np.empty((oil.rows, len(q) + self.has_outlet))
            oil.fill(q, h, self.nodes, at)
            return at
        (n_y, n_x), (has_lower, has_upper), count = self.shape, self.has_sides, len(q) // self.n_x
        at = np.empty((oil.rows, n_y + 2, n_x + 1))
        step = max(BLOCK // n_x, 1)
        inner = at[:, int(has_lower) : n_y + 2 - int(has_upper)]
        for begin in range(0, count, step):
            rows = slice(begin, min(begin + step, count))
            block = slice(rows.start * n_x, rows.stop * n_x)
            flat = np.empty((oil.rows, (rows.stop - begin) * (n_x + 1)))
            oil.fill(q[block], h[block], part_of(self.nodes, block), flat)
            of_nodes, beyond = np.split(flat, [block.stop - block.start], axis=1)
            inner[:, rows, :n_x] = of_nodes.reshape(oil.rows, -1, n_x)
            inner[:, rows, n_x] = beyond
        for given, has_side, beyond, last in zip(self.given, self.has_sides, (0, -1), (1, -2), strict=True):
            if has_side and given is not None:
                side = np.empty((oil.rows, n_x + 1))
                oil.fill(given[0], given[1], slice(0, n_x), side)
                at[:, beyond] = side
            elif has_side:
                at[:, beyond] = at[:, last]
                at[OF_PRESSURE, beyond] = at[OF_PRESSURE, last, n_x:]
        return at.reshape(oil.rows, -1)

    def face_law(self, inputs: StepInputs, spacing: float) -> tuple:
        """Constants of :func:`.finite_volumes.flux_through` between nodes `spacing` half-widths apart."""
        s, leaks = self.scales, self.gap.leaks or inputs.leaks
        return s.p0 / (s.a * spacing), s.h, *shear_constants(inputs, s), self.gap.layer, leaks

    def speeds(self, inputs: StepInputs) -> tuple[np.ndarray, np.ndarray]:
        """Speeds of the local rows and of the faces below, between and above them, see `row_speeds`."""
        now = inputs.conditions, inputs.film_is_carried
        if self._speeds is None or self._speeds[0] != now:  # all evaluations of a step have the same
            rows, first, count = row_speeds(inputs, self.scales), self.first_row, self.shape[0]
            of_both = rows[first : first + count], face_speeds(rows)[first : first + count + 1]
            self._speeds = now, of_both
        return self._speeds[1]

    def storage(self, inputs: StepInputs) -> tuple:
        """Storage of the local nodes for :func:`.finite_volumes.balance`."""
        history, local = inputs.history, self.local
        if history is None:
            nothing = np.zeros(self.size)
            return nothing, nothing, 0.0, 0.0
        return history.m[local], history.extrapolated[local], history.k, self.cell / history.dt

    def evaluate(self, q: np.ndarray, h: np.ndarray, inputs: StepInputs) -> tuple[np.ndarray, np.ndarray]:
        """See :class:`NoOil`."""
        table, (*history, rate), scale = inputs.flow_table, self.storage(inputs), self.film_scale
        at, law = self.properties(q, h, inputs.oil), self.face_law(inputs, self.dx)
        of_rows, of_faces = self.speeds(inputs)
        rows = residual, derivatives = np.empty(self.size), np.empty((self.size, self.width))
        first = slice(None, None, self.shape[1])
        if self.has_inlet:
            derivatives[first] = 0.0
        balance(at, self.layout, law, of_rows, table, (*history, rate / scale), self.dy / scale, rows)
        if self.has_sides is not None:
            law = self.face_law(inputs, self.dy)
            across = inputs.cross_flow_table
            self._add_across(at, self.shape, law, of_faces, inputs.flow, across, self.dx / scale, rows)
        self._beyond_edges(derivatives.reshape(*self.shape, -1))
        if self.has_inlet:
            of_inlet = inlet(q[self.owned][first], h[self.owned][first], inputs.inlet_film)
            residual[first], derivatives[first, Q_OWN], derivatives[first, Q_OWN + 1] = of_inlet
        return residual, derivatives

    def _beyond_edges(self, derivatives: np.ndarray) -> None:
        """Add derivatives by the film beyond an edge that is that of the last node to those by it."""
        has_lower, has_upper = self.has_sides or (False, False)
        below, above = self.given
        for is_edge, follows, edge, at in (
            (self.has_outlet, True, derivatives[:, -1], Q_OWN + 2),
            (has_lower, below is None, derivatives[0], Q_BELOW),
            (has_upper, above is None, derivatives[-1], Q_ABOVE),
        ):
            if is_edge:
                edge[..., Q_OWN + 1] += follows * edge[..., at + 1]
                edge[..., at : at + 2] = 0.0
