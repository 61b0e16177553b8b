r"""Rows of nodes along x, as the loops along the film take them, and conduction along a surface between them.

A field over the nodes is flat, x fastest; a line contact is one row. Film and body carry heat along x, row by
row. Between rows heat flows in the bodies alone, by the second difference of the temperature,

.. math:: \frac{\partial A}{\partial t}=\chi\frac{A_{j-1}-2A_j+A_{j+1}}{\Delta y^2},

whose solution in time is exact in the modes of the difference and positive at any step.
"""

import numpy as np

from ehlpetsc.physics.grid import Grid


def in_rows(values: np.ndarray, rows: int) -> np.ndarray:
    """Fields over all nodes, shape (fields, nodes), by rows: (rows, fields, nodes of a row), contiguous."""
    return np.ascontiguousarray(values.reshape(len(values), rows, -1).swapaxes(0, 1))


def joined(values: np.ndarray) -> np.ndarray:
    """Inverse of :func:`in_rows`."""
    rows, fields, nodes = values.shape
    return np.ascontiguousarray(values.swapaxes(0, 1)).reshape(fields, rows * nodes)


class Across:
    r"""Conduction between the rows of a grid; no heat passes the sides of a point contact.

    `rows`: number of rows.
    `modes`: columns of an orthogonal matrix, shape (rows, rows).
    `decay`: rate of decay of each over :math:`\chi` [1/m^2], shape (rows,).
    """

    def __init__(self, grid: Grid) -> None:
        self.rows = grid.n // grid.shape[-1]
        nodes = np.eye(self.rows)
        steps = np.diff(nodes, axis=0, append=nodes[:1] if grid.periodic else nodes[-1:]) / grid.spacings[0]
        decay, self.modes = np.linalg.eigh(steps.T @ steps)
        self.decay = np.maximum(decay, 0.0)

    def mixed(self, values: np.ndarray, matrix: np.ndarray) -> np.ndarray:
        """Product of a matrix and the rows of a flat field, which may have further axes."""
        return (matrix @ values.reshape(self.rows, -1)).reshape(values.shape)

    def spread(self, values: np.ndarray, area: float) -> np.ndarray:
        r"""Values after conduction between the rows.

        `area`: :math:`\chi t` [m^2].
        """
        return self.mixed(values, (self.modes * np.exp(-self.decay * area)) @ self.modes.T)
