"""Checks of the arguments of a simulation that is called from Python."""

import math
import os
from numbers import Integral, Real
from pathlib import Path

import numpy as np
from mpi4py import MPI

from ehlpetsc.errors import UsageError

NODE_TOLERANCE = 1e-9  # relative: nodes and half widths nearer than this are equal
MIN_STEP_RATIO = 1e-9  # smallest time step over the nominal one


def check_file(name, path):
    """Refuse an argument that is not a file name.

    Parameters
    ----------
    name : str
        Name of the argument.
    path : path-like or None

    Raises
    ------
    UsageError
    """
    if path is not None and not isinstance(path, str | Path):
        text = os.fspath(path) if isinstance(path, os.PathLike) else path
        if not isinstance(text, str):
            raise UsageError(f"{name} = {path!r}: allowed: the name of a file")


def check_comm(comm):
    """Refuse an argument that is not a communicator; UsageError."""
    if comm is not None and not isinstance(comm, MPI.Comm):
        raise UsageError(f"comm = {comm!r}: allowed: a communicator of mpi4py, as mpi4py.MPI.COMM_WORLD")


def option_texts(options):
    """PETSc options as strings by name.

    Parameters
    ----------
    options : dict or None
        None, True, False, numbers and strings by name without the dash.

    Raises
    ------
    UsageError
    """
    if not isinstance(options or {}, dict):
        raise UsageError(f"options = {options!r}: allowed: a dict of PETSc options without the dash")
    texts = {}
    for name, value in (options or {}).items():
        text = "" if value is None else str(value).lower() if isinstance(value, bool) else str(value)
        if not isinstance(name, str) or not name or not (name + text).isprintable():
            raise UsageError(f"options: {name!r}: {value!r}: allowed: names and values in one line of text")
        texts[name] = text
    return texts


def check_pass(case, scales, after, pass_number):
    """Number of a pass, after checks against the previous pass.

    Parameters
    ----------
    case : case.loading.Case
    scales : physics.scales.Scales
    after : run.simulation.Simulation or None
        The previous pass.
    pass_number : int or None

    Returns
    -------
    int

    Raises
    ------
    UsageError
    """
    min_number = after.pass_number + 1 if after is not None and hasattr(after, "pass_number") else 1
    number = min_number if pass_number is None else pass_number
    if not isinstance(number, Integral) or isinstance(number, bool) or number < min_number:
        raise UsageError(f"pass_number = {number!r}: allowed: a whole number from {min_number} on")
    if after is None:
        return int(number)
    if not hasattr(after, "solution") or not hasattr(after, "scales"):
        raise UsageError(f"after = {after!r}: allowed: the ehlpetsc.Simulation of the pass before")
    if not after.finished:
        raise UsageError("after: the pass before is not at its end; iterate over its states first")
    if after.case.contact.law != case.contact.law:
        raise UsageError(
            f"after: contact.law is {case.contact.law}, of the pass before {after.case.contact.law}"
        )
    x, before = scales.x * scales.a, after.scales.x * after.scales.a
    if len(x) != len(before) or np.abs(x - before).max() > NODE_TOLERANCE * np.ptp(before):
        raise UsageError("after: the pass before has other nodes; allowed: the same [mesh] and half width")
    return int(number)


def check_time_step(dt, simulation):
    """Refuse an impossible length of a time step, and a step after the end of the simulation.

    Parameters
    ----------
    dt : float or None
        [s]; None: of the step control.
    simulation : run.simulation.Simulation

    Raises
    ------
    UsageError
    """
    if simulation.finished:
        raise UsageError("advance: the simulation is at its end")
    if dt is None:
        return
    if simulation.solution is None:
        raise UsageError(f"dt = {dt!r}: the first state is the steady start, which has no time step")
    left = simulation.end - simulation.solution.time
    shortest = MIN_STEP_RATIO * simulation.scales.dt
    is_number = isinstance(dt, Real) and not isinstance(dt, bool) and math.isfinite(dt)
    if not is_number or not shortest <= dt <= left * (1.0 + NODE_TOLERANCE):
        raise UsageError(f"dt = {dt!r}: allowed: a number from {shortest:.3g} to the {left:.6g} s left")
