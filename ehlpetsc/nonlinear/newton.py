r"""SNES set-up for one solve: bound-constrained Newton with the exact deflection in the operator.

The default is ``vinewtonrsls``: at every iteration the nodes with h at its bound and F > 0 form the
contact set, whose Reynolds rows and films leave the system. The operator is the near-field matrix
plus the far field by FFT, applied matrix-free in GMRES, so that Newton converges as with the full Jacobian;
its preconditioner (:mod:`ehlpetsc.nonlinear.preconditioner.far_field_band`) has the far field
too, by exponentials. Other preconditioners (``-pc_type lu`` ...) get the near-field matrix alone.

Newton's steps are limited in the line search's pre-check (:mod:`ehlpetsc.nonlinear.step_limits`).
"""

from functools import cached_property

import numpy as np
from petsc4py import PETSc

from ehlpetsc.discretisation.ehl_problem import LEAK, ContactProblem
from ehlpetsc.errors import SolveFailed, UsageError
from ehlpetsc.nonlinear import events as log
from ehlpetsc.nonlinear.preconditioner import FarFieldBand
from ehlpetsc.nonlinear.preconditioner.banded_jacobian import ExtendedBand
from ehlpetsc.nonlinear.preconditioner.exponential_kernel import GROUP
from ehlpetsc.nonlinear.preconditioner.spike import SplitBand
from ehlpetsc.nonlinear.step_limits import STEP_LIMIT, keep_oil, largest_change, let_overlaps_touch

LINEAR_ATOL = 1e-2  # of Newton's absolute tolerance: where a linear residual is small enough
LONGER_START = 7  # times the iterations of a time step
DEFAULTS = {
    "snes_type": "vinewtonrsls",
    "snes_linesearch_type": "basic",
    "snes_linesearch_maxstep": "1e10",
    "snes_max_it": "30",
    "snes_atol": "1e-7",
    "snes_rtol": "0",  # the first residual of a thick film may be 1e17: a share of it says nothing
    "snes_stol": "0",
    "snes_max_funcs": "100000",
    "ksp_type": "fgmres",  # keeps what the preconditioner gave: one application less than gmres
    "ksp_rtol": "1e-4",  # tighter gains nothing, looser costs Newton iterations
    "ksp_pc_side": "right",
    "snes_max_linear_solve_fail": "1000",
    "ksp_max_it": "100",
    "ksp_gmres_restart": "100",
}
PRECONDITIONER = {"pc_type": "python", "pc_python_type": "ehlpetsc.nonlinear.preconditioner.FarFieldBand"}


def set_defaults(options, extra=()):
    """Enter the case's, then this program's options wherever the user gave none.

    Returns
    -------
    list of str
        Names of the program's own that were entered.
    """
    entered = []
    for name, value in dict(extra).items():
        if not options.hasName(name):
            options[name] = value
    for name, value in (DEFAULTS | ({} if options.hasName("pc_type") else PRECONDITIONER)).items():
        if not options.hasName(name):
            options[name] = value
            entered.append(name)
    return entered


class _Operator:
    """Matrix-free Jacobian: the near-field matrix and the far field by FFT."""

    def __init__(self, solver):
        self.solver = solver

    def mult(self, mat, v, out):
        s = self.solver
        s.matrix.mult(v, out)
        v_p = s.gather(v)[0] * s.slope
        with log.FAR_FIELD:
            far = s.problem.far_product(v_p)
        out.array[: 2 * s.local : 2] += far - s.leak * v.array_r[: 2 * s.local : 2]


class Solver:
    """Holds vectors, matrices and SNES of one scene on one communicator.

    Parameters
    ----------
    case, scales, film_scale
        As in :class:`ehlpetsc.discretisation.ehl_problem.ContactProblem`.
    comm : MPI communicator
    """

    def __init__(self, case, scales, film_scale, comm=PETSc.COMM_WORLD):
        n = scales.nx
        rank, size = comm.rank, comm.size
        if size > n // GROUP:
            raise UsageError(f"{size} ranks for {n} nodes; allowed: at most {n // GROUP}")
        cuts = [n * k // size // GROUP * GROUP for k in range(size)] + [n]
        first, last = cuts[rank], cuts[rank + 1]
        self.n, self.local, self.first, self.comm = n, last - first, first, comm
        self.problem = ContactProblem(case, scales, film_scale, first, last)
        local = 2 * self.local + self.problem.load_is_local
        self.x = PETSc.Vec().createMPI((local, 2 * n + 1), comm=comm)
        self.f = self.x.duplicate()
        self.to_all, self.all = PETSc.Scatter.toAll(self.x)
        self._create_matrix(local)
        self.bound = case.contact.minimum_film / scales.h
        self._create_bounds(self.bound)
        self._create_snes()
        self.evaluated = self.inactive = None

    def _create_matrix(self, local):
        p, sizes = self.problem, ((local, 2 * self.n + 1),) * 2
        self.matrix = PETSc.Mat().createAIJ(sizes, comm=self.comm)
        zeros = np.zeros(len(p.pattern_columns))
        self.matrix.setPreallocationCSR((p.pattern_rows, p.pattern_columns, zeros))
        self.matrix.setOption(PETSc.Mat.Option.NEW_NONZERO_LOCATION_ERR, True)
        self.matrix.setOption(PETSc.Mat.Option.NO_OFF_PROC_ENTRIES, True)  # nothing to exchange at assembly
        self.operator = PETSc.Mat().createPython(sizes, _Operator(self), comm=self.comm)
        self.operator.setUp()
        self.slope = np.full(self.n, np.nan)  # dp/dq of the rows in the matrix

    def _create_bounds(self, minimum_film):
        self.lower, self.upper = self.x.duplicate(), self.x.duplicate()
        self.lower.set(PETSc.NINFINITY)
        self.upper.set(PETSc.INFINITY)
        self.lower.array[1 : 2 * self.local : 2] = minimum_film

    def _create_snes(self):
        self.snes = PETSc.SNES().create(self.comm)
        self.snes.setFunction(self._function, self.f)
        try:
            self.snes.setFromOptions()
        except PETSc.Error as error:
            reason = str(error).splitlines()[-1].split("] ")[-1]
            raise UsageError(f"PETSc refuses an option: {reason}") from None
        # SNES copies the rows in the system of what it hands to the preconditioner: spare it where not needed
        pc = self.snes.ksp.pc
        own = pc.getType() == "python" and isinstance(pc.getPythonContext(), FarFieldBand)
        self.snes.setJacobian(self._jacobian, self.operator, self.operator if own else self.matrix)
        self.follows = not PETSc.Options().hasName("ksp_atol")
        kind = self.snes.getType()
        if kind == "vinewtonssls":
            raise UsageError(
                "-snes_type vinewtonssls needs the whole deflection in an assembled matrix; "
                "allowed: vinewtonrsls, and types without bounds where nothing touches"
            )
        self.bounded = kind == "vinewtonrsls"
        if self.bounded:
            self.snes.setVariableBounds(self.lower, self.upper)
        self.snes.setLineSearchPreCheck(self._limit_step)

    @cached_property
    def split(self):
        """The band that the preconditioner factors."""
        return SplitBand(ExtendedBand(self.problem), -self.problem.end_scale, self.comm.tompi4py())

    def gather(self, v):
        """The whole vector on every rank, as q, h (shape (nx,)) and h00."""
        self.to_all.scatter(v, self.all, mode=PETSc.ScatterMode.FORWARD)
        return self._parts(self.all.array_r)

    def _parts(self, whole):
        return whole[: 2 * self.n : 2].copy(), whole[1 : 2 * self.n : 2].copy(), whole[2 * self.n]

    def scatter(self, q, h, h00):
        """Fill the local part of the unknowns from whole arrays."""
        mine = slice(self.first, self.first + self.local)
        x = self.x.array
        x[: 2 * self.local : 2], x[1 : 2 * self.local : 2] = q[mine], h[mine]
        if self.problem.load_is_local:
            x[-1] = h00

    def _function(self, snes, x, f):
        self._evaluate(x)
        f.array[:] = self.residual

    def _evaluate(self, x):
        """Residual and q, h of all nodes at x; SNES asks two or three times at the same place."""
        self.to_all.scatter(x, self.all, mode=PETSc.ScatterMode.FORWARD)
        if self.evaluated is None or not np.array_equal(self.all.array_r, self.evaluated):
            self.evaluated = self.all.array_r.copy()
            self.whole = q, h, h00 = self._parts(self.evaluated)
            with log.RESIDUAL, np.errstate(over="ignore", invalid="ignore"):
                self.residual = self.problem.residual(q, h, h00)

    def _jacobian(self, snes, x, operator, preconditioner):
        self._evaluate(x)
        with log.ASSEMBLY:
            self._fill(*self.whole[:2])
            self.matrix.assemble()
            operator.assemble()

    def _fill(self, q, h):
        p, matrix = self.problem, self.matrix
        # a node in contact and cavitated at once would leave its deflection row blind
        slope = np.where(h <= self.bound, 1.0, p.slope(q))
        mine = slice(self.first, self.first + self.local)
        changed = slope != self.slope
        if changed.any():
            self.slope = slope
            self.leak = np.where(slope[mine] > 0.0, 0.0, LEAK)
            rows = p.near_rows(changed)
            numbers = (2 * (self.first + rows)).astype(np.int32)
            set_rows(matrix, numbers, p.deflection_columns[rows], p.deflection_rows(slope, rows))
            if p.load_is_local:
                matrix.setValues([2 * self.n], 2 * np.arange(self.n, dtype=np.int32), p.dx * slope)
        rows = 2 * np.arange(self.first, self.first + self.local, dtype=np.int32) + 1
        set_rows(matrix, rows, p.flow_columns, p.flow_values)

    def in_system(self):
        """Local (q, h) that SNES has kept in the linear system, and the local nodes whose film it has not."""
        if not self.bounded:
            return np.arange(2 * self.local), np.arange(0)
        inactive = self.snes.getVIInactiveSet().indices
        if not np.array_equal(inactive, self.inactive):
            self.inactive = inactive.copy()
            self.kept = inactive[: len(inactive) - self.problem.load_is_local] - self.x.owner_range[0]
            films = np.ones(self.local, dtype=bool)
            films[self.kept[self.kept % 2 == 1] // 2] = False
            self.touching = np.flatnonzero(films)
        return self.kept, self.touching

    def _limit_step(self, x, y):
        pairs, local = slice(0, 2 * self.local), (self.local, 2)
        now, step = x.array_r[pairs].reshape(local), y.array[pairs].reshape(local)
        change = largest_change(now, step, self.bound, -np.inf if self.problem.dry else 0.0)
        largest = self.comm.tompi4py().allreduce(change, max)
        if largest > STEP_LIMIT:
            y.scale(STEP_LIMIT / largest)
        (let_overlaps_touch if self.problem.dry else keep_oil)(now, y.array[pairs].reshape(local), self.bound)
        return True

    @property
    def start_iterations(self):
        """Iterations that a steady start may take: what is exponential falls by one exponent in each."""
        return LONGER_START * self.snes.max_it

    def flow_rows(self):
        """F of the last solution at every node, shape (nx,)."""
        self.snes.computeFunction(self.x, self.f)
        return self.gather(self.f)[1]

    def solve(self, q, h, h00, max_it=None):
        """Solve from the given start, with `max_it` iterations instead of the usual number at most.

        Returns
        -------
        q, h : ndarray, shape (nx,)
        h00 : float
        iterations : int

        Raises
        ------
        SolveFailed
        """
        self.evaluated = None  # gap and past may have changed
        self.scatter(q, h, h00)
        usual = self.snes.max_it
        self.snes.max_it = max_it or usual
        if self.follows:
            self.snes.ksp.setTolerances(atol=LINEAR_ATOL * self.snes.atol)
        FarFieldBand.solver = self  # PETSc makes a new one whenever the contact set changes
        self.snes.solve(None, self.x)
        self.snes.max_it = usual
        reason, iterations = self.snes.getConvergedReason(), self.snes.getIterationNumber()
        q, h, h00 = self.gather(self.x)
        if reason <= 0:
            # a failed factorisation stays failed in PETSc's solver objects
            self.snes.destroy()
            self._create_snes()
            raise SolveFailed(REASONS.get(reason, str(reason)), iterations)
        if not np.isfinite([q.sum(), h.sum(), h00]).all():
            raise SolveFailed("NOT_FINITE", iterations)
        if not self.bounded and h.min() < self.bound:
            raise SolveFailed("FILM_BELOW_ITS_BOUND", iterations)
        return q, h, h00, iterations


REASONS = {v: k for k, v in vars(PETSc.SNES.ConvergedReason).items() if isinstance(v, int)}


def set_rows(matrix, rows, columns, values):
    """Insert a block of rows of equal width; negative columns are left out by PETSc."""
    for_row = np.arange(len(rows) + 1, dtype=np.int32) * columns.shape[1]
    matrix.setValuesIJV(for_row, columns.ravel(), values.ravel(), rowmap=rows)
