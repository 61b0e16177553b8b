"""The command: one case on all ranks, or a series on groups of them. Rank 0 alone reads the case."""

import sys
from pathlib import Path

from mpi4py import MPI
from petsc4py import PETSc

from ehlpetsc.case.loading import load
from ehlpetsc.errors import CaseError, NotConverged, OutputError, UsageError
from ehlpetsc.nonlinear.newton import set_defaults
from ehlpetsc.nonlinear.options import faults, help_text, text_of, time_limit
from ehlpetsc.nonlinear.scheme import scheme
from ehlpetsc.run.series import Series
from ehlpetsc.run.simulation import NOT_CONVERGED, Run
from ehlpetsc.run.stop import StopRequest

BAD_INPUT = 2


def read_case(comm, path, overrides):
    """The case on every rank, or None where it is faulty (told on rank 0)."""
    case = None
    if comm.rank == 0:
        try:
            case = load(path, overrides)
        except CaseError as error:
            print("\n".join(error.faults), file=sys.stderr, flush=True)
    return comm.bcast(case)


def refuse(comm, lines):
    """Say on rank 0 what is wrong with the input."""
    if comm.rank == 0:
        print("\n".join(lines), file=sys.stderr, flush=True)
    return BAD_INPUT


def run(path, overrides):
    """Run a case file on all ranks; without one, list the options. Returns the exit status."""
    comm, options = MPI.COMM_WORLD, PETSc.Options()
    try:
        stop = StopRequest(time_limit(options))
        scheme(options)
    except UsageError as error:
        return refuse(comm, [f"ehlpetsc: {error}"])
    wrong = faults(options.getAll())
    if wrong:
        return refuse(comm, wrong)
    case = path and read_case(comm, path, overrides)
    if path and case is None:
        return BAD_INPUT
    try:
        if case and options.hasName("help"):
            set_defaults(options, case.petsc)
            Run(comm, case, options, stop, "none.h5")  # PETSc's own objects tell theirs as they are made
        if options.hasName("help"):
            PETSc.Sys.Print(help_text())
            return 0
        output = text_of(options, "ehl_output") or Path(case.path).stem + ".h5"
        if case.series:
            return Series(comm, case, options, stop, output).go()
        return run_single(comm, case, options, stop, output)
    except (OutputError, UsageError) as error:
        return refuse(comm, [f"ehlpetsc: {error}"])


def run_single(comm, case, options, stop, output):
    """A case that is no series, on all ranks. Returns the exit status."""
    entered = set_defaults(options, case.petsc)
    try:
        this = Run(comm, case, options, stop, output)
        this.announce()
        return this.go(text_of(options, "ehl_restart"))
    except NotConverged as error:
        if comm.rank == 0:
            print(f"ehlpetsc: not converged: {error}", file=sys.stderr, flush=True)
        return NOT_CONVERGED
    finally:
        for name in entered:  # -options_left is to list the user's alone
            options.delValue(name)
