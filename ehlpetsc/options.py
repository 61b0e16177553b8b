"""The command line: the case file, own options (-ehl_*) and those handed on to PETSc."""
import difflib
import itertools
import os
import shlex
from dataclasses import dataclass, field
from pathlib import Path


@dataclass(frozen=True)
class Option:
    """An own option as ``-help`` lists it: what follows it with its unit, its default, its meaning."""

    value: str
    default: str
    text: str


OWN = {
    "ehl_output": Option("FILE.h5", "CASE.h5 in this folder", "result file, the restart file beside it"),
    "ehl_ranks_per_member": Option("RANKS", "1", "of a [series], how many ranks compute one member"),
    "ehl_restart": Option("FILE.restart.h5", "begin at time 0", "go on from there and append to the result"),
    "ehl_scheme": Option("newton|sweep", "newton", "iteration; sweep is the paper's own, slower"),
    "ehl_set": Option("TABLE.KEY=VALUE", "the case as it is", "set a key of the case; may be repeated"),
    "ehl_time_limit": Option("MINUTES", "none", "stop after this wall clock time, restart file written"),
}

USAGE = "python3 -m ehlpetsc CASE.toml [options]"


class UsageError(Exception):
    """The command line cannot be understood; the message says what is allowed."""


@dataclass
class Command:
    """A command line taken apart.

    Attributes
    ----------
    case : str or None
        The case file.
    overrides : list of str
        Values of -ehl_set: those of PETSC_OPTIONS, then those of the command line.
    explain : bool
        Whether the scene is to be told in words and not run.
    petsc : list of str
        All other words, for PETSc.
    """

    case: str | None = None
    overrides: list = field(default_factory=list)
    explain: bool = False
    petsc: list = field(default_factory=list)


def understand(arguments):
    """Take the command line apart.

    The case file is the one word that ends in .toml, else the first word. -ehl_set is taken out, here and
    from PETSC_OPTIONS, because PETSc's table keeps only the last option of a name.

    Raises
    ------
    UsageError
        Two case files, or none where one is needed; an options file that is not there.
    """
    command = Command()
    rest, sets = _without_sets(arguments)
    try:
        environment, earlier = _without_sets(shlex.split(os.environ.get("PETSC_OPTIONS", "")))
    except ValueError as error:
        raise UsageError(f"PETSC_OPTIONS: {error}") from None
    if earlier:
        os.environ["PETSC_OPTIONS"] = shlex.join(environment)
    command.overrides = earlier + sets
    command.explain = "--explain" in rest
    rest = [word for word in rest if word != "--explain"]
    names = [word for word in rest if word.endswith(".toml")] or [word for word in rest[:1] if word[0] != "-"]
    if len(names) > 1:
        raise UsageError(f"one case file at a time, not {' and '.join(names)}: {USAGE}")
    if names:
        command.case = names[0]
        rest.remove(names[0])
    elif not {"-help", "--help", "-h"} & set(rest):
        raise UsageError(f"which case? {USAGE}; what there is: python3 -m ehlpetsc -help")
    for word, name in itertools.pairwise(rest):
        if word == "-options_file" and not Path(name).is_file():
            raise UsageError(f"-options_file {name}: no such file")
    command.petsc = ["-help" if word in ("--help", "-h") else word for word in rest]
    return command


def _without_sets(words):
    rest, sets = [], []
    words = iter(words)
    for word in words:
        if word in ("-ehl_set", "--ehl_set"):
            sets.append(next(words, ""))
        else:
            rest.append(word)
    return rest, sets


def faults(names):
    """One line for each own option that there is none of, with the nearest there is.

    Parameters
    ----------
    names : iterable of str
        Names in PETSc's table.
    """
    lines = []
    for name in sorted(names):
        if name == "ehl_set":
            lines.append("-ehl_set in an options file: allowed on the command line and in PETSC_OPTIONS")
        elif name.startswith(("ehl", "-ehl")) and name not in OWN:
            close = difflib.get_close_matches(name.lstrip("-"), OWN, n=1)
            hint = f"did you mean -{close[0]}?" if close else f"allowed: -{', -'.join(OWN)}"
            lines.append(f"-{name}: unknown option; {hint}")
    return lines


def help_text():
    """Own options with values, units and defaults, in the manner of PETSc's -help."""
    lines = [
        "----------------------------------------",
        f"ehlpetsc: {USAGE}, under mpirun on any number of ranks",
        "Options come from: program defaults < [petsc] of the case < PETSC_OPTIONS < command line.",
        "Own options:",
    ]
    lines += [f"  -{name} <{o.value}>: {o.text} (default: {o.default})" for name, o in OWN.items()]
    lines += [
        "  --explain: tell the scene in words, with expected film, run time and file size; nothing is run",
        "Exit status: 0 done, 1 bug, 2 bad input, 3 no convergence, 4 stopped and restart file written.",
    ]
    return "\n".join(lines)


def text_of(options, name):
    """Value of an own option, "" where it is not given.

    Parameters
    ----------
    options : petsc4py.PETSc.Options
    name : str

    Raises
    ------
    UsageError
        It stands without a value.
    """
    value = options.getString(name, "")
    if options.hasName(name) and not value:
        raise UsageError(f"-{name} stands without a value; allowed: -{name} {OWN[name].value}")
    return value


def time_limit(options):
    """Minutes of -ehl_time_limit, 0 where there is no limit.

    Raises
    ------
    UsageError
        Not a number above 0.
    """
    text = text_of(options, "ehl_time_limit")
    try:
        minutes = float(text or "inf")
    except ValueError:
        minutes = 0.0
    if not minutes > 0.0:
        raise UsageError(f"-ehl_time_limit {text}: allowed: a number > 0 [minutes]")
    return minutes if text else 0.0
