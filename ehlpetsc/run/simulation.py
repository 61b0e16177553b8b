"""Simulation of one case on the ranks of a communicator."""

from __future__ import annotations

import threading
import time as clock
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from os import PathLike
from typing import Any

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from ehlpetsc.base.case import KINDS
from ehlpetsc.base.errors import CaseError, NoSteadyStart, NotConverged, Stopped, UsageError
from ehlpetsc.case.loading import Case, load
from ehlpetsc.case.tables.surface import check_unchanged
from ehlpetsc.discretisation.unknowns import Unknowns
from ehlpetsc.effects import effects_of
from ehlpetsc.effects.scene import Scene
from ehlpetsc.nonlinear import solver_of
from ehlpetsc.nonlinear.newton import NewtonSolver
from ehlpetsc.nonlinear.options import START, TIME_STEPS, RunOptions
from ehlpetsc.nonlinear.ranks import Columns
from ehlpetsc.physics import operation_of
from ehlpetsc.physics.film_formulas import expected_film
from ehlpetsc.physics.scales import NODE_TOLERANCE, Scales
from ehlpetsc.run.forecast.domain import cures, domain_faults
from ehlpetsc.run.ranks import StopRequest, on_root
from ehlpetsc.stepping.convergence_check import Watch, check_ends
from ehlpetsc.stepping.observables import diagnostics
from ehlpetsc.stepping.state import State
from ehlpetsc.stepping.steady_start import coarser, guess_of
from ehlpetsc.stepping.time_stepping import LAST_OF_RAMP, TimeStepping

MONITORS = ("snes_monitor", "snes_vi_monitor", "snes_converged_reason", "ksp_monitor", "ksp_converged_reason")
MIN_COARSE_POINTS = 50  # on the half-width: coarsest mesh of a start for a finer one that fails without
MIN_HEATED_POINTS = 8  # on the half-width of the start: coarsest mesh of one with heat
FINEST_NODES = 60_000  # of a mesh whose rough start takes one coarser mesh alone
MANY_NODES = 20_000  # from here on a start on a coarser mesh costs less than it saves
PETSC_LOCK = threading.RLock()  # one thread at a time calls PETSc, which is not made for more
LAST_STEP_RATIO = 1e-9  # smallest time step over the nominal one


@dataclass(frozen=True)
class AcceptedState:
    """Accepted time level of a simulation; every scalar and field is also an attribute.

    Attributes
    ----------
    scalars
        Scalars of the step, as in ``steps/`` of a result file [SI units].
    fields : shape (nx,), of a plane (ny, nx)
        Fields of the step [SI units].
    in_contact : shape as of the fields
    dimensionless
        The same in the units of the equations, with the history for the next step.
    """

    scalars: dict
    fields: dict = field(repr=False)
    in_contact: np.ndarray = field(repr=False)
    dimensionless: State = field(repr=False)

    def __getattr__(self, name: str) -> Any:
        for values in (vars(self).get("scalars", {}), vars(self).get("fields", {})):
            if name in values:
                return values[name]
        raise AttributeError(name)


class Simulation:
    """Simulation of a case, an iterable over its accepted states.

    The iteration begins with the steady solution at time 0 and ends at the travel of the case; it can be
    interrupted and continued. After :meth:`resume` it continues from the state of a restart file.

    Parameters
    ----------
    comm
        Ranks of the simulation, all of which iterate. Default: this process alone.
    options
        PETSc options without the dash, ``{"snes_max_it": 50, "snes_monitor": None}``, which override all
        others and are in PETSc's table under a prefix of this simulation.
    after
        Previous pass of the same case, at its end, whose bodies meet again with their plastic deformation and
        wear.
    pass_number
        Number of a pass that is continued from a restart file; by default it follows from `after`. With a
        fraction surface 2 is shifted by that part of `time.pass_shift`.
    records
        Records of effects by name with which the pass begins, instead of those of `after`.

    Attributes
    ----------
    scales : physics.scales.Scales
    operation : physics.operation.ConstantOperation
        Load, radius and speeds over time.
    roughness : surfaces.roughness.Roughness or None
    scene : effects.scene.Scene
        Case, scales, operation and the positions of both surfaces at the beginning of this run.
    options : nonlinear.options.RunOptions
        Of PETSc's solvers.
    stepper : stepping.time_stepping.TimeStepping
    pass_number : float
        Number of the pass of both bodies over each other, from 1.
    state : AcceptedState or None
        Last state of this process.
    dimensionless : stepping.state.State or None
        The same in the units of the equations, or the state of a restart file.

    Raises
    ------
    CaseError
        The case is faulty, or it is a series.
    UsageError
        An impossible option, or a pass that cannot follow the previous one.

    Examples
    --------
    >>> import ehlpetsc
    >>> short = {"mesh.points_per_half_width": 20, "time.travel": 0.1}
    >>> simulation = ehlpetsc.Simulation(ehlpetsc.load("cases/ridge.toml", short))
    >>> [state.step for state in simulation]
    [0, 1, 2]
    >>> print(simulation.state.pressure.shape, simulation.state.h_min < 1e-6)  # Pa, m
    (81,) True
    """

    def __init__(
        self,
        case: Case | dict | str | PathLike,
        comm: MPI.Comm | None = None,
        options: dict | None = None,
        after: Simulation | None = None,
        pass_number: float | None = None,
        records: dict | None = None,
    ) -> None:
        self.case = case = case if isinstance(case, Case) else load(case)
        if case.series:
            one_by_one = "solve its members one by one, ehlpetsc.members(case)"
            raise CaseError([f"{case.path}: a [series]: {one_by_one}"])
        self.comm = comm or MPI.COMM_SELF
        given = case.petsc, _option_texts(options or {})
        self.options = RunOptions(case.contact.law, *given, case.kind, is_dry=case.fluid is None)
        self._options = options
        on_root(self.comm, check_unchanged, case)
        self.scales = Scales.of(case)
        self.operation = operation_of(case, self.scales)
        self.pass_number: float = pass_number or (after.pass_number + 1 if after else 1)
        if after and not (after.finished and self._is_of_contact(after)):
            raise UsageError("after: allowed: a pass at its end, on the same nodes, of the same contact law")
        if faults := domain_faults(case, self.scales):
            raise CaseError(faults)
        self._beyond_mesh = None
        if KINDS[case.kind].surroundings:
            around = KINDS[case.kind].part("surroundings")(case, self.scales, self._solved)
            self.scales, self._beyond_mesh = around
        columns = Columns(self.comm, self.scales.grid.shape[-1]) if self.comm.size > 1 else None
        self.scene = Scene.of_pass(case, self.scales, self.operation, self.pass_number, columns)
        self.roughness = self.scene.roughness
        self._film = film = expected_film(case, self.scales)
        self.state: AcceptedState | None = None
        self.dimensionless: State | None = None
        with PETSC_LOCK:
            solver = solver_of(case, self.scales, film, PETSc.Comm(self.comm), self.options)
        before = after.dimensionless.records if after else records or {}
        self.stepper = TimeStepping(solver, self.scene, effects_of(self.scene, before), film)
        self._records = {e.name: e.start(before.get(e.name)) for e in self.stepper.effects}

    def _is_of_contact(self, other: Simulation) -> bool:
        """Whether another simulation has the same nodes and contact law."""
        (mesh, law), of_other = ((s.case.mesh, s.case.contact.law) for s in (self, other))
        is_equal = abs(self.scales.a - other.scales.a) < NODE_TOLERANCE * self.scales.a
        return is_equal and (mesh, law) == of_other

    @property
    def finished(self) -> bool:
        """Whether the last state is at the end of the travel; of a steady case, whether it is solved."""
        if self.dimensionless is None:
            return False
        return self.case.time is None or self._time_left() == 0.0

    @property
    def end(self) -> float:
        """Time of the end of the run [s]."""
        return self.dimensionless.time + self._time_left()

    def _time_left(self) -> float:
        return self.operation.remaining(self.dimensionless.time, self.dimensionless.travelled)

    def __iter__(self) -> Iterator[AcceptedState]:
        return self.states()

    def states(self, stop: StopRequest | None = None) -> Iterator[AcceptedState]:
        """Accepted states up to the end.

        `stop`: called with the communicator: before every time step, whether to stop; in every iteration,
        whether to abandon the step in progress. Raises `Stopped NotConverged`.
        """
        while not self.finished:
            begun = self.dimensionless is not None
            if begun and stop and stop(self.comm):
                raise Stopped
            watch = partial(_raise_if_stopped, stop.overdue if begun else stop, self.comm) if stop else None
            yield self.advance(watch=watch)

    def resume(self, state: State, baseline: tuple[np.ndarray, np.ndarray]) -> None:
        """Continue from a time level; `baseline` are steady q and w for the predictor."""
        solver = self.stepper.solver
        effects = effects_of(self.scene, state.records)
        self.stepper = TimeStepping(solver, self.scene, effects, self._film, baseline)
        records = {e.name: state.records.get(e.name) or e.start() for e in effects}
        m = solver.problem.mass_per_area(state.q, state.w) if state.m is None else state.m
        self.dimensionless = replace(state, records=records, m=m)

    def advance(self, dt: float | None = None, watch: Watch | None = None) -> AcceptedState:
        """Solve the steady contact, at later calls one time step.

        `dt`: length of the step [s]; by default that of the case, shorter after halved steps. `watch`: called
        in every iteration on every rank; an exception from it ends the solve.

        Raises
        ------
        NotConverged
            Its `state` is the last accepted state.
        UsageError
            No such time step is possible, or the simulation is at its end.
        """
        self._check_time_step(dt)
        started, gmres = clock.monotonic(), self._linear_iterations
        with PETSC_LOCK:
            try:
                state = self._start(watch) if self.dimensionless is None else self._step(dt, watch)
                check_ends(self.scales.grid, state.p, state.solution.loads.contact_mask)
                self.dimensionless = state
            except NotConverged as error:
                raise NotConverged(str(error), self.state) from error
        problem, effects = self.stepper.problem, self.stepper.effects
        scalars, fields, in_contact = diagnostics(
            self.scene, problem, effects, state, started, self._smooth_film
        )
        scalars |= {"step": state.step, "time": state.time, "gmres": self._linear_iterations - gmres}
        shape = self.scales.grid.shape
        fields = {name: values.reshape(shape) for name, values in fields.items()}
        self.state = AcceptedState(scalars, fields, in_contact.reshape(shape), state)
        return self.state

    @cached_property
    def _smooth_film(self) -> float:
        """Minimum film of the smooth contact over that of the formulas; asked for after the start."""
        if self.case.fluid is None:
            return 1.0
        from ehlpetsc.stepping.smooth_film import computed_over_expected

        return computed_over_expected(self.scene, self.stepper.problem, self.stepper.baseline)

    @property
    def _linear_iterations(self) -> int:
        """GMRES iterations so far on the mesh of the case."""
        return self.stepper.solver.linear_iterations

    def _check_time_step(self, dt: float | None) -> None:
        """Refuse an impossible length of a time step [s], and a step after the end."""
        if self.finished:
            raise UsageError("advance: the simulation is at its end")
        if dt is None:
            return
        if self.dimensionless is None:
            raise UsageError(f"dt = {dt!r}: the first state is the steady start, which has no time step")
        left, shortest = self._time_left(), LAST_STEP_RATIO * self.scales.dt
        if not shortest <= dt <= left * (1.0 + NODE_TOLERANCE):
            raise UsageError(f"dt = {dt!r}: allowed: a number from {shortest:.3g} to the {left:.6g} s left")

    def _start(self, watch: Watch) -> State:
        with START:
            try:
                state = self._started(watch)
            except NotConverged as error:
                if isinstance(error.__cause__, NoSteadyStart):
                    advice = cures(self.case, self.scales, self.operation.at(0.0), self._film)
                    raise NotConverged(f"{error}{advice}") from error.__cause__
                raise
        if isinstance(self.stepper.solver, NewtonSolver):
            for name in self.options.deferred_views:
                snes = self.stepper.solver.snes
                (snes if name == "snes_view" else snes.ksp).view()
        return state

    def _started(self, watch: Watch) -> State:
        failures, begun = [], self._ramped(watch)
        for guess, records in self._guesses(watch):
            self._print_heading(f"steady start on {self.scales.grid.n} nodes")
            try:
                return self.stepper.start(self._records | records, watch, guess, begun)
            except NotConverged as error:
                if not isinstance(error.__cause__, NoSteadyStart):
                    raise
                failures.append(error)
        raise failures[-1]

    def _guesses(self, watch: Watch) -> Iterator[tuple[Unknowns | None, dict]]:
        """Guesses of the steady state, one after the other, with records of effects; None: by Hertz.

        The solution on a coarser mesh, if any, is the first one where there are many nodes, or heat, as
        pressure spikes move by a node an iteration when the film changes; else the last.
        """
        case, points = self.case, self.case.mesh.points_per_half_width
        is_hertz = case.fluid is None and self.roughness is None and not KINDS[case.kind].has_ends
        resolved = points * self.scales.size(self.operation.at(0.0))
        is_heated = case.heat is not None and case.fluid is not None and resolved >= 2 * MIN_HEATED_POINTS
        is_first = is_heated or self.scales.grid.n > MANY_NODES and not is_hertz
        if self._beyond_mesh:
            yield self._beyond_mesh(self.stepper.problem), {}
        if not is_first:
            yield None, {}
        coarse = self._coarse_guess(watch) if is_first or points >= 2 * MIN_COARSE_POINTS else None
        if coarse is not None:
            yield coarse
        if is_first:
            yield None, {}

    def _solved(self, case: Case) -> Simulation:
        """Simulation of the steady case around this one, solved; a CaseError without a solution."""
        simulation = Simulation(case, self.comm, self._options)
        try:
            simulation.advance()
        except NotConverged as error:
            raise CaseError([f"{case.path}: the smooth {case.kind} beside the mesh: {error}"]) from error
        return simulation

    def _coarse_guess(self, watch: Watch) -> tuple[Unknowns, dict] | None:
        """Steady solution on a mesh with half as many nodes per half-width; None: there is none."""
        try:
            coarse = Simulation(coarser(self.case), self.comm, self._options)
            coarse.advance(watch=watch)
        except (CaseError, NotConverged, UsageError):
            return None
        state = coarse.dimensionless
        effects = {e.name: e for e in self.stepper.effects}
        found = {name: effects[name].interpolated(r, coarse.scales) for name, r in state.records.items()}
        records = {name: record for name, record in found.items() if record is not None}
        return guess_of(state, coarse.stepper.problem, self.stepper.problem), records

    def _ramped(self, watch: Watch) -> State | None:
        """State during a rough start on a coarser mesh, interpolated; None: no such ramp, or no solution."""
        if self.case.time is None or self.case.time.ramp == "fine":
            return None
        nested = "coarse" if self.scales.grid.n > FINEST_NODES else "fine"
        coarse = Simulation(coarser(self.case, nested), self.comm, self._options)
        begun = coarse._ramped(watch)
        for guess, records in coarse._guesses(watch):
            with suppress(NotConverged):
                state = coarse.stepper.ramped(coarse._records | records, watch, guess, begun, LAST_OF_RAMP)
                of_mesh = guess_of(state, coarse.stepper.problem, self.stepper.problem)
                return replace(state, unknowns=of_mesh)
        return None

    def _step(self, dt: float | None, watch: Watch) -> State:
        self._print_heading(f"step {self.dimensionless.step + 1} from {1e6 * self.dimensionless.time:.4f} us")
        with TIME_STEPS:
            return self.stepper.advance(self.dimensionless, dt, watch)

    def _print_heading(self, text: str) -> None:
        """Print a heading above the output of PETSc's monitors."""
        if any(name in self.options.given for name in MONITORS):
            PETSc.Sys.Print(text, comm=self.comm)


def _raise_if_stopped(is_requested: Callable, comm: MPI.Comm) -> None:
    if is_requested(comm):
        raise Stopped


def _option_texts(options: dict) -> dict[str, str]:
    """PETSc options as strings by name, from None, True, False, numbers and strings."""
    texts = {}
    for name, value in options.items():
        texts[name] = "" if value is None else str(value).lower() if isinstance(value, bool) else str(value)
        if not (f"{name}{texts[name]}").isprintable():  # PETSc would end the process
            raise UsageError(f"options: {name!r}: {value!r}: allowed: names and values in one line of text")
    return texts
