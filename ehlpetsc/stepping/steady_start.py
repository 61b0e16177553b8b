r"""Steady start of a run, with continuation for hard cases, or from the solution on a coarser mesh.

From the smoothed Hertz pressure and a film of 1.3 times Moes' central film, Newton's method takes 4 to 7
iterations for most oils and loads. It fails in two cases. Beyond about :math:`\alpha p_0=20` the pressures of
the exit spike oscillate, because the flow out of a node at high pressure hardly depends on that pressure;
shorter steps or other films do not help. With thick films, Eyring's flow is exponential in
:math:`hp_x/\tau_0`, which at the start may be in the hundreds.

Both are solved by continuation: first the same contact with a fraction s of the pressure-viscosity
coefficient and with :math:`\tau_0/s^4`, nearly Newtonian, s halved until Newton's method converges; then s
increases to 1, each solution the guess of the next one. Roughness under the film at the start is left out
and then added in the same way. Barus' law converges up to :math:`\alpha p_0=267`, and thick films converge
from first residuals of 1e50. Pseudo-time steps needed three times the iterations in contacts of the
first kind and did not always converge.

A starved inlet needs another guess, because the meniscus moves one node per iteration: void where the gap is
wider than the oil film. The flooded solution decides whether the contact starves: if it carries more oil than
the inlet supplies, the contact is starved; otherwise the flooded solution holds except at the first node.
At rest the oil film of the inlet is everywhere, with voids where the gap is wider.

If the Hertz pressure exceeds the yield pressure, the guess is the dry contact of
:func:`.first_guess.bounded_start`.

With a film far thinner than a layer of asperities, the guess is far from the solution, in which the layer
keeps oil in, and Newton's method may wander. The speed at which the film is as thick as the layer is easy,
and slower solutions differ little: six iterations lead to a tenth of the speed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from ehlpetsc.base.case import Case
from ehlpetsc.base.errors import NoSteadyStart, SolveFailed
from ehlpetsc.discretisation.ehl_problem import EHLProblem
from ehlpetsc.discretisation.step_inputs import IsothermalOil, StepInputs
from ehlpetsc.discretisation.unknowns import Unknowns
from ehlpetsc.physics.oil.rheology import SHEAR_LAWS, shear_law
from ehlpetsc.stepping.convergence_check import Solver, Watch, solve_checked
from ehlpetsc.stepping.first_guess import SMOOTHING, bounded_start, hertz_start, starved_start
from ehlpetsc.stepping.state import State

MIN_VISCOSITY_FRACTION = 2.0**-8  # of alpha: with less an oil is practically isoviscous
FIRST_LOAD_RATIO = 0.8  # of the load at which the Hertz pressure is the yield pressure
LOAD_GROWTH = 1.2  # factor from one load to the next
QUICK_ITERATIONS = 15  # after which a start that yields is tried otherwise
MIN_RAMP_INCREMENT = 1e-3  # of the fraction, from one solution to the next
NEAR_ITERATIONS = 30  # iterations from the solution on a coarser mesh, which is near or of no use
FILM_EXPONENT = 0.7  # of the speed in the film of a smooth contact
FIRST_SPEEDS = (1.0, 0.1, 0.01)  # over the speed of a film that hardly touches
SLOWING = 10.0  # ratio of two successive speeds of a start that begins at a higher speed
MIN_SLOWING = 1.1  # smaller ratios end it
MAX_ATTEMPTS = 100  # solves of one start, including failed ones


def steady(
    solver: Solver, film: float, inputs: StepInputs, watch: Watch = None, guess: Unknowns | None = None
) -> tuple[Unknowns, int]:
    """Steady solution, and the number of iterations with failed attempts; raise `NoSteadyStart` without one.

    `film` is the expected one in a^2/R, `guess` the solution on a coarser mesh.
    """
    problem, oil = solver.problem, inputs.inlet_film
    if guess is not None:
        return Continuation(solver, inputs, NEAR_ITERATIONS, watch).solve(guess)
    if problem.model.yield_pressure < 1.0:
        return yielding_start(solver, film, inputs, watch)
    if oil is None:
        # every node of the mesh may enter or leave the contact set, one an iteration
        max_it = problem.n if problem.fluid is None and solver.bounded else None
        return flooded_start(solver, film, inputs, watch, max_it)
    begin, iterations = flooded_start(solver, film, replace(inputs, inlet_film=None), watch)
    q, w, _ = begin
    if problem.mass_per_area(q, w)[-1] <= oil:
        q[0] = min(oil / problem.model.film(q, w)[0] - 1.0, 0.0)
    else:
        begin = starved_start(problem, film, inputs)
    # the meniscus may move over all nodes of the inlet, one an iteration
    solution, starved_iterations = Continuation(solver, inputs, problem.n, watch).solve(begin)
    return solution, iterations + starved_iterations


def flooded_start(
    solver: Solver, film: float, inputs: StepInputs, watch: Watch = None, max_it: int | None = None
) -> tuple[Unknowns, int]:
    """Start as of :func:`steady`, flooded or dry; a film below the layer by :func:`from_higher_speeds`."""
    problem, spent = solver.problem, 0
    if problem.fluid is not None and not inputs.rests and film < problem.model.touching_film:
        quick = SolveAttempts(solver, NEAR_ITERATIONS, watch)
        solution = quick(hertz_start(problem, film, inputs), inputs)
        if solution is None:
            solution = from_higher_speeds(quick, film, inputs)
        if solution is not None:
            return solution, quick.spent
        spent = quick.spent
    begin = hertz_start(problem, film, inputs)
    solution, iterations = Continuation(solver, inputs, max_it, watch).solve(begin)
    return solution, spent + iterations


def from_higher_speeds(attempt: SolveAttempts, film: float, inputs: StepInputs) -> Unknowns | None:
    r"""Steady solution by a series of falling speeds; None if one of them does not converge.

    The first one has a film that hardly touches, by :math:`h\sim u^{0.7}`, or a thinner one: the rows are
    scaled for the film at the end, and at a speed 1e5 times as high linear solves are not accurate enough.
    """
    problem, now = attempt.solver.problem, inputs.conditions

    def solved(begin: Unknowns, factor: float) -> Unknowns | None:
        return attempt(
            begin, replace(inputs, conditions=now._replace(u1=factor * now.u1, u2=factor * now.u2))
        )

    for excess in FIRST_SPEEDS:
        factor = (problem.model.touching_film / film) ** (1.0 / FILM_EXPONENT) * excess
        solution = solved(hertz_start(problem, film * factor**FILM_EXPONENT, inputs), factor)
        if solution is not None:
            break
    slowing = SLOWING
    while solution is not None and factor > 1.0:
        slower = solved(solution, max(factor / slowing, 1.0))
        if slower is not None:
            solution, factor, slowing = slower, max(factor / slowing, 1.0), SLOWING
            continue
        slowing **= 0.5
        if slowing < MIN_SLOWING:
            return None
    return solution


def yielding_start(
    solver: Solver, film: float, inputs: StepInputs, watch: Watch = None
) -> tuple[Unknowns, int]:
    """Start as of :func:`steady` for solids that yield at the Hertz pressure, from the dry contact.

    From the Hertz pressure all nodes in contact would yield at once, and a pressure at its bound
    everywhere does not depend on the load. Most films need smoothed edges of the flat pressure; thin
    films far above the yield pressure do not. For thick films the load is increased from the onset of
    yielding.
    """
    problem, quick = solver.problem, SolveAttempts(solver, QUICK_ITERATIONS, watch)
    for width in (SMOOTHING, 0.0):
        solution = quick(bounded_start(problem, film, inputs, width), inputs)
        if solution is not None:
            return solution, quick.spent
    attempt = SolveAttempts(solver, watch=watch, spent=quick.spent)
    # where faces leak the film behind the flat pressure depends less on the mesh, and is near the solution
    solution = attempt(bounded_start(problem, film, inputs, SMOOTHING), replace(inputs, leaks=True))
    if solution is not None:
        solution = attempt(solution, inputs)
    if solution is not None:
        return solution, attempt.spent
    load, reached = FIRST_LOAD_RATIO * problem.model.yield_pressure**2, 0.0
    solution = hertz_start(problem, film, replace(inputs, load_share=load))
    while reached < 1.0:
        nearer = attempt(solution, replace(inputs, load_share=load))
        if nearer is not None:
            solution, reached, load = nearer, load, min(load * LOAD_GROWTH, 1.0)
            continue
        load = 0.5 * (reached + load)
        if load < reached * (1.0 + MIN_RAMP_INCREMENT) or not reached:
            raise NoSteadyStart(attempt.failure)
    return solution, attempt.spent


class SolveAttempts:
    """Checked solves from given states, `MAX_ATTEMPTS` at most.

    `spent`: Newton iterations, failed attempts included. `failure`: last failure.
    """

    def __init__(self, solver: Solver, max_it: int | None = None, watch: Watch = None, spent: int = 0):
        self.solver, self.watch, self.max_it = solver, watch, solver.start_iterations(max_it)
        self.made, self.spent = 0, spent
        self.failure: SolveFailed | None = None

    def __call__(self, begin: Unknowns, inputs: StepInputs) -> Unknowns | None:
        """Solution; None if Newton's method does not converge."""
        if self.made == MAX_ATTEMPTS:
            tried = f"{self.made} attempts and {self.spent} Newton iterations"
            message = f"given up after {tried}; the last failure: {self.failure}"
            raise NoSteadyStart(message)
        self.made += 1
        try:
            solution, iterations = solve_checked(self.solver, begin, inputs, self.max_it, self.watch)
        except SolveFailed as error:
            self.spent, self.failure = self.spent + error.iterations, error
            return None
        self.spent += iterations
        return solution


class Continuation:
    """Solve directly or by continuation in the pressure-viscosity coefficient and the roughness."""

    def __init__(self, solver: Solver, inputs: StepInputs, max_it: int | None = None, watch: Watch = None):
        self.inputs, self.attempt = inputs, SolveAttempts(solver, max_it, watch)

    def solve(self, begin: Unknowns) -> tuple[Unknowns, int]:
        """Solution, and the number of Newton iterations."""
        solution = self._try(begin, 1.0, 1.0) or self._by_steps(begin)
        return solution, self.attempt.spent

    def _by_steps(self, begin: Unknowns) -> Unknowns:
        """Increase the pressure-viscosity coefficient of the smooth contact, then the roughness."""
        rough = self.inputs.phi.any()
        state = self._try(begin, 1.0, 0.0) if rough else None
        if state is None:
            state = self._ramp(*self._softened(begin), lambda fraction: (fraction, 0.0))
        return self._ramp(state, 0.0, lambda fraction: (1.0, fraction)) if rough else state

    def _softened(self, begin: Unknowns) -> tuple[Unknowns, float]:
        fraction = 0.5 if self.inputs.fluid else 0.0  # without oil there is no viscosity to reduce
        while fraction >= MIN_VISCOSITY_FRACTION:
            state = self._try(begin, fraction, 0.0)
            if state is not None:
                return state, fraction
            fraction *= 0.5
        raise NoSteadyStart(self.attempt.failure)

    def _ramp(self, state: Unknowns, fraction: float, of: Callable[[float], tuple[float, float]]) -> Unknowns:
        growth = fraction or 0.5
        while fraction < 1.0:
            nearer = self._try(state, *of(min(fraction + growth, 1.0)))
            if nearer is not None:
                state, fraction, growth = nearer, min(fraction + growth, 1.0), 1.5 * growth
                continue
            growth *= 0.4
            if growth < MIN_RAMP_INCREMENT:
                raise NoSteadyStart(self.attempt.failure)
        return state

    def _try(self, begin: Unknowns, fraction: float, roughness: float) -> Unknowns | None:
        return self.attempt(begin, easier(self.inputs, fraction, roughness))


def easier(inputs: StepInputs, fraction: float, roughness: float) -> StepInputs:
    """Inputs with fractions of the pressure-viscosity coefficient and of the roughness."""
    fluid, oil = inputs.fluid, inputs.oil
    if fluid and fraction < 1.0:
        change = {"exponent_factor": fraction}
        stress = list(SHEAR_LAWS[shear_law(fluid)].keys)[:1]
        change |= {key: getattr(fluid, key) / fraction**4 for key in stress}
        oil = IsothermalOil(fluid.copy(update=change), oil.scales)
    return replace(inputs, oil=oil, phi=roughness * inputs.phi)


def coarser(case: Case, ramp: str | None = None) -> Case:
    """Steady case with half as many nodes per half-width, likewise across; smooth if its steady start is.

    `ramp`: `time.ramp` of a case that is neither steady nor smooth.
    """
    along, across = case.mesh.points_per_half_width, case.mesh.points_across
    change = {"points_per_half_width": along // 2, "points_across": across and max(across // 2, 1)}
    tables = {"mesh": case.mesh.copy(change)}
    if ramp is not None:
        tables["time"] = case.time.copy({"ramp": ramp})
    elif case.time is not None and case.time.start == "rough":
        tables |= {"time": None, "surface": case.surface.copy({"body_1": None, "body_2": None})}
    return case.copy(tables)


def guess_of(coarse: State, by: EHLProblem, problem: EHLProblem) -> Unknowns:
    """Unknowns of a problem interpolated from the solution by another one, on other nodes."""
    h, solids = by.model.film(coarse.q, coarse.w), by.model.contact_pressure(coarse.w)
    q, h, solids = (by.grid.interpolated(values, problem.grid) for values in (coarse.q, h, solids))
    return Unknowns(q, problem.model.w_from_state(h, solids), coarse.unknowns.border)
