"""Words of a run: options of the program and of PETSc, the case file; the run of a case, series or passes.

Options of the program are PETSc's too, in the table of which they end: ``-o FILE`` is ``-ehl_output FILE``.
Only rank 0 reads the case file.
"""

from __future__ import annotations

import difflib
import itertools
import os
import shlex
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO

from ehlpetsc.base.errors import CaseError, ExitStatus, OutputError, UsageError

if TYPE_CHECKING:
    from mpi4py import MPI
    from petsc4py import PETSc

    from ehlpetsc.case.tables import Case
    from ehlpetsc.run.stop import StopRequest

NO_SIGNAL_HANDLER = "-no_signal_handler"  # PETSc's handler would end the process with its own report


@dataclass(frozen=True)
class Option:
    """Option of the program: value, default, meaning."""

    value: str
    default: str
    text: str

    def help_line(self, name: str) -> str:
        """Line of the help of ``-ehl_`` and this name."""
        words = f"--{name.replace('_', '-')} {self.value}".rstrip()
        return f"  {f'-o, {words}' if name == 'output' else words:32s} {self.text} (default: {self.default})"


OPTIONS = {  # names after -ehl_
    "output": Option("FILE", "CASE.h5 in this folder", "result file, the restart file beside it"),
    "set": Option("TABLE.KEY=VALUE", "the case as it is", "key of the case; may be repeated"),
    "overwrite": Option("", "no", "replace the file of another or of an edited case"),
    "restart": Option("FILE", "begin at time 0", "continue from FILE and append to the result"),
    "time_limit": Option("MINUTES", "none", "stop after this wall clock time"),
    "ranks_per_member": Option("RANKS", "1", "ranks of each member of a [series]"),
    "scheme": Option("newton|sweep", "newton", "sweep: Gauss-Seidel iteration of the paper"),
}
OWN = tuple(f"ehl_{name}" for name in OPTIONS)


@dataclass
class Run:
    """Words of a run.

    Attributes
    ----------
    case
        The case file; None: -help alone.
    overrides
        Values of -ehl_set in PETSC_OPTIONS, then on the command line.
    petsc
        All other words, for PETSc.
    shows_ranks
        Whether only the default number of ranks is printed, for run_mpi.sh.
    """

    case: str | None = None
    overrides: list[str] = field(default_factory=list)
    petsc: list[str] = field(default_factory=list)
    shows_ranks: bool = False

    def worthwhile_ranks(self) -> int:
        """Default number of ranks; 1 for a faulty case."""
        from ehlpetsc.case.loading import load
        from ehlpetsc.run.forecast import worthwhile_ranks

        try:
            return worthwhile_ranks(load(self.case, self.overrides))
        except CaseError:
            return 1

    def run(self) -> int:
        """Start PETSc, run the case on all ranks; returns the exit status."""
        import petsc4py

        try:
            petsc4py.init(["ehlpetsc", NO_SIGNAL_HANDLER, *self.petsc])
        except RuntimeError as error:  # PETSc.Error, which cannot be imported before initialisation
            return _refuse(0, [f"ehlpetsc: PETSc cannot begin with {' '.join(self.petsc)}: {error}"])
        from mpi4py import MPI
        from petsc4py import PETSc

        options = PETSc.Options()
        options.delValue(NO_SIGNAL_HANDLER)  # not an option of the run
        sys.stdout = Lasting(sys.stdout)
        try:
            return _run(self, MPI.COMM_WORLD, options)
        except CaseError as error:
            faults = error.faults
        except (OutputError, UsageError) as error:
            faults = [f"ehlpetsc: {error}"]
        for name in options.getAll():
            options.hasName(name)  # newer releases of PETSc would list unused options as well
        return _refuse(MPI.COMM_WORLD.rank, faults)


class Lasting:
    """Text stream whose output is dropped once its reader has gone, as `head -1` does: the run continues."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def write(self, text: str) -> None:
        """Write like a file."""
        self._attempt(self._stream.write, text)

    def flush(self) -> None:
        """Flush like a file."""
        self._attempt(self._stream.flush)

    def _attempt(self, action: Callable, *arguments: str) -> None:
        try:
            action(*arguments)
        except OSError:
            os.dup2(os.open(os.devnull, os.O_WRONLY), self._stream.fileno())


def _refuse(rank: int, lines: list[str]) -> int:
    if rank == 0:
        print("\n".join(lines), file=sys.stderr, flush=True)
    return ExitStatus.BAD_INPUT


def parse(words: list[str]) -> Run:
    """Sort the words of a run.

    The case file is the word that ends in .toml, otherwise the first word. -ehl_set is taken out, also of
    PETSC_OPTIONS, because PETSc's table stores only the last option of a name.

    Raises
    ------
    UsageError
        Two case files, or none although one is needed; an unknown option; a word that belongs to no option.
    """
    run = Run(shows_ranks="--ranks" in words)
    words, settings = _without_settings(_in_petsc_style([word for word in words if word != "--ranks"]))
    try:
        earlier, from_environment = _without_settings(shlex.split(os.environ.get("PETSC_OPTIONS", "")))
    except ValueError as error:
        raise UsageError(f"PETSC_OPTIONS: {error}") from None
    if from_environment:
        os.environ["PETSC_OPTIONS"] = shlex.join(earlier)
    run.overrides = from_environment + settings
    for word in [*words, *settings]:
        if not word.isprintable():
            raise UsageError(f"{word!r}: allowed: one line of UTF-8 text")
    run.case, run.petsc = _without_case(words)
    for word, value in itertools.pairwise([*run.petsc, ""]):
        if word == "-options_file" and not os.path.isfile(value):
            raise UsageError(f"-options_file {value}: no such file")
        _check_name(word)
    _refuse_stray_words(run)
    return run


def _in_petsc_style(words: list[str]) -> list[str]:
    """Words with ``-o FILE`` as ``-ehl_output FILE``, ``--time-limit=5`` as ``-ehl_time_limit 5``."""
    styled = []
    for word in words:
        name, equals, value = word.partition("=")
        own = name.removeprefix("--").replace("-", "_")
        if word == "-o":
            styled.append("-ehl_output")
        elif word in ("-h", "--help"):
            styled.append("-help")
        elif word.startswith("--") and own in OPTIONS:
            styled += [f"-ehl_{own}", *([value] if equals else [])]
        else:
            styled.append(word)
    return styled


def _without_settings(words: list[str]) -> tuple[list[str], list[str]]:
    others, settings = [], []
    following = iter(words)
    for word in following:
        if word != "-ehl_set":
            others.append(word)
            continue
        value = next(following, "")
        if not value or value.startswith("-"):
            raise UsageError(f"--set has no value; allowed: --set {OPTIONS['set'].value}")
        if "=" not in value:
            raise UsageError(f"--set {value}: write --set {value}={next(following, 'VALUE')}")
        settings.append(value)
    return others, settings


def _without_case(words: list[str]) -> tuple[str | None, list[str]]:
    """The case file, None with -help alone, and the other words."""
    files = ("-ehl_output", "-ehl_restart", "-options_file")
    cases = [
        k for k, word in enumerate(words) if word.endswith(".toml") and (k == 0 or words[k - 1] not in files)
    ]
    if not cases and words and not words[0].startswith("-"):
        cases = [0]
    if len(cases) > 1:
        names = " and ".join(words[k] for k in cases)
        raise UsageError(f"one case file at a time, not {names}")
    if not cases and "-help" in words:
        return None, words
    if not cases or not words[cases[0]]:
        raise UsageError("which case? usage: ehlpetsc CASE.toml [options]; ehlpetsc -h lists all commands")
    (k,) = cases
    return words[k], words[:k] + words[k + 1 :]


def _check_name(word: str) -> None:
    """Refuse an option that neither this program nor PETSc has."""
    if word in ("-n", "-np"):
        raise UsageError(
            f"{word} is an option of mpirun and run_mpi.sh, before the case: mpirun {word} RANKS ..."
        )
    name = word.lstrip("-").replace("-", "_")
    is_long = word.startswith("--") and name[:1].isalpha()
    if is_long or word.startswith("-") and not word.startswith("-ehl"):
        close = difflib.get_close_matches(name, OPTIONS, n=1, cutoff=0.6 if is_long else 0.9)
        if close:
            raise UsageError(f"{word}: unknown option; did you mean --{close[0].replace('_', '-')}?")
    if is_long:
        raise UsageError(f"{word}: unknown option; PETSc's have one dash, ehlpetsc -h lists the program's")


def _refuse_stray_words(run: Run) -> None:
    """Refuse a word that is neither an option nor the value of one, which PETSc would take for an option."""
    before = "value"
    for word in run.petsc:
        if not word.startswith("-") and not before.startswith("-"):
            raise UsageError(
                f"{word}: neither an option nor a value; a command comes first: ehlpetsc {word} {run.case}"
            )
        before = word


def faults(names: list[str]) -> list[str]:
    """One message for each unknown option of the program among the names in PETSc's table."""
    lines = []
    for name in sorted(names):
        if name == "ehl_set":
            lines.append("-ehl_set in an options file: allowed on the command line and in PETSC_OPTIONS")
        elif name.startswith(("ehl", "-ehl")) and name not in OWN:
            close = difflib.get_close_matches(name.lstrip("-"), OWN, n=1)
            hint = f"did you mean -{close[0]}?" if close else f"allowed: -{', -'.join(OWN)}"
            lines.append(f"-{name}: unknown option; {hint}")
    return lines


def text_of(options: PETSc.Options, name: str) -> str:
    """Value of an option of the program in PETSc's table; "" if it is not set.

    Raises
    ------
    UsageError
        The option has no value.
    """
    value = options.getString(f"ehl_{name}", "")
    if options.hasName(f"ehl_{name}") and not value:
        raise UsageError(f"-ehl_{name} has no value; allowed: -ehl_{name} {OPTIONS[name].value}")
    return value


def time_limit(options: PETSc.Options) -> float:
    """Minutes of -ehl_time_limit; 0: no limit."""
    text = text_of(options, "time_limit")
    try:
        minutes = float(text or "inf")
    except ValueError:
        minutes = 0.0
    if not minutes > 0.0:
        raise UsageError(f"-ehl_time_limit {text}: allowed: a number > 0 [minutes]")
    return minutes if text else 0.0


def _ranks_per_member(options: PETSc.Options, size: int) -> int:
    text = text_of(options, "ranks_per_member") or "1"
    if not text.isdecimal() or not 1 <= int(text) <= size:
        raise UsageError(f"-ehl_ranks_per_member {text}: allowed: whole numbers 1 to {size}, all ranks")
    return int(text)


def _run(words: Run, comm: MPI.Comm, options: PETSc.Options) -> int:
    """Run a case file on all ranks; with -help print PETSc's options."""
    from ehlpetsc.nonlinear.scheme import check_scheme
    from ehlpetsc.run.simulation import Simulation
    from ehlpetsc.run.stop import StopRequest

    stop = StopRequest(time_limit(options))
    check_scheme(text_of(options, "scheme"))
    if wrong := faults(options.getAll()):
        raise CaseError(wrong)
    if words.case is None:
        return ExitStatus.DONE
    case = _read_case(comm, words)
    if options.hasName("help"):
        Simulation(case, comm)  # PETSc's objects print their options when they are created
        return ExitStatus.DONE
    output = Path(text_of(options, "output") or f"{Path(case.path).stem}.h5")
    overwrite, begun = options.getBool("ehl_overwrite", False), text_of(options, "restart")
    restart = Path(begun) if begun else None
    is_series, has_passes = bool(case.series), case.time is not None and case.time.passes > 1
    if is_series and has_passes:
        allowed = "one of them at a time; a member: --set KEY=VALUE -o NAME.h5"
        raise CaseError([f"{case.path}: [series] and time.passes: {allowed}"])
    if is_series:
        from ehlpetsc.run.series import Series

        if restart:
            raise UsageError("--restart with a [series]: leave it out: unfinished members are continued")
        return Series(comm, case, output, stop, _ranks_per_member(options, comm.size), overwrite).run()
    if has_passes:
        from ehlpetsc.run.passes import Passes

        return Passes(comm, case, output, stop).run(restart, overwrite)
    return _run_single(comm, case, stop, output, restart, overwrite)


def _read_case(comm: MPI.Comm, words: Run) -> Case:
    """Case on every rank, read on rank 0."""
    from ehlpetsc.case.loading import load

    case = faulty = None
    if comm.rank == 0:
        try:
            case = load(words.case, words.overrides)
        except CaseError as error:
            faulty = error.faults
    case, faulty = comm.bcast((case, faulty))
    if faulty:
        raise CaseError(faulty)
    return case


def _run_single(
    comm: MPI.Comm, case: Case, stop: StopRequest, output: Path, restart: Path | None, overwrite: bool
) -> int:
    """Run a case that is not a series."""
    from ehlpetsc.run.forecast import banner
    from ehlpetsc.run.simulation import Simulation
    from ehlpetsc.run.solve import Run as Solution
    from ehlpetsc.run.warnings import warnings

    simulation = Simulation(case, comm)
    if comm.rank == 0:
        for line in banner(case, simulation.scales, simulation.roughness, comm.size):
            print(line)
        for line in warnings(case, simulation.scales):
            print(f"warning: {line}", flush=True)
    return Solution(simulation, output, stop).run(restart, overwrite).status
