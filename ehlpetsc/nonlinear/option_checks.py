"""Checks of PETSc options: refused options, PETSc's error messages, loose tolerances."""

import importlib

from ehlpetsc.errors import UsageError

MAX_OPTIONS = 512  # size of PETSc's table
DEFAULT_TOLERANCES = {"snes_rtol": 0.0, "snes_stol": 0.0, "snes_vi_zero_tolerance": 1e-8}
NO_FINITE_DIFFERENCES = "PETSc's finite differences would replace the Jacobian; leave it out"
REFUSED = {"snes_mf": NO_FINITE_DIFFERENCES, "snes_mf_operator": NO_FINITE_DIFFERENCES}
NUMERIC_PREFIXES, NOT_FINITE = ("snes_", "ksp_", "pc_"), ("nan", "inf", "infinity")
# parts of the names of options that only print
OUTPUT_OPTIONS = ("monitor", "view", "reason", "log_", "options_", "info", "malloc", "help")


def refusal(error, user_options):
    """Message of an error of PETSc with the options that can cause it; None if none can.

    Parameters
    ----------
    error : petsc4py.PETSc.Error
    user_options : dict of str to str
        Options of the user.
    """
    reason = petsc_message(error)
    is_of_output = "viewer" in reason.lower()
    possible = {
        name: value
        for name, value in user_options.items()
        if not name.startswith("ehl_") and any(part in name for part in OUTPUT_OPTIONS) == is_of_output
    }
    named = {  # a viewer is type:file:format, of which PETSc names one
        name: value
        for name, value in possible.items()
        if name in reason or any(part and part in reason for part in (value or "").split(":"))
    }
    causes = named if len(named) == 1 else possible
    names = [f"-{name} {value or ''}".strip() for name, value in causes.items()]
    if not names:
        return None
    return f"PETSc refuses {'one of ' if len(names) > 1 else ''}{', '.join(names)}: {reason}"


def petsc_message(error):
    """Last line of PETSc's error message."""
    return str(error).splitlines()[-1].split("] ")[-1]


def check_options(options, program_count):
    """Refuse options that PETSc would accept although they fail later or end the process.

    Parameters
    ----------
    options : dict of str to str
        Options of the user.
    program_count : int
        Number of options that the program sets.

    Raises
    ------
    UsageError
    """
    if len(options) + program_count > MAX_OPTIONS:
        raise UsageError(
            f"{len(options)} options for PETSc, whose table holds {MAX_OPTIONS} with the program's own; "
            "give fewer"
        )
    for name, value in options.items():
        if name in REFUSED and str(value).lower() not in ("false", "no", "0"):
            raise UsageError(f"-{name}: {REFUSED[name]}")
        if name.startswith(NUMERIC_PREFIXES) and str(value).lower().strip().lstrip("+-") in NOT_FINITE:
            raise UsageError(f"-{name} {value}: allowed: a number")
    if options.get("pc_python_type"):
        _check_class(options["pc_python_type"])


def _check_class(path):
    """Refuse a class that is not a preconditioner, which PETSc would notice during the first solve."""
    module, _, name = path.rpartition(".")
    try:
        preconditioner = getattr(importlib.import_module(module), name)()
    except Exception as error:
        raise UsageError(f"-pc_python_type {path}: {error}; allowed: a class, package.module.Class") from None
    if not callable(getattr(preconditioner, "apply", None)):
        raise UsageError(f"-pc_python_type {path}: has no method apply(pc, x, y), as a preconditioner has")


def loose_tolerances(values, atol):
    """One message for every tolerance that is looser than the default.

    Parameters
    ----------
    values : dict of str to str
        Options.
    atol : float
        Default of ``-snes_atol``.
    """
    lines = []
    for name, default in {"snes_atol": atol, **DEFAULT_TOLERANCES}.items():
        value = _number(values.get(name, default))
        if value is not None and value > default:
            lines.append(
                f"-{name} {value:g} is looser than the program's {default:g}: results are less certain"
            )
    return lines


def _number(text):
    try:
        return float(text)
    except (TypeError, ValueError):  # no value, or no number
        return None
