"""Where the unknowns of a node stand in a vector: (q_0, w_0, q_1, w_1, ..., h00), rows likewise."""

import numpy as np


def first_of(nodes):
    """Places of q, or of the deflection rows."""
    return 2 * nodes


def second_of(nodes):
    """Places of w, or of Reynolds' rows."""
    return 2 * nodes + 1


def firsts(vector, nodes):
    """View of the first entries of so many nodes."""
    return vector[: 2 * nodes : 2]


def seconds(vector, nodes):
    """View of the second entries of so many nodes."""
    return vector[1 : 2 * nodes : 2]


def pairs(vector, nodes):
    """View of both, shape (nodes, 2)."""
    return vector[: 2 * nodes].reshape(nodes, 2)


def both_of(nodes):
    """Places of both unknowns of each node, last axis (q, w)."""
    return np.stack([first_of(nodes), second_of(nodes)], axis=-1)
