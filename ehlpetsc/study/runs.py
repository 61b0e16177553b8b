"""Run of a case in a separate process with a time limit: scalars, exit status, last message."""

import contextlib
import csv
import math
import os
import resource
import signal
import subprocess
import sys
import time as clock
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from ehlpetsc.case.loading import load
from ehlpetsc.errors import OutputError, PostError
from ehlpetsc.physics.rheology import viscosity
from ehlpetsc.physics.scales import Scales
from ehlpetsc.results.post_result import PostResult, post_path
from ehlpetsc.results.reader import read_result
from ehlpetsc.results.totals import Totals

TIMED_OUT = -1  # in addition to the exit statuses of the program


@dataclass
class Outcome:
    """Outcome of a run.

    Attributes
    ----------
    status : int
        Exit status of ``python3 -m ehlpetsc``, or `TIMED_OUT`.
    message : str
        Last line of the output, or the reason of an early end.
    steps, retries, newton : int
        Sums over the run, including the steady start.
    h_min, p_max, viscosity : float
        Minimum film [m], maximum pressure [Pa] and its viscosity [Pa s] of all steps.
    load_error, mass_error : float
        Maximum relative errors of all steps.
    seconds, wall : float
        Wall clock time of the process, and of its time steps [s].
    processor : float
        Processor time of the process [s].
    result : Path or None
        Result file; None without a stored step.
    """

    status: int
    message: str = ""
    steps: int = 0
    retries: int = 0
    newton: int = 0
    h_min: float = np.nan
    p_max: float = np.nan
    viscosity: float = np.nan
    load_error: float = np.nan
    mass_error: float = np.nan
    seconds: float = 0.0
    wall: float = 0.0
    processor: float = 0.0
    result: Path | None = field(default=None, repr=False)


def command(case, overrides, options, ranks, output):
    """Command line that runs a case."""
    words = [sys.executable, "-m", "ehlpetsc", str(case)]
    if ranks > 1:
        words = ["mpirun", "-n", str(ranks), *words]
    for override in overrides:
        words += ["-ehl_set", override]
    return [*words, "-ehl_output", str(output), *options]


def run(case, overrides=(), *, options=(), ranks=1, folder, name="run", limit=600.0):
    """Run a case file in a separate process.

    Parameters
    ----------
    case : path-like
    overrides : sequence of str
        ``table.key=value``.
    options : sequence of str
        Further arguments of the command line.
    ranks : int
    folder : path-like
        Folder of result, restart file and output of the program.
    name : str
        Stem of those files.
    limit : float
        Wall clock time [s] after which the process is ended.

    Returns
    -------
    Outcome
    """
    output = Path(folder) / f"{name}.h5"
    for left in (output, output.with_suffix(".restart.h5")):  # of an earlier run with this name
        left.unlink(missing_ok=True)
    begun, used = clock.monotonic(), _processor_time()
    with open(output.with_suffix(".txt"), "w+") as printed:
        status = _wait(command(case, overrides, options, ranks, output), printed, limit)
        seconds = clock.monotonic() - begun
        printed.seek(0)
        outcome = Outcome(
            status, last_message(printed.read()), seconds=seconds, processor=_processor_time() - used
        )
    if output.exists():
        outcome = replace(outcome, **_read_scalars(output, load(case, overrides), outcome.message))
    return outcome


def check_damage(case, surface, mesh):
    """Refuse damage, before any run, if no point of a surface would pass the whole mesh.

    Parameters
    ----------
    case : case.loading.Case
    surface : str
        "1" or "2".
    mesh : int
        Points per half width of the coarsest run, whose mesh may be half a spacing wider than that of the
        case.

    Raises
    ------
    PostError
    """
    if not case.time:
        raise PostError("--damage: the case is steady; damage takes a [time] section, with time.travel")
    scales = Scales.of(case)
    speed = abs(scales.u1 if surface == "1" else scales.u2)
    if not speed:
        raise PostError(f"--damage: surface {surface} is at rest, and none of its points has a passage")
    width = case.mesh.outlet - case.mesh.inlet
    needed = (width + 1.0 / mesh) * scales.u_max / speed
    if case.time.travel < needed:
        raise PostError(
            f"--damage: within a travel of {case.time.travel:g} a no point of surface {surface} passes "
            f"the whole mesh, {width:g} a wide; allowed: time.travel = {math.ceil(100.0 * needed) / 100.0:g} "
            "or more"
        )


def greatest_damage(path, surface, depths=()):
    """Maximum fatigue damage on a surface at each depth [half widths]; by default at the depths of the case.

    Returns
    -------
    ndarray, shape (ndepths,)

    Raises
    ------
    PostError
        See `ehlpetsc.post`; for instance, the travel is too short for one passage.
    """
    output = post_path(path)
    words = [sys.executable, "-m", "ehlpetsc.post", str(path), "-o", str(output), "--surface", surface]
    words += ["--depths", *map(str, depths)] if depths else []
    done = subprocess.run(words, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    if done.returncode:
        raise PostError(f"no damage: {last_message(done.stderr)}")
    greatest = PostResult(output).passed(surface).max(axis=1)
    output.unlink()
    return greatest


@contextlib.contextmanager
def csv_table(path, columns):
    """Function that appends a row, a dict by column, to a new CSV file and writes it to disk at once.

    Parameters
    ----------
    path : path-like
    columns : sequence of str
    """
    with open(path, "w", newline="") as file:
        writer = csv.DictWriter(file, columns)
        writer.writeheader()

        def append(row):
            writer.writerow(row)
            file.flush()

        yield append


def _processor_time():
    """Processor time of all processes that have ended [s]."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _wait(words, stream, limit):
    process = subprocess.Popen(
        words, stdout=stream, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, start_new_session=True
    )
    try:
        return process.wait(limit)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        return TIMED_OUT


def last_message(text):
    """Line with the reason of an early end: message of the solver, otherwise last line."""
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    failures = [line for line in lines if line.startswith("ehlpetsc: not converged:")]
    return (failures or lines or [""])[-1].removeprefix("ehlpetsc: not converged: ")


def _read_scalars(path, case, message):
    """Fields of an `Outcome` from a result file; the message names a damaged file."""
    try:
        with read_result(path) as result:
            totals = Totals.of_result(result).values
    except OutputError as error:
        return {"message": f"{message} {error}".strip()}
    if not totals:
        return {}
    names = ("newton", "retries", "h_min", "p_max", "wall", "load_error", "mass_error")
    scalars = {"result": path, "steps": totals["step"]} | {name: totals[name] for name in names}
    if case.fluid:
        ratio = viscosity(np.array([totals["p_max"]]), case.fluid)[0][0]
        scalars["viscosity"] = float(case.fluid.viscosity * np.exp(min(ratio, 700.0)))
    return scalars
