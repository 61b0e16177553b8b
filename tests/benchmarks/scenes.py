"""Scenes of the benchmarks: a solver with a state in the middle of a rough run."""

import os
import sys
import time
from dataclasses import dataclass
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))
from ehlpetsc.base import environment

environment.prepare()
import petsc4py

petsc4py.init(sys.argv[:1])
from ehlpetsc.case.loading import load
from ehlpetsc.run.simulation import Simulation

FAST = 8.0  # nominal steps in one, on the way to where time is taken
# measured profile at a fifth of its height under a thick film: never any contact
FULL_FILM = ("fluid.viscosity=0.01", "surface.1.scale=0.2", "surface.2.scale=0.2")


@dataclass
class Scene:
    """A run in this process."""

    simulation: Simulation
    step: float

    @property
    def solver(self):
        return self.simulation.stepper.solver

    @property
    def state(self):
        return self.simulation.solution

    def advance(self, steps):
        """Newton iterations and CPU seconds of so many steps."""
        newton, begun = 0, time.process_time()
        for _ in range(steps):
            self.simulation.advance(self.step)
            newton += self.state.newton
        return newton, time.process_time() - begun


def scene(name, *overrides):
    """Start a case of cases/."""
    simulation = Simulation(load(ROOT / "cases" / f"{name}.toml", overrides))
    simulation.options.__enter__()  # for good: the benchmarks solve parts of steps as well
    simulation.advance()
    return Scene(simulation, simulation.scales.dt)


def rough(points, inlet=-2.5, *more):
    """Full film at so many points a half-width, stepped until roughness fills the contact's front half."""
    mesh = (f"mesh.points_per_half_width={points}", f"mesh.inlet={inlet}")
    made = scene("table1_rough", *FULL_FILM, *mesh, *more)
    step = made.step
    made.step = FAST * step
    made.advance(int((0.3 - inlet) * points / (0.5 * FAST)))
    made.step = step
    made.advance(5)
    return made


def timed(solver, before=lambda: None):
    """Wall seconds that the solver spends from now on, in a list; `before` is called ahead of each solve."""
    spent, solve = [0.0], solver.solve

    def within(*arguments, **named):
        before()
        begun = time.perf_counter()
        try:
            return solve(*arguments, **named)
        finally:
            spent[0] += time.perf_counter() - begun

    solver.solve = within
    return spent
