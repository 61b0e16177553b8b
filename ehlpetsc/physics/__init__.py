"""Laws of physics as functions."""

from typing import Any


def operation_of(case: Any, scales: Any) -> Any:
    """Operation of a case: constant, or from its table of conditions."""
    from ehlpetsc.physics.operation import Conditions, ConstantOperation

    table = case.conditions
    if table is None:
        return ConstantOperation.of(case, scales)
    from ehlpetsc.physics.variable_operation import VariableOperation

    travel = case.time.travel * scales.a
    if not table.varies:
        conditions = Conditions(*(float(column[0]) for column in table[1:5]))
        return ConstantOperation(conditions, min(travel, table.swept_length()))
    return VariableOperation(table, case.time.courant, scales.dx, scales.E, travel)
