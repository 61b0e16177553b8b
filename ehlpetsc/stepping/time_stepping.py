"""Time stepping of a run: steady solution, time steps, retries.

The initial guess of a step is that of :mod:`.state`. A step that does not converge is halved and counted;
:func:`next_step` returns to the nominal step.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from ehlpetsc.base.counts import COUNT_TOLERANCE, whole_up
from ehlpetsc.base.errors import NoSteadyStart, NotConverged, SolveFailed
from ehlpetsc.discretisation.ehl_problem import Solution
from ehlpetsc.discretisation.film_history import FilmHistory, FilmLevels, film_history
from ehlpetsc.discretisation.step_inputs import StepInputs, mirrored
from ehlpetsc.discretisation.unknowns import Unknowns
from ehlpetsc.effects.effect import Effect, Step
from ehlpetsc.effects.scene import Scene
from ehlpetsc.nonlinear.options import ROUGHNESS
from ehlpetsc.physics.scales import Scales
from ehlpetsc.stepping.convergence_check import Solver, Watch, solve_step
from ehlpetsc.stepping.state import State, TimeLevel, predict
from ehlpetsc.stepping.steady_start import steady

if TYPE_CHECKING:
    from ehlpetsc.base.declarations import Values
    from ehlpetsc.physics import Operation
    from ehlpetsc.physics.variable_operation import VariableOperation
    from ehlpetsc.stepping.step_control import StepControl

REST_SPEED = 1e-9  # of the scales' speed: a slower film is at rest
REST_RAMP_LENGTH = 1.0  # half-widths of entrained distance over which roughness at rest is ramped up
LAST_OF_RAMP = 0.15  # of it: what a mesh does itself that takes its state from a coarser one
MAX_STEADY_SOLUTIONS = 60  # of a steady start, in turn with the records of the effects
MIN_STEP_RATIO = 2.0**-12  # smallest step over the nominal one
MAX_STEP_RATIO = 2.0  # of successive steps; BDF2 is stable up to 2.4
NEARLY_NOMINAL = 1.5  # a step within this factor of the nominal step is followed by the nominal step


def next_step(dt: float | None, retries: int, nominal: float, left: float) -> float:
    """Size of the next time step [s], of which a whole number ends on the next time level.

    After halved steps the run thus returns to the time levels that the members of a series have in common.
    The size does not increase directly after a halved step, because a longer step would mostly fail too.

    `dt`: last step [s]; None at the start. `retries`: number of times that the last step was halved.
    `nominal`: nominal step [s]. `left`: time to the next time level [s].
    """
    longest = nominal
    if dt is not None and NEARLY_NOMINAL * dt < nominal:
        longest = dt if retries else MAX_STEP_RATIO * dt
    return left / whole_up(left / longest)


def ramp_time(scales: Scales, dt: float) -> float:
    """Duration of the ramp of roughness at rest [s], a whole number of steps of `dt` [s]."""
    return whole_up(REST_RAMP_LENGTH * scales.a / scales.u / dt) * dt


def step_control(time: Values | None, operation: Operation) -> StepControl | None:
    """Control of the steps of `[time]`; None: all steps are from one time level to the next."""
    if time is None or time.tolerance is None or not operation.varies:
        return None
    from ehlpetsc.stepping.step_control import StepControl

    return StepControl(time, cast("VariableOperation", operation))


class TimeStepping:
    """Steady and transient solution of one scene.

    `film`: expected film in a^2/R. `baseline`: steady q and w for the predictor of a resumed run; otherwise
    computed by :meth:`start`.

    `ramp_time`: time before time 0 over which roughness at rest was ramped up [s]; 0 after a steady solution.
    """

    def __init__(
        self,
        solver: Solver,
        scene: Scene,
        effects: list[Effect],
        film: float,
        baseline: tuple[np.ndarray, np.ndarray] | None = None,
    ):
        self.solver, self.problem, self.film = solver, solver.problem, film
        self.scene, self.scales, self.operation, self.effects = scene, scene.scales, scene.operation, effects
        self.baseline, self.ramp_time, self._is_prepared = baseline, 0.0, False
        self._show_ramp: Callable[[float], object] = lambda share: None
        time = scene.case.time
        self._starts_rough = time is not None and time.start == "rough" and self.problem.fluid is not None
        # the baseline is the steady solution of the start, which holds for constant conditions only
        self._is_rough = any(effect.moves_with_surfaces for effect in effects)
        self._advected = self._is_rough and not self.operation.varies
        self._control = step_control(time, self.operation)

    def start(
        self, records: dict, watch: Watch = None, guess: Unknowns | None = None, begun: State | None = None
    ) -> State:
        """Steady state at time 0 from the records of the effects, or a guess from a coarser mesh.

        By time steps if roughness at rest prevents convergence, or if the case starts rough.

        `begun`: state during these steps, with which they begin.
        """
        if self._starts_rough:  # its baseline for the predictor is the smooth state before the ramp
            return self._start_by_time_stepping(records, watch, guess, begun)
        inputs = self._with_effects(self._inputs_of(self._step_end()), records, self._step_end())
        try:
            state = self._steady(inputs, records, watch, guess)
        except NoSteadyStart as error:
            if self.scales.dt is None or self.problem.fluid is None or not inputs.phi.any():
                raise NotConverged(f"steady start: {error}") from error
            state = self._start_by_time_stepping(records, watch)
        self.baseline = (state.q, state.w)
        return state

    def _steady(
        self, inputs: StepInputs, records: dict, watch: Watch, guess: Unknowns | None = None
    ) -> State:
        solved, newton = self._inlet_first(
            inputs, guess, lambda i, begin: steady(self.solver, self.film, i, watch, begin)
        )
        state = self._state(solved, self._step_end(), records, newton=newton, m_older=solved.mass)
        return self._settled(state, inputs, records, watch)

    def _settled(self, state: State, inputs: StepInputs, before: dict, watch: Watch) -> State:
        """Steady solution consistent with the records of the effects, by repeated solves."""
        end, newton = self._step_end(), state.newton
        pairs: dict[str, list] = {e.name: [] for e in self.effects}
        for _ in range(MAX_STEADY_SOLUTIONS):
            if all(e.is_settled(before[e.name], state.records[e.name]) for e in self.effects):
                return state
            for name, of_effect in pairs.items():
                of_effect.append((before[name], state.records[name]))
            before = {e.name: e.mixed(pairs[e.name]) for e in self.effects}
            again = replace(self._with_effects(self._inputs_of(end), before, end), phi=inputs.phi)
            try:
                max_it = self.solver.start_iterations()
                solved, iterations = self._solve_step(again, state.unknowns, watch, max_it)
            except SolveFailed as error:
                raise NoSteadyStart(error) from error
            newton += iterations
            state = self._state(solved, end, before, newton=newton, m_older=solved.mass)
        raise NoSteadyStart(f"{MAX_STEADY_SOLUTIONS} solutions in turn with the effects")

    def _solve_step(
        self, inputs: StepInputs, guess: Unknowns, watch: Watch, max_it: int | None = None
    ) -> tuple[Solution, int]:
        return self._inlet_first(
            inputs, guess, lambda i, begin: solve_step(self.solver, begin, i, watch, max_it)
        )

    def _inlet_first(
        self,
        inputs: StepInputs,
        guess: Unknowns | None,
        solve: Callable[[StepInputs, Unknowns | None], tuple[Unknowns, int]],
    ) -> tuple[Solution, int]:
        """Solution and iterations with the inlet at the first node: mirrored if entrainment is negative.

        At rest the inlet is where the film last came from.
        """
        direction = inputs.conditions.entrainment
        if abs(direction) < REST_SPEED * self.scales.u and inputs.history is not None:
            direction = inputs.history.moved
        if direction >= 0.0:
            unknowns, iterations = solve(inputs, guess)
            residual = self.solver.residual().reynolds
        else:
            unknowns, iterations = solve(mirrored(inputs), mirrored(guess))
            unknowns, residual = mirrored(unknowns), mirrored(self.solver.residual().reynolds)
        return self.problem.solution(unknowns, residual, inputs), iterations

    def _start_by_time_stepping(
        self, records: dict, watch: Watch, guess: Unknowns | None = None, begun: State | None = None
    ) -> State:
        """State at time 0 after time steps during which roughness at rest is ramped up.

        Roughness at rest is under the film from the start, where Newton's method may not converge; the
        roughness of a moving body enters through the inlet. The ramp ends after an entrained distance of
        `REST_RAMP_LENGTH`.
        """
        state = self.ramped(records, watch, guess, begun)
        at_zero: dict[str, Any] = {"time": 0.0, "travelled": (0.0, 0.0), "step": 0}
        return replace(state, **at_zero, retries=0, dt=None, m_older=None, earlier=())

    def ramped(
        self, records: dict, watch: Watch, guess: Unknowns | None, begun: State | None, left: float = 0.0
    ) -> State:
        """State of the ramp of which at least a share is left; other arguments as of :meth:`start`."""
        try:
            end = self._step_end()
            inputs = self._with_effects(self._inputs_of(end), records, end)
            state = self._steady(replace(inputs, phi=np.zeros(self.problem.n)), records, watch, guess)
        except NoSteadyStart as error:
            raise NotConverged(f"steady start: {error}") from error
        dt, newton = self.operation.time_step(0.0, self.scales.dt), state.newton
        self.ramp_time = ramp_time(self.scales, dt)
        moved = self.operation.displacement(0.0, -self.ramp_time)
        frozen = {e.name: records[e.name] for e in self.effects if e.frozen_before_start}
        state = replace(state, time=-self.ramp_time, travelled=moved, records=state.records | frozen)
        self.baseline = (state.q, state.w)
        if begun is not None:
            m = self.problem.mass_per_area(begun.q, begun.w)
            state = replace(state, unknowns=begun.unknowns, m=m, m_older=None)
            state = replace(state, time=begun.time, travelled=begun.travelled)
        before = left * self.ramp_time + (dt if left else COUNT_TOLERANCE * dt)  # steps may be coarse
        max_it = None if begun is None else self.solver.start_iterations()  # asperities overlap between nodes
        while state.time < -before:
            state, max_it = self.advance(state, watch=watch, max_it=max_it), None
            state, newton = replace(state, records=state.records | frozen), newton + state.newton
            self._show_ramp(1.0 + state.time / self.ramp_time)
        return replace(state, newton=newton)

    def show_ramp(self, show: Callable[[float], object]) -> None:
        """Have a function called with the share of the ramp that each of its steps has reached."""
        self._show_ramp = show

    def _roughness_ramp(self, time: float) -> float:
        """Factor of the roughness: from 0 to 1 before time 0 [s], then 1."""
        r = 1.0 + time / self.ramp_time if time < 0.0 else 1.0
        return r * r * r * (10.0 - r * (15.0 - 6.0 * r))

    def _step_end(self, state: State | None = None, dt: float | None = None) -> Step:
        if state is None:
            return Step(0.0, None, (0.0, 0.0), self.operation.at(0.0))
        moved = self.operation.displacement(state.time, dt)
        travelled = tuple(map(sum, zip(state.travelled, moved, strict=True)))
        return Step(state.time + dt, dt, travelled, self.operation.at(state.time + dt))

    def _inputs_of(self, step: Step, history: FilmHistory | None = None) -> StepInputs:
        return self.problem.inputs(history=history, conditions=step.conditions, dt=step.dt)

    def _with_effects(self, inputs: StepInputs, records: dict, step: Step) -> StepInputs:
        with ROUGHNESS:
            for effect in self.effects:
                inputs = effect.inputs(records[effect.name], inputs, step)
        return inputs

    def inputs(self, state: State, dt: float) -> tuple[Step, StepInputs]:
        """Step of `dt` [s] from a state, and the inputs of its solve."""
        history = None if self.problem.fluid is None else self.history(state, dt)
        step = self._step_end(state, dt)
        inputs = self._with_effects(self._inputs_of(step, history), state.records, step)
        if step.time < 0.0:
            inputs = replace(inputs, phi=self._roughness_ramp(step.time) * inputs.phi)
        return step, inputs

    def history(self, state: State, dt: float) -> FilmHistory:
        """Masses per area of the film at the level of a state and before, for a step of `dt` [s]."""
        rows, unit = self.problem.grid.rows, self.scales.u / self.scales.a
        dt_older = state.dt or dt  # before a steady start the film was as it is
        moved = self._nodes_moved(state.time, dt), self._nodes_moved(state.time - dt_older, dt_older)
        masses = rows(state.m), None if state.m_older is None else rows(state.m_older)
        levels = FilmLevels(*masses, dt * unit, dt_older * unit, *moved)
        has_smooth = levels.is_long and self._advected and self.baseline is not None
        smooth = rows(self.problem.mass_per_area(*self.baseline)) if has_smooth else None
        return film_history(levels, self._is_rough, smooth, not self.scales.across.varies)

    def _nodes_moved(self, time: float, dt: float) -> float:
        """Distance of the film from a time [s] on in a step of `dt` [s], in nodes."""
        return 0.5 * sum(self.operation.displacement(time, dt)) / self.scales.spacing

    def _state(self, solution: Solution, end: Step, records: dict, **entries: Any) -> State:
        accepted = {e.name: e.accept(records[e.name], solution, end) for e in self.effects}
        unknowns = solution.unknowns
        q, w = self.problem.model.reset_yielding(unknowns.q, unknowns.w)
        return State(
            unknowns._replace(q=q, w=w),
            solution,
            m=solution.mass,
            time=end.time,
            dt=end.dt,
            travelled=end.travelled,
            records=accepted,
            **entries,
        )

    def guess(self, state: State, dt: float) -> tuple[np.ndarray, np.ndarray]:
        """Initial guess of q and w for a step of `dt` [s]."""
        if not self._advected or self.problem.fluid is None:
            return state.q, state.w
        levels = (state.level, *state.earlier)
        entrained = 0.5 * sum(self._step_end(state, dt).travelled)
        nodes = [(entrained - level.travelled) / self.scales.spacing for level in levels]
        baseline, as_rows = TimeLevel(0.0, *self.baseline), self.problem.grid.as_rows

        def at(columns: slice) -> np.ndarray:
            return as_rows(np.stack(predict(self.problem, baseline, levels, nodes, columns)))

        q, w = self.scene.over_columns(at)
        return q.ravel(), w.ravel()

    def _prepare(self, dt: float) -> None:
        """Prepare the solver, once, for time steps of `dt` [s] from the smooth contact."""
        if self._is_prepared or self.baseline is None or self.problem.fluid is None:
            return
        self._is_prepared = True
        q, w = self.baseline
        m = self.problem.mass_per_area(q, w)
        smooth = Unknowns(q, w, self.problem.balance.uniform(0.0))
        history = self.history(State(smooth, m=m, m_older=m, dt=dt), dt)
        self.solver.prepare(smooth, self.problem.inputs(history=history, dt=dt))

    def advance(
        self, state: State, dt: float | None = None, watch: Watch = None, max_it: int | None = None
    ) -> State:
        """State after one time step of `dt` [s], by default of the step control; halved as needed.

        `max_it`: iteration limit in place of that of a time step.
        """
        nominal = self.operation.time_step(state.time, self.scales.dt)
        levels, dt = (1, dt) if dt else self._length(state, nominal)
        self._prepare(nominal)
        retries = newton = 0
        while True:
            guess = self.guess(state, dt) if retries == 0 else (state.q, state.w)
            try:
                step, inputs = self.inputs(state, dt)
                unknowns = Unknowns(*guess, state.unknowns.border)
                solved, iterations = self._solve_step(inputs, unknowns, watch, max_it)
            except SolveFailed as error:
                newton, retries, levels = newton + error.iterations, retries + 1, 1
                dt *= 0.5
                if dt < MIN_STEP_RATIO * nominal:
                    raise NotConverged(
                        f"step {state.step + 1}, time {state.time:.6e} s: {error}, also with a step of "
                        f"{dt:.2e} s. Try a smaller time.courant, a finer mesh or a higher viscosity"
                    ) from error
                continue
            newton, film_error = newton + iterations, self._error(state, solved, step)
            if not (self._control and self._control.is_repeated(film_error, levels)):
                break
            levels = min(self._control.levels(dt, film_error, nominal), levels - 1)
            dt = self._control.operation.time_over(state.time, levels)
        return self._state(
            solved,
            step,
            state.records,
            m_older=state.m,
            step=state.step + 1,
            error=film_error,
            newton=newton,
            retries=retries,
            earlier=(state.level, *state.earlier[:1]),
        )

    def _length(self, state: State, nominal: float) -> tuple[int, float]:
        """Time levels that the next step spans, and its length [s]; `nominal`: to the next level [s]."""
        if self._control and state.time >= 0.0:
            levels = self._control.levels(state.dt, state.error, nominal, may_grow=not state.retries)
            if levels > 1:
                return levels, self._control.operation.time_over(state.time, levels)
        left = self.operation.time_left(state.time, nominal)
        return 1, next_step(state.dt, state.retries, nominal, left)

    def _error(self, state: State, solution: Solution, end: Step) -> float | None:
        """Relative error of the film in a step from a state; None without step control."""
        if self._control is None:
            return None
        levels, model = (state.level, *state.earlier), self.problem.model
        films = [solution.nodes.film, *(model.film(level.q, level.w) for level in levels)]
        times = [end.time, *(level.time for level in levels)]
        return self._control.error(films, times, solution.nodes.pressure)
