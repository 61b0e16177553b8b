"""System of equations of a contact in the plane: Jacobian, preconditioner, exchange."""

from __future__ import annotations

import contextlib
import ctypes
from typing import TYPE_CHECKING

import numpy as np
from petsc4py import PETSc

from ehlpetsc.discretisation.contact import film_scale_of
from ehlpetsc.discretisation.contact.node_state import full_of_oil
from ehlpetsc.discretisation.ehl_problem import problem_of
from ehlpetsc.discretisation.plane.deflection import Deflection
from ehlpetsc.discretisation.reynolds import Reynolds
from ehlpetsc.discretisation.step_inputs import StepInputs
from ehlpetsc.discretisation.unknowns import Unknowns, pairs
from ehlpetsc.elasticity.bodies import Bodies
from ehlpetsc.elasticity.kernel import Mesh
from ehlpetsc.elasticity.kernels import kernel_of
from ehlpetsc.nonlinear.plane.exchange import PlaneExchange, RankTransposition, first_rows, share_of
from ehlpetsc.nonlinear.plane.held_films import HIGHEST, MOVED, HeldFilms, settle
from ehlpetsc.nonlinear.plane.jacobian import PlaneJacobian
from ehlpetsc.nonlinear.plane.preconditioner import Elimination
from ehlpetsc.nonlinear.ranks import all_ranks, global_max
from ehlpetsc.nonlinear.two_fields import FILM_AFTER_RELEASE, ZERO_TOLERANCE, Matrices, TwoFields
from ehlpetsc.physics.scales import Scales

if TYPE_CHECKING:
    from ehlpetsc.base.case import Case

# largest change of pressure, in p0 or where that is more of the highest pressure: with oil 0.3 p0 costs
# asperities half as many iterations again; a dry layer of 0.1 nm needs shorter steps, others take hardly more
STEP_LIMITS, DRY_STEP_LIMITS = (1.0, 0.3), (0.1, 0.1)
SETTLED_STEPS = 8  # of a solve; most take six

# options of glibc's mallopt, and values: M_MMAP_THRESHOLD, M_MMAP_MAX, M_TRIM_THRESHOLD
RETURNING = ((-3, 1 << 25), (-4, 1 << 16), (-1, 1 << 27))


class PlaneMatrices(Matrices):
    """Matrix-free Jacobian; the preconditioner around that of the user's options."""

    keeps_factors = True
    linear_atol = 0.1  # an iteration costs a convolution
    elimination: Elimination | None = None

    def jacobian(self, ksp: PETSc.KSP) -> PlaneJacobian:
        """See :class:`ehlpetsc.nonlinear.two_fields.Matrices`."""
        self.elimination = Elimination(self.problem, self.ranks, ksp.comm)
        return PlaneJacobian(self.problem, self.exchange, self.ranks, self.elimination, ksp.rtol)

    def begin_solve(self) -> None:
        """See :class:`ehlpetsc.nonlinear.two_fields.Matrices`."""
        if self.elimination.factors:
            self.elimination.begin_solve()

    def renew(self) -> None:
        """See :class:`ehlpetsc.nonlinear.two_fields.Matrices`."""
        self.elimination.renew()

    def keep(self, jacobian: PlaneJacobian) -> None:
        """See :class:`ehlpetsc.nonlinear.two_fields.Matrices`."""
        self.elimination.keep(jacobian)


class PlaneFields(TwoFields):
    """System of a contact in the plane."""

    exchange: PlaneExchange
    steps = 0  # of the solve

    def set_initial_guess(self, guess: Unknowns, inputs: StepInputs) -> None:
        """See :class:`TwoFields`."""
        super().set_initial_guess(guess, inputs)
        self.steps = 0

    def limit_step(self, x: PETSc.Vec, y: PETSc.Vec) -> None:
        """As of :class:`TwoFields`; of elastic solids by the pressures to which the limited entries lead.

        Where a stiff layer lets go, or a cavity fills, the linearised change is a thousand times the real one
        and would bring the whole iteration to a halt. A steady solution may be far off: there the linearised
        change of the oil counts too.
        """
        if np.isfinite(self.contact.yield_pressure):
            super().limit_step(x, y)
            return
        now, step = pairs(x.array_r, self.local), pairs(y.array, self.local).copy()
        of_oil = np.maximum(now[:, 0] - step[:, 0], 0.0) - np.maximum(now[:, 0], 0.0)
        self._clip(now, step)
        pressure, new = self.contact.pressure(*now.T), self.contact.pressure(*(now - step).T)
        largest = np.array([pressure.max(), np.abs(new - pressure).max(), np.abs(of_oil).max()])
        highest, change, of_oil = global_max(self.ranks, largest)
        is_dry = self.problem.fluid is None
        limit, of_highest = DRY_STEP_LIMITS if is_dry else STEP_LIMITS
        excess = change / max(limit, of_highest * highest)
        if self.inputs.history is None and not is_dry:
            excess = max(excess, of_oil / limit)
        given = pairs(y.array, self.local)
        if excess > 1.0:
            y.scale(1.0 / excess)
            self._clip(now, given)
        else:
            given[:] = step
        reynolds, is_steady = self.problem.reynolds, self.inputs.history is None
        if isinstance(reynolds, Reynolds) and not is_steady and self.model.lower_bound is None:
            self._settle(reynolds, now, given)

    def _clip(self, now: np.ndarray, step: np.ndarray) -> None:
        """Change and limit single entries of a step; a steady start in oil may be far from its solution."""
        if self.inputs.history is not None or self.problem.fluid is None:
            self.contact.follow_pressure(now, step)
        self.contact.clip_step(now, step, FILM_AFTER_RELEASE * self.problem.film_scale)

    def _settle(self, reynolds: Reynolds, now: np.ndarray, step: np.ndarray) -> None:
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
            cells = HeldFilms(reynolds, self.inputs, q, self.contact.state(q, w).film)
            settle(cells, settled, changed)
            step[:, 0] = before - settled


def return_freed_memory() -> None:
    """Have malloc return freed blocks of 4 MB and more to the system.

    SuperLU_DIST, which Debian's PETSc loads, has it keep them, and factors do not fit the holes of others.
    """
    with contextlib.suppress(AttributeError):  # another C library
        for option in RETURNING:
            ctypes.CDLL(None).mallopt(*option)


def plane_system(
    case: Case, scales: Scales, film_scale: float, comm: PETSc.Comm, bound_tolerance: float = ZERO_TOLERANCE
) -> TwoFields:
    """System of a point contact or a strip; arguments as of :func:`.line.system.line_system`."""
    return_freed_memory()
    grid, ranks = scales.grid, comm.tompi4py()
    cuts = first_rows(grid.shape[0], ranks.size)
    share, has_sides = share_of(grid.shape, cuts[ranks.rank : ranks.rank + 2], grid.periodic)
    transposition = RankTransposition(cuts, ranks) if ranks.size > 1 else None
    kernel = kernel_of(Bodies.of(case.contact), Mesh(grid.shape, grid.increments, grid.periodic, scales.a))
    law = kernel, scales.stiffness, film_scale_of(case, scales, film_scale), grid.periodic
    deflection = Deflection(grid.increments, *law, share.owned, transposition)
    problem = problem_of(case, scales, film_scale, share, deflection, has_sides, bound_tolerance)
    exchange = PlaneExchange(problem, ranks, grid.periodic)
    return PlaneFields(problem, exchange, PlaneMatrices(problem, exchange, ranks), comm)
