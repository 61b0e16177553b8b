"""Options that are refused, with PETSc's own message, and tolerances looser than the program's."""

import importlib

from ehlpetsc.errors import UsageError

MAX_OPTIONS = 512  # options that PETSc's table holds
LOOSER = {"snes_rtol": 0.0, "snes_stol": 0.0, "snes_vi_zero_tolerance": 1e-8}
DIFFERENCES = "PETSc's differences would stand in for the Jacobian, a product here; leave it out"
REFUSED = {"snes_mf": DIFFERENCES, "snes_mf_operator": DIFFERENCES}
NUMERIC, NO_NUMBERS = ("snes_", "ksp_", "pc_"), ("nan", "inf", "infinity")
# in names of options that only tell
NO_CAUSE = ("monitor", "view", "reason", "log_", "options_", "info", "malloc", "help")


def refusal(error, given):
    """PETSc's message when it refuses an option, after the options that it can mean; None if there are none.

    Parameters
    ----------
    error : petsc4py.PETSc.Error
    given : dict of str to str
        Options of the user.
    """
    reason = petsc_message(error)
    can = {n: v for n, v in given.items() if not (n.startswith("ehl_") or any(map(n.__contains__, NO_CAUSE)))}
    named = {n: v for n, v in can.items() if n in reason or v and v in reason}
    names = [f"-{name} {value or ''}".strip() for name, value in (named if len(named) == 1 else can).items()]
    if not names:
        return None
    return f"PETSc refuses {'one of ' if len(names) > 1 else ''}{', '.join(names)}: {reason}"


def petsc_message(error):
    """Last line of an error of PETSc."""
    return str(error).splitlines()[-1].split("] ")[-1]


def check_options(options, own):
    """Refuse what PETSc would take and then do wrong, or end the process over.

    Parameters
    ----------
    options : dict of str to str
    own : int
        Number of the program's own.

    Raises
    ------
    UsageError
    """
    if len(options) + own > MAX_OPTIONS:
        raise UsageError(
            f"{len(options)} options for PETSc, whose table holds {MAX_OPTIONS} with the program's own; "
            "give fewer"
        )
    for name, value in options.items():
        if name in REFUSED and str(value).lower() not in ("false", "no", "0"):
            raise UsageError(f"-{name}: {REFUSED[name]}")
        if name.startswith(NUMERIC) and str(value).lower().strip().lstrip("+-") in NO_NUMBERS:
            raise UsageError(f"-{name} {value}: allowed: a number")
    if options.get("pc_python_type"):
        _check_class(options["pc_python_type"])


def _check_class(path):
    """Refuse what cannot be made, or not be applied, as a preconditioner: PETSc finds out while it solves."""
    module, _, name = path.rpartition(".")
    try:
        made = getattr(importlib.import_module(module), name)()
    except Exception as error:
        raise UsageError(f"-pc_python_type {path}: {error}; allowed: a class, package.module.Class") from None
    if not callable(getattr(made, "apply", None)):
        raise UsageError(f"-pc_python_type {path}: has no method apply(pc, x, y), as a preconditioner has")


def loose_tolerances(values, atol):
    """One line for every tolerance that is looser than the program's own.

    Parameters
    ----------
    values : dict of str to str
        Options.
    atol : float
        The program's own ``-snes_atol``.
    """
    lines = []
    for name, own in {"snes_atol": atol, **LOOSER}.items():
        value = _number(values.get(name, own))
        if value is not None and value > own:
            lines.append(f"-{name} {value:g} is looser than the program's {own:g}: results are less certain")
    return lines


def _number(text):
    try:
        return float(text)
    except (TypeError, ValueError):  # without a value, or a word
        return None
