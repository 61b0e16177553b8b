"""Interface of an effect: physics, other than the film, whose state changes from time level to time level.

The state of a run contains one record of each effect, a NamedTuple of arrays, numbers and other NamedTuples.
The record is saved in restart files by its field names; only the effect reads it.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, TypeVar, get_type_hints

import numpy as np

from ehlpetsc.base.case import KINDS
from ehlpetsc.base.declarations import KeyTable

if TYPE_CHECKING:
    from ehlpetsc.base.case import Case
    from ehlpetsc.discretisation.ehl_problem import Solution, StepInputs
    from ehlpetsc.effects.scene import Scene
    from ehlpetsc.physics.operation import Conditions
    from ehlpetsc.physics.scales import Scales


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


class NoRecord(NamedTuple):
    """Empty record of an effect without a state."""


R = TypeVar("R")  # record of an effect


class Effect(Generic[R]):
    """Base class of effects: no influence, no quantities.

    `name`: name of the record in the state and in restart files.
    `record`: type of the record, a NamedTuple.
    `table`: table of the case file, :class:`ehlpetsc.base.declarations.KeyTable`.
    `contacts`: kinds of contact that it serves; others are refused.
    `moves_with_surfaces`: whether its contribution to the gap moves with the surfaces from the first step on.
    `frozen_before_start`: whether its record does not change in the time steps before time 0.
    `fields`, `scalars`, `surface`: quantities of the effect, see :mod:`ehlpetsc.base.quantities`: fields
    over the nodes, scalars of every time step, depths along each surface at the end of the run.
    """

    name = ""
    record: type = NoRecord
    table: KeyTable | None = None
    contacts: Collection[str] = tuple(KINDS)
    moves_with_surfaces = False
    frozen_before_start = False
    fields: dict = {}
    scalars: dict = {}
    surface: dict = {}

    def __init__(self, scene: Scene) -> None:
        self.scene = scene

    @classmethod
    def is_in(cls, case: Case) -> bool:
        """Whether a case has this effect: by default its table of keys."""
        return cls.table is not None and getattr(case, cls.table.name) is not None

    def start(self, before: R | None = None) -> R:
        """Record at time 0.

        `before`: record at the end of the previous pass.
        """
        return self.record()

    def interpolated(self, record: R, scales: Scales) -> R | None:
        """Record to begin a steady start with, from that of the same contact on other nodes; None: no use.

        `scales`: of the other nodes.
        """
        return None

    def inputs(self, record: R, inputs: StepInputs, step: Step) -> StepInputs:
        """Inputs of the solve with the contribution of the effect.

        `record`: record at the beginning of the step.
        """
        return inputs

    def accept(self, record: R, solution: Solution, step: Step) -> R:
        """Record at the end of an accepted step.

        `record`: record at the beginning of the step.
        """
        return record

    def mixed(self, pairs: Sequence[tuple[R, R]]) -> R:
        """Record before the next solve of a steady start, from those before and after the ones so far."""
        return pairs[-1][1]

    def is_settled(self, before: R | None, after: R) -> bool:
        """Whether a steady solution is consistent with the record after it; otherwise it is solved again."""
        return True

    def film_shear(self, record: R, solution: Solution, shear: np.ndarray | None) -> np.ndarray | None:
        """Mean shear stress of the film [Pa] by `shear`, that without this effect; None: isothermal."""
        return shear

    def observe(self, record: R, solution: Solution, step: Step) -> tuple[dict, dict]:
        """Values, by name and in SI units, of `fields` and `scalars` that have no function `of`."""
        return {}, {}

    def on_surfaces(
        self, record: R, points: Sequence[np.ndarray | None]
    ) -> dict[str, Sequence[np.ndarray | None]]:
        """Values of the quantities `surface` at points of surfaces 1 and 2.

        `points`: body points s [m]; None: not stored.
        """
        return {}


def flat(record: NamedTuple, name: str) -> dict[str, Any]:
    """Fields of a record, and of records in it, by dotted names."""
    values: dict[str, Any] = {}
    for key, value in record._asdict().items():
        inner = f"{name}.{key}"
        values |= flat(value, inner) if hasattr(value, "_asdict") else {inner: value}
    return values


def unflat(kind: type, values: dict[str, Any], name: str) -> Any:
    """Record of type `kind` from the values of :func:`flat`."""
    fields = {}
    for key, inner in get_type_hints(kind).items():
        path = f"{name}.{key}"
        fields[key] = unflat(inner, values, path) if hasattr(inner, "_fields") else values[path]
    return kind(**fields)
