"""Limits of Newton steps: how far one step may change pressures and single unknowns of the nodes."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from mpi4py import MPI

from ehlpetsc.discretisation.contact.model import ContactModel
from ehlpetsc.discretisation.ehl_problem import EHLProblem
from ehlpetsc.discretisation.step_inputs import StepInputs
from ehlpetsc.discretisation.unknowns import pairs
from ehlpetsc.nonlinear.ranks import global_max

STEP_LIMIT = 0.3  # p0: largest change of pressure in one Newton step
FILM_AFTER_RELEASE = 1e-3  # film given to a node that leaves contact, over the expected film


class StepLimit(Protocol):
    """Limit of the Newton steps of a system."""

    def begin(self) -> None:
        """Called at the start of each nonlinear solve."""

    def __call__(self, inputs: StepInputs, contact: ContactModel, x: np.ndarray, y: np.ndarray) -> None:
        """Shorten the step y, to be subtracted from x, and change single entries of it, in place; collective.

        `contact`: contact model of the solve. `x`, `y`: local unknowns, on the last rank the border's behind.
        """


class Linearised:
    """Limit by the linearised change of the pressures.

    All of a step is scaled by one factor, so that linear rows remain satisfied, to `STEP_LIMIT` p0 in any
    pressure, because the viscosity is exponential in p; the contact model limits single entries.
    """

    def __init__(self, problem: EHLProblem, ranks: MPI.Comm):
        self.problem, self.ranks = problem, ranks

    def begin(self) -> None:
        """See :class:`StepLimit`."""

    def __call__(self, inputs: StepInputs, contact: ContactModel, x: np.ndarray, y: np.ndarray) -> None:
        """See :class:`StepLimit`."""
        now, step = (pairs(part, self.problem.local) for part in (x, y))
        change = global_max(self.ranks, contact.pressure_change(now, step))
        if change > STEP_LIMIT:
            y *= STEP_LIMIT / change
        contact.clip_step(now, step, FILM_AFTER_RELEASE * self.problem.film_scale)
        if inputs.rests:  # any void would be a solution: no flow fills it
            step[:, 0] = np.minimum(step[:, 0], now[:, 0])
