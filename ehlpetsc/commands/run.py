"""Words of a run: options of the program, case file, options of PETSc; run of a case, series or passes.

Every option of the program is also known with the prefix of PETSc's options, ``-ehl_output FILE``. All other
words are PETSc's. Only rank 0 reads the case file.
"""

from __future__ import annotations

import argparse
import difflib
import math
import os
import re
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

from ehlpetsc.base.command_line import OF_SET
from ehlpetsc.base.environment import other_mpi
from ehlpetsc.base.errors import CaseError, ExitStatus, OutputError, UsageError

if TYPE_CHECKING:
    from mpi4py import MPI
    from petsc4py import PETSc

    from ehlpetsc.run.ranks import StopRequest
    from ehlpetsc.run.simulation import Simulation

NO_SIGNAL_HANDLER = "-no_signal_handler"  # PETSc's handler would end the process with its own report


def minutes(text: str) -> float:
    """Wall clock time of an option."""
    if not 0.0 < float(text) < math.inf:
        raise argparse.ArgumentTypeError(f"{text}: allowed: a number > 0 [minutes]")
    return float(text)


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        raise UsageError(f"{message.removeprefix('argument ')}; ehlpetsc -h lists the options")


def run_parser() -> argparse.ArgumentParser:
    """Parser of the options of a run."""
    parser = _Parser(add_help=False, allow_abbrev=False, usage=argparse.SUPPRESS)
    add = parser.add_argument
    of_output = "result file, also -o; the restart file beside it [CASE.h5 in this folder]"
    add("--output", metavar="FILE", help=of_output)
    add("--set", metavar="TABLE.KEY=VALUE", action="append", default=[], help=OF_SET)
    add("--overwrite", action="store_true", help="replace the file of another or of an edited case")
    add("--restart", metavar="FILE", type=Path, help="continue from FILE and append to the result")
    limit = "stop after this wall clock time [none]"
    add("--time-limit", metavar="MINUTES", type=minutes, default=0.0, help=limit)
    return parser


def parse(words: list[str]) -> argparse.Namespace:
    """Sort the words of a run: values of its options, the case file as `case`, all other words as `petsc`.

    The case file, None with -help alone, is the word that ends in .toml, otherwise the first word.

    Raises
    ------
    UsageError
        Two case files, or none although one is needed; an unknown option; a word that belongs to no option.
    """
    chosen, others = run_parser().parse_known_args([_long(word) for word in words])
    case, petsc = _without_case(others)
    names = [_long(f"-ehl_{name}") for name in vars(chosen)]
    for before, word, value in zip(["value", *petsc], petsc, [*petsc[1:], ""], strict=False):
        _check(word, value, before, case, names)
    return argparse.Namespace(**vars(chosen), case=case, petsc=petsc)


def _long(word: str) -> str:
    """``--time-limit`` of ``-ehl_time_limit``, ``--output`` of ``-o``, PETSc's ``-help`` of ``-h``."""
    if word.startswith("-ehl_"):
        return "--" + word.removeprefix("-ehl_").replace("_", "-")
    return {"-o": "--output", "-h": "-help", "--help": "-help"}.get(word, word)


def _without_case(words: list[str]) -> tuple[str | None, list[str]]:
    cases = [k for k, word in enumerate(words) if word.endswith(".toml")]
    if not cases and words and not words[0].startswith("-"):
        cases = [0]
    if len(cases) > 1:
        raise UsageError(f"one case file at a time, not {' and '.join(words[k] for k in cases)}")
    if not cases and "-help" in words:
        return None, words
    if not cases or not words[cases[0]]:
        raise UsageError("which case? usage: ehlpetsc CASE.toml [options]; ehlpetsc -h lists all commands")
    (k,) = cases
    return words[k], words[:k] + words[k + 1 :]


def _check(word: str, value: str, before: str, case: str | None, names: list[str]) -> None:
    """Refuse a word that neither this program nor PETSc has, and files that PETSc could not open."""
    name = word.lstrip("-")
    if word in ("-n", "-np"):
        raise UsageError(f"{word} RANKS comes before the case: ehlpetsc -n RANKS {case}")
    if re.match(r"[^-]|-\d", word) and not before.startswith("-"):
        reason = "neither an option nor a value; a command comes first"
        raise UsageError(f"{word}: {reason}: ehlpetsc {word} {case}")
    close = difflib.get_close_matches(f"--{name}", names, cutoff=0.8)
    if close and word.startswith("-"):
        raise UsageError(f"{word}: unknown option; did you mean {close[0]}?")
    if word.startswith("--") and name[:1].isalpha():
        raise UsageError(f"{word}: unknown option; PETSc's have one dash, ehlpetsc -h lists the program's")
    if word == "-options_file" and not os.path.isfile(value):
        raise UsageError(f"-options_file {value}: no such file")


def run(chosen: argparse.Namespace, stop: StopRequest) -> int:
    """Start PETSc, run the case on all ranks; returns the exit status. CaseError, OutputError, UsageError."""
    import petsc4py

    try:
        petsc4py.init(["ehlpetsc", NO_SIGNAL_HANDLER, *chosen.petsc])
    except RuntimeError as error:  # PETSc.Error, which cannot be imported before initialisation
        raise UsageError(f"PETSc cannot begin with {' '.join(chosen.petsc)}: {error}") from None
    from mpi4py import MPI
    from petsc4py import PETSc

    if fault := other_mpi(MPI.COMM_WORLD.size):
        raise UsageError(fault)
    options = PETSc.Options()
    options.delValue(NO_SIGNAL_HANDLER)  # not an option of the run
    try:
        return _run(chosen, MPI.COMM_WORLD, options, stop)
    except (CaseError, OutputError, UsageError):
        for name in options.getAll():
            options.hasName(name)  # newer releases of PETSc would list unused options as well
        raise


def _run(chosen: argparse.Namespace, comm: MPI.Comm, options: PETSc.Options, stop: StopRequest) -> int:
    """Run a case file on all ranks; with -help print PETSc's options."""
    from ehlpetsc.base.compiled import announce_compilation
    from ehlpetsc.case.loading import load
    from ehlpetsc.physics.scales import Scales
    from ehlpetsc.results.output_guard import file_path
    from ehlpetsc.run.forecast.domain import has_passes, refusals
    from ehlpetsc.run.ranks import on_root
    from ehlpetsc.run.simulation import Simulation

    if comm.rank == 0:
        announce_compilation(partial(print, flush=True))
    case = on_root(comm, load, chosen.case, chosen.set)
    if options.hasName("help"):
        _print_petsc_options(comm)
        return ExitStatus.DONE
    output = file_path(f"{Path(case.path).stem}.h5" if chosen.output is None else chosen.output)
    restart, overwrite = chosen.restart, chosen.overwrite
    if case.series:
        if faults := refusals(case, Scales.of(case)):
            raise CaseError(faults)
        from ehlpetsc.run.series import Series

        if restart:
            raise UsageError("--restart with a [series]: leave it out: unfinished members are continued")
        return Series(comm, case, output, stop, overwrite).run()
    if has_passes(case):
        from ehlpetsc.run.passes import Passes

        return Passes(comm, case, output, stop).run(restart, overwrite)
    from ehlpetsc.run.solve import Run

    simulation = Simulation(case, comm)
    on_root(comm, _print_heading, simulation)  # which may refuse a law of the user
    return Run(simulation, output, stop).run(restart, overwrite)[0]


def _print_petsc_options(comm: MPI.Comm) -> None:
    """Print the options of a solver without its prefix, as users give them."""
    from petsc4py import PETSc

    snes = PETSc.SNES().create(PETSc.Comm(comm))
    snes.setType("vinewtonrsls")
    snes.ksp.setType("fgmres")
    snes.setFromOptions()


def _print_heading(simulation: Simulation) -> None:
    from ehlpetsc.run.forecast.cost import banner
    from ehlpetsc.run.forecast.validity import warnings

    case, scales = simulation.case, simulation.scales
    print(*banner(case, scales, simulation.roughness, simulation.comm.size), sep="\n")
    for line in warnings(case, scales, simulation.roughness):
        print(f"warning: {line}", flush=True)
