"""Run a case from a test without files."""

import numpy as np
import petsc4py

from support import CASES

petsc4py.init([])

from ehlpetsc.case.loading import load
from ehlpetsc.run.simulation import Simulation


class Scene:
    """One case on one rank, its state kept at the last time level."""

    def __init__(self, name, *overrides, **options):
        self.simulation = Simulation(load(CASES / name, overrides), options=options)
        self.scales, self.stepper = self.simulation.scales, self.simulation.stepper
        self.x, self.solver, self.problem = self.scales.x, self.stepper.solver, self.stepper.problem
        self.centre = int(np.argmin(np.abs(self.x)))

    def start(self, max_it=30):
        """Solve the steady start in at most `max_it` Newton iterations."""
        self.solver.snes.max_it = max_it
        self.state = self.simulation.advance().dimensionless
        return self

    def steps(self, count, dt):
        """Take `count` steps of `dt` [s] and yield each state; a halved step is an error."""
        for _ in range(count):
            self.state = self.simulation.advance(dt).dimensionless
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
