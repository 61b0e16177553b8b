"""A Newton iteration against LAPACK and a dense Newton step: ``python3 tests/benchmarks/newton_speed.py``.

1. a whole Newton iteration (residual, far field, assembly, factors, solve) over LAPACK's banded solve alone
   of the matrix of a near field of 30 nodes, at a/200 and a/800;
2. a full-film time step at a/200 over a textbook Newton step of the same equations, numpy's dense solve;
3. time a step against nodes, a/100 to a/1600: the exponent;
4. Newton iterations a step.

Each pair is timed in turns in this process, medians: CPU time, and for the parts and SNES of 1 wall time.
"""

import argparse
import statistics
import time

import numpy as np
from scenes import PETSc, rough, scene
from scipy.linalg import lapack

from ehlpetsc.nonlinear import events as log

HALF_BAND = 30  # nodes


def cpu(call, repeats):
    """Median CPU seconds."""
    times = []
    for _ in range(repeats):
        begun = time.process_time()
        call()
        times.append(time.process_time() - begun)
    return statistics.median(times)


def banded(solver):
    """Matrix of the solver's last iteration without the load row, in LAPACK's banded storage."""
    n, matrix = 2 * solver.n, solver.matrix
    pointers, columns, values = matrix.getValuesCSR()
    rows = np.repeat(np.arange(n + 1), np.diff(pointers))
    inside = (rows < n) & (columns < n)
    rows, columns, values = rows[inside], columns[inside], values[inside]
    width = int(np.abs(rows - columns).max())
    band = np.zeros((3 * width + 1, n), order="F")
    band[2 * width + rows - columns, columns] = values
    return band, width


def lapack_solve(band, width, right):
    factors, pivots, info = lapack.dgbtrf(band, width, width)
    assert info == 0
    return lapack.dgbtrs(factors, width, width, right, pivots)


def seconds(events):
    """Seconds that PETSc's log has under some events so far."""
    return np.array([event.getPerfInfo()["time"] for event in events])


def against_lapack(points):
    """Ratio 1: of the iteration's parts, of SNES with all that it does itself, and with the predictor."""
    ours, given = rough(points), rough(points, -2.5, f"mesh.near_field={HALF_BAND}")
    band, width = banded(given.solver)
    right = np.ones((band.shape[1], 2), order="F")  # residual and the column of h00
    parts = [log.RESIDUAL, log.ASSEMBLY, log.FACTOR, PETSc.Log.Event("KSPSolve")]
    iterations, solves = [], []
    for _ in range(9):
        before = seconds([*parts, PETSc.Log.Event("SNESSolve")])
        newton, whole = ours.advance(5)
        spent = seconds([*parts, PETSc.Log.Event("SNESSolve")]) - before
        iterations.append(1e3 * np.array([spent[:-1].sum(), spent[-1], whole]) / newton)
        solves.append(1e3 * cpu(lambda: lapack_solve(band, width, right), 3))
    mine, theirs = np.median(iterations, axis=0), statistics.median(solves)
    print(
        f"1. a/{points}, {ours.solver.n} nodes: LAPACK's banded solve (half band {width}) {theirs:.2f} ms; "
        "Newton iteration: residual, assembly, factors, solve with far field {:.2f} ms, ratio {:.2f}; "
        "all of SNES {:.2f}, {:.2f}; of the time step, with its predictor, {:.2f}, {:.2f}".format(
            *np.stack([mine, mine / theirs], axis=1).ravel()
        ),
        flush=True,
    )


def dense_iteration(solver, state):
    """A textbook Newton iteration: the whole Jacobian as a dense matrix, numpy's solve."""
    problem, n = solver.problem, solver.n
    q, h, h00 = state.q, state.h, state.h00
    residual = problem.residual(q, h, h00)
    solver.scatter(q, h, h00)
    solver._jacobian(solver.snes, solver.x, solver.operator, solver.matrix)
    pointers, columns, values = solver.matrix.getValuesCSR()
    matrix = np.zeros((2 * n + 1, 2 * n + 1))
    matrix[np.repeat(np.arange(2 * n + 1), np.diff(pointers)), columns] = values
    distance = np.abs(np.subtract.outer(np.arange(n), np.arange(n)))
    matrix[2 : 2 * n - 2 : 2, 0 : 2 * n : 2] = -problem.curvature[distance][1:-1]
    return np.linalg.solve(matrix, residual)


def against_dense(points=200):
    """Ratio 2: both take as many iterations."""
    made = rough(points)
    steps, dense = [], []
    for _ in range(5):
        newton, seconds = made.advance(10)
        steps.append(seconds / 10)
        dense.append(newton / 10 * cpu(lambda: dense_iteration(made.solver, made.state), 1))
    mine, theirs = statistics.median(steps), statistics.median(dense)
    print(
        f"2. a/{points}: time step {1e3 * mine:.1f} ms, dense Newton step {1e3 * theirs:.0f} ms, "
        f"{theirs / mine:.0f} times",
        flush=True,
    )


def exponent(meshes):
    """Slope 3, at the same time and with a step of the same courant number."""
    nodes, seconds = [], []
    for points in meshes:
        made = rough(points, -1.4)
        times = [made.advance(4)[1] / 4 for _ in range(5)]
        nodes.append(made.solver.n)
        seconds.append(statistics.median(times))
        print(f"3. a/{points}: {nodes[-1]} nodes, {1e3 * seconds[-1]:.1f} ms a step", flush=True)
    slope = np.polyfit(np.log(nodes), np.log(seconds), 1)[0]
    print(f"3. time a step goes with nodes to the power {slope:.2f}", flush=True)


def iterations(steps):
    """Figure 4: full film, and the mixed case."""
    made = rough(200)
    newton, _ = made.advance(steps)
    print(f"4. full film, a/200: {newton / steps:.2f} Newton iterations a step", flush=True)
    made = scene("table1_rough", "mesh.inlet=-1.4")
    made.advance(450)
    newton, _ = made.advance(steps)
    print(f"4. table1_rough, a/200: {newton / steps:.2f} Newton iterations a step, halved ones included")


if __name__ == "__main__":
    PETSc.Log.begin()
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="up to a/400 only")
    quick = parser.parse_args().quick
    for mesh in (200,) if quick else (200, 800):
        against_lapack(mesh)
    against_dense()
    exponent((100, 200, 400) if quick else (100, 200, 400, 800, 1600))
    iterations(200)
