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

import numpy as np

from ehlpetsc.errors import NoSteadyStart, SolveFailed

SMOOTHED = 0.2
AMBIENT = 1e-6  # pressure in p0 of oil that is not to begin as a cavity
LEAST_SHARE = 2.0**-8  # of alpha: below it an oil is as good as isoviscous
LEAST_GROWTH = 1e-3  # of the share, from one solution to the next


def hertz_start(problem, film, thick=1.3):
    """Hertz pressure and a film everywhere above the expected one; behind the outlet a cavity.

    The pressure is smoothed over `SMOOTHED` times the length of the inlet sweep, film^(2/3): the infinite
    slope at Hertz' edge drives more oil through a thick film than all that follows.
    """
    x = problem.x
    p = np.sqrt(np.maximum(1.0 - x**2, 0.0))
    if not problem.dry:
        p = smoothed(p, SMOOTHED * film ** (2.0 / 3.0) / problem.dx)
    p *= 0.5 * np.pi / (problem.dx * p.sum())
    h = problem.film(p, 0.0)
    if problem.dry:
        return p, np.where(p > 0.0, 0.0, np.maximum(h - h[np.argmax(p)], 0.0)), -h[np.argmax(p)]
    h00 = thick * film - h.min()
    h += h00
    behind = (x > 1.0) & (p < AMBIENT)
    return np.where(behind, np.minimum(film / h - 1.0, 0.0), np.maximum(p, AMBIENT)), h, h00


def smoothed(p, width):
    """Mean of p, zero beyond its ends, under a Gaussian of so many nodes.

    (scipy.ndimage has it, but loads 14 MB, which a smooth contact has no other need of.)
    """
    reach = int(4.0 * width + 0.5)
    weights = np.exp(-0.5 * (np.arange(-reach, reach + 1) / width) ** 2)
    return np.convolve(p, weights / weights.sum())[reach : reach + len(p)]


def starved_start(problem, film):
    """Hertz pressure and the oil film of the inlet, void wherever the gap is wider."""
    oil = problem.reynolds.inlet
    q, h, h00 = hertz_start(problem, min(film, oil))
    void = (problem.x < -1.0) & (h > oil)
    return np.where(void, oil / h - 1.0, q), h, h00


def steady(solver, film):
    """Steady solution of the solver's problem.

    Parameters
    ----------
    solver : solver.Solver
    film : float
        Expected film in a^2/R.

    Returns
    -------
    q, h : ndarray, shape (nx,)
    h00 : float
    iterations : int
        Of Newton, those of failed attempts too.

    Raises
    ------
    NoSteadyStart
    """
    problem = solver.problem
    oil = None if problem.dry else problem.reynolds.inlet
    if oil is None:
        # the set of dry nodes may have all of them to go
        max_it = problem.n if problem.dry else None
        return _Continuation(solver, max_it).solve(hertz_start(problem, film))
    problem.reynolds.inlet = None
    try:
        q, h, h00, iterations = _Continuation(solver).solve(hertz_start(problem, film))
    finally:
        problem.reynolds.inlet = oil
    if problem.reynolds.mass(q, h)[0][-1] <= oil:
        q[0] = min(oil / h[0] - 1.0, 0.0)
        begin = q, h, h00
    else:
        begin = starved_start(problem, film)
    # the meniscus may have all nodes of the inlet to go
    *state, more = _Continuation(solver, max_it=problem.n).solve(begin)
    return *state, iterations + more


class _Continuation:
    """Solve at once or, failing that, with a growing share of what makes the contact hard.

    Attributes
    ----------
    spent : int
        Newton iterations, those of failed attempts too.
    """

    def __init__(self, solver, max_it=None):
        self.solver, self.problem = solver, solver.problem
        self.max_it = max_it or solver.start_iterations
        self.gap = self.problem.gap
        self.fluid = None if self.problem.dry else self.problem.reynolds.fluid
        self.spent, self.failure = 0, None

    def solve(self, begin):
        """Returns q, h, h00 and the iterations spent."""
        try:
            state = self._try(begin, 1.0, 1.0) or self._by_steps(begin)
        finally:
            self._set(1.0, 1.0)
        return *state, self.spent

    def _by_steps(self, begin):
        """The smooth contact, its oil made stiff by steps; then the roughness grown under it."""
        rough = self.gap.any()
        state = self._try(begin, 1.0, 0.0) if rough else None
        if state is None:
            state = self._grown(*self._easier(begin), lambda share: (share, 0.0))
        return self._grown(state, 0.0, lambda share: (1.0, share)) if rough else state

    def _easier(self, begin):
        share = 0.5
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
        self._set(share, roughness)
        try:
            *state, iterations = self.solver.solve(*begin, max_it=self.max_it)
        except SolveFailed as error:
            self.spent, self.failure = self.spent + error.iterations, error
            return None
        self.spent += iterations
        return state

    def _set(self, share, roughness):
        self.problem.gap = roughness * self.gap
        if self.fluid:
            change = {"pressure_viscosity": share * self.fluid.pressure_viscosity}
            if self.fluid.eyring_stress is not None:
                change["eyring_stress"] = self.fluid.eyring_stress / share**4
            self.problem.reynolds.fluid = self.fluid.copy(update=change)
