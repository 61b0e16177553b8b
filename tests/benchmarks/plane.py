"""Contacts in the plane: iterations, time, memory and errors, mesh by mesh.

``python3 tests/benchmarks/plane.py [--meshes 65 129 257 513] [--ranks 1 2] [--options ksp_rtol=1e-4]``:
scenes of a circular contact, M = 200 and L = 10, each in a process of its own; every table is Markdown.

- smooth: steady start, counted as one step.
- wave: cos kx cos ky of a half-width, a hundredth of the film (2 nm), pure rolling.
- rigid, layer: self-affine roughness in mixed contact, slide/roll ratio 0.3, with a boundary film or a
  compliant layer; heavy, slow: more of the load on solids, 3 and, at 0.02 m/s, 20 %.
- heat: layer with temperatures of film and surfaces, 2 m/s, slide/roll ratio 0.5.

Waves and roughness fill the contact from the first step on (`time.start = "rough"`).

Time is processor time, on several ranks wall time; its unit is a zero-padded convolution of the mesh, the
median of some in the same process. Without waiting is the processor time of a rank outside of MPI
(`waiting.py`). The last column is the
processor time of the whole process. Errors of the smooth films, the minimum that of a parabola through 3 x 3
nodes, are against check values, extrapolated from two independent programs, and have an order and a limit;
all others are against the finest mesh at the same instant.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

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
from support.convergence import order_and_limit
from support.points import lowest, moes_film, point

from ehlpetsc.case.loading import Case, load
from ehlpetsc.run.simulation import Simulation

M, L = 200.0, 10.0
CENTRAL, LOWEST = 3.641, 1.740  # H of the smooth contact, extrapolated from two independent programs
HALF_WIDTH = 172.8907e-6  # a [m]
WAVE = {"kind": "sine", "amplitude": 2e-9, "wavelength": HALF_WIDTH, "wavelength_across": HALF_WIDTH}
ROUGH = {"kind": "self-affine", "sq": 0.15e-6, "hurst": 0.8, "seed": 1}
ROUGH |= {"roll_off": 0.5 * HALF_WIDTH, "short_cutoff": 0.25 * HALF_WIDTH}
SLIDING = {"surface.1": {"synthetic": ROUGH}, "motion.slide_roll_ratio": 0.3}
LAYER = SLIDING | {"contact.boundary_film": None}
STEEP = ROUGH | {"sq": 0.5e-6, "seed": 2}  # which does not touch at the outlet
HEAVY = LAYER | {"surface.1": {"synthetic": STEEP}, "contact.asperity_height": 30e-9}
HOT = LAYER | {"contact.asperity_height": 20e-9, "heat.bulk_temperature": 333.0}
HOT |= {"motion.entrainment_speed": 2.0, "motion.slide_roll_ratio": 0.5, "fluid.limiting_shear": 0.05}
SCENES = {
    "smooth": {},
    "wave": {"surface.1": {"synthetic": WAVE}},
    "rigid": SLIDING | {"contact.boundary_film": 10e-9},
    "layer": LAYER | {"contact.asperity_height": 20e-9},
    "heavy": HEAVY,
    "slow": HEAVY | {"motion.entrainment_speed": 0.02},
    "heat": HOT,
}
CONVOLUTIONS = 21  # timed
COLUMNS = {
    "scene": "scene",
    "nodes": "nodes",
    "ranks": "ranks",
    "steps": "steps",
    "newton": "Newton a step",
    "halved": "halved",
    "gmres": "GMRES an iteration",
    "builds": "builds a step",
    "seconds": "s a step",
    "worked": "without waiting",
    "calls": "exchanges a step",
    "sent": "MB sent",
    "convolution": "convolution, ms",
    "relative": "convolutions a step",
    "memory": "MB a rank",
    "process": "process, s",
}
ERRORS = {
    "h_c": "central film",
    "h_min": "minimum film",
    "p_max": "maximum pressure",
    "film": "local film",
    "share": "load on solids",
}


def case_of(scene: str, side: int, travel: float) -> Case:
    """Case of a scene on a square mesh of `side` nodes."""
    changes = dict(SCENES[scene])
    surface = changes.pop("surface.1", None)
    tables = point(M, L, (side - 1) // 4, changes)
    if surface:
        tables |= {"surface": {"1": surface}, "time": {"travel": travel, "start": "rough"}}
    return load(tables)


class Counter:
    """Linear iterations of a simulation, failed solves included."""

    def __init__(self, simulation: Simulation) -> None:
        self.solver, self.linear = simulation.stepper.solver, 0
        self._solve: Callable = self.solver.solve
        self.solver.solve = self.counted

    def counted(self, *arguments: object, **named: object) -> tuple:
        """Solve and count."""
        try:
            return self._solve(*arguments, **named)
        finally:
            self.linear += self.solver.snes.getLinearSolveIterations()

    @property
    def builds(self) -> int:
        """Builds of the preconditioner."""
        return self.solver.system.matrices.elimination.builds


class Traffic(MPI.Intracomm):
    """Communicator that counts its calls and the bytes that this rank sends.

    PETSc's own messages, of norms and of overlapping rows, are not among them.
    """

    calls, sent = 0, 0

    @classmethod
    def of(cls, simulation: Simulation) -> Traffic:
        """Communicator of all parts of a simulation from now on."""
        system = simulation.stepper.solver.system
        counted, elimination = cls(system.ranks), system.matrices.elimination
        parts = [system, system.exchange, system.matrices, elimination, system.jacobian]
        parts += [system.problem.deflection.convolution.ranks]
        parts += [factors.coarse for factors in (elimination.kept, elimination.factors) if factors]
        for part in filter(None, parts):
            part.ranks = counted
        return counted


def counted(name: str, size: Callable) -> Callable:
    """Method of a communicator that counts; `size`: bytes that a rank sends, of its arguments."""
    call = getattr(MPI.Intracomm, name)

    def method(ranks: Traffic, *arguments: Any, **named: Any) -> Any:
        ranks.calls, ranks.sent = ranks.calls + 1, ranks.sent + size(ranks, *arguments)
        return call(ranks, *arguments, **named)

    return method


SIZES = {
    "Alltoallv": lambda ranks, sent, received: sent[0].itemsize * (sent[1].sum() - sent[1][ranks.rank]),
    "Sendrecv": lambda ranks, sent, to, *others: sent.nbytes * (to != MPI.PROC_NULL),
    "Allreduce": lambda ranks, place, values, operation: values.nbytes,
    "allreduce": lambda ranks, value: 8,
    "allgather": lambda ranks, values: values.nbytes,
    "bcast": lambda ranks, values: values.nbytes,
}
for name, size in SIZES.items():
    setattr(Traffic, name, counted(name, size))


def inside(scene: str, side: int, travel: float, options: dict[str, str | None], fields: str | None) -> None:
    """Run a scene on all ranks; the first one prints its figures, one writes its fields."""
    comm = MPI.COMM_WORLD
    clock = time.process_time if comm.size == 1 else time.perf_counter
    simulation = Simulation(case_of(scene, side, travel), comm, options)
    counter, newton, halved, taken, at = Counter(simulation), 0, 0, [], clock()
    state = simulation.advance()
    is_steady = simulation.finished
    traffic, worked = Traffic.of(simulation) if comm.size > 1 else None, waiting.seconds_outside_mpi()
    begun, started = (0, 0) if is_steady else (counter.linear, counter.builds), clock() - at
    while not simulation.finished:
        at = clock()
        state = simulation.advance()
        taken.append(clock() - at)
        newton, halved = newton + state.newton, halved + state.retries
    steps = len(taken) or 1
    newton, seconds = (state.newton, started) if is_steady else (newton, sum(taken) / steps)
    figures = {"steps": steps, "newton": newton / steps, "halved": halved, "seconds": seconds}
    figures |= {"gmres": (counter.linear - begun[0]) / newton, "builds": (counter.builds - begun[1]) / steps}
    worked = comm.allreduce(waiting.seconds_outside_mpi() - worked, MPI.MAX) / steps
    figures |= {"worked": seconds if is_steady else worked, "calls": 0.0, "sent": 0.0}
    if traffic:
        figures |= {"calls": traffic.calls / steps, "sent": traffic.sent / steps / 1e6}
    figures |= {
        "scene": scene,
        "nodes": side,
        "ranks": comm.size,
        "convolution": convolution(simulation, clock),
    }
    used = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    figures |= {"memory": comm.allreduce(used, MPI.MAX), "process": time.process_time()}
    figures["relative"] = 1e3 * figures["seconds"] / figures["convolution"]
    if comm.rank == 0:
        print(json.dumps(figures), flush=True)
    if fields:
        share = float(getattr(state, "contact_share", 0.0))
        unit = moes_film(simulation.scales, 1.0)
        np.savez(fields, film=state.film_thickness, p_max=state.p_max, share=share, unit=unit)


def convolution(simulation: Simulation, clock: Callable[[], float]) -> float:
    """Time of a convolution of the mesh [ms]."""
    problem, taken = simulation.stepper.problem, []
    pressure = np.ascontiguousarray(simulation.dimensionless.p[problem.first : problem.last])
    for _ in range(CONVOLUTIONS):
        at = clock()
        problem.deflection.convolution(pressure)
        taken.append(clock() - at)
    return 1e3 * statistics.median(taken)


def measured(scene: str, side: int, ranks: int, chosen: argparse.Namespace, fields: Path | None) -> dict:
    """Figures of a group of processes."""
    command = ["mpirun", "-n", str(ranks), "--oversubscribe"] if ranks > 1 else []
    command += [sys.executable, __file__, "--inside", scene, "--meshes", str(side)]
    command += ["--travel", str(chosen.travel)]
    command += ["--options", *chosen.options] if chosen.options else []
    command += ["--fields", str(fields)] if fields else []
    variables = ENVIRONMENT | chosen.loaded
    printed = subprocess.run(command, env=variables, text=True, stdout=subprocess.PIPE, check=True).stdout
    return json.loads(printed.splitlines()[-1])


def smooth_films(fields: Path) -> tuple[float, float]:
    """Central and minimum film after Moes of stored fields."""
    with np.load(fields) as values:
        side, unit = round(np.sqrt(values["film"].size)), float(values["unit"])
        film = unit * values["film"].reshape(side, side)
        return film[(side - 1) // 2, 5 * (side - 1) // 8], lowest(film)


def errors(fields: Path, finest: Path, is_smooth: bool) -> dict[str, float]:
    """Relative errors against the finest mesh, of the smooth films against the check values."""
    with np.load(fields) as values, np.load(finest) as best:
        side = round(np.sqrt(values["film"].size))
        film, fine = values["film"].reshape(side, side), best["film"]
        stride = (round(np.sqrt(fine.size)) - 1) // (side - 1)
        fine = fine.reshape([round(np.sqrt(fine.size))] * 2)[::stride, ::stride]
        middle = (side - 1) // 2, 5 * (side - 1) // 8  # y = 0, x = 0
        h_c = fine[middle]
        y, x = np.meshgrid(np.linspace(-2.0, 2.0, side), np.linspace(-2.5, 1.5, side), indexing="ij")
        local = float(np.abs(film - fine)[x**2 + y**2 <= 1.0].max() / h_c)
        found = {"p_max": values["p_max"] / best["p_max"] - 1.0, "film": local}
        if is_smooth:
            of_moes = smooth_films(fields)
            found |= {"h_c": of_moes[0] / CENTRAL - 1.0, "h_min": of_moes[1] / LOWEST - 1.0}
        else:
            found |= {"h_c": film[middle] / h_c - 1.0, "h_min": film.min() / best["film"].min() - 1.0}
        if best["share"]:
            found["share"] = values["share"] / best["share"] - 1.0
    return {name: abs(float(value)) for name, value in found.items()}


def exponent(rows: list[dict]) -> float:
    """Slope of the logarithm of the time a step over that of the nodes."""
    nodes, seconds = [np.log([row[name] for row in rows]) for name in ("nodes", "seconds")]
    return float(np.polyfit(2.0 * nodes, seconds, 1)[0])


def line(cells: list[object]) -> str:
    """Line of a Markdown table."""
    words = (f"{cell:.3g}" if isinstance(cell, float) else str(cell) for cell in cells)
    return f"| {' | '.join(words)} |"


def measure(chosen: argparse.Namespace, folder: Path) -> list[dict]:
    """Rows of the first table, printed one by one."""
    rows = []
    print(line([*COLUMNS.values()]), line(["---"] * len(COLUMNS)), sep="\n", flush=True)
    for scene in chosen.scenes:
        for side in chosen.meshes:
            for ranks in chosen.ranks:
                fields = folder / f"{scene}{side}.npz" if ranks == 1 else None
                rows.append(measured(scene, side, ranks, chosen, fields))
                print(line([rows[-1][name] for name in COLUMNS]), flush=True)
    return rows


def summary(chosen: argparse.Namespace, rows: list[dict], folder: Path) -> None:
    """Print growth, speed-up and errors of the rows."""
    for scene in chosen.scenes:
        of_scene = {
            ranks: [row for row in rows if (row["scene"], row["ranks"]) == (scene, ranks)]
            for ranks in chosen.ranks
        }
        first = of_scene[chosen.ranks[0]]
        if len(first) > 1:
            print(f"\n{scene}: time a step grows with nodes to the power of {exponent(first):.2f}")
        for ranks in chosen.ranks[1:]:
            for key, what in (("seconds", ""), ("worked", " in processor time without waiting")):
                faster = [a[key] / b[key] for a, b in zip(first, of_scene[ranks], strict=True)]
                ratios = ", ".join(f"{f:.2f}" for f in faster)
                print(f"\n{scene}: {ranks} ranks over {chosen.ranks[0]}{what}: {ratios}")
    if 1 not in chosen.ranks:
        return
    print("", line(["scene", "nodes", "s", *ERRORS.values()]), line(["---"] * (3 + len(ERRORS))), sep="\n")
    for row in (row for row in rows if row["ranks"] == 1):
        scene, side = row["scene"], row["nodes"]
        if scene != "smooth" and side == max(chosen.meshes):
            continue
        found = errors(
            folder / f"{scene}{side}.npz", folder / f"{scene}{max(chosen.meshes)}.npz", scene == "smooth"
        )
        cells = [found.get(name, "") for name in ERRORS]
        print(line([scene, side, row["seconds"] * row["steps"], *cells]))
    if "smooth" in chosen.scenes and len(chosen.meshes) > 2:
        found = [smooth_films(folder / f"smooth{side}.npz") for side in sorted(chosen.meshes)[-3:]]
        for name, values in zip(("central", "minimum"), zip(*found, strict=True), strict=True):
            order, limit = order_and_limit(*values)
            print(f"\nsmooth {name} film: {values[-1]:.4f}, order {order:.2f}, limit {limit:.4f}")


def main() -> None:
    """Run the command."""
    form = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=form)
    add = parser.add_argument
    add("--meshes", type=int, nargs="+", default=[65, 129, 257], help="nodes a side, 4 k + 1")
    add("--ranks", type=int, nargs="+", default=[1])
    add("--scenes", nargs="+", choices=SCENES, default=[*SCENES])
    add("--travel", type=float, default=0.25, help="half-widths after the start")
    add("--options", nargs="+", default=[], metavar="NAME[=VALUE]", help="PETSc options without the dash")
    add("--inside", help=argparse.SUPPRESS)
    add("--fields", help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    if chosen.inside:
        pairs = (word.partition("=") for word in chosen.options)
        options = {name: value or None for name, _, value in pairs}
        return inside(chosen.inside, chosen.meshes[0], chosen.travel, options, chosen.fields)
    with tempfile.TemporaryDirectory() as folder:
        chosen.loaded = waiting.preload(Path(folder)) if max(chosen.ranks) > 1 else {}
        summary(chosen, measure(chosen, Path(folder)), Path(folder))


if __name__ == "__main__":
    main()
