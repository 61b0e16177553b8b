"""Checks of the arguments of a simulation that is called from Python."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ehlpetsc.base.errors import UsageError

if TYPE_CHECKING:
    from ehlpetsc.run.simulation import Simulation

NODE_TOLERANCE = 1e-9  # relative: nodes and half widths nearer than this are equal
MIN_STEP_RATIO = 1e-9  # smallest time step over the nominal one


def option_texts(options: dict | None) -> dict[str, str]:
    """PETSc options as strings by name, from None, True, False, numbers and strings."""
    texts = {}
    for name, value in (options or {}).items():
        texts[name] = "" if value is None else str(value).lower() if isinstance(value, bool) else str(value)
        if not (f"{name}{texts[name]}").isprintable():  # PETSc would end the process
            raise UsageError(f"options: {name!r}: {value!r}: allowed: names and values in one line of text")
    return texts


def check_pass(simulation: Simulation, after: Simulation | None, pass_number: int | None) -> int:
    """Number of a pass, after checks against the previous pass; UsageError."""
    min_number = after.pass_number + 1 if after else 1
    number = min_number if pass_number is None else pass_number
    if number < min_number:
        raise UsageError(f"pass_number = {number!r}: allowed: a whole number from {min_number} on")
    if after is None:
        return number
    if not after.finished:
        raise UsageError("after: the pass before is not at its end; iterate over its states first")
    law, before = simulation.case.contact.law, after.case.contact.law
    if before != law:
        raise UsageError(f"after: contact.law is {law}, of the pass before {before}")
    x, x_before = (s.x * s.a for s in (simulation.scales, after.scales))
    if len(x) != len(x_before) or np.abs(x - x_before).max() > NODE_TOLERANCE * np.ptp(x_before):
        raise UsageError("after: the pass before has other nodes; allowed: the same [mesh] and half width")
    return number


def check_time_step(dt: float | None, simulation: Simulation) -> None:
    """Refuse an impossible length of a time step [s], and a step after the end; None: of the step control."""
    if simulation.finished:
        raise UsageError("advance: the simulation is at its end")
    if dt is None:
        return
    if simulation.solution is None:
        raise UsageError(f"dt = {dt!r}: the first state is the steady start, which has no time step")
    left = simulation.end - simulation.solution.time
    shortest = MIN_STEP_RATIO * simulation.scales.dt
    if not shortest <= dt <= left * (1.0 + NODE_TOLERANCE):
        raise UsageError(f"dt = {dt!r}: allowed: a number from {shortest:.3g} to the {left:.6g} s left")
