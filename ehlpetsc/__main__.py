"""``mpirun -n N python3 -m ehlpetsc CASE.toml [options]``: run a case; ``-help`` lists the options."""

import errno
import signal
import sys
import warnings

from ehlpetsc import streams
from ehlpetsc.errors import ExitStatus

QUIET = ("-no_signal_handler",)  # PETSc would end the process with a report of its own
STOPS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGUSR1)  # until the run takes them


def main(argv):
    """Run the command; returns its exit status."""
    from ehlpetsc import environment
    from ehlpetsc.errors import UsageError

    missing = environment.prepare()
    if missing:
        return refuse(environment.advice(missing, argv[1:]))
    if argv[1:2] in (["--keys"], ["--template"]):
        return print_keys(argv[1:])
    from ehlpetsc.run.command_line import options_list, parse_command_line

    try:
        command = parse_command_line(argv[1:])
    except UsageError as error:
        return refuse(f"ehlpetsc: {error}")
    if command.case is None and first_only_help(command.petsc):
        from ehlpetsc.environment import first_rank

        if first_rank():
            print(options_list())
        return output_status()
    if command.explain or command.ranks:
        return explain(command)
    nowhere = environment.startup_problem()
    if nowhere:
        return refuse(f"ehlpetsc: {nowhere}")
    import petsc4py

    try:
        petsc4py.init([argv[0], *QUIET, *command.petsc])
    except RuntimeError as error:  # PETSc's own kind, which cannot be imported before it has begun
        return refuse(f"ehlpetsc: PETSc cannot begin with {' '.join(command.petsc)}: {error}")
    from petsc4py import PETSc

    PETSc.Options().delValue(QUIET[0])  # it is no option of the run
    from ehlpetsc.run.command import run

    return run(command.case, command.overrides)


def first_only_help(words):
    """Whether the command line asks for the list of options and for nothing of PETSc's."""
    return words == ["-help"]


def print_keys(words):
    """Print every key of a case file, of one table, or a commented case."""
    from ehlpetsc.case import key_page
    from ehlpetsc.environment import first_rank
    from ehlpetsc.errors import UsageError

    try:
        text = key_page.template() if words[0] == "--template" else key_page.keys(*words[1:2]) + "\n"
    except UsageError as error:
        return refuse(f"ehlpetsc: {error}")
    if first_rank():
        print(text, end="")
    return output_status()


def explain(command):
    """Print the scene in words, or the number of ranks that it is worth."""
    from ehlpetsc.case.loading import load
    from ehlpetsc.environment import first_rank
    from ehlpetsc.errors import CaseError
    from ehlpetsc.run.preview.banner import worthwhile_ranks
    from ehlpetsc.run.preview.explain import explain as words

    try:
        text = (worthwhile_ranks if command.ranks else words)(load(command.case, command.overrides))
    except CaseError as error:
        return refuse("\n".join(error.faults))
    if first_rank():
        print(text)
    return output_status()


def output_status():
    """Status of a command whose output is all there is of it: bad input where that has no room."""
    sys.stdout.flush()
    lost = getattr(sys.stdout, "lost", None)
    return ExitStatus.DONE if lost is None or lost.errno == errno.EPIPE else ExitStatus.BAD_INPUT


def refuse(text):
    """Say once, not on every rank, what is wrong; bad input."""
    from ehlpetsc.environment import first_rank

    if first_rank():
        print(text, file=sys.stderr, flush=True)
    return ExitStatus.BAD_INPUT


def run_guarded(argv):
    """Run `main`; an unexpected error on one rank ends all of them, with its traceback."""
    if not sys.warnoptions:  # those of numpy are for developers: python3 -W default shows them
        warnings.simplefilter("ignore")
    streams.harden_std_streams()
    asked = stops_raise()
    try:
        status = main(argv)
    except SystemExit:
        raise
    except BaseException as error:  # any other way out would leave the other ranks waiting for ever
        status = ended(error, asked)
        if "mpi4py.MPI" in sys.modules:
            mpi = sys.modules["mpi4py.MPI"]
            if mpi.COMM_WORLD.size > 1:
                mpi.COMM_WORLD.Abort(status)
    signal.signal(signal.SIGUSR1, signal.SIG_IGN)  # said again by run_mpi.sh, it would end Python as it ends
    sys.stdout.flush()
    sys.stderr.flush()
    return status


class Interrupted(BaseException):
    """A signal to stop; after a KeyboardInterrupt inside an import Python would end by the signal itself."""


class EarlyStop:
    """Handler of the signals that come before the run takes them.

    Attributes
    ----------
    asked : list
        Empty until one has come.
    """

    def __init__(self):
        self.asked = []

    def __call__(self, *_):
        self.asked.append(True)
        raise Interrupted


def stops_raise():
    """From now on a signal to stop is an `Interrupted`; returns whether one has come.

    One that comes inside a callback of numba's compiler is lost there: `stop.asked` is for who handles
    signals next.
    """
    stop, previous_hook = EarlyStop(), sys.unraisablehook
    sys.unraisablehook = lambda lost: None if isinstance(lost.exc_value, Interrupted) else previous_hook(lost)
    for name in STOPS:
        if signal.getsignal(name) is not signal.SIG_IGN:  # nohup
            signal.signal(name, stop)
    return lambda: bool(stop.asked)


def ended(error, asked):
    """Say what has ended a command from inside; returns its status."""
    if asked():  # an import may have made another error of it
        from ehlpetsc.environment import first_rank

        if first_rank():
            print("ehlpetsc: stopped before the run had begun; nothing to go on with", file=sys.stderr)
        return ExitStatus.STOPPED
    import traceback

    traceback.print_exception(error)
    sys.stdout.flush()
    sys.stderr.flush()
    return ExitStatus.BUG


if __name__ == "__main__":
    from ehlpetsc.commands import dispatch

    sys.exit(dispatch(lambda: run_guarded(sys.argv)))
