"""Driving a scene of the project from a test, without files, and fitting observed orders."""

from pathlib import Path

import numpy as np
import petsc4py

petsc4py.init([])

from petsc4py import PETSc

from ehlpetsc.case.loading import load
from ehlpetsc.nonlinear.newton import NewtonSolver, set_defaults
from ehlpetsc.physics.film_formulas import expected_film
from ehlpetsc.physics.scales import Scales
from ehlpetsc.stepping.time_stepping import TimeStepping
from ehlpetsc.surfaces.roughness import Roughness

CASES = Path(__file__).parents[2] / "cases"


class Scene:
    """One case on one rank, its state kept at the last time level.

    Parameters
    ----------
    name : str
        File in cases/.
    *overrides : str
        ``table.key=value``.
    """

    def __init__(self, name, *overrides):
        set_defaults(PETSc.Options())
        case = load(CASES / name, overrides)
        self.scales = Scales.of(case)
        film = expected_film(case, self.scales)
        solver = NewtonSolver(case, self.scales, film, PETSc.COMM_SELF)
        self.march = TimeStepping(solver, self.scales, Roughness.of(case, self.scales), film)
        self.x, self.solver, self.problem = self.scales.x, solver, solver.problem
        self.centre = int(np.argmin(np.abs(self.x)))

    def start(self, max_it=30):
        """Steady solution at time 0, in so many Newton iterations at most."""
        self.solver.snes.max_it = max_it
        self.state = self.march.start()
        return self

    def steps(self, count, dt):
        """Go `count` steps of `dt` [s], yielding after each; a step that had to be halved is an error."""
        for _ in range(count):
            self.state = self.march.advance(self.state, dt)
            assert self.state.retries == 0
            yield self.state

    @property
    def film(self):
        """Film thickness [m]."""
        return self.state.h * self.scales.h

    @property
    def pressure(self):
        """Pressure [Pa]."""
        return self.state.p * self.scales.p0


def observed_order(errors):
    """Slope of log2(error) over refinements, each of which halves the spacing."""
    return -np.polyfit(np.arange(len(errors)), np.log2(errors), 1)[0]
