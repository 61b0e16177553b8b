"""Laws of physics as functions."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ehlpetsc.base.case import Case
    from ehlpetsc.physics.operation import ConstantOperation
    from ehlpetsc.physics.scales import Scales
    from ehlpetsc.physics.variable_operation import VariableOperation

    Operation = ConstantOperation | VariableOperation


def operation_of(case: Case, scales: Scales) -> Operation:
    """Operation of a case: constant, or from its table of conditions."""
    from ehlpetsc.physics.operation import Conditions, ConstantOperation

    table = case.conditions
    if table is None:
        travel = None if case.time is None else scales.duration * scales.u_max
        return ConstantOperation(scales.conditions, travel)
    from ehlpetsc.physics.variable_operation import VariableOperation

    travel = case.time.travel * scales.a
    if not table.varies:
        conditions = Conditions(*(float(column[0]) for column in table[1:5]))
        return ConstantOperation(conditions, min(travel, table.swept_length()))
    half_width = partial(scales.geometry.half_width, modulus=scales.E, extent=scales.extent)
    return VariableOperation(
        table, case.time.shortest, scales.spacing, half_width, scales.grid.growth, travel
    )
