"""The program with its imports done, which forks for every run: importing costs more than most runs here.

A run has a process, arguments, a folder and streams of its own as otherwise; the modules of MPI and PETSc,
whose import starts them, are imported in it alone. Orders come in as lines of JSON, exit statuses go out.
"""

import ctypes
import gc
import importlib.util
import json
import os
import runpy
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve()
LIMIT = 300  # s, after which a run is ended
HEAVY = (
    "scipy.fft",
    "scipy.interpolate",
    "scipy.linalg",
    "scipy.ndimage",
    "ehlpetsc.__main__",
    "ehlpetsc.case.loading",
    "ehlpetsc.discretisation.ehl_problem",
    "ehlpetsc.run.cli.options",
    "ehlpetsc.results.output_guard",
    "ehlpetsc.results.reader",
    "ehlpetsc.results.restart_file",
    "ehlpetsc.results.writer",
    "ehlpetsc.run.accepted_state",
    "ehlpetsc.run.cli.command_line",
    "ehlpetsc.run.preview.banner",
    "ehlpetsc.run.preview.explain",
    "ehlpetsc.run.restart.rescaling",
    "ehlpetsc.run.series.member",
    "ehlpetsc.stepping.observables",
    "ehlpetsc.stepping.predictor",
    "ehlpetsc.stepping.steady_start",
    "ehlpetsc.surfaces.body_field",
    "ehlpetsc.surfaces.roughness",
)


class Prepared:
    """The prepared process, started when first asked; it ends with this one."""

    def __init__(self, python, environment):
        self.command, self.environment, self.process = [python, str(HERE)], environment, None

    def run(self, words, folder, environment, out, err):
        """Run a script, the first of `words`, in a folder, streams into files; returns the exit status."""
        if self.process is None:
            pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
            self.process = subprocess.Popen(self.command, env=self.environment, text=True, bufsize=1, **pipes)
        order = {"words": words, "folder": folder, "environment": environment, "out": out, "err": err}
        self.process.stdin.write(json.dumps(order, default=str) + "\n")
        return int(self.process.stdout.readline())


def load_compiled():
    """Have the compiled loops ready: to load them takes as long as all else that a short run does."""
    from ehlpetsc.case.loading import load
    from ehlpetsc.discretisation.contact.node_state import directional_derivative
    from ehlpetsc.discretisation.ehl_problem import EHLProblem, jacobian_rows
    from ehlpetsc.discretisation.finite_volumes import extrapolated, reynolds_rounding
    from ehlpetsc.physics.scales import Scales
    from ehlpetsc.stepping.predictor import advected

    case = load(HERE.parents[2] / "cases" / "table1_smooth.toml", ["mesh.points_per_half_width=20"])
    scales = Scales.of(case)
    problem, one = EHLProblem(case, scales, 1.0, 0, scales.nx), np.ones(scales.nx)
    found = problem.evaluate(one, one, 0.0, problem.inputs(0.0 * one))
    step, now = np.zeros((scales.nx, 2)), np.ones((scales.nx, 2))
    now.flags.writeable = False  # as PETSc gives it
    by, rows = found.state.derivatives(), np.empty(2 * scales.nx + 1)
    directional_derivative(by[0], step, problem.owned.start, one)
    sums = problem.deflection.sums(one)
    form, room = problem.deflection.form, np.empty((3, scales.nx))
    jacobian_rows(by, found.reynolds_derivatives, step, 0.0, *sums, *form, room, rows)
    reynolds_rounding(found.reynolds_derivatives, one, one, problem.owned.start)
    extrapolated(one, one, 1.0)
    advected(one, 1.0)
    problem.model.pressure_change(now, step)
    problem.model.clip_step(now, step, 0.0)


def load_libraries():
    """Have the libraries of MPI and PETSc in memory; what starts them is that Python imports them."""
    place = importlib.util.find_spec("petsc4py").submodule_search_locations[0]
    for path in Path(place, "lib").rglob(f"PETSc.{sys.implementation.cache_tag}-*.so"):
        ctypes.CDLL(path)


def serve():
    """Fork for every order; the child returns, ready to run, this process does not."""
    for line in sys.stdin:
        child = os.fork()
        if child == 0:
            return make_ready(**json.loads(line))
        _, ended = os.waitpid(child, 0)
        print(os.waitstatus_to_exitcode(ended), flush=True)
    os._exit(0)


def make_ready(words, folder, environment, out, err):
    """Folder, environment, streams and arguments as ordered."""
    os.chdir(folder)
    os.environ.update(environment)
    for stream, path in ((0, os.devnull), (1, out), (2, err)):
        opened = os.open(path, os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND)
        os.dup2(opened, stream)
        os.close(opened)
    signal.alarm(LIMIT)
    sys.argv = list(map(str, words))


if __name__ == "__main__":
    sys.path[0] = ""  # as for python -m: the folder of the run
    for name in HEAVY:
        __import__(name)
    load_compiled()
    load_libraries()
    assert not {"mpi4py.MPI", "petsc4py.PETSc"} & sys.modules.keys(), "started before the fork"
    gc.freeze()  # or a run's first collection would copy all that it shares with this process
    serve()
    runpy.run_path(sys.argv[0], run_name="__main__")
