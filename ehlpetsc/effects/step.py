"""End of a time step: instant, length, distances travelled, conditions."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from ehlpetsc.physics.operation import Conditions


class Step(NamedTuple):
    """End of a time step.

    `time`: [s]
    `dt`: length of the step [s]; None: the steady start.
    `travelled`: distances travelled by surfaces 1 and 2 since time 0 [m].
    """

    time: float
    dt: float | None
    travelled: tuple
    conditions: Conditions
