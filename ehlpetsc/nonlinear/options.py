"""Options of a solver under its own prefix in PETSc's table: defaults, precedence; events of ``-log_view``.

With a prefix, solvers of one process, as those of a coarse guess, of a series or of a notebook, have defaults
of their own, and the user's options stay as they are. This gives up short messages: those of monitors and of
``-ksp_view`` name the prefix, ``KSP Object: (ehl1_)``. `tests/unit/test_plane_jacobian.py` holds that nothing
leaks from one solver to another or into the user's options.
"""

from __future__ import annotations

import ctypes
import itertools
import re
import weakref
from collections.abc import Collection
from typing import Any

from petsc4py import PETSc

from ehlpetsc.base.case import KINDS
from ehlpetsc.base.errors import UsageError

DEFAULTS = {
    "snes_linesearch_type": "basic",
    "snes_max_it": "30",
    "snes_rtol": "0",  # no fraction of the first residual is an accuracy: with a thick film it may be 1e17
    "snes_stol": "0",
    # no limit, as it is relative to the first residual, which may be almost zero; -1 is 1e4 since PETSc 3.22
    "snes_divergence_tolerance": "-3",
    "snes_max_funcs": "100000",
    "ksp_type": "fgmres",  # stores the preconditioned vectors: one application less than gmres
    "ksp_rtol": "1e-4",  # tighter gains nothing, looser costs Newton iterations
    "ksp_pc_side": "right",
    "snes_max_linear_solve_fail": "1000",
    "ksp_max_it": "100",
    "ksp_gmres_restart": "100",
}
# Direct contact does not conserve percents of the oil where solids touch, and below 1e-5 no result changes in
# six digits; mixed contact conserves the oil to 1e-6, which needs 1e-7.
# A compliant layer makes the load nonlinear in the film: 1e-8 balances it to 1e-10.
ATOL = {"direct": "1e-5", "mixed": "1e-7", "compliant": "1e-8"}
PRECONDITIONER = {"pc_type": "python", "pc_python_type": "ehlpetsc.nonlinear.line.system.FarFieldBand"}
KRYLOV = {"ksp_type": "python", "ksp_python_type": "ehlpetsc.nonlinear.line.gmres.FlexibleGMRES"}
# of a contact in the plane, which has no assembled matrix for PETSc's preconditioners
PLANE = {
    "ksp_rtol": "3e-3",  # 1e-2 costs a Newton iteration in three, 1e-3 iterations of GMRES
    # with stiff asperities the basis else loses its orthogonality, and the residual found is not the true one
    "ksp_gmres_cgs_refinement_type": "refine_ifneeded",
    "pc_type": "python",
    "pc_python_type": "ehlpetsc.nonlinear.plane.preconditioner.EliminatedFilm",
}
PLANE_KRYLOV = {"ksp_type": "python", "ksp_python_type": "ehlpetsc.nonlinear.plane.gmres.FlexibleGMRES"}
# of a dry one: an error of a stiff layer's separation is one of its pressure a thousand times as large
DRY_PLANE = {"ksp_rtol": "1e-6"}
# options that both FlexibleGMRES support; any other KSP option of the user selects PETSc's fgmres
GMRES_OPTIONS = ("ksp_rtol", "ksp_atol", "ksp_divtol", "ksp_monitor", "ksp_converged_reason", "ksp_view")
# PETSc's LU and ILU do not pivot, and pivots of the deflection rows may be zero by chance
PETSC_FACTORISATION = {"pc_factor_shift_type": "nonzero", "sub_pc_factor_shift_type": "nonzero"}

READ_BY_FINALIZE = ("citations", "get_total_flops", "options_left", "options_view", "checkstack")
VIEWS = ("snes_view", "ksp_view")
PREFIX = re.compile(r"ehl\d+_")
NUMBERS = itertools.count(1)  # of the solvers of this process

RESIDUAL = PETSc.Log.Event("EHL residual")
ASSEMBLY = PETSc.Log.Event("EHL assembly")
PRODUCT = PETSc.Log.Event("EHL product")
FACTOR = PETSc.Log.Event("EHL factor")
BACK_SOLVE = PETSc.Log.Event("EHL back solve")
ROUGHNESS = PETSc.Log.Event("EHL roughness")
WRITING = PETSc.Log.Event("EHL output")
START = PETSc.Log.Stage("Steady start")
TIME_STEPS = PETSc.Log.Stage("Time steps")


class RunOptions:
    """Options of one nonlinear solver, in PETSc's table under a prefix of its own, ``ehl1_snes_max_it``.

    Precedence: defaults < `of_case` < the user's options in the table, without a prefix < `of_call`. The
    entries live as long as this object; what the user has put into the table stays as it is.

    `law`: contact model.
    `of_case`, `of_call`: `[petsc]` of the case; options of a call from Python.

    `prefix`: of PETSc's objects of the solver.
    `given`: options of the user: of the case, of PETSc's table and of the call.
    `values`: the same with the defaults.
    `deferred_views`: ``snes_view`` and ``ksp_view`` set without a value: they have no entry, because PETSc
        would repeat the output at every solve.
    """

    def __init__(
        self,
        law: str = "direct",
        of_case: dict | None = None,
        of_call: dict | None = None,
        kind: str = "line",
        is_dry: bool = False,
    ) -> None:
        table = PETSc.Options()
        of_user = {name: value for name, value in table.getAll().items() if not PREFIX.match(name)}
        self.given: dict = (of_case or {}) | of_user | (of_call or {})
        check_options(self.given)
        self._defaults = DEFAULTS | {"snes_atol": ATOL[law]}
        of_scene = DRY_PLANE if is_dry and KINDS[kind].is_areal else {}
        linear_solver = KINDS[kind].part("linear_solver")
        self.values: dict = self._defaults | linear_solver(of_scene | self.given)
        self.deferred_views = [name for name in VIEWS if name in self.values and not self.values[name]]
        self.prefix = f"ehl{next(NUMBERS)}_"
        entries = self.values.keys() - set(self.deferred_views)
        for name in entries:
            table[self.prefix + name] = self.values[name]
        weakref.finalize(self, _withdraw, self.prefix, entries, self.deferred_views)

    def value(self, name: str, default: object = None) -> Any:
        """Value of an option, which counts as used."""
        PETSc.Options().hasName(self.prefix + name)
        return self.values.get(name, default)

    def real(self, name: str, default: float | None = None) -> float:
        """Value of an option as a number."""
        value = self.value(name, default)
        try:
            return float(value)
        except ValueError:
            raise UsageError(f"-{name} {value}: allowed: a number") from None

    def loose_tolerances(self) -> list[str]:
        """One message for every tolerance of the user that is looser than the default."""
        lines = []
        for name, default in {"snes_atol": float(self._defaults["snes_atol"]), **DEFAULT_TOLERANCES}.items():
            value = _number(self.given.get(name, default))
            if value is not None and value > default:
                lines.append(
                    f"-{name} {value:g} is looser than the program's {default:g}: results are less certain"
                )
        return lines

    def unused_so_far(self) -> set[str]:
        """Names of the user's options that have not been read."""
        read = {name for name in self.given if was_read(self.prefix + name) or was_read(name)}
        return self.given.keys() - read - {*READ_BY_FINALIZE, *self.deferred_views}


def _withdraw(prefix: str, names: Collection[str], views: Collection[str]) -> None:
    """Remove the entries of a solver; the user's that it has read count as read, for -options_left."""
    table = PETSc.Options()
    for name in [*(name for name in names if was_read(prefix + name)), *views]:
        table.hasName(name)
    for name in names:
        table.delValue(prefix + name)


def line_solver(wanted: dict) -> dict:
    """Options with those of KSP and PC: this program's types unless the options of the user exclude them."""
    if any(wanted.get(name, value) != value for name, value in PRECONDITIONER.items()):
        return PETSC_FACTORISATION | wanted
    return PRECONDITIONER | (KRYLOV if _has_own_krylov(wanted) else {}) | wanted


def plane_solver(wanted: dict) -> dict:
    """Options as of :func:`line_solver` for the plane, whose preconditioner is that of this program alone."""
    for name in ("pc_type", "pc_python_type"):
        if wanted.get(name, PLANE[name]) != PLANE[name]:
            own = "a contact in the plane has a preconditioner of its own; leave it out"
            raise UsageError(f"-{name} {wanted[name]}: {own}")
    return PLANE | (PLANE_KRYLOV if _has_own_krylov(wanted) else {}) | wanted


def roller_solver(wanted: dict) -> dict:
    """Options as of :func:`plane_solver` for meshes of many rows, whose first solve takes some 60 iterations.

    GMRES then has a basis of 4 kB a node if it stores the preconditioned vectors too, else of 2 kB.
    """
    return plane_solver({"ksp_type": "gmres"} | wanted)


def _has_own_krylov(wanted: dict) -> bool:
    """Whether no option asks for more than this program's GMRES has."""
    return not any(name.startswith("ksp_") and name not in GMRES_OPTIONS for name in wanted)


def was_read(name: str) -> bool:
    """Whether an option has been read (PetscOptionsUsed, which petsc4py lacks)."""
    answer = ctypes.c_int(1)
    ctypes.CDLL(PETSc.__file__).PetscOptionsUsed(None, name.encode(), ctypes.byref(answer))
    return bool(answer.value)


DEFAULT_TOLERANCES = {"snes_rtol": 0.0, "snes_stol": 0.0, "snes_vi_zero_tolerance": 1e-8}
NO_FINITE_DIFFERENCES = "PETSc's finite differences would replace the Jacobian; leave it out"
REFUSED = {"snes_mf": NO_FINITE_DIFFERENCES, "snes_mf_operator": NO_FINITE_DIFFERENCES}
NUMERIC_PREFIXES, NOT_FINITE = ("snes_", "ksp_", "pc_"), ("nan", "inf", "infinity")


def raise_refusal(error: PETSc.Error, user_options: dict) -> None:
    """Raise an error of PETSc, as a `UsageError` where options of the user can be its cause."""
    reason = str(error).splitlines()[-1].split("] ")[-1]
    possible = {name: value for name, value in user_options.items() if not name.startswith("ehl_")}
    named = {  # a viewer is type:file:format, of which PETSc names one
        name: value
        for name, value in possible.items()
        if name in reason or any(part and part in reason for part in (value or "").split(":"))
    }
    causes = named if len(named) == 1 else possible
    names = [f"-{name} {value or ''}".strip() for name, value in causes.items()]
    if not names:
        raise error
    one_of = "one of " if len(names) > 1 else ""
    raise UsageError(f"PETSc refuses {one_of}{', '.join(names)}: {reason}") from None


def check_options(options: dict) -> None:
    """Refuse options that PETSc would accept although they fail later or end the process."""
    for name, value in options.items():
        if name in REFUSED and str(value).lower() not in ("false", "no", "0"):
            raise UsageError(f"-{name}: {REFUSED[name]}")
        if name.startswith(NUMERIC_PREFIXES) and str(value).lower().strip().lstrip("+-") in NOT_FINITE:
            raise UsageError(f"-{name} {value}: allowed: a number")


def _number(text: str | float | None) -> float | None:
    try:
        return float(text)
    except (TypeError, ValueError):  # no value, or no number
        return None
