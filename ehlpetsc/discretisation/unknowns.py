"""Unknowns of the discrete problem, and their order in a vector: (q_0, w_0, q_1, w_1, ...), then the border.

Rows have the same order. Rows of coefficients over some nodes have it too, without the border, see
:mod:`.balance`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class Unknowns(NamedTuple):
    """Both unknowns of the nodes, shape (nodes,), see :mod:`.contact`; those of the :mod:`.balance`."""

    q: np.ndarray
    w: np.ndarray
    border: np.ndarray


class Rows(NamedTuple):
    """Residual: deflection and Reynolds rows, shape (nodes,), and those of the border."""

    deflection: np.ndarray
    reynolds: np.ndarray
    border: np.ndarray


class Share(NamedTuple):
    """Nodes of a rank.

    `first`, `last`: nodes first .. last-1 of the mesh are its own.
    `window`: nodes on which its rows depend. `owned`: its own nodes among them.
    """

    first: int
    last: int
    window: slice | np.ndarray
    owned: slice

    @property
    def window_size(self) -> int:
        """Number of nodes of the window."""
        if isinstance(self.window, slice):
            return self.window.stop - self.window.start
        return len(self.window)

    @property
    def local(self) -> slice:
        """Own nodes among those of the mesh."""
        return slice(self.first, self.last)


def q_index(nodes: np.ndarray) -> np.ndarray:
    """Indices of q, or of the deflection rows."""
    return 2 * nodes


def w_index(nodes: np.ndarray) -> np.ndarray:
    """Indices of w, or of the Reynolds rows."""
    return 2 * nodes + 1


def n_dofs(nodes: int) -> int:
    """Number of unknowns q and w of `nodes` nodes, which is also the index of the border."""
    return 2 * nodes


def nodes_of_w(indices: np.ndarray) -> np.ndarray:
    """Nodes whose w, or Reynolds row, is among the indices."""
    return indices[indices % 2 == 1] // 2


def q_of(vector: np.ndarray, nodes: int) -> np.ndarray:
    """View of q, or of the deflection rows, of the first nodes."""
    return vector[: 2 * nodes : 2]


def w_of(vector: np.ndarray, nodes: int) -> np.ndarray:
    """View of w, or of the Reynolds rows, of the first nodes."""
    return vector[1 : 2 * nodes : 2]


def border_of(vector: np.ndarray, nodes: int) -> np.ndarray:
    """View of the unknowns, or of the rows, of the border, behind those of all nodes of the vector."""
    return vector[2 * nodes :]


def pairs(vector: np.ndarray, nodes: int) -> np.ndarray:
    """View of q and w, or of both rows, of the first nodes; shape (nodes, 2)."""
    return vector[: 2 * nodes].reshape(nodes, 2)


def q_columns(rows: np.ndarray) -> np.ndarray:
    """View of the coefficients of q in each row, shape (rows, nodes)."""
    return rows[:, ::2]


def w_columns(rows: np.ndarray) -> np.ndarray:
    """View of the coefficients of w, or of the film, in each row, shape (rows, nodes)."""
    return rows[:, 1::2]


def dofs_of(nodes: np.ndarray) -> np.ndarray:
    """Indices of both unknowns of each node, last axis (q, w)."""
    return np.stack([q_index(nodes), w_index(nodes)], axis=-1)
