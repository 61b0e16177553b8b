"""``mpirun -n N python3 -m ehlpetsc CASE.toml [options]``: run a case; ``-help`` lists the options."""

import errno
import os
import signal
import sys
import traceback
import warnings

from ehlpetsc import environment
from ehlpetsc.errors import CaseError, ExitStatus, UsageError
from ehlpetsc.run.cli.streams import harden_std_streams
from ehlpetsc.run.stop import EarlyStop

NO_SIGNAL_HANDLER = "-no_signal_handler"  # PETSc's handler would end the process with its own report


def main(argv):
    """Run the command; returns its exit status."""
    missing = environment.prepare()
    if missing:
        return refuse(environment.advice(missing, argv[1:]))
    if argv[1:2] in (["--keys"], ["--template"]):
        return print_keys(argv[1:])
    from ehlpetsc.run.cli.command_line import parse_command_line
    from ehlpetsc.run.cli.options import help_text

    try:
        command = parse_command_line(argv[1:])
    except UsageError as error:
        return refuse(f"ehlpetsc: {error}")
    if "-help" in [*command.petsc, *os.environ.get("PETSC_OPTIONS", "").split()]:
        status = print_once(help_text())
        if command.case is None and command.petsc == ["-help"]:  # works without PETSc
            return status
    if command.explain or command.ranks:
        return explain(command)
    problem = environment.startup_problem()
    if problem:
        return refuse(f"ehlpetsc: {problem}")
    import petsc4py

    try:
        petsc4py.init([argv[0], NO_SIGNAL_HANDLER, *command.petsc])
    except RuntimeError as error:  # PETSc.Error, which cannot be imported before initialisation
        return refuse(f"ehlpetsc: PETSc cannot begin with {' '.join(command.petsc)}: {error}")
    from petsc4py import PETSc

    PETSc.Options().delValue(NO_SIGNAL_HANDLER)  # not an option of the run
    from ehlpetsc.run.cli.command import run

    return run(command.case, command.overrides)


def print_keys(arguments):
    """Print the keys of a case file or of one table, or a commented case; returns the exit status."""
    from ehlpetsc.case import key_page

    try:
        is_template = arguments[0] == "--template"
        text = key_page.template() if is_template else key_page.keys(*arguments[1:2]) + "\n"
    except UsageError as error:
        return refuse(f"ehlpetsc: {error}")
    return print_once(text, end="")


def explain(command):
    """Print the summary of a case, or its default number of ranks; returns the exit status."""
    from ehlpetsc.case.loading import load
    from ehlpetsc.run.preview.banner import worthwhile_ranks
    from ehlpetsc.run.preview.explain import explain as summary

    try:
        return print_once(
            (worthwhile_ranks if command.ranks else summary)(load(command.case, command.overrides))
        )
    except CaseError as error:
        return refuse("\n".join(error.faults))


def print_once(text, end="\n"):
    """Print on one rank; returns the exit status, bad input if standard output cannot be written."""
    if environment.first_rank():
        print(text, end=end)
    sys.stdout.flush()
    lost = getattr(sys.stdout, "lost", None)
    return ExitStatus.DONE if lost is None or lost.errno == errno.EPIPE else ExitStatus.BAD_INPUT


def refuse(text):
    """Print a fault on one rank; returns the exit status of bad input."""
    if environment.first_rank():
        print(text, file=sys.stderr, flush=True)
    return ExitStatus.BAD_INPUT


def run_guarded(argv):
    """Run `main`; an unexpected error on one rank ends all ranks, with its traceback."""
    if not sys.warnoptions:  # warnings of numpy are for developers: python3 -W default shows them
        warnings.simplefilter("ignore")
    harden_std_streams()
    stop = EarlyStop()
    try:
        status = main(argv)
    except SystemExit:
        raise
    except BaseException as error:  # otherwise the other ranks would wait for ever
        status = _after_error(error, stop)
        if "mpi4py.MPI" in sys.modules:
            mpi = sys.modules["mpi4py.MPI"]
            if mpi.COMM_WORLD.size > 1:
                mpi.COMM_WORLD.Abort(status)
    signal.signal(signal.SIGUSR1, signal.SIG_IGN)  # run_mpi.sh may repeat it while Python ends
    sys.stdout.flush()
    sys.stderr.flush()
    return status


def _after_error(error, stop):
    """Report an error, or the stop that caused it; returns the exit status."""
    if stop.is_requested:  # an import may have raised another error instead
        if environment.first_rank():
            print("ehlpetsc: stopped before the run had begun; nothing to continue from", file=sys.stderr)
        return ExitStatus.STOPPED
    traceback.print_exception(error)
    sys.stdout.flush()
    sys.stderr.flush()
    return ExitStatus.BUG


if __name__ == "__main__":
    from ehlpetsc.commands import dispatch

    sys.exit(dispatch(lambda: run_guarded(sys.argv)))
