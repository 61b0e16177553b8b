"""Banded LU with a border of one row and column, as a PETSc preconditioner.

Use: ``-pc_type python -pc_python_type ehlpetsc.banded.BorderedBand`` (the default on one rank).

The matrix of a contact has a narrow band, the near field, but for its last row (the load) and column (h00).
SNES's variational-inequality Newton hands over a new submatrix at every iteration, for which PETSc's own
LU repeats ordering and symbolic factorisation; LAPACK's band has none.
"""
import numpy as np
from scipy.linalg.lapack import dgbtrf, dgbtrs

from ehlpetsc import log


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
            self._factor(pc.getOperators()[1])

    def _factor(self, matrix):
        pointers, columns, values = matrix.getValuesCSR()
        if self.layout is None or not self.layout.fits(pointers, columns):
            self.layout = _Layout(pointers, columns)
        band, column, row = self.layout.fill(values)
        self.lu, self.pivots, singular = dgbtrf(band, self.layout.lower, self.layout.upper, overwrite_ab=True)
        if singular:
            # a preconditioner may be off where the operator is singular, but must not be infinite
            diagonal = self.lu[self.layout.lower + self.layout.upper]
            diagonal[diagonal == 0.0] = np.abs(diagonal).max()
        self.row = row[:-1]
        self.column = self._band_solve(column)
        corner = row[-1] - self.row @ self.column
        self.corner = corner if corner != 0.0 else 1.0

    def _band_solve(self, b):
        return dgbtrs(self.lu, self.layout.lower, self.layout.upper, b, self.pivots)[0]

    def apply(self, pc, x, y):
        b, out = x.array_r, y.array
        with log.BACK_SOLVE:
            inner = self._band_solve(b[:-1])
            last = (b[-1] - self.row @ inner) / self.corner
            out[:-1] = inner - last * self.column
            out[-1] = last
