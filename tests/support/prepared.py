"""A process with all imports done that forks for every run: importing takes longer than most runs here.

Each run has its own process, arguments, folder and streams. The modules of MPI and PETSc are imported in the
forked process only, because their import initialises them. Requests are lines of JSON on standard input, exit
statuses lines on standard output.
"""

import contextlib
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
from unittest import mock

HERE = Path(__file__).resolve()
ROOT = HERE.parents[2]
LIMIT = 300  # [s] of a run
HEAVY = """
scipy.fft scipy.interpolate scipy.linalg scipy.ndimage ehlpetsc.__main__ ehlpetsc.case.loading
ehlpetsc.discretisation.ehl_problem ehlpetsc.effects.heat.step ehlpetsc.results.output_guard
ehlpetsc.results.reader ehlpetsc.run.checkpoint ehlpetsc.results.means ehlpetsc.results.writer
ehlpetsc.commands.run ehlpetsc.run.forecast.validity ehlpetsc.run.forecast.limits
ehlpetsc.run.forecast.cost ehlpetsc.run.forecast.explain ehlpetsc.stepping.observables
ehlpetsc.stepping.state ehlpetsc.stepping.steady_start
ehlpetsc.surfaces.motion.body_field ehlpetsc.surfaces.motion.roughness
""".split()


class Prepared:
    """Client of the prepared process, which starts at the first run and ends with this process."""

    def __init__(self, python, environment):
        self.command, self.environment, self.process = [python, str(HERE)], environment, None

    def run(self, words, folder, environment, out, err):
        """Exit status of a script, the first of `words`, run in `folder` with its output in files."""
        if self.process is None:
            pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
            self.process = subprocess.Popen(self.command, env=self.environment, text=True, bufsize=1, **pipes)
        request = {"words": words, "folder": folder, "environment": environment, "out": out, "err": err}
        self.process.stdin.write(json.dumps(request, default=str) + "\n")
        return int(self.process.stdout.readline())


@contextlib.contextmanager
def temporary_modules(modules):
    """Add modules to `sys.modules`; drop them, and what is imported of the package meanwhile, at the end."""
    before = set(sys.modules)
    sys.modules.update(modules)
    yield
    for name in sys.modules.keys() - before:
        if name in modules or name.startswith("ehlpetsc."):
            del sys.modules[name]


def load_kernels():
    """Import the solver's modules with stand-ins for MPI and PETSc, for their compiled functions.

    Loading compiled code takes a third of a short run. The modules are dropped again: a run imports them with
    MPI and PETSc, and `compiled.compiled` then adds the code that is loaded already. Code for named tuples
    of a dropped module is not among it, as that module then has another class of the same name.
    """
    from numba.core.dispatcher import Dispatcher

    library = importlib.util.find_spec("mpi4py.MPI").origin
    stand_ins = {"mpi4py.MPI": mock.MagicMock(__file__=library), "petsc4py.PETSc": mock.MagicMock()}
    stand_ins["petsc4py.PETSc"].SNES.ConvergedReason.DIVERGED_FNORM_NAN = -4  # sought by its name
    with temporary_modules(stand_ins):
        for path in sorted((ROOT / "ehlpetsc").glob("nonlinear/**/[!_]*.py")):
            importlib.import_module(".".join(path.relative_to(ROOT).with_suffix("").parts))
        modules = {name: module for name, module in sys.modules.items() if name.startswith("ehlpetsc.")}
    for name in modules.keys() - sys.modules.keys():
        package, _, attribute = name.rpartition(".")
        if package in sys.modules:
            delattr(sys.modules[package], attribute)
    values = (value for module in modules.values() for value in vars(module).values())
    kernels = {
        (one.py_func.__module__, one.py_func.__qualname__): one
        for one in values
        if isinstance(one, Dispatcher) and hasattr(one._cache, "_cache_file")
    }
    original = compiled.compiled

    def with_loaded_code(function=None, **options):
        if function is None:
            return lambda function: with_loaded_code(function, **options)
        kernel, name = original(function, **options), (function.__module__, function.__qualname__)
        for code in kernels[name].overloads.values() if name in kernels else ():
            kernel.add_overload(code)
        return kernel

    compiled.compiled = with_loaded_code
    return kernels, modules


def load_cached(kernels, modules):
    """Load code that earlier runs have compiled into numba's cache."""
    with temporary_modules(modules):  # numba imports the module of each function
        for kernel in kernels.values():
            for signature, *_ in kernel._cache._cache_file._load_index():
                if signature not in kernel.overloads:
                    kernel.compile(signature)


def load_libraries():
    """Load the libraries of MPI and PETSc without initialising them, which the import in Python does."""
    place = importlib.util.find_spec("petsc4py").submodule_search_locations[0]
    for path in Path(place, "lib").rglob(f"PETSc.{sys.implementation.cache_tag}-*.so"):
        ctypes.CDLL(path)


def serve(kernels, modules):
    """Fork for every request; only the child returns, ready to run."""
    for line in sys.stdin:
        load_cached(kernels, modules)
        child = os.fork()
        if child == 0:
            return make_ready(**json.loads(line))
        _, ended = os.waitpid(child, 0)
        print(os.waitstatus_to_exitcode(ended), flush=True)
    os._exit(0)


def make_ready(words, folder, environment, out, err):
    """Set folder, environment, streams and arguments as requested."""
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
    load_libraries()
    from ehlpetsc.base import compiled

    kernels, modules = load_kernels()
    load_cached(kernels, modules)
    assert not {"mpi4py.MPI", "petsc4py.PETSc"} & sys.modules.keys(), "started before the fork"
    gc.freeze()  # or a run's first collection would copy all that it shares with this process
    serve(kernels, modules)
    runpy.run_path(sys.argv[0], run_name="__main__")
