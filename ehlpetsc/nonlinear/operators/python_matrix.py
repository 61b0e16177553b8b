"""PETSc's matrices whose products Python computes, and what SNESVI takes out of them."""

from petsc4py import PETSc


def python_matrix(context, sizes, comm):
    """A square matrix that asks `context`, ready for products.

    Parameters
    ----------
    context : object
        With PETSc's names of what a matrix can do: ``mult``, ``createSubMatrix``.
    sizes : tuple of int
        Rows on this rank, and of all ranks.
    comm : petsc4py.PETSc.Comm
    """
    made = PETSc.Mat().createPython((sizes, sizes), context, comm=comm)
    made.setUp()
    return made


class Restrictable:
    """Context of a matrix that SNESVI restricts to the unknowns it keeps.

    Parameters
    ----------
    restriction : callable
        Gives the context of the restricted matrix, of this one, the places kept and the whole matrix.
    """

    def __init__(self, restriction):
        self._restriction = restriction

    def createSubMatrix(self, mat, rows, columns, out=None):
        """What SNESVI keeps of the system; rows and columns are the same."""
        return python_matrix(self._restriction(self, rows, mat), rows.getSizes(), mat.comm)
