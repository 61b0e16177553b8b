"""A Newton iteration against LAPACK: ``python3 tests/benchmarks/newton_speed.py``.

1. an iteration of SNES, with all that it does, over LAPACK's banded solve alone of the matrix of a near field
   of 30 nodes, in full film and where both rough surfaces fill the contact, at a/200 and a/800;
2. time a step against nodes, a/100 to a/1600: the exponent;
3. Newton iterations a step.

Each pair is timed in turns in this process, medians: wall time of SNES, processor time of all else.
"""

import argparse
import statistics
import time

import numpy as np
from petsc4py import PETSc
from scenes import rough, scene, timed
from scipy.linalg import lapack

from ehlpetsc.nonlinear.jacobian import NearFieldMatrix

HALF_BAND = 30  # nodes
PAIRS = 9


def cpu(call, repeats):
    """Median CPU seconds."""
    times = []
    for _ in range(repeats):
        begun = time.process_time()
        call()
        times.append(time.process_time() - begun)
    return statistics.median(times)


def near_field(system, near):
    """Rows, columns and values of the last Jacobian with the deflection of `near` nodes."""
    matrix = PETSc.Mat().createAIJ((system.x.getSizes(),) * 2, comm=system.comm)
    given = system.jacobian.state, system.jacobian.reynolds_derivatives
    NearFieldMatrix(system.problem, near, matrix).fill(*given)
    pointers, columns, values = matrix.getValuesCSR()
    return np.repeat(np.arange(len(pointers) - 1), np.diff(pointers)), columns, values


def banded(system):
    """The near field's matrix without the load row, in LAPACK's banded storage."""
    n = 2 * system.n
    rows, columns, values = near_field(system, HALF_BAND)
    inside = (rows < n) & (columns < n)
    rows, columns, values = rows[inside], columns[inside], values[inside]
    width = int(np.abs(rows - columns).max())
    band = np.zeros((3 * width + 1, n), order="F")
    band[2 * width + rows - columns, columns] = values
    return band, width


def against_lapack(points, made, what):
    """Ratio 1."""
    system = made.solver.system
    band, width = banded(system)
    right = np.ones((band.shape[1], 2), order="F")  # residual and the column of h00

    def solve():
        factors, pivots, info = lapack.dgbtrf(band, width, width)
        assert info == 0
        lapack.dgbtrs(factors, width, width, right, pivots)

    spent, ratios, ours = timed(made.solver), [], []
    for _ in range(PAIRS):
        spent[0] = 0.0
        newton, _ = made.advance(5)
        ours.append(1e3 * spent[0] / newton)
        ratios.append(ours[-1] / (1e3 * cpu(solve, 3)))
    print(
        f"1. a/{points}, {system.n} nodes, {what}: SNES {statistics.median(ours):.2f} ms an iteration, "
        f"over LAPACK's banded solve (half band {width}) {statistics.median(ratios):.2f} "
        f"({min(ratios):.2f} to {max(ratios):.2f})",
        flush=True,
    )


def in_contact(points):
    """The measured surfaces at full height."""
    made = scene("table1_rough", "mesh.inlet=-1.4", f"mesh.points_per_half_width={points}")
    made.advance(int(450 * points / 200))
    return made


def exponent(meshes):
    """Slope 2, at the same time and with a step of the same courant number."""
    nodes, seconds = [], []
    for points in meshes:
        made = rough(points, -1.4)
        nodes.append(made.solver.system.n)
        seconds.append(statistics.median(made.advance(4)[1] / 4 for _ in range(5)))
        print(f"2. a/{points}: {nodes[-1]} nodes, {1e3 * seconds[-1]:.1f} ms a step", flush=True)
    slope = np.polyfit(np.log(nodes), np.log(seconds), 1)[0]
    print(f"2. time a step goes with nodes to the power {slope:.2f}", flush=True)


def iterations(steps=200):
    """Figure 3, halved steps included."""
    for made, name in ((rough(200), "full film"), (in_contact(200), "table1_rough")):
        newton, _ = made.advance(steps)
        print(f"3. {name}, a/200: {newton / steps:.2f} Newton iterations a step", flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="up to a/400 only")
    quick = parser.parse_args().quick
    for mesh in (200,) if quick else (200, 800):
        against_lapack(mesh, rough(mesh), "full film")
        against_lapack(mesh, in_contact(mesh), "in contact")
    exponent((100, 200, 400) if quick else (100, 200, 400, 800, 1600))
    iterations()
