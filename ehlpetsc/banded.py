"""Banded LU with a border of one row and column, as a PETSc preconditioner.

Use: ``-pc_type python -pc_python_type ehlpetsc.banded.BorderedBand`` (the default on one rank; on two, of
each rank's block), ``ehlpetsc.banded.OverlappingBand`` (the default on more).

The matrix of a contact has a narrow band, the near field, but for its last row (the load) and column (h00).
SNES's variational-inequality Newton hands over a new submatrix at every iteration, for which PETSc's own
LU repeats ordering and symbolic factorisation; LAPACK's band has none.
"""
import numpy as np
from mpi4py import MPI
from petsc4py import PETSc
from scipy.linalg.lapack import dgbtrf, dgbtrs

from ehlpetsc import log

OVERLAP = 32  # unknowns, two to a node


class _Layout:
    """Where the entries of a sparse matrix go in LAPACK's band and in the border."""

    def __init__(self, pointers, columns):
        self.pointers, self.columns = pointers, columns
        n = self.n = len(pointers) - 1
        rows = np.repeat(np.arange(n), np.diff(pointers))
        in_band = (rows < n - 1) & (columns < n - 1)
        below = rows[in_band] - columns[in_band]
        self.lower, self.upper = max(below.max(initial=0), 0), max(-below.min(initial=0), 0)
        self.height = 2 * self.lower + self.upper + 1
        self.band = np.flatnonzero(in_band)
        self.place = columns[in_band] * self.height + self.lower + self.upper + below
        self.row = np.flatnonzero(rows == n - 1)
        self.column = np.flatnonzero((columns == n - 1) & (rows < n - 1))
        self.column_rows = rows[self.column]

    def fits(self, pointers, columns):
        return np.array_equal(self.pointers, pointers) and np.array_equal(self.columns, columns)

    def fill(self, values):
        """Band in LAPACK's storage, last column without its corner, whole last row."""
        band = np.zeros(self.height * (self.n - 1))
        band[self.place] = values[self.band]
        column, row = np.zeros(self.n - 1), np.zeros(self.n)
        column[self.column_rows] = values[self.column]
        row[self.columns[self.row]] = values[self.row]
        return band.reshape(self.n - 1, self.height).T, column, row


class BorderedBand:
    """PETSc calls `setUp` for a new matrix and `apply` for every right-hand side."""

    layout = None

    def setUp(self, pc):
        with log.FACTOR:
            column, row = self._factor(*pc.getOperators()[1].getValuesCSR())
            self.row, self.column = row[:-1], self._band_solve(column)
            self._set_corner(row[-1], self.row @ self.column)

    def _factor(self, pointers, columns, values):
        """Factor the band of compressed rows; the last column without the corner, and the last row."""
        if self.layout is None or not self.layout.fits(pointers, columns):
            self.layout = _Layout(pointers, columns)
        band, column, row = self.layout.fill(values)
        self.lu, self.pivots, singular = dgbtrf(band, self.layout.lower, self.layout.upper, overwrite_ab=True)
        if singular:
            # a preconditioner may be off where the operator is singular, but must not be infinite
            diagonal = self.lu[self.layout.lower + self.layout.upper]
            diagonal[diagonal == 0.0] = np.abs(diagonal).max()
        return column, row

    def _set_corner(self, corner, through_band):
        left = corner - through_band
        self.corner = left if left != 0.0 else 1.0

    def _band_solve(self, b):
        return dgbtrs(self.lu, self.layout.lower, self.layout.upper, b, self.pivots)[0]

    def apply(self, pc, x, y):
        b, out = x.array_r, y.array
        with log.BACK_SOLVE:
            inner = self._band_solve(b[:-1])
            last = (b[-1] - self.row @ inner) / self.corner
            out[:-1] = inner - last * self.column
            out[-1] = last


class OverlappingBand(BorderedBand):
    """The same on any number of ranks: each factors its rows and `OVERLAP` more on either side.

    Of a solution each rank keeps its own part (restricted additive Schwarz); the border is eliminated as a
    whole, for which the ranks add up one number. In contact at a/800 GMRES takes 18 iterations on one rank
    and 19, 32 and 81 on 2, 4 and 8, where blocks without overlap take 25, 82 and more than 100; on two ranks
    the blocks win by their cheaper set-up.
    """

    numbered = None

    def setUp(self, pc):
        matrix = pc.getOperators()[1]
        self.ranks = matrix.comm.tompi4py()
        with log.FACTOR:
            rows, border, begin, self.own = overlapping_rows(matrix, self.ranks)
            column, row = self._factor(*self._number(*rows, border, begin))
            self.row, self.column = row[:-1][self.own], self._band_solve(column)[self.own]
        self._set_corner(row[-1], self.ranks.allreduce(self.row @ self.column))
        rows = np.append(begin + np.arange(len(column)), matrix.size[0] - 1).astype(np.int32)
        self.b = PETSc.Vec().createSeq(len(rows))
        here = PETSc.IS().createGeneral(rows, comm=PETSc.COMM_SELF)
        self.scatter = PETSc.Scatter().create(matrix.createVecRight(), here, self.b, None)

    def _number(self, lengths, columns, values, border, begin):
        """Pointers, columns and values of rows in local numbers, the border as last row and column."""
        count, end = len(lengths), len(border) - 1
        pattern = (np.array([begin, end]), lengths, columns)
        if self.numbered is None or not all(map(np.array_equal, pattern, self.numbered[0])):
            inside = (columns >= begin) & (columns < begin + count)
            kept = inside | (columns == end)
            ends = np.concatenate([[0], np.cumsum(kept)])[np.concatenate([[0], np.cumsum(lengths)])]
            local = np.where(inside, columns - begin, count)[kept]
            self.numbered = (pattern, np.flatnonzero(kept), np.append(ends, ends[-1] + count + 1),
                             np.append(local, np.arange(count + 1)))
        _, kept, pointers, columns = self.numbered
        return pointers, columns, np.concatenate([values[kept], border[begin:begin + count], border[end:]])

    def apply(self, pc, x, y):
        self.scatter.scatter(x, self.b, mode=PETSc.ScatterMode.FORWARD)
        b, out = self.b.array_r, y.array
        with log.BACK_SOLVE:
            inner = self._band_solve(b[:-1])[self.own]
        last = (b[-1] - self.ranks.allreduce(self.row @ inner)) / self.corner
        out[: len(inner)] = inner - last * self.column
        out[len(inner):] = last  # of the last rank


def overlapping_rows(matrix, ranks):
    """This rank's rows of a matrix with those of the overlap, and the border.

    Returns
    -------
    rows : tuple of ndarray
        Number of entries of each row; columns and values of all.
    border : ndarray
        The last row, in full.
    begin : int
        Number of the first row.
    own : slice
        Rows of this rank, but for the border, among them.
    """
    pointers, columns, values = matrix.getValuesCSR()
    end, (first, last) = matrix.size[0] - 1, matrix.getOwnershipRange()
    border = np.zeros(end + 1)
    if last > end:
        border[columns[pointers[-2]:]] = values[pointers[-2]:]
        pointers, last = pointers[:-1], end
    ranks.Bcast(border, ranks.size - 1)

    def some(one, other):
        entries = slice(pointers[one], pointers[other])
        return np.diff(pointers[one:other + 1]), columns[entries], values[entries]

    count = last - first
    before = ranks.rank - 1 if ranks.rank > 0 else MPI.PROC_NULL
    after = ranks.rank + 1 if ranks.rank + 1 < ranks.size else MPI.PROC_NULL
    right = ranks.sendrecv(some(0, min(OVERLAP, count)), before, source=after) or some(0, 0)
    left = ranks.sendrecv(some(max(count - OVERLAP, 0), count), after, source=before) or some(0, 0)
    rows = tuple(map(np.concatenate, zip(left, some(0, count), right, strict=True)))
    return rows, border, first - len(left[0]), slice(len(left[0]), len(left[0]) + count)
