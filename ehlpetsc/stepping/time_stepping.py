"""From the start to the end of a run: steady solution, time steps, retries.

The first guess of a step is :mod:`.predictor`'s. A step that does not converge is halved and counted;
:mod:`.step_control` leads back to the nominal one.
"""

from dataclasses import dataclass, field, replace

import numpy as np

from ehlpetsc.discretisation.reynolds import FilmHistory, mirrored
from ehlpetsc.errors import NoSteadyStart, NotConverged, SolveFailed
from ehlpetsc.nonlinear import events
from ehlpetsc.stepping.certificate import solve_checked
from ehlpetsc.stepping.predictor import TimeLevel, predict
from ehlpetsc.stepping.steady_start import steady
from ehlpetsc.stepping.step_control import LEVEL, next_step

GROWTH = 1.0  # half widths at the mean speed, over which roughness at rest grows where it has to
SMALLEST = 2.0**-12  # of the nominal step: below it a step is given up


@dataclass
class State:
    """One time level and what the next step needs of the past; arrays of shape (nx,), dimensionless.

    Attributes
    ----------
    q, w, h00
        Unknowns (see :mod:`ehlpetsc.discretisation.contact`).
    p, h
        Pressure and film; direct contact's w is the film itself.
    m, m_older
        Film contents of this level and the one before (None: none).
    time, dt
        [s]; `dt` is the step that led here (None at the start).
    step
        Number of steps taken.
    travelled
        Ways of the fast and the slow surface since time 0 [m], signed.
    earlier
        The two levels before this one, latest first.
    imbalance
        Reynolds' rows F of the solution.
    sets
        Permanent sets of the fast and the slow body; empty where solids are elastic.
    depth
        What this step has added to both together, in a^2/R (None: elastic).
    """

    q: np.ndarray
    w: np.ndarray
    h00: float
    p: np.ndarray | None = None
    h: np.ndarray | None = None
    m: np.ndarray | None = None
    m_older: np.ndarray | None = None
    time: float = 0.0
    dt: float | None = None
    step: int = 0
    travelled: tuple = (0.0, 0.0)
    earlier: tuple = ()
    newton: int = 0
    retries: int = 0
    imbalance: np.ndarray = field(default=None, repr=False)
    sets: tuple = field(default=(), repr=False)
    depth: np.ndarray | None = field(default=None, repr=False)

    @property
    def level(self):
        """What predictors of later steps need of this one."""
        return TimeLevel(0.5 * sum(self.travelled), self.q, self.w)


class TimeStepping:
    """Steady and transient solution of one scene.

    Parameters
    ----------
    solver : newton.NewtonSolver or gauss_seidel.GaussSeidelSolver
    scales : scales.Scales
    operation : physics.operation.ConstantOperation
    roughness : roughness.Roughness or None
    film : float
        Expected film in a^2/R.
    bodies : surfaces.permanent_set.BothBodies, optional
        Of solids that yield, or have yielded before.
    sets : pair of PermanentSet, or empty
        What they have yielded before.

    Attributes
    ----------
    smooth : pair of ndarray
        Steady q and w that the predictor starts from.
    before : float
        For how long before time 0 roughness at rest has grown [s]; 0 where a steady solution was found.
    """

    def __init__(self, solver, scales, operation, roughness, film, bodies=None, sets=()):
        self.solver, self.problem, self.scales, self.film = solver, solver.problem, scales, film
        self.operation = operation
        self.roughness, self.bodies, self.sets = roughness, bodies, sets
        self.smooth, self.before = None, 0.0

    def phi(self, travelled, sets=()):
        """What roughness and permanent sets add to the gap, in a^2/R: means over the cells of the mesh.

        Parameters
        ----------
        travelled : (float, float)
            Ways of the fast and the slow surface [m].
        sets : pair of PermanentSet, or empty
        """
        phi = np.zeros(self.problem.n)
        with events.ROUGHNESS:
            if self.roughness is not None:
                places, cell = self.scales.x * self.scales.a, self.scales.dx
                phi += self.roughness.phi_after(places, travelled, cell) / self.scales.h
            if sets:
                phi += sum(self.bodies.depths(sets, travelled)) / self.scales.h
        return phi

    def start(self):
        """Steady solution at time 0 or, under roughness at rest that has none in reach, one marched to."""
        phi = self.phi((0.0, 0.0), self.sets)
        try:
            state = self._steady(phi)
        except NoSteadyStart as error:
            if self.scales.dt is None or self.problem.fluid is None or not phi.any():
                raise NotConverged(f"steady start: {error}") from error
            state = self._marched()
        self.smooth = (state.q, state.w)
        return state

    def _steady(self, phi):
        inputs = self.problem.inputs(phi, conditions=self.operation.at(0.0))
        solution, newton, imbalance = self._inlet_first(inputs, lambda i: steady(self.solver, self.film, i))
        return self._state(*solution, imbalance=imbalance, newton=newton, sets=self.sets)

    def _inlet_first(self, inputs, solve, *nodal):
        """Solve with the inlet at the first node: mirrored where the entrainment speed is negative.

        Parameters
        ----------
        inputs : ehl_problem.StepInputs
        solve : callable
            Of inputs and the arrays `nodal`; returns q, w, h00 and the number of iterations.
        *nodal : ndarray, shape (nx,)

        Returns
        -------
        solution : (q, w, h00)
        iterations : int
        imbalance : ndarray, shape (nx,)
            Reynolds' rows at the solution.
        """
        if inputs.conditions.entrainment >= 0.0:
            *solution, iterations = solve(inputs, *nodal)
            return solution, iterations, self.solver.mass_imbalance()
        q, w, h00, iterations = solve(inputs.mirrored(), *map(mirrored, nodal))
        return (mirrored(q), mirrored(w), h00), iterations, mirrored(self.solver.mass_imbalance())

    def _marched(self):
        """The state at time 0 of a film into which roughness at rest has grown by time steps before.

        It lies under the film from the start, where Newton's method may find no way to it; that of a moving
        body comes in through the inlet. The growth takes the way `GROWTH` of the mean speed.
        """
        try:
            state = self._steady(np.zeros(self.problem.n))
        except NoSteadyStart as error:
            raise NotConverged(f"steady start: {error}") from error
        dt, newton = self.operation.time_step(0.0, self.scales.dt), state.newton
        self.before = np.ceil(GROWTH * self.scales.a / self.scales.u / dt) * dt
        state = replace(state, time=-self.before, travelled=self.operation.displacement(0.0, -self.before))
        self.smooth = (state.q, state.w)
        while state.time < -LEVEL * dt:
            state = self.advance(state)
            newton += state.newton
        begun = {"time": 0.0, "travelled": (0.0, 0.0), "step": 0, "newton": newton}
        return replace(state, **begun, retries=0, dt=None, m_older=None, earlier=())

    def _grown(self, time):
        """Share of the roughness that has grown at a time before 0 [s]; all from there on."""
        r = 1.0 + time / self.before if time < 0.0 else 1.0
        return r * r * r * (10.0 - r * (15.0 - 6.0 * r))

    def _state(self, q, w, h00, *, sets, travelled=(0.0, 0.0), **more):
        model = self.problem.model
        nodes, m = model.state(q, w), self.problem.content(q, w)
        p, h = nodes.pressure, nodes.film
        if nodes.plastic is not None:
            more["depth"] = nodes.plastic.depth
            sets = self.bodies.laid_down(sets, travelled, self.scales.h * more["depth"])
        q, w = model.reset_yielding(q, w)
        return State(q, w, h00, p=p, h=h, m=m, travelled=travelled, sets=sets, **more)

    def guess(self, state, dt):
        """Start of Newton's iteration for a step of dt [s]."""
        if self.roughness is None or self.problem.fluid is None:
            return state.q, state.w
        levels = (state.level, *state.earlier)
        then = 0.5 * sum(self._travelled(state, dt))
        nodes = [(then - level.travelled) / self.scales.dx for level in levels]
        return predict(self.problem, TimeLevel(0.0, *self.smooth), levels, nodes)

    def _travelled(self, state, dt):
        """Ways of both surfaces [m] after a step of dt [s]."""
        return tuple(map(sum, zip(state.travelled, self.operation.displacement(state.time, dt), strict=True)))

    def _inputs(self, state, dt):
        history = None
        if self.problem.fluid is not None:
            unit = self.scales.u / self.scales.a
            older = None if state.dt is None else state.dt * unit
            history = FilmHistory(state.m, state.m_older, dt * unit, older)
        phi = self._grown(state.time + dt) * self.phi(self._travelled(state, dt), state.sets)
        return self.problem.inputs(phi, history, self.operation.at(state.time + dt), dt)

    def _solve(self, inputs, q, w, h00):
        """As of the solver; where solids yield, failing that, from what they would do elastically."""
        elastic = self.problem.model.elastic()
        try:
            return solve_checked(self.solver, q, w, h00, inputs)
        except SolveFailed as error:
            if elastic is None:
                raise
            spent = error.iterations
        try:
            *begin, more = solve_checked(self.solver, q, w, h00, replace(inputs, contact=elastic))
            spent += more
            *state, more = solve_checked(self.solver, *begin, inputs)
        except SolveFailed as error:
            error.iterations += spent
            raise
        return *state, spent + more

    def advance(self, state, dt=None):
        """One accepted time step of `dt` [s], by default the step control's; halved as needed."""
        nominal = self.operation.time_step(state.time, self.scales.dt)
        left = self.operation.time_left(state.time, nominal)
        dt = dt or next_step(state.dt, state.retries, nominal, left)
        retries = newton = 0
        while True:
            guess = self.guess(state, dt) if retries == 0 else (state.q, state.w)
            try:
                solution, iterations, imbalance = self._inlet_first(
                    self._inputs(state, dt), lambda i, q, w: self._solve(i, q, w, state.h00), *guess
                )
                break
            except SolveFailed as error:
                newton, retries = newton + error.iterations, retries + 1
                dt *= 0.5
                if dt < SMALLEST * nominal:
                    raise NotConverged(
                        f"step {state.step + 1}, time {state.time:.6e} s: {error}, also with a step of "
                        f"{dt:.2e} s. Try a smaller time.courant, a finer mesh or a higher viscosity"
                    ) from error
        return self._state(
            *solution,
            imbalance=imbalance,
            m_older=state.m,
            time=state.time + dt,
            travelled=self._travelled(state, dt),
            sets=state.sets,
            dt=dt,
            step=state.step + 1,
            newton=newton + iterations,
            retries=retries,
            earlier=(state.level, *state.earlier[:1]),
        )
