"""Options of the program (-ehl_*): table, help text, values."""

import difflib
from dataclasses import dataclass

from ehlpetsc.command_parser import program
from ehlpetsc.errors import UsageError


@dataclass(frozen=True)
class Option:
    """Option of this program: value with its unit, default, meaning."""

    value: str
    default: str
    text: str

    @property
    def placeholder(self):
        """Value as printed by ``-help``."""
        return self.value and f" <{self.value}>"


OWN = {
    "ehl_output": Option("FILE.h5", "CASE.h5 in this folder", "result file, the restart file beside it"),
    "ehl_overwrite": Option("", "no", "replace any file at the path of the result"),
    "ehl_ranks_per_member": Option("RANKS", "1", "of a [series], how many ranks compute one member"),
    "ehl_restart": Option(
        "FILE.restart.h5", "begin at time 0", "continue from there and append to the result"
    ),
    "ehl_scheme": Option("newton|sweep", "newton", "iteration; sweep: Gauss-Seidel of the paper, slower"),
    "ehl_set": Option("TABLE.KEY=VALUE", "the case as it is", "set a key of the case; may be repeated"),
    "ehl_time_limit": Option("MINUTES", "none", "stop after this wall clock time, restart file written"),
}


def usage():
    """Usage of the command, with the name by which it was called."""
    return f"{program('ehlpetsc')} CASE.toml [options]"


def faults(names):
    """One message for each unknown option of the program, with the most similar known option.

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
        f"ehlpetsc: {usage()}, under mpirun on any number of ranks",
        "Options come from: program defaults < [petsc] of the case < PETSC_OPTIONS < command line.",
        "Own options:",
    ]
    lines += [f"  -{name}{o.placeholder}: {o.text} (default: {o.default})" for name, o in OWN.items()]
    lines += [
        "  --explain: print a summary of the case: expected film, run time, file size; nothing is run",
        "  --ranks: print the default number of ranks of the case, one or two; nothing is run",
        "  --keys [TABLE or TABLE.KEY]: print the keys of a case file with units, bounds, defaults",
        "  --template: print a commented case to begin from",
        "Other commands, each with -h: ehlpetsc plot, post, summary, compare, ensemble;",
        "  ehlpetsc explain CASE.toml, keys, template, python SCRIPT.py, completion (for bash)",
        "Exit status: 0 done, 1 bug, 2 bad input, 3 no convergence, 4 stopped and restart file written.",
        "With a case, -help then lists PETSc's options: -snes_*, -ksp_*, -pc_*, -log_view ...",
    ]
    return "\n".join(lines)


def text_of(options, name):
    """Value of an option of the program; "" if it is not set.

    Parameters
    ----------
    options : petsc4py.PETSc.Options
    name : str

    Raises
    ------
    UsageError
        The option has no value.
    """
    value = options.getString(name, "")
    if options.hasName(name) and not value:
        raise UsageError(f"-{name} has no value; allowed: -{name} {OWN[name].value}")
    return value


def time_limit(options):
    """Minutes of -ehl_time_limit; 0: no limit.

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
