"""Where the unknowns of a node stand in a vector: (q_0, w_0, q_1, w_1, ..., h00), rows likewise.

Rows of coefficients over some nodes hold them in the same order, without h00.
"""

import numpy as np


def first_of(nodes):
    """Places of q, or of the deflection rows."""
    return 2 * nodes


def second_of(nodes):
    """Places of w, or of Reynolds' rows."""
    return 2 * nodes + 1


def count(nodes):
    """Unknowns of so many nodes, h00 left out: where that stands."""
    return 2 * nodes


def nodes_of_seconds(places):
    """Nodes whose w, or Reynolds row, stands in one of the places."""
    return places[places % 2 == 1] // 2


def firsts(vector, nodes):
    """View of the first entries of so many nodes."""
    return vector[: 2 * nodes : 2]


def seconds(vector, nodes):
    """View of the second entries of so many nodes."""
    return vector[1 : 2 * nodes : 2]


def pairs(vector, nodes):
    """View of both, shape (nodes, 2)."""
    return vector[: 2 * nodes].reshape(nodes, 2)


def firsts_of_rows(rows):
    """View of what each row has under q, shape (rows, nodes)."""
    return rows[:, ::2]


def seconds_of_rows(rows):
    """View of what each row has under w, or under the film, shape (rows, nodes)."""
    return rows[:, 1::2]


def both_of(nodes):
    """Places of both unknowns of each node, last axis (q, w)."""
    return np.stack([first_of(nodes), second_of(nodes)], axis=-1)
