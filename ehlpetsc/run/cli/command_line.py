"""Parsing of the command line: case file, settings of its keys, options of PETSc."""

import difflib
import itertools
import os
import shlex
from dataclasses import dataclass, field

from ehlpetsc.case.schema.table import is_plain
from ehlpetsc.command_parser import program
from ehlpetsc.errors import UsageError
from ehlpetsc.run.cli.options import OWN, usage

OPTION_PREFIXES = tuple(
    "snes ksp pc mat vec sub mg sys log options help info malloc citations get_total_flops checkstack "
    "on_error fp_trap version debug ehl da dm start_in_debugger stop_for_debugger debugger error_output "
    "shared_tmp use_gpu cuda memory v h skip_petscrc python viewer tao ts prefix no_signal_handler".split()
)  # of PETSc's and the program's options; misspelt options of the program are refused later with a suggestion


@dataclass
class Command:
    """A parsed command line.

    Attributes
    ----------
    case : str or None
        The case file.
    overrides : list of str
        Values of -ehl_set in PETSC_OPTIONS, then on the command line.
    explain : bool
        Whether to print the summary of the case instead of running it.
    ranks : bool
        Whether to print the default number of ranks instead of running the case.
    petsc : list of str
        All other arguments, for PETSc.
    """

    case: str | None = None
    overrides: list = field(default_factory=list)
    explain: bool = False
    ranks: bool = False
    petsc: list = field(default_factory=list)


def parse_command_line(arguments):
    """Parse the command line.

    The case file is the argument that ends in .toml, otherwise the first argument. -ehl_set is removed, also
    from PETSC_OPTIONS, because PETSc's table stores only the last option of a name. Two dashes before a name
    count as one: for PETSc they would be part of another, unused name.

    Raises
    ------
    UsageError
        Two case files, or none although one is needed; a missing options file; -ehl_set without a value.
    """
    command = Command()
    words, sets = _without_sets(arguments)
    try:
        environment, earlier = _without_sets(shlex.split(os.environ.get("PETSC_OPTIONS", "")))
    except ValueError as error:
        raise UsageError(f"PETSC_OPTIONS: {error}") from None
    single = [_with_one_dash(word) for word in environment]
    if earlier or single != environment:
        os.environ["PETSC_OPTIONS"] = shlex.join(single)
    command.overrides = earlier + sets
    command.explain, command.ranks = "--explain" in words, "--ranks" in words
    words = [word for word in words if word not in ("--explain", "--ranks")]
    cases = [at for at, word in enumerate(words) if word.endswith(".toml") and not _is_value(words, at)]
    cases = cases or [at for at, word in enumerate(words[:1]) if word[:1] != "-"]
    if len(cases) > 1:
        raise UsageError(f"one case file at a time, not {' and '.join(words[at] for at in cases)}: {usage()}")
    if cases:
        command.case = words.pop(cases[0])
        if not command.case:
            raise UsageError(f"which case? an empty name is none: {usage()}")
    elif not {"-help", "--help", "-h"} & set(words):
        raise UsageError(f"which case? {usage()}; what there is: {program('ehlpetsc')} -help")
    for word in [*words, *sets]:
        if not is_plain(word):
            raise UsageError(f"{word!r}: allowed: one line of UTF-8 text")
    for word in words:
        _check_name(word)
    for word, name in itertools.pairwise(words):
        if _with_one_dash(word) == "-options_file" and not os.path.isfile(name):
            raise UsageError(f"-options_file {name}: no such file")
    command.petsc = ["-help" if word == "-h" else _with_one_dash(word) for word in words]
    return command


def _with_one_dash(word):
    return word[1:] if word.startswith("--") and word[2:3].isalpha() else word


def _check_name(word):
    """Refuse an option that neither this program nor PETSc has."""
    name = word.lstrip("-")
    if word == "-n" or word == "-np":
        raise UsageError(
            f"{word} is an option of mpirun and run_mpi.sh, before the case: mpirun {word} RANKS ..."
        )
    meant = difflib.get_close_matches(f"ehl_{name}", OWN, n=1, cutoff=0.9)
    if word.startswith("-") and name not in OWN and meant:
        raise UsageError(f"{word}: unknown option; did you mean -{meant[0]}?")
    if word.startswith("--") and name[:1].isalpha() and not (name in OWN or name.startswith(OPTION_PREFIXES)):
        raise UsageError(f"{word}: unknown option; {program('ehlpetsc')} -help lists the options")


def _is_value(words, at):
    """Whether an argument is the file name after an option of the program."""
    return at > 0 and words[at - 1].lstrip("-") in ("ehl_output", "ehl_restart")


def _without_sets(words):
    other_words, sets = [], []
    words = iter(words)
    for word in words:
        if word in ("-ehl_set", "--ehl_set"):
            value = next(words, "")
            if not value or value.startswith("-"):
                raise UsageError(f"{word} has no value; allowed: {word} {OWN['ehl_set'].value}")
            if "=" not in value:
                raise UsageError(f"{word} {value}: write {word} {value}={next(words, 'VALUE')}")
            sets.append(value)
        else:
            other_words.append(word)
    return other_words, sets
