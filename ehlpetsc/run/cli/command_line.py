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
    arguments, settings = _without_settings(arguments)
    try:
        environment, earlier = _without_settings(shlex.split(os.environ.get("PETSC_OPTIONS", "")))
    except ValueError as error:
        raise UsageError(f"PETSC_OPTIONS: {error}") from None
    single = [_with_one_dash(argument) for argument in environment]
    if earlier or single != environment:
        os.environ["PETSC_OPTIONS"] = shlex.join(single)
    command.overrides = earlier + settings
    command.explain, command.ranks = "--explain" in arguments, "--ranks" in arguments
    arguments = [argument for argument in arguments if argument not in ("--explain", "--ranks")]
    command.case, arguments = _without_case(arguments)
    for argument in [*arguments, *settings]:
        if not is_plain(argument):
            raise UsageError(f"{argument!r}: allowed: one line of UTF-8 text")
    for argument in arguments:
        _check_name(argument)
    for argument, name in itertools.pairwise(arguments):
        if _with_one_dash(argument) == "-options_file" and not os.path.isfile(name):
            raise UsageError(f"-options_file {name}: no such file")
    command.petsc = ["-help" if argument == "-h" else _with_one_dash(argument) for argument in arguments]
    return command


def _without_case(arguments):
    """The case file, None with -help alone, and the other arguments."""
    cases = [
        k
        for k, argument in enumerate(arguments)
        if argument.endswith(".toml") and not _is_value(arguments, k)
    ]
    if not cases and arguments and not arguments[0].startswith("-"):
        cases = [0]
    if len(cases) > 1:
        names = " and ".join(arguments[k] for k in cases)
        raise UsageError(f"one case file at a time, not {names}: {usage()}")
    if not cases:
        if {"-help", "--help", "-h"} & set(arguments):
            return None, arguments
        raise UsageError(f"which case? {usage()}; what there is: {program('ehlpetsc')} -help")
    (k,) = cases
    if not arguments[k]:
        raise UsageError(f"which case? an empty name is none: {usage()}")
    return arguments[k], arguments[:k] + arguments[k + 1 :]


def _with_one_dash(argument):
    return argument[1:] if argument.startswith("--") and argument[2:3].isalpha() else argument


def _check_name(argument):
    """Refuse an option that neither this program nor PETSc has."""
    name = argument.lstrip("-")
    if argument == "-n" or argument == "-np":
        raise UsageError(
            f"{argument} is an option of mpirun and run_mpi.sh, before the case: mpirun {argument} RANKS ..."
        )
    meant = difflib.get_close_matches(f"ehl_{name}", OWN, n=1, cutoff=0.9)
    if argument.startswith("-") and name not in OWN and meant:
        raise UsageError(f"{argument}: unknown option; did you mean -{meant[0]}?")
    if (
        argument.startswith("--")
        and name[:1].isalpha()
        and not (name in OWN or name.startswith(OPTION_PREFIXES))
    ):
        raise UsageError(f"{argument}: unknown option; {program('ehlpetsc')} -help lists the options")


def _is_value(arguments, k):
    """Whether argument k is the file name after an option of the program."""
    return k > 0 and arguments[k - 1].lstrip("-") in ("ehl_output", "ehl_restart")


def _without_settings(arguments):
    others, settings = [], []
    arguments = iter(arguments)
    for argument in arguments:
        if argument in ("-ehl_set", "--ehl_set"):
            value = next(arguments, "")
            if not value or value.startswith("-"):
                raise UsageError(f"{argument} has no value; allowed: {argument} {OWN['ehl_set'].value}")
            if "=" not in value:
                raise UsageError(f"{argument} {value}: write {argument} {value}={next(arguments, 'VALUE')}")
            settings.append(value)
        else:
            others.append(argument)
    return others, settings
