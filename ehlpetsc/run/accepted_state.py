"""Accepted state of a simulation: a time level in SI units."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from ehlpetsc.stepping.observables import diagnostics


@dataclass(frozen=True)
class AcceptedState:
    """Accepted time level of a simulation; every scalar and field is also an attribute.

    Attributes
    ----------
    scalars
        Scalars of the step, as in ``steps/`` of a result file [SI units].
    fields : shape (nx,)
        Fields of the step [SI units].
    in_contact : shape (nx,)
    solution
        Unknowns, and the history for the next step.
    """

    scalars: dict
    fields: dict = field(repr=False)
    in_contact: object = field(repr=False)
    solution: object = field(repr=False)

    def __getattr__(self, name: str) -> Any:
        for values in (vars(self).get("scalars", {}), vars(self).get("fields", {})):
            if name in values:
                return values[name]
        raise AttributeError(name)

    @classmethod
    def of(cls, simulation: Any, started: float) -> AcceptedState:
        """Accepted state of the `solution` of a simulation.

        Parameters
        ----------
        started
            Monotonic clock at the beginning of the step [s].
        """
        stepper, solution = simulation.stepper, simulation.solution
        scalars, fields, in_contact = diagnostics(
            simulation.scene, stepper.problem, stepper.effects, solution, started
        )
        scalars |= {"step": solution.step, "time": solution.time}
        return cls(scalars, fields, in_contact, solution)
