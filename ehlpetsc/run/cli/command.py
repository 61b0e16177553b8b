"""Run command: one case on all ranks, or a series on groups of ranks. Only rank 0 reads the case file."""

import sys
from pathlib import Path

from mpi4py import MPI
from petsc4py import PETSc

from ehlpetsc.case.loading import load
from ehlpetsc.errors import CaseError, ExitStatus, OutputError, UsageError
from ehlpetsc.nonlinear.scheme import check_scheme
from ehlpetsc.run.cli.options import faults, text_of, time_limit
from ehlpetsc.run.preview.banner import banner
from ehlpetsc.run.preview.warnings import warnings
from ehlpetsc.run.series.passes import Passes
from ehlpetsc.run.series.series import Series
from ehlpetsc.run.simulation import Simulation
from ehlpetsc.run.solve import Run
from ehlpetsc.run.stop import StopRequest


def read_case(comm, path, overrides):
    """Case on every rank; None if it is faulty (reported on rank 0)."""
    case = None
    if comm.rank == 0:
        try:
            case = load(path, overrides)
        except CaseError as error:
            print("\n".join(error.faults), file=sys.stderr, flush=True)
    return comm.bcast(case)


def refuse(comm, lines):
    """Print the faults of the input on rank 0."""
    table = PETSc.Options()
    for name in table.getAll():
        table.hasName(name)  # newer releases of PETSc would list unused options as well
    if comm.rank == 0:
        print("\n".join(lines), file=sys.stderr, flush=True)
    return ExitStatus.BAD_INPUT


def run(path, overrides):
    """Run a case file on all ranks; with -help print PETSc's options. Returns the exit status."""
    comm, options = MPI.COMM_WORLD, PETSc.Options()
    try:
        stop = StopRequest(time_limit(options))
        check_scheme(text_of(options, "ehl_scheme"))
    except UsageError as error:
        return refuse(comm, [f"ehlpetsc: {error}"])
    wrong = faults(options.getAll())
    if wrong:
        return refuse(comm, wrong)
    case = path and read_case(comm, path, overrides)
    if path and case is None:
        return ExitStatus.BAD_INPUT
    try:
        if options.hasName("help"):
            if case:
                Simulation(case, comm)  # PETSc's objects print their options when they are created
            return ExitStatus.DONE
        output = text_of(options, "ehl_output") or Path(case.path).stem + ".h5"
        several = case.time is not None and case.time.passes > 1
        if case.series and several:
            allowed = "one of them at a time; a member: -ehl_set KEY=VALUE -ehl_output NAME.h5"
            return refuse(comm, [f"{case.path}: [series] and time.passes: {allowed}"])
        if case.series:
            return Series(comm, case, options, stop, output).run()
        overwrite = options.getBool("ehl_overwrite", False)
        restart = text_of(options, "ehl_restart")
        if several:
            return Passes(comm, case, output, stop).run(restart, overwrite)
        return run_single(comm, case, stop, output, restart, overwrite)
    except CaseError as error:
        return refuse(comm, error.faults)
    except (OutputError, UsageError) as error:
        return refuse(comm, [f"ehlpetsc: {error}"])


def run_single(comm, case, stop, output, restart, overwrite):
    """Run a case that is not a series on all ranks. Returns the exit status."""
    simulation = Simulation(case, comm)
    if comm.rank == 0:
        for line in banner(case, simulation.scales, simulation.roughness, comm.size):
            print(line)
        for line in warnings(case, simulation.scales):
            print(f"warning: {line}", flush=True)
    return Run(simulation, output, stop).run(restart, overwrite).status
