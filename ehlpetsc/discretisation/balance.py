r"""The border of the system: the unknown of the whole contact, h00, and its equation.

.. math:: h=h_{00}+g+D\,p,\qquad\sum p\,\Delta A=W\quad\mathrm{or}\quad h_{00}=-\delta.

The last rank owns both, behind the unknowns and the rows of its nodes. In units of the scales: h00 in a^2/R,
the load in p0 times the unit of the grid's cell.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ehlpetsc.discretisation.step_inputs import StepInputs
from ehlpetsc.physics.operation import Conditions
from ehlpetsc.physics.scales import Scales

if TYPE_CHECKING:
    from ehlpetsc.base.case import Case


class Load:
    """Balance of the load by h00.

    `unknowns`: of the whole contact; as many equations.
    `equation`: name of the equation in messages.
    `by_h00`, `by_load`: derivatives of the row by h00 and by the integral of the pressure.
    """

    unknowns = 1
    equation = "load"
    by_h00, by_load = 0.0, 1.0

    def __init__(self, scales: Scales):
        self.scales = scales

    def share(self, inputs: StepInputs) -> float:
        """Load of a step over the load of the scales."""
        return inputs.load_share * (inputs.conditions.load / self.scales.load)

    def residual(self, h00: float, load: float, inputs: StepInputs) -> float:
        """Row of the equation; `load`: integral of the pressure."""
        return load - self.scales.grid.load * self.share(inputs)

    def product(self, h00: float, load: float) -> float:
        """Derivative of the row times changes of h00 and of the integral of the pressure."""
        return self.by_h00 * h00 + self.by_load * load

    def gap(self, nodes: int) -> np.ndarray:
        """Gap that a unit of h00 adds at each of some nodes."""
        return np.ones(nodes)

    def change(self, row: float, load: float, by_unit: float) -> float:
        """Change of h00 for a right-hand side of the row.

        Parameters
        ----------
        row
            Right-hand side.
        load
            Integral of the pressures that follow from the rows of the nodes while h00 does not change.
        by_unit
            Change of that integral by a unit of h00.
        """
        return (row - self.by_load * load) / (self.by_h00 + self.by_load * by_unit)

    def error(self, h00: float, load: float, conditions: Conditions) -> float:
        """Relative error of the equation; load in N or N/m."""
        return abs(load / conditions.load - 1.0)


class Approach(Load):
    """Given rigid-body approach of a point contact; its load follows.

    `approach`: of the case [m].
    """

    equation = "approach"
    by_h00, by_load = 1.0, 0.0

    def __init__(self, scales: Scales, approach: float):
        super().__init__(scales)
        self.approach = approach / scales.h

    def residual(self, h00: float, load: float, inputs: StepInputs) -> float:
        """Row of the equation: a fraction of the load is that of a smaller approach."""
        return h00 + self.approach * self.share(inputs) ** self.scales.grid.growth

    def error(self, h00: float, load: float, conditions: Conditions) -> float:
        """See :class:`Load`."""
        return abs(h00 / self.approach + 1.0)


def balance_of(case: Case, scales: Scales) -> Load:
    """Border of a case."""
    return Load(scales) if case.contact.approach is None else Approach(scales, case.contact.approach)
