"""Jacobian of a contact as a matrix-free Python matrix of PETSc; of its kind are the products."""

from __future__ import annotations

from copy import copy
from functools import partial
from typing import Any

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from ehlpetsc.discretisation.ehl_problem import EHLProblem, Evaluation
from ehlpetsc.discretisation.unknowns import (
    n_dofs,
    nodes_of_w,
)
from ehlpetsc.nonlinear import events
from ehlpetsc.nonlinear.ranks import global_sum


class Jacobian:
    """Matrix-free Jacobian, context of PETSc's Python matrix; kinds of contact differ in the product.

    `exchange`: of vectors between ranks.

    `model`, `state`, `reynolds_derivatives`: point of linearisation, as in `ehl_problem.Evaluation`.
    `derivatives`: of the nodes, see `contact.node_state.NodeState.derivatives`.
    `size`: local unknowns of the whole system.
    `active`: local indices of the unknowns in the system.
    `inactive_nodes`: local nodes whose second unknown is not in the system.
    """

    def __init__(self, problem: EHLProblem, exchange: object, ranks: MPI.Comm):
        self.problem, self.exchange, self.ranks = problem, exchange, ranks
        self.active: slice | np.ndarray = slice(None)
        self.inactive_nodes = np.arange(0)
        self.model: Any = None
        self.state: Any = None
        self.derivatives: np.ndarray = None
        self.reynolds_derivatives: np.ndarray = None
        self.size = n_dofs(problem.local) + problem.load_is_local

    def product(self, v: np.ndarray, out: np.ndarray) -> None:
        """Fill in the local rows of the product with a local vector, zero in inactive rows; collective."""
        raise NotImplementedError

    def linearise(self, evaluation: Evaluation) -> None:
        """Set the point of linearisation."""
        self.model, self.reynolds_derivatives = evaluation.model, evaluation.reynolds_derivatives
        self.state = self.model.linearised(
            evaluation.state, self.problem.owned, partial(global_sum, self.ranks)
        )
        self.derivatives = self.state.derivatives()

    def mult(self, mat: PETSc.Mat, v: PETSc.Vec, out: PETSc.Vec) -> None:
        """PETSc's product."""
        full, rows = np.zeros(self.size), np.empty(self.size)
        full[self.active] = v.array_r
        with events.PRODUCT:
            self.product(full, rows)
        out.array[:] = rows[self.active]

    def createSubMatrix(
        self, mat: PETSc.Mat, rows: PETSc.IS, columns: PETSc.IS, out: PETSc.Mat | None = None
    ) -> PETSc.Mat:
        """Matrix of the active unknowns of SNESVI; rows and columns are the same."""
        restricted = copy(self)
        restricted.restrict(rows.indices - mat.getOwnershipRange()[0])
        return python_matrix(restricted, rows.getSizes(), mat.comm)

    def restrict(self, active: np.ndarray) -> None:
        """Leave all unknowns out of the system but those of these local indices."""
        if len(active) < self.size:
            is_inactive = np.ones(self.size, dtype=bool)
            is_inactive[active] = False
            self.active, self.inactive_nodes = active, nodes_of_w(np.flatnonzero(is_inactive))


def python_matrix(context: object, sizes: tuple[int, int], comm: PETSc.Comm) -> PETSc.Mat:
    """Square matrix with a Python context, ready for products.

    `context`: with methods of PETSc's names: ``mult``, ``createSubMatrix``.
    `sizes`: rows on this rank, and of all ranks.
    """
    matrix = PETSc.Mat().createPython((sizes, sizes), context, comm=comm)
    matrix.setUp()
    return matrix
