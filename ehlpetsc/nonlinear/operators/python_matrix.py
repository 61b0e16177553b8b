"""PETSc's matrices whose products Python computes."""

from petsc4py import PETSc


def python_matrix(context, sizes, comm):
    """Square matrix with a Python context, ready for products.

    Parameters
    ----------
    context : object
        With methods of PETSc's names: ``mult``, ``createSubMatrix``.
    sizes : tuple of int
        Rows on this rank, and of all ranks.
    comm : petsc4py.PETSc.Comm
    """
    made = PETSc.Mat().createPython((sizes, sizes), context, comm=comm)
    made.setUp()
    return made
