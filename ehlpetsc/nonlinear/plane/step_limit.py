"""Limit of the Newton steps of a contact in the plane."""

from __future__ import annotations

import numpy as np
from mpi4py import MPI

from ehlpetsc.discretisation.contact.model import ContactModel
from ehlpetsc.discretisation.contact.node_state import full_of_oil
from ehlpetsc.discretisation.ehl_problem import EHLProblem
from ehlpetsc.discretisation.reynolds import Reynolds
from ehlpetsc.discretisation.step_inputs import StepInputs
from ehlpetsc.discretisation.unknowns import pairs
from ehlpetsc.nonlinear.plane.exchange import PlaneExchange
from ehlpetsc.nonlinear.plane.held_films import HIGHEST, MOVED, HeldFilms, settle
from ehlpetsc.nonlinear.ranks import all_ranks, global_max
from ehlpetsc.nonlinear.step_limit import FILM_AFTER_RELEASE, Linearised

# largest change of pressure, in p0 or where that is more of the highest pressure: with oil 0.3 p0 costs
# asperities half as many iterations again; a dry layer of 0.1 nm needs shorter steps, others take hardly more
STEP_LIMITS, DRY_STEP_LIMITS = (1.0, 0.3), (0.1, 0.1)
SETTLED_STEPS = 8  # of a solve; most take six


class ByPressures:
    """Limit by the pressures to which the changed entries lead; of solids that yield, :class:`Linearised`.

    Where a stiff layer lets go, or a cavity fills, the linearised change is a thousand times the real one and
    would bring the whole iteration to a halt. A steady solution may be far off: there the linearised change
    of the oil counts too. Thin oil and the edges of cavities are then settled with the films held.

    `steps`: of the solve so far.
    """

    def __init__(self, problem: EHLProblem, exchange: PlaneExchange, ranks: MPI.Comm):
        self.problem, self.exchange, self.ranks = problem, exchange, ranks
        self.linearised, self.steps = Linearised(problem, ranks), 0

    def begin(self) -> None:
        """See :class:`ehlpetsc.nonlinear.step_limit.StepLimit`."""
        self.steps = 0

    def __call__(self, inputs: StepInputs, contact: ContactModel, x: np.ndarray, y: np.ndarray) -> None:
        """See :class:`ehlpetsc.nonlinear.step_limit.StepLimit`."""
        if np.isfinite(contact.yield_pressure):
            self.linearised(inputs, contact, x, y)
            return
        now, given = (pairs(part, self.problem.local) for part in (x, y))
        step = given.copy()
        self._clip(inputs, contact, now, step)
        excess = self._excess(inputs, contact, now, given, step)
        if excess > 1.0:
            y *= 1.0 / excess
            self._clip(inputs, contact, now, given)
        else:
            given[:] = step
        reynolds, is_steady = self.problem.reynolds, inputs.history is None
        if isinstance(reynolds, Reynolds) and not is_steady and self.problem.model.lower_bound is None:
            self._settle(reynolds, inputs, contact, now, given)

    def _excess(
        self, inputs: StepInputs, contact: ContactModel, now: np.ndarray, given: np.ndarray, step: np.ndarray
    ) -> float:
        """Largest change of a pressure by a step, given and with its entries limited, over the limit."""
        of_oil = np.maximum(now[:, 0] - given[:, 0], 0.0) - np.maximum(now[:, 0], 0.0)
        pressure, new = contact.pressure(*now.T), contact.pressure(*(now - step).T)
        largest = np.array([pressure.max(), np.abs(new - pressure).max(), np.abs(of_oil).max()])
        highest, change, of_oil = global_max(self.ranks, largest)
        is_dry = self.problem.fluid is None
        limit, of_highest = DRY_STEP_LIMITS if is_dry else STEP_LIMITS
        excess = change / max(limit, of_highest * highest)
        return max(excess, of_oil / limit) if inputs.history is None and not is_dry else excess

    def _clip(self, inputs: StepInputs, contact: ContactModel, now: np.ndarray, step: np.ndarray) -> None:
        """Change and limit single entries of a step; a steady start in oil may be far from its solution."""
        if inputs.history is not None or self.problem.fluid is None:
            contact.follow_pressure(now, step)
        contact.clip_step(now, step, FILM_AFTER_RELEASE * self.problem.film_scale)

    def _settle(
        self,
        reynolds: Reynolds,
        inputs: StepInputs,
        contact: ContactModel,
        now: np.ndarray,
        step: np.ndarray,
    ) -> None:
        """Change a step so that thin oil and the edges of cavities are where its films have them.

        Where the pressure of a single node lifts a thin film, Newton's method may cycle with this change;
        without it, after `SETTLED_STEPS`, it converges.
        """
        self.steps += 1
        if self.steps > SETTLED_STEPS:
            return
        new, before = now - step, now[:, 0]
        is_changed = (np.abs(step[:, 0]) > MOVED) & (new[:, 0] < HIGHEST)
        changed = np.flatnonzero(is_changed | (full_of_oil(new[:, 0]) != full_of_oil(before)))
        if all_ranks(self.ranks, not len(changed)):
            return
        q, w = np.ascontiguousarray(self.exchange.window(new).T)
        if len(changed):
            settled = q[self.problem.owned].copy()
            cells = HeldFilms(reynolds, inputs, q, contact.film(q, w))
            settle(cells, settled, changed)
            step[:, 0] = before - settled
