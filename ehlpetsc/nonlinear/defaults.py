"""PETSc's table of options as a run needs it, and as it was before."""

import ctypes
import threading

from petsc4py import PETSc

from ehlpetsc.errors import UsageError
from ehlpetsc.nonlinear.refusals import check_options, loose_tolerances, petsc_message

DEFAULTS = {
    "snes_linesearch_type": "basic",
    "snes_linesearch_maxstep": "1e10",
    "snes_max_it": "30",
    "snes_rtol": "0",  # the first residual of a thick film may be 1e17: a share of it says nothing
    "snes_stol": "0",
    "snes_divergence_tolerance": "-1",  # of the first residual, which may be next to nothing
    "snes_max_funcs": "100000",
    "ksp_type": "fgmres",  # keeps what the preconditioner gave: one application less than gmres
    "ksp_rtol": "1e-4",  # tighter gains nothing, looser costs Newton iterations
    "ksp_pc_side": "right",
    "snes_max_linear_solve_fail": "1000",
    "ksp_max_it": "100",
    "ksp_gmres_restart": "100",
}
# Direct contact makes up or loses percents of the oil where solids touch, and no figure changes in six digits
# below 1e-5; mixed contact promises the oil's balance to 1e-6, which is what 1e-7 gives.
# A compliant layer makes the load nonlinear in the film: 1e-8 balances it to 1e-10.
ATOL = {"direct": "1e-5", "mixed": "1e-7", "compliant": "1e-8"}
PRECONDITIONER = {"pc_type": "python", "pc_python_type": "ehlpetsc.nonlinear.preconditioner.FarFieldBand"}
KRYLOV = {"ksp_type": "python", "ksp_python_type": "ehlpetsc.nonlinear.gmres.FlexibleGMRES"}
# what this method of Krylov's knows; with any other option of KSP it is PETSc's own
OF_KRYLOV = ("ksp_rtol", "ksp_atol", "ksp_divtol", "ksp_monitor", "ksp_converged_reason", "ksp_view")
# PETSc's LU and ILU do not exchange rows, and pivots of the deflection's rows come out as zero by chance
OTHERS = {"pc_factor_shift_type": "nonzero", "sub_pc_factor_shift_type": "nonzero"}

READ_AT_THE_END = ("citations", "get_total_flops", "options_left", "options_view", "checkstack")
VIEWS = ("snes_view", "ksp_view")
TABLE = (
    threading.RLock()
)  # one table serves the process: with two threads in it, each would take the other's options


class RunOptions:
    """The options of a run in PETSc's table, for a ``with`` statement; afterwards the table is as it was.

    ``program's defaults < of_case < what the table holds < given``. May be entered again inside itself.
    Threads enter one after the other.

    Parameters
    ----------
    law : {"direct", "mixed", "compliant"}
        Of contact.
    of_case, given : dict of str to str
        `[petsc]` of the case; those of a call from Python.

    Attributes
    ----------
    deferred_views : list of str
        ``snes_view`` and ``ksp_view``, where they are set without a value: kept out of PETSc's table, because
        PETSc would repeat them at every solve.
    given : dict of str to str
        All that are not the program's defaults; those of PETSc's table from the first entry on.
    unused : set of str
        Names in `of_case` and `given` that have not been read yet.
    """

    def __init__(self, law="direct", of_case=(), given=()):
        self._defaults = DEFAULTS | {"snes_atol": ATOL[law]}
        self._of_case, self._of_call, self._depth = dict(of_case), dict(given), 0
        self._entered, self._saved = [], {}
        self.given = self._of_case | self._of_call
        self.deferred_views, self.unused = [], set(self.given)

    @property
    def user_set(self):
        """Names of the options that are not the program's defaults."""
        return set(self.given)

    def value(self, name, default=None):
        """Value of an option, which counts as used."""
        if name in self.given:
            PETSc.Options().hasName(name)
            self.unused.discard(name)
        return (self._defaults | self.given).get(name, default)

    def real(self, name, default=None):
        """Value of an option as a number.

        Raises
        ------
        UsageError
            It is none.
        """
        value = self.value(name, default)
        try:
            return float(value)
        except ValueError:
            raise UsageError(f"-{name} {value}: allowed: a number") from None

    def __enter__(self):
        TABLE.acquire()
        try:
            if self._depth == 0:
                self._enter(PETSc.Options())
        except BaseException:
            TABLE.release()
            raise
        self._depth += 1
        return self

    def __exit__(self, *exception):
        self._depth -= 1
        try:
            if self._depth == 0:
                self._leave(PETSc.Options())
        finally:
            TABLE.release()

    def loose_tolerances(self):
        """One line for every tolerance of the user that is looser than the program's own."""
        return loose_tolerances(self.given, float(self._defaults["snes_atol"]))

    def unused_so_far(self):
        """Names of the user's options that have not been read by now."""
        of_program = {*DEFAULTS, *PRECONDITIONER, *KRYLOV, *OTHERS, "snes_atol", *self.deferred_views}
        mine = (name for name in self.unused if not (self._depth and was_read(name)))
        return {*mine, *unused()} - of_program

    def _enter(self, table):
        there = table.getAll()
        self.given = wanted = self._of_case | there | self._of_call
        check_options(wanted, len(self._defaults | PRECONDITIONER | KRYLOV))
        wanted = self._defaults | _linear_solver(wanted) | wanted
        self.deferred_views = [name for name in VIEWS if name in wanted and not wanted.pop(name)]
        self._entered = [name for name, value in wanted.items() if name not in there or there[name] != value]
        changed = [name for name in [*self._entered, *self.deferred_views] if name in there]
        self._saved = {name: table.getString(name, "") for name in changed}
        for name in self.deferred_views:
            table.delValue(name)
        for number, name in enumerate(self._entered):
            try:
                table[name] = wanted[name]
            except PETSc.Error as error:
                for earlier in self._entered[:number]:
                    table.delValue(earlier)
                raise UsageError(f"PETSc refuses -{name} {wanted[name]}: {petsc_message(error)}") from None

    def _leave(self, table):
        self.unused = {name for name in self.unused if not was_read(name)} - set(self.deferred_views)
        for name in self._entered:
            table.delValue(name)
        for name, value in self._saved.items():
            table[name] = value
            table.hasName(name)  # it has been read, for -options_left


def _linear_solver(wanted):
    """Defaults of KSP and PC beside options of the user: this program's own as far as these let it."""
    if any(wanted.get(name, value) != value for name, value in PRECONDITIONER.items()):
        return OTHERS
    if any(name.startswith("ksp_") and name not in OF_KRYLOV for name in wanted):
        return PRECONDITIONER
    return PRECONDITIONER | KRYLOV


def unused():
    """Unused options in PETSc's table, without ``-ehl_*`` and those that PETSc reads at its end."""
    names = PETSc.Options().getAll()
    return sorted(n for n in names if not (n.startswith("ehl_") or n in READ_AT_THE_END or was_read(n)))


def was_read(name):
    """Whether an option has been read (PetscOptionsUsed, which petsc4py lacks)."""
    answer = ctypes.c_int(1)
    ctypes.CDLL(PETSc.__file__).PetscOptionsUsed(None, name.encode(), ctypes.byref(answer))
    return bool(answer.value)
