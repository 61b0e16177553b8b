"""Scenes of the benchmarks: a solver with a state in the middle of a rough run."""

import os
import sys
import time
from dataclasses import dataclass
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))
from ehlpetsc import environment

environment.prepare()
import petsc4py

petsc4py.init(sys.argv[:1])
from petsc4py import PETSc

from ehlpetsc.case.loading import load
from ehlpetsc.nonlinear.newton import NewtonSolver, set_defaults
from ehlpetsc.physics.film_formulas import expected_film
from ehlpetsc.physics.scales import Scales
from ehlpetsc.stepping.time_stepping import TimeStepping
from ehlpetsc.surfaces.roughness import Roughness

FAST = 8.0  # nominal steps in one, on the way to where time is taken
# measured profile at a fifth of its height under a thick film: never any contact
FULL_FILM = ("fluid.viscosity=0.01", "surface.fast.scale=0.2", "surface.slow.scale=0.2")


@dataclass
class Scene:
    """A run in this process."""

    march: TimeStepping
    state: object
    step: float

    @property
    def solver(self):
        return self.march.solver

    def advance(self, steps):
        """Newton iterations and CPU seconds of so many steps."""
        newton, begun = 0, time.process_time()
        for _ in range(steps):
            self.state = self.march.advance(self.state, self.step)
            newton += self.state.newton
        return newton, time.process_time() - begun


def scene(name, *overrides):
    """Start a case of cases/."""
    set_defaults(PETSc.Options())
    case = load(ROOT / "cases" / f"{name}.toml", overrides)
    scales = Scales.of(case)
    film = expected_film(case, scales)
    solver = NewtonSolver(case, scales, film, PETSc.COMM_SELF)
    march = TimeStepping(solver, scales, Roughness.of(case, scales), film)
    return Scene(march, march.start(), scales.dt)


def rough(points, inlet=-2.5, *more):
    """Full film at so many points a half width, stepped until roughness fills the contact's front half."""
    mesh = (f"mesh.points_per_half_width={points}", f"mesh.inlet={inlet}")
    made = scene("table1_rough", *FULL_FILM, *mesh, *more)
    step = made.step
    made.step = FAST * step
    made.advance(int((0.3 - inlet) * points / (0.5 * FAST)))
    made.step = step
    made.advance(5)
    return made
