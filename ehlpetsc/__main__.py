"""The program: ``ehlpetsc CASE.toml`` runs a case, ``ehlpetsc plot RESULT.h5`` draws, and so on: `COMMANDS`.

``ehlpetsc -n N CASE.toml``, or ``mpirun -n N python3 -m ehlpetsc CASE.toml``, runs it on N ranks. A command
imports only what it needs, and names the packages that are missing.
"""

import difflib
import gc
import importlib
import io
import os
import shutil
import signal
import sys
import threading
import traceback
import warnings
from collections.abc import Iterator
from pathlib import Path
from types import TracebackType

import ehlpetsc.base.environment as packages
from ehlpetsc.base.environment import NUMERICS, READING
from ehlpetsc.base.errors import (
    CaseError,
    ExitStatus,
    OutputError,
    UsageError,
    is_of_standard_output,
    not_written,
)
from ehlpetsc.base.toml_file import is_plain
from ehlpetsc.base.version import __version__
from ehlpetsc.run.ranks import StopRequest

MAX_RANKS = 99999
FIRST_FILE = 3  # number of the first file after the standard streams
SECONDS_TO_REPEAT = 0.1  # after which the callback has returned
LOST_INTERRUPTS: list[object] = []  # the callbacks
INTERRUPTED = 130  # exit status of a script after Ctrl-C, as shells have it
DRAWING, FORECAST = (*NUMERICS, "matplotlib"), (*READING, "h5py")


# module of `ehlpetsc.commands` and its function, by default main, packages that it needs, description
COMMANDS = {
    "post": ("post", NUMERICS, "stresses, fatigue damage, statistics"),
    "plot": ("plot", DRAWING, "pictures of results, of a series or of a case"),
    "summary": ("summary", NUMERICS, "means, percentiles and extremes as CSV"),
    "compare": ("compare", NUMERICS, "two results field by field"),
    "gears": ("gears", DRAWING, "path of contact of a gear pair, and a run along it"),
    "table": ("table", packages.NEEDED, "friction and film over conditions, for other programs"),
    "stiffness": ("stiffness", packages.NEEDED, "stiffness and damping of a smooth contact"),
    "life": ("life", DRAWING, "wear against fatigue over many passes"),
    "converge": ("converge", DRAWING, "a case on three meshes: order, limit and error bar"),
    "surface": ("surface", DRAWING, "roughness parameters of a profile or map file"),
    "explain": ("explain", FORECAST, "film, run time, effects of a case"),
    "keys": ("keys", READING, "keys of a case: meaning, unit, bounds, default"),
    "template": ("keys:template", READING, "a commented case to begin with"),
    "python": ("python", (), "a script in which import ehlpetsc works"),
}


def main(words: list[str] | None = None) -> int:
    """Run the program; returns its exit status. An unexpected error on one rank ends all ranks."""
    words = sys.argv[1:] if words is None else words
    _prepare_streams()
    if signal.getsignal(signal.SIGINT) == signal.SIG_DFL:  # set by the package while it was imported
        signal.signal(signal.SIGINT, signal.default_int_handler)
    sys.unraisablehook = _repeat_lost_interrupt
    is_script = words[:1] == ["python"]
    # warnings of numpy are for developers: python3 -W default shows them, and a script those of its own
    if not (sys.warnoptions or is_script):
        warnings.simplefilter("ignore")
    try:
        status = _start(words)
        sys.stdout.flush()
    except SystemExit:
        raise
    except CaseError as error:  # laws and effects of the user, as a command imports them
        status = refuse(str(error))
    except UsageError as error:  # of a command whose modules cannot be imported
        status = refuse(f"ehlpetsc: {error}")
    except BrokenPipeError:  # the reader has gone, as `head -1` does
        _drop_output()
        status = ExitStatus.STOPPED
    except BaseException as error:  # otherwise the other ranks would wait for ever
        status = _after_error(error, is_script)
        mpi = sys.modules.get("mpi4py.MPI")
        if mpi and mpi.COMM_WORLD.size > 1:
            mpi.COMM_WORLD.Abort(status)
    signal.signal(signal.SIGUSR1, signal.SIG_IGN)  # run_mpi.sh may repeat it while Python ends
    _leave_nothing_to_one_rank()
    return status


def _prepare_streams() -> None:
    """Open the null device as the standard streams that are closed, as files would get their numbers.

    Letters that the code page of the output does not have are printed as their numbers.
    """
    while (number := os.open(os.devnull, os.O_RDWR)) < FIRST_FILE:
        os.set_inheritable(number, True)
    os.close(number)
    for number, name in ((1, "stdout"), (2, "stderr")):
        if getattr(sys, name) is None:
            setattr(sys, name, open(number, "w", closefd=False))
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")


def _drop_output() -> None:
    """Discard what is not printed yet, which Python would try again at its end."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _repeat_lost_interrupt(lost: "sys.UnraisableHookArgs") -> None:
    """Send a Ctrl-C again that a callback from C has swallowed, as those of numba's compiler do."""
    if lost.exc_type is KeyboardInterrupt:
        LOST_INTERRUPTS.append(lost.object)
        again = threading.Timer(SECONDS_TO_REPEAT, os.kill, (os.getpid(), signal.SIGINT))
        again.daemon = True  # the end of the program does not wait for it
        again.start()
    else:
        sys.__unraisablehook__(lost)


def _leave_nothing_to_one_rank() -> None:
    """Collect garbage on all ranks.

    An error leaves PETSc's objects in cycles, which each rank would collect at another time. The end of PETSc
    is collective and waits for ever where one rank has objects left and another has none.
    """
    mpi = sys.modules.get("mpi4py.MPI")
    if mpi and mpi.COMM_WORLD.size > 1:
        gc.collect()


def _start(words: list[str]) -> int:
    """Start the command of the first word, otherwise run a case; returns the exit status."""
    first = words[0] if words else ""
    for word in words:
        if "=" not in word and not is_plain(word):  # messages and result files have paths in one line
            return refuse(f"ehlpetsc: {ascii(word)}: allowed: a name without line breaks; rename the file")
    if "--version" in words[:1]:
        return _print(f"ehlpetsc {__version__}")
    if words in (["-h"], ["--help"], ["-help"]):
        return _print(help_text())
    if first in COMMANDS:
        return _start_command(first, words[1:])
    if first in ("-n", "-np"):
        return _start_ranks(words[1:])
    if first and not (first.startswith("-") or first.endswith(".toml") or Path(first).exists()):
        close = difflib.get_close_matches(first, [*COMMANDS, *(path.stem for path in Path().glob("*.toml"))])
        meant = " or ".join(name if name in COMMANDS else f"{name}.toml" for name in close)
        hint = f"did you mean {meant}?" if meant else f"allowed: CASE.toml, {', '.join(COMMANDS)}"
        return refuse(f"ehlpetsc: {first}: unknown command; {hint}")
    return _run(words)


def _start_command(name: str, words: list[str]) -> int:
    place, needs, _ = COMMANDS[name]
    if lacks := packages.missing(needs):
        return refuse(packages.advice(lacks, [name, *words]))
    for number in (signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) == signal.SIG_DFL:
            signal.signal(number, _interrupt)
    module, _, function = place.partition(":")
    return getattr(importlib.import_module(f"ehlpetsc.commands.{module}"), function or "main")(words)


def _interrupt(*_: object) -> None:
    """End a command as Ctrl-C does, which removes temporary files."""
    raise KeyboardInterrupt


def _start_ranks(words: list[str]) -> int:
    """Start a case on a number of ranks, by run_mpi.sh in a clone, otherwise by mpirun."""
    ranks = words[0] if words else ""
    if not (ranks.isdecimal() and 0 < int(ranks) <= MAX_RANKS):
        return refuse(f"ehlpetsc: -n {ranks}: allowed: a whole number of ranks, at least 1")
    if any(name in os.environ for name in packages.MPIRUN_VARIABLES):
        return refuse(f"ehlpetsc: -n {ranks} under mpirun, which has started the ranks; leave it out")
    path, of_python = os.environ.get("PATH", ""), str(Path(sys.executable).parent)
    if packages.SCRIPT.exists():
        os.environ["PATH"] = os.pathsep.join([of_python, path])
        os.execv(packages.SCRIPT, [str(packages.SCRIPT), "-n", *words])
    if sys.prefix != sys.base_prefix:  # a virtual environment, which need not be activated
        path = os.pathsep.join([of_python, path])
    mpirun = shutil.which("mpirun", path=path)
    if mpirun is None:
        return refuse(f"ehlpetsc: -n {ranks}: there is no mpirun on the PATH; install that of mpi4py's MPI")
    os.execv(mpirun, [mpirun, "-n", ranks, sys.executable, "-m", "ehlpetsc", *words[1:]])


def _run(words: list[str]) -> int:
    """Run a case with PETSc on all ranks."""
    from ehlpetsc.commands.run import parse, run

    try:
        chosen = parse(words)
        stop = StopRequest(chosen.time_limit)  # before the imports, which take a second
        if missing := packages.prepare():
            return refuse(packages.advice(missing, words))
        if fault := packages.load_mpi():
            return refuse(f"ehlpetsc: {fault}")
        if "-help" in [*chosen.petsc, *os.environ.get("PETSC_OPTIONS", "").split()]:
            _print(help_text())
            if chosen.case is None:
                return ExitStatus.DONE
        return run(chosen, stop)
    except CaseError as error:
        return refuse(str(error))
    except OutputError as error:
        return refuse(f"ehlpetsc: {error}", error.status)
    except UsageError as error:
        return refuse(f"ehlpetsc: {error}")


def help_text() -> str:
    """All commands and the options of a run, in the manner of PETSc's ``-help``."""
    from ehlpetsc.commands.run import run_parser

    lines = [
        "usage: ehlpetsc [-n RANKS] CASE.toml [options]    run a case",
        "       ehlpetsc COMMAND ...            each with -h:",
        *(f"  {name:9s} {text}" for name, (*_, text) in COMMANDS.items()),
        "Options of a run, also as -ehl_output ...; and --version:",
        run_parser().format_help().partition("\n")[2],
        "PETSc's options, of which -help with a case prints a list (-snes_*, -ksp_*, -pc_*, -log_view ...),",
        "may be in [petsc] of the case, in PETSC_OPTIONS and on the command line; the last one counts.",
        "Exit status: 0 done, 1 bug, 2 bad input, 3 no convergence, 4 stopped: the same command continues,",
        "from the restart file after a time step; 5 result file deleted or replaced during the run.",
    ]
    return "\n".join(lines)


def _print(text: object) -> int:
    if packages.first_rank():
        print(text, flush=True)
    return ExitStatus.DONE


def refuse(text: str, status: ExitStatus = ExitStatus.BAD_INPUT) -> int:
    """Print a fault on one rank; returns the exit status."""
    if packages.first_rank():
        print(text, file=sys.stderr, flush=True)
    return status


def _after_error(error: BaseException, is_script: bool) -> int:
    """Report an error, or Ctrl-C in a command or script; returns the exit status.

    Some libraries answer Ctrl-C with an error of their own: matplotlib as it ends a movie, Python in a class,
    numba after a lost one.
    """
    stops = [one for one in _causes(error) if isinstance(one, KeyboardInterrupt)]
    if stops or LOST_INTERRUPTS:
        reason = str(stops[0]) if stops else ""
        refuse(f"ehlpetsc: {reason or 'stopped; files written before are complete'}")
        return INTERRUPTED if is_script else ExitStatus.STOPPED
    if is_of_standard_output(error):
        _drop_output()
        return refuse(f"ehlpetsc: {not_written(error)}")
    traceback.print_exception(error.with_traceback(_in_script(error.__traceback__)))
    sys.stdout.flush()
    return ExitStatus.BUG


def _in_script(whole: TracebackType | None) -> TracebackType | None:
    """Traceback without the frames that lead to a script of ``ehlpetsc python``."""
    found = frame = whole
    while frame is not None:
        if frame.tb_frame.f_globals.get("__name__") == "runpy":
            found = frame.tb_next
        frame = frame.tb_next
    return found


def _causes(error: BaseException | None) -> Iterator[BaseException]:
    """An error, and those from which or during whose handling it arose."""
    while error is not None:
        yield error
        error = error.__cause__ or error.__context__


if __name__ == "__main__":
    sys.exit(main())
