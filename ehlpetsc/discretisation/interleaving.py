"""Order of the unknowns in a vector: (q_0, w_0, q_1, w_1, ..., h00); rows in the same order.

Rows of coefficients over some nodes have the same order, without h00.
"""

import numpy as np


def q_index(nodes):
    """Indices of q, or of the deflection rows."""
    return 2 * nodes


def w_index(nodes):
    """Indices of w, or of the Reynolds rows."""
    return 2 * nodes + 1


def n_dofs(nodes):
    """Number of unknowns q and w of `nodes` nodes, which is also the index of h00."""
    return 2 * nodes


def nodes_of_w(indices):
    """Nodes whose w, or Reynolds row, is among the indices."""
    return indices[indices % 2 == 1] // 2


def q_of(vector, nodes):
    """View of q, or of the deflection rows, of the first nodes."""
    return vector[: 2 * nodes : 2]


def w_of(vector, nodes):
    """View of w, or of the Reynolds rows, of the first nodes."""
    return vector[1 : 2 * nodes : 2]


def pairs(vector, nodes):
    """View of q and w, or of both rows, of the first nodes; shape (nodes, 2)."""
    return vector[: 2 * nodes].reshape(nodes, 2)


def q_columns(rows):
    """View of the coefficients of q in each row, shape (rows, nodes)."""
    return rows[:, ::2]


def w_columns(rows):
    """View of the coefficients of w, or of the film, in each row, shape (rows, nodes)."""
    return rows[:, 1::2]


def dofs_of(nodes):
    """Indices of both unknowns of each node, last axis (q, w)."""
    return np.stack([q_index(nodes), w_index(nodes)], axis=-1)
