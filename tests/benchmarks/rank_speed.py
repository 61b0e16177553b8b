"""One contact on several ranks: ``python3 tests/benchmarks/rank_speed.py [--meshes 200] [--ranks 1 2 4]``.

The measured surfaces where both fill the contact's front half. The same steps on each number of ranks, in
turns, `--repeats` times: medians of the time of an iteration of SNES and of the whole step, the speed-up over
the first number of ranks, iterations (equal on any number), and the maximum memory of a rank.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import time

from scenes import ROOT, timed

ENVIRONMENT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
STEPS = 16
FAST = 8.0  # nominal steps in one on the way


def measured(points, ranks):
    """Figures of one process group."""
    mpirun = ["mpirun", "-n", str(ranks), "--oversubscribe"]
    command = [*mpirun, sys.executable, __file__, "--inside", str(points)]
    environment = os.environ | ENVIRONMENT
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    return json.loads(done.stdout.splitlines()[-1])


def inside(points):
    """Run on every rank; the first one prints the figures."""
    import resource

    from mpi4py import MPI

    from ehlpetsc.case.loading import load
    from ehlpetsc.nonlinear import gmres
    from ehlpetsc.run.simulation import Simulation

    comm = MPI.COMM_WORLD
    mesh = (f"mesh.points_per_half_width={points}", "mesh.inlet=-1.5", "mesh.outlet=1.3")
    simulation = Simulation(load(ROOT / "cases" / "table1_rough.toml", mesh), comm)
    simulation.options.__enter__()  # for good: parts of steps are solved as well
    simulation.advance()
    step, solver = simulation.scales.dt, simulation.stepper.solver
    for _ in range(int(1.8 * points / (0.5 * FAST))):
        simulation.advance(FAST * step)
    for _ in range(4):
        simulation.advance(step)
    spent = timed(solver, comm.Barrier)
    krylov, iterations = [0], gmres.iterations

    def counting(*arguments):
        norms = iterations(*arguments)
        krylov[0] += len(norms) - 1
        return norms

    gmres.iterations = counting
    comm.Barrier()
    begun, newton = time.perf_counter(), 0
    for _ in range(STEPS):
        simulation.advance(step)
        newton += simulation.solution.newton
    comm.Barrier()
    whole = time.perf_counter() - begun
    memory = comm.allreduce(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0, MPI.MAX)
    figures = {"nodes": solver.system.n, "newton": newton, "krylov": krylov[0], "memory": memory}
    figures |= {"snes": 1e3 * spent[0] / newton, "step": 1e3 * whole / newton}
    if comm.rank == 0:
        print(json.dumps(figures), flush=True)


def main():
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--meshes", type=int, nargs="+", default=[200, 800, 1600])
    parser.add_argument("--ranks", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--repeats", type=int, default=7)
    parser.add_argument("--inside", type=int, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.inside:
        inside(arguments.inside)
        return
    for points in arguments.meshes:
        taken = {ranks: [] for ranks in arguments.ranks}
        for _ in range(arguments.repeats):
            for ranks, figures in taken.items():
                figures.append(measured(points, ranks))
        print_row(points, taken)


def print_row(points, taken):
    """One line for each number of ranks."""
    base = [one["snes"] for one in next(iter(taken.values()))]
    for ranks, figures in taken.items():
        median = {name: statistics.median(one[name] for one in figures) for name in figures[0]}
        faster = statistics.median(b / one["snes"] for b, one in zip(base, figures, strict=True))
        print(f"a/{points}, {median['nodes']:.0f} nodes, {ranks} ranks, {faster:.2f} times as fast:", end=" ")
        print(f"{median['snes']:.2f} ms a SNES iteration, {median['step']:.2f} with the whole step;", end=" ")
        print(f"{median['newton']:.0f} Newton, {median['krylov']:.0f} Krylov, {median['memory']:.0f} MB")


if __name__ == "__main__":
    main()
