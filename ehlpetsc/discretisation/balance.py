r"""The border of the system: the unknowns of the whole contact, and their equations.

.. math:: h=h_{00}+g+D\,p,\qquad\sum p\,\Delta A=W\quad\mathrm{or}\quad h_{00}=-\delta.

The last rank owns both, behind the unknowns and the rows of its nodes. In units of the scales: h00 in a^2/R,
the load in p0 times the unit of the grid's cell. All other modules store the unknowns of the border as one
array, shape (unknowns,), and call the methods below.
"""

from __future__ import annotations

import numpy as np

from ehlpetsc.base.case import Case
from ehlpetsc.discretisation.step_inputs import StepInputs
from ehlpetsc.physics.operation import Conditions
from ehlpetsc.physics.scales import Scales


class Load:
    """Balance of the load by the separation h00.

    `equations`: name of each equation in messages; as many unknowns.
    `by_border`, `by_forces`: derivatives of each row by its own unknown and by its own force.
    """

    equations: tuple[str, ...] = ("load",)
    by_border, by_forces = np.zeros(1), np.ones(1)

    def __init__(self, scales: Scales):
        self.scales, self.outside = scales, scales.grid.surroundings.load

    @property
    def unknowns(self) -> int:
        """Number of unknowns of the whole contact."""
        return len(self.equations)

    def share(self, inputs: StepInputs) -> float:
        """Load of a step over the load of the scales."""
        return inputs.load_share * (inputs.conditions.load / self.scales.load)

    def load(self, inputs: StepInputs) -> float:
        """Integral of the pressure on the mesh that balances the load of a step."""
        return self.scales.grid.load * self.share(inputs) - self.outside

    def uniform(self, gap: float) -> np.ndarray:
        """Unknowns that add the same gap at every node."""
        return np.array([gap])

    def gap(self, border: np.ndarray, nodes: slice = slice(None)) -> float | np.ndarray:
        """Gap that the unknowns add at nodes of the mesh; a number where it is the same at all of them."""
        return border[0]

    def separation(self, border: np.ndarray) -> float:
        """Undeformed separation h00 [m]."""
        return border[0] * self.scales.h

    def tilt(self, border: np.ndarray) -> float:
        """Slope of the gap across."""
        return 0.0

    def forces(self, pressure: np.ndarray, nodes: slice = slice(None)) -> np.ndarray:
        """Work of the pressures at nodes of the mesh on the gap of a unit of each unknown: the load."""
        return np.array([self.scales.grid.cell * pressure.sum()])

    def residual(self, border: np.ndarray, forces: np.ndarray, inputs: StepInputs) -> np.ndarray:
        """Rows of the equations; `forces`: of all nodes."""
        return forces - self.load(inputs)

    def product(self, border: np.ndarray, forces: np.ndarray) -> np.ndarray:
        """Derivatives of the rows times changes of the unknowns and of the forces."""
        return self.by_border * border + self.by_forces * forces

    def change(self, rows: np.ndarray, forces: np.ndarray, by_unit: np.ndarray) -> np.ndarray:
        """Change of the unknowns for a right-hand side of the rows.

        Parameters
        ----------
        rows
            Right-hand side.
        forces
            Of the pressures that follow from the rows of the nodes while the unknowns do not change.
        by_unit
            Changes of the forces by a unit of each unknown, shape (unknowns, unknowns).
        """
        matrix = np.diag(self.by_border) + self.by_forces[:, None] * by_unit.T
        return np.linalg.solve(matrix, rows - self.by_forces * forces)

    def error(self, border: np.ndarray, load: float, conditions: Conditions) -> float:
        """Relative error of the equation; load on the mesh in N or N/m."""
        beyond = self.outside / self.scales.grid.load * self.scales.load
        return abs((load + beyond) / conditions.load - 1.0)


class Approach(Load):
    """Given rigid-body approach of a point contact; its load follows.

    `approach`: of the case [m].
    """

    equations = ("approach",)
    by_border, by_forces = np.ones(1), np.zeros(1)

    def __init__(self, scales: Scales, approach: float):
        super().__init__(scales)
        self.approach = approach / scales.h

    def residual(self, border: np.ndarray, forces: np.ndarray, inputs: StepInputs) -> np.ndarray:
        """Row of the equation: a fraction of the load is that of a smaller approach."""
        return border + self.approach * self.share(inputs) ** self.scales.grid.growth

    def error(self, border: np.ndarray, load: float, conditions: Conditions) -> float:
        """See :class:`Load`."""
        return abs(border[0] / self.approach + 1.0)


class Tilt(Load):
    r"""Balance of the load, and the slope of the gap across, :math:`h=h_{00}+\varphi y+\dots`.

    `tilt`: of the case; None: the moment of the pressure about y = 0 vanishes.
    """

    def __init__(self, scales: Scales, tilt: float | None):
        super().__init__(scales)
        self.unit, self.y = scales.h / scales.a, scales.grid.coordinates[0]
        self.is_free = tilt is None
        self.given = scales.grid.tilt if tilt is None else tilt / self.unit
        self.equations = "load", "moment" if self.is_free else "tilt"
        self.by_border, self.by_forces = np.array([0.0, not self.is_free]), np.array([1.0, self.is_free])

    def uniform(self, gap: float) -> np.ndarray:
        """See :class:`Load`; with the given tilt, or that with which a self-aligning contact begins."""
        return np.array([gap, self.given])

    def gap(self, border: np.ndarray, nodes: slice = slice(None)) -> np.ndarray:
        """See :class:`Load`."""
        return border[0] + border[1] * self.y[nodes]

    def tilt(self, border: np.ndarray) -> float:
        """See :class:`Load`."""
        return border[1] * self.unit

    def forces(self, pressure: np.ndarray, nodes: slice = slice(None)) -> np.ndarray:
        """See :class:`Load`: the load, and its moment about y = 0."""
        return self.scales.grid.cell * np.array([pressure.sum(), self.y[nodes] @ pressure])

    def residual(self, border: np.ndarray, forces: np.ndarray, inputs: StepInputs) -> np.ndarray:
        """See :class:`Load`."""
        moment = forces[1] if self.is_free else border[1] - self.given
        return np.array([super().residual(border, forces, inputs)[0], moment])


def balance_of(case: Case, scales: Scales) -> Load:
    """Border of a case."""
    if case.contact.tilt is not None or case.contact.self_aligning:
        return Tilt(scales, case.contact.tilt)
    return Load(scales) if case.contact.approach is None else Approach(scales, case.contact.approach)
