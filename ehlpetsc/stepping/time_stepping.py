r"""From the start to the end of a run: steady solution, time steps, retries, stops.

Predictor: what the roughness has changed of the smooth solution is carried along with the mean speed
(:func:`carried`; of films the ratio, which keeps them positive), from that one of the last three time
levels whose way from here is nearest to a whole number of nodes. Asperity pressures are two or three nodes
wide, and interpolating between the nodes is what a predictor loses most by: on the measured surfaces the last
level alone cost 6.0 Newton iterations a step, the best of three 4.6 (over 5 a of travel). Extrapolation in
time gained nothing more.

A step that does not converge is halved and counted; :mod:`.step_control` leads back to the nominal one.
"""

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from ehlpetsc.discretisation.reynolds import Storage
from ehlpetsc.errors import NoSteadyStart, NotConverged, SolveFailed
from ehlpetsc.nonlinear import events as log
from ehlpetsc.stepping.steady_start import steady
from ehlpetsc.stepping.step_control import next_step

SMALLEST = 2.0**-12  # of the nominal step: below it a step is given up
THIN = 1e-3  # of the expected film, least divisor of films: on a coarse mesh the smooth one may touch too
AGE = 0.03  # nodes off a whole number that a level one step younger makes up for


class Level(NamedTuple):
    """Unknowns of an earlier time level [s], for the predictor."""

    time: float
    q: np.ndarray
    h: np.ndarray


@dataclass
class State:
    """One time level and what the next step needs of the past; arrays of shape (nx,), dimensionless.

    Attributes
    ----------
    q, h, h00
        Unknowns (see :mod:`ehlpetsc.discretisation.ehl_problem`).
    m, m_older
        Film contents of this level and the one before (None: none).
    time, dt
        [s]; `dt` is the step that led here (None at the start).
    step
        Number of steps taken.
    earlier
        The two levels before this one, latest first.
    """

    q: np.ndarray
    h: np.ndarray
    h00: float
    m: np.ndarray | None = None
    m_older: np.ndarray | None = None
    time: float = 0.0
    dt: float | None = None
    step: int = 0
    earlier: tuple = ()
    newton: int = 0
    retries: int = 0
    flow: np.ndarray = field(default=None, repr=False)


def carried(share, nodes):
    """Move what the roughness has changed of the smooth solution along by `nodes` nodes.

    Cubic interpolation, kept between the two values it lies between: beside the pressure spikes of
    asperities, two or three nodes wide, a cubic undershoots, and the cavity it makes there costs Newton's
    method iterations.
    """
    from scipy.ndimage import shift  # 14 MB that a smooth contact does not need

    moved = shift(share, nodes, order=3, mode="nearest")
    one, other = neighbours(share, nodes)
    return np.clip(moved, np.minimum(one, other), np.maximum(one, other))


def neighbours(v, nodes):
    """Values of the two nodes that a point moved by `nodes` nodes has come from between."""
    source = np.arange(len(v)) - int(np.floor(nodes))
    return v.take(source, mode="clip"), v.take(source - 1, mode="clip")


class March:
    """Steady and transient solution of one scene.

    Parameters
    ----------
    solver : solver.Solver
    scales : scales.Scales
    roughness : roughness.Roughness or None
    film : float
        Expected film in a^2/R.
    """

    def __init__(self, solver, scales, roughness, film):
        self.solver, self.problem, self.scales, self.film = solver, solver.problem, scales, film
        self.roughness = roughness
        self.smooth = None

    def set_gap(self, time):
        """Put the roughness where it is at `time` [s]."""
        if self.roughness is not None:
            with log.ROUGHNESS:
                self.problem.gap = self.roughness.gap(self.scales.x * self.scales.a, time) / self.scales.h

    def start(self):
        """Steady solution at time 0."""
        self.set_gap(0.0)
        self.problem.past = None
        try:
            q, h, h00, newton = steady(self.solver, self.film)
        except NoSteadyStart as error:
            raise NotConverged(f"steady start: {error}") from error
        self.smooth = (q, h)
        return State(q, h, h00, m=self._mass(q, h), newton=newton, flow=self._flow())

    def _mass(self, q, h):
        return None if self.problem.dry else self.problem.reynolds.mass(q, h)[0]

    def _flow(self):
        return self.solver.flow_rows()

    def predict(self, state, dt):
        """Start of Newton's iteration: the roughness' share carried along with the mean speed."""
        if self.roughness is None or self.problem.dry:
            return state.q, state.h
        levels = (Level(state.time, state.q, state.h), *state.earlier)
        nodes = [self.scales.u * (state.time + dt - level.time) / self.scales.dx for level in levels]
        best = min(range(len(levels)), key=lambda k: abs(nodes[k] - round(nodes[k])) + AGE * k)
        q0, h0 = self.smooth[0], np.maximum(self.smooth[1], THIN * self.film)
        level, way = levels[best], nodes[best]
        q = q0 + carried(level.q - q0, way)
        # where there was oil, the differences carried must not leave a cavity
        least = np.minimum(q0, np.minimum(*neighbours(level.q, way)))
        q = np.maximum(q, np.where(least > 0.0, 0.5 * least, -1.0 + 1e-3))
        return q, np.maximum(h0 * carried(level.h / h0, way), self.solver.bound)

    def advance(self, state, dt=None):
        """One accepted time step of `dt` [s], by default the step control's; halved as needed."""
        nominal = self.scales.dt
        unit = self.scales.u / self.scales.a if self.scales.u else 1.0
        dt = dt or next_step(state.time, state.dt, state.retries, nominal)
        retries = newton = 0
        while True:
            self.set_gap(state.time + dt)
            older = None if state.dt is None else state.dt * unit
            if not self.problem.dry:
                self.problem.past = Storage(state.m, state.m_older, dt * unit, older)
            guess = self.predict(state, dt) if retries == 0 else (state.q, state.h)
            try:
                q, h, h00, iterations = self.solver.solve(*guess, state.h00)
                break
            except SolveFailed as error:
                newton, retries = newton + error.iterations, retries + 1
                dt *= 0.5
                if dt < SMALLEST * nominal:
                    raise NotConverged(
                        f"step {state.step + 1}, time {state.time:.6e} s: {error}, also with a step of "
                        f"{dt:.2e} s. Try a smaller time.courant, a finer mesh or a higher viscosity"
                    ) from error
        return State(
            q,
            h,
            h00,
            m=self._mass(q, h),
            m_older=state.m,
            time=state.time + dt,
            dt=dt,
            step=state.step + 1,
            newton=newton + iterations,
            retries=retries,
            flow=self._flow(),
            earlier=(Level(state.time, state.q, state.h), *state.earlier[:1]),
        )
