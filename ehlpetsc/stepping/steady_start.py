r"""The steady solution that every run begins with, and how a hard one is reached.

From Hertz' pressure, smoothed, under a film 1.3 times Moes' central one, Newton's method takes 4 to 7
iterations for most oils and loads. Where it does not arrive, pressures of the exit spike swing: beyond about
:math:`\alpha p_0=20` the flow out of a node at high pressure hardly depends on that pressure any more, and
shorter steps or other film thicknesses only swing elsewhere. Thick films fail otherwise: Eyring's flow is
exponential in :math:`hp_x/\tau_0`, which at the start may be in the hundreds.

What leads there is continuation: the same contact with a share s of the pressure-viscosity coefficient and
with :math:`\tau_0/s^4`, nearly Newtonian, is solved first, s halved until that succeeds; s then grows back
to 1, each solution the start of the next; roughness that lies under the film from the start is left out
meanwhile and then grown likewise. It took Barus' law to :math:`\alpha p_0=267`, and thick films from first
residuals of 1e50; steps in pseudo-time, tried on contacts of the first kind, cost three times the iterations
and did not always arrive.

A starved inlet needs another start: the meniscus moves one node per iteration, so that the void is put where
the gap is wider than the oil film. Whether a contact starves at all, the flooded solution tells: it does if
it takes more oil than it is given, and else it is the solution but for the first node.
"""

from dataclasses import replace

import numpy as np

from ehlpetsc.discretisation.elasticity import fast_length
from ehlpetsc.errors import NoSteadyStart, SolveFailed
from ehlpetsc.stepping.certificate import certified

SMOOTHED = 0.2
DIRECT = 1000  # nodes on either side: beyond it a transform is quicker than the sum
AMBIENT = 1e-6  # pressure in p0 of oil that is not to begin as a cavity
LEAST_SHARE = 2.0**-8  # of alpha: below it an oil is as good as isoviscous
FROM = 0.8  # of the load under which Hertz' pressure is the yield pressure
PRESSED = 1.2  # growth of the load from there
LEAST_GROWTH = 1e-3  # of the share, from one solution to the next


def hertz_start(problem, film, phi, thick=1.3, load=1.0):
    """Hertz pressure and a film everywhere above the expected one; behind the outlet a cavity.

    The pressure is smoothed over `SMOOTHED` times the length of the inlet sweep, film^(2/3): the infinite
    slope at Hertz' edge drives more oil through a thick film than all that follows.

    Parameters
    ----------
    problem : ehl_problem.EHLProblem
    film : float
        Expected film in a^2/R.
    phi : ndarray, shape (nx,)
        Roughness in the gap, in a^2/R.
    thick : float
        Times the expected film.
    load : float
        Share of the load.

    Returns
    -------
    q, w : ndarray, shape (nx,)
    h00 : float
    """
    x = problem.x
    p = np.sqrt(np.maximum(load - x**2, 0.0))
    if not problem.dry:
        p = smoothed(p, SMOOTHED * film ** (2.0 / 3.0) / problem.dx)
    p *= 0.5 * np.pi * load / (problem.dx * p.sum())
    h = problem.film(p, 0.0, phi)
    if problem.dry:
        gap = np.where(p > 0.0, 0.0, np.maximum(h - h[np.argmax(p)], 0.0))
        begin = (
            (np.zeros_like(p), problem.model.second_unknown(gap, p)) if problem.model.is_mixed else (p, gap)
        )
        return *begin, -h[np.argmax(p)]
    h00 = thick * film - h.min()
    h += h00
    behind = (x > 1.0) & (p < AMBIENT)
    q = np.where(behind, np.minimum(film / h - 1.0, 0.0), np.maximum(p, AMBIENT))
    return q, problem.model.from_film(h), h00


def smoothed(p, width):
    """Mean of p, zero beyond its ends, under a Gaussian of so many nodes, which is cut at the mesh's length.

    (scipy.ndimage has it, but loads 14 MB, which a smooth contact has no other need of.)
    """
    reach = min(int(4.0 * width + 0.5), len(p) - 1)
    weights = np.exp(-0.5 * (np.arange(-reach, reach + 1) / width) ** 2)
    weights /= weights.sum()
    if reach <= DIRECT:
        return np.convolve(p, weights)[reach : reach + len(p)]
    length = fast_length(len(p) + 2 * reach)
    product = np.fft.irfft(np.fft.rfft(p, length) * np.fft.rfft(weights, length), length)
    return np.maximum(product[reach : reach + len(p)], 0.0)


def starved_start(problem, film, inputs):
    """Hertz pressure and the oil film of the inlet, void wherever the gap is wider."""
    oil = inputs.inlet_film
    q, w, h00 = hertz_start(problem, min(film, oil), inputs.phi)
    h = problem.model.relations(q, w).film
    void = (problem.x < -1.0) & (h > oil)
    return np.where(void, oil / h - 1.0, q), w, h00


def steady(solver, film, inputs):
    """Steady solution of the solver's problem.

    Parameters
    ----------
    solver : newton.NewtonSolver
    film : float
        Expected film in a^2/R.
    inputs : ehl_problem.StepInputs

    Returns
    -------
    q, w : ndarray, shape (nx,)
    h00 : float
    iterations : int
        Of Newton, those of failed attempts too.

    Raises
    ------
    NoSteadyStart
    """
    problem, oil = solver.problem, inputs.inlet_film
    if problem.model.yields and problem.model.yield_pressure < 1.0:
        return pressed(solver, film, inputs)
    if oil is None:
        # the set of dry nodes may have all of them to go
        max_it = problem.n if problem.dry and solver.bounded else None
        return Continuation(solver, inputs, max_it).solve(hertz_start(problem, film, inputs.phi))
    flooded = replace(inputs, inlet_film=None)
    q, w, h00, iterations = Continuation(solver, flooded).solve(hertz_start(problem, film, inputs.phi))
    if problem.content(q, w)[-1] <= oil:
        q[0] = min(oil / problem.model.relations(q, w).film[0] - 1.0, 0.0)
        begin = q, w, h00
    else:
        begin = starved_start(problem, film, inputs)
    # the meniscus may have all nodes of the inlet to go
    *state, more = Continuation(solver, inputs, max_it=problem.n).solve(begin)
    return *state, iterations + more


def pressed(solver, film, inputs):
    """Steady solution of solids that yield under Hertz' pressure: the load grown from where they begin to.

    Arguments, returns and errors of :func:`steady`. All that touches would yield under the whole load at
    once, and a pressure that is at its bound everywhere tells Newton's method nothing of the load.
    """
    problem = solver.problem
    load, reached, spent = FROM * problem.model.yield_pressure**2, 0.0, 0
    state = hertz_start(problem, film, inputs.phi, load=load)
    while True:
        try:
            *state, iterations = certified(
                solver, *state, replace(inputs, load=load), solver.start_iterations()
            )
        except SolveFailed as error:
            spent, load = spent + error.iterations, 0.5 * (reached + load)
            if not reached or load < reached * (1.0 + LEAST_GROWTH):
                raise NoSteadyStart(error, None, spent) from error
            continue
        spent, reached = spent + iterations, load
        if reached == 1.0:
            return *state, spent
        load = min(reached * PRESSED, 1.0)


class Continuation:
    """Solve at once or, failing that, with a growing share of what makes the contact hard.

    Attributes
    ----------
    spent : int
        Newton iterations, those of failed attempts too.
    """

    def __init__(self, solver, inputs, max_it=None):
        self.solver, self.inputs = solver, inputs
        self.max_it = solver.start_iterations(max_it)
        self.spent, self.failure = 0, None

    def solve(self, begin):
        """Returns q, w, h00 and the iterations spent."""
        state = self._try(begin, 1.0, 1.0) or self._by_steps(begin)
        return *state, self.spent

    def _by_steps(self, begin):
        """The smooth contact, its oil made stiff by steps; then the roughness grown under it."""
        rough = self.inputs.phi.any()
        state = self._try(begin, 1.0, 0.0) if rough else None
        if state is None:
            state = self._grown(*self._easier(begin), lambda share: (share, 0.0))
        return self._grown(state, 0.0, lambda share: (1.0, share)) if rough else state

    def _easier(self, begin):
        share = 0.5 if self.inputs.fluid else 0.0  # without oil there is nothing to make easier
        while share >= LEAST_SHARE:
            state = self._try(begin, share, 0.0)
            if state is not None:
                return state, share
            share *= 0.5
        raise NoSteadyStart(self.failure, None, self.spent)

    def _grown(self, state, share, of):
        growth = share or 0.5
        while share < 1.0:
            nearer = self._try(state, *of(min(share + growth, 1.0)))
            if nearer is not None:
                state, share, growth = nearer, min(share + growth, 1.0), 1.5 * growth
                continue
            growth *= 0.4
            if growth < LEAST_GROWTH:
                raise NoSteadyStart(self.failure, share, self.spent)
        return state

    def _try(self, begin, share, roughness):
        inputs = easier(self.inputs, share, roughness)
        try:
            *state, iterations = certified(self.solver, *begin, inputs, max_it=self.max_it)
        except SolveFailed as error:
            self.spent, self.failure = self.spent + error.iterations, error
            return None
        self.spent += iterations
        return state


def easier(inputs, share, roughness):
    """The inputs with a share of the pressure-viscosity coefficient, and a share of the roughness."""
    fluid = inputs.fluid
    if fluid and share < 1.0:
        change = {"pressure_viscosity": share * fluid.pressure_viscosity}
        if fluid.eyring_stress is not None:
            change["eyring_stress"] = fluid.eyring_stress / share**4
        fluid = fluid.copy(update=change)
    return replace(inputs, fluid=fluid, phi=roughness * inputs.phi)
