"""The solver against LAPACK, over nodes and on several ranks.

``python3 tests/benchmarks/solver_speed.py``: an iteration of SNES, with all that it does, over LAPACK's
banded solve alone of the matrix of a near field of 30 nodes, in full film and in contact; the exponent of the
time a step over nodes; Newton iterations a step. Wall time of SNES, processor time of all else, medians of
pairs in turns.

``... --ranks 1 2 [--meshes 200]``: the same steps in contact on each number of ranks, in turns: medians of
the time of an iteration, the speed-up over the first number, maximum memory of a rank; of whole steps the
processor time of a rank without waiting, and how many times that of the first number it goes into.
"""

import argparse
import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

os.environ |= {"OMP_NUM_THREADS": "1", "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
ENVIRONMENT = dict(os.environ)  # of other processes: without the variables that MPI sets in this one
ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "tests")]
from ehlpetsc.base import environment

environment.need_solver()
import petsc4py

petsc4py.init(sys.argv[:1])
import numpy as np
from benchmarks import waiting
from mpi4py import MPI
from petsc4py import PETSc
from scipy.linalg import lapack

from ehlpetsc.case.loading import load
from ehlpetsc.nonlinear.line.jacobian import NearFieldMatrix
from ehlpetsc.run.simulation import Simulation

COURANT = 0.5  # nodes that the film moves in a nominal step
FAST = 8.0  # nominal steps in one, on the way to where time is taken
HALF_BAND = 30  # nodes
PAIRS = 9
# measured profile at a fifth of its height under a thick film: never any contact
FULL_FILM = ("fluid.viscosity=0.01", "surface.1.scale=0.2", "surface.2.scale=0.2")


def advance(simulation, steps, fast=1.0):
    """Newton iterations and processor time [s] of so many steps."""
    newton, begun = 0, time.process_time()
    for _ in range(steps):
        simulation.advance(fast * simulation.scales.dt)
        newton += simulation.dimensionless.newton
    return newton, time.process_time() - begun


def rough(points, *overrides, comm=None, inlet=-1.4, edge=0.3):
    """The measured surfaces, roughness in the contact up to x/a = `edge`."""
    keys = (f"mesh.points_per_half_width={points}", f"mesh.inlet={inlet}", f"time.courant={COURANT}")
    simulation = Simulation(load(ROOT / "cases" / "table1_rough.toml", [*keys, *overrides]), comm)
    simulation.advance()
    advance(simulation, int((edge - inlet) * points / (COURANT * FAST)), FAST)
    advance(simulation, 5)
    return simulation


def timed(simulation, before=lambda: None):
    """Wall seconds that the solver spends from now on, in a list; `before` is called ahead of each solve."""
    solver = simulation.stepper.solver
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


def banded(system):
    """The near field's matrix without the load row, in LAPACK's banded storage, and its half band."""
    n, matrix = 2 * system.n, PETSc.Mat().createAIJ((system.x.getSizes(),) * 2, comm=system.comm)
    given = system.jacobian.state, system.jacobian.reynolds_derivatives
    NearFieldMatrix(system.problem, HALF_BAND, matrix).fill(*given)
    pointers, columns, values = matrix.getValuesCSR()
    rows = np.repeat(np.arange(len(pointers) - 1), np.diff(pointers))
    inside = (rows < n) & (columns < n)
    rows, columns, values = rows[inside], columns[inside], values[inside]
    width = int(np.abs(rows - columns).max())
    band = np.zeros((3 * width + 1, n), order="F")
    band[2 * width + rows - columns, columns] = values
    return band, width


def against_lapack(points, simulation, what):
    """Time of an iteration over that of the banded solve."""
    band, width = banded(simulation.stepper.solver.system)
    right = np.ones((band.shape[1], 2), order="F")  # residual and the column of h00
    spent, ratios, ours = timed(simulation), [], []
    for _ in range(PAIRS):
        spent[0] = 0.0
        newton, _ = advance(simulation, 5)
        begun = time.process_time()
        for _ in range(3):
            factors, pivots, info = lapack.dgbtrf(band, width, width)
            assert info == 0
            lapack.dgbtrs(factors, width, width, right, pivots)
        ours.append(1e3 * spent[0] / newton)
        ratios.append(ours[-1] / (1e3 * (time.process_time() - begun) / 3))
    print(
        f"a/{points}, {what}: {statistics.median(ours):.2f} ms an iteration, over LAPACK's banded solve "
        f"{statistics.median(ratios):.2f} ({min(ratios):.2f} to {max(ratios):.2f})",
        flush=True,
    )


def exponent(meshes):
    """Slope of the time a step over nodes, with steps of the same courant number."""
    nodes, seconds = [], []
    for points in meshes:
        simulation = rough(points, *FULL_FILM)
        nodes.append(simulation.scales.nx)
        seconds.append(statistics.median(advance(simulation, 4)[1] / 4 for _ in range(5)))
        print(f"a/{points}: {nodes[-1]} nodes, {1e3 * seconds[-1]:.1f} ms a step", flush=True)
    slope = np.polyfit(np.log(nodes), np.log(seconds), 1)[0]
    print(f"time a step goes with nodes to the power {slope:.2f}", flush=True)


def on_ranks(points, ranks, loaded):
    """Figures of one group of processes; `loaded`: variables of :func:`.waiting.preload`."""
    command = ["mpirun", "-n", str(ranks), "--oversubscribe", sys.executable, __file__, "--inside"]
    printed = subprocess.check_output([*command, str(points)], env=ENVIRONMENT | loaded, text=True)
    return json.loads(printed.splitlines()[-1])


def inside(points, steps=16):
    """Run on every rank; the first one prints the figures."""
    comm = MPI.COMM_WORLD
    waiting.follow_lines()
    simulation = rough(points, "mesh.outlet=1.3", comm=comm)
    spent = timed(simulation, comm.Barrier)
    begun = waiting.seconds_outside_mpi()
    newton, _ = advance(simulation, steps)
    worked = comm.allreduce(waiting.seconds_outside_mpi() - begun, MPI.MAX)
    memory = comm.allreduce(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0, MPI.MAX)
    if comm.rank == 0:
        figures = {"nodes": simulation.scales.nx, "newton": newton, "memory": memory}
        figures |= {"snes": 1e3 * spent[0] / newton, "worked": 1e3 * worked / steps}
        print(json.dumps(figures), flush=True)


def main():
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--meshes", type=int, nargs="+", default=[200, 800])
    parser.add_argument("--ranks", type=int, nargs="+")
    parser.add_argument("--inside", type=int, help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    if chosen.inside:
        return inside(chosen.inside)
    with tempfile.TemporaryDirectory() as folder:
        measure(chosen, Path(folder))


def measure(chosen, folder):
    """Print the figures of the command."""
    loaded = waiting.preload(folder) if chosen.ranks else {}
    for points in chosen.meshes:
        if not chosen.ranks:
            against_lapack(points, rough(points, *FULL_FILM, inlet=-2.5), "full film")
            against_lapack(points, rough(points, edge=-0.3), "in contact")
            continue
        taken = {ranks: [] for ranks in chosen.ranks}
        for _ in range(PAIRS):
            for ranks, figures in taken.items():
                figures.append(on_ranks(points, ranks, loaded))
        first = taken[chosen.ranks[0]]
        for ranks, figures in taken.items():
            median = {name: statistics.median(one[name] for one in figures) for name in figures[0]}
            faster, less = (
                statistics.median(b[key] / one[key] for b, one in zip(first, figures, strict=True))
                for key in ("snes", "worked")
            )
            print(f"{median['nodes']:.0f} nodes, {ranks} ranks, {faster:.2f} times as fast:", end=" ")
            print(
                f"{median['snes']:.2f} ms, {median['newton']:.0f} Newton, {median['memory']:.0f} MB;", end=" "
            )
            print(f"a step without waiting {median['worked']:.1f} ms of a rank, {less:.2f} times less")
    if not chosen.ranks:
        exponent((100, 200, 400, 800, 1600))
        for overrides, name in ((FULL_FILM, "full film"), ((), "in contact")):
            newton, _ = advance(rough(200, *overrides), 200)
            print(f"a/200, {name}: {newton / 200:.2f} Newton iterations a step", flush=True)


if __name__ == "__main__":
    main()
