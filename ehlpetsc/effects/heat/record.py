"""State of the heat at a time level, and its fields by rows of nodes along x."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ehlpetsc.physics.contact.grid import Grid

MIN_TEMPERATURE_RISE = 1e-3  # K
WIDENING = 1.5  # of the widths of rows beyond the sides of the mesh


class BodyHeat(NamedTuple):
    """Heat of one body, in rows of cells along x; arrays are flat, x fastest.

    `first`: position of the first cell of each row in the body, in cells.
    `terms`: :math:`A_m` [J/m^2], shape (cells, terms).
    `flux`: heat flux at the time level [W/m^2], shape (cells,).
    `rates`, `weights`: of the sum of exponentials, shape (terms,).
    """

    first: int
    terms: np.ndarray
    flux: np.ndarray
    rates: np.ndarray
    weights: np.ndarray


class HeatRecord(NamedTuple):
    """Temperatures and heat at a time level; arrays over the nodes, but for `flow` over the faces
    of each row, one more than nodes.

    `film`, `wall_1`, `wall_2`: temperatures [K].
    `flux_1`, `flux_2`: heat fluxes into both bodies [W/m^2].
    `base`, `profile`: state of the film, see :mod:`.film_law`.
    `solved`: mean temperature of the film in the solve of this level [K], on which its viscosity depended;
        `film` is that of the accepted solution, with its own heat and flow.
    `shear`: mean shear stress of the film [Pa].
    `source`: heat of the pressure flow and of compression [W/m^2].
    `rubbing`: heat of the solids [W/m^2], in the walls of the next solve.
    `spread`: as of :func:`.film_oil.oil_at`.
    `flow`: heat capacity that the surfaces' mean speed moves through the faces, per cell [W/(m^2 K)].
    `response_1`, `response_2`: of the surfaces to their flux, in a steady solve [m^2 K/W].
    `pressure`: of the oil [Pa].
    `rate`: change of the film's temperature over the last step [K/s]; 0: steady.
    `extrapolated`: heat of the film beyond that at its temperature, see :mod:`.transport` [J/m^2].
    `heat`: dissipated [W/m], in a point contact [W].
    `error`: its imbalance over it.
    `levels`: number of solutions before this level; 0: none yet.
    """

    film: np.ndarray
    wall_1: np.ndarray
    wall_2: np.ndarray
    flux_1: np.ndarray
    flux_2: np.ndarray
    base: np.ndarray
    profile: np.ndarray
    solved: np.ndarray
    shear: np.ndarray
    source: np.ndarray
    rubbing: np.ndarray
    spread: np.ndarray
    flow: np.ndarray
    response_1: np.ndarray
    response_2: np.ndarray
    pressure: np.ndarray
    rate: np.ndarray
    extrapolated: np.ndarray
    body_1: BodyHeat
    body_2: BodyHeat
    heat: float
    error: float
    levels: int


def interpolated(record: HeatRecord, by: Grid, onto: Grid) -> HeatRecord:
    """Record of a steady solution with its nodal fields on another grid; those of the bodies remain."""
    nodal = (k for k, v in record._asdict().items() if isinstance(v, np.ndarray) and v.shape == (by.n,))
    at_nodes: dict[str, Any] = {name: by.interpolated(getattr(record, name), onto) for name in nodal}
    flow = record.flow.reshape(-1, by.shape[-1] + 1)
    per_cell = by.interpolated(0.5 * (flow[:, 1:] + flow[:, :-1]).ravel(), onto) * (by.dx / onto.dx)
    rows = np.pad(onto.rows(per_cell), ((0, 0), (1, 1)), mode="edge")
    return record._replace(**at_nodes, flow=0.5 * (rows[:, 1:] + rows[:, :-1]).ravel())


def in_rows(values: np.ndarray, rows: int) -> np.ndarray:
    """Fields over all nodes, shape (fields, nodes), by rows: (rows, fields, nodes of a row), contiguous."""
    return np.ascontiguousarray(values.reshape(len(values), rows, -1).swapaxes(0, 1))


def joined(values: np.ndarray) -> np.ndarray:
    """Inverse of :func:`in_rows`."""
    rows, fields, nodes = values.shape
    return np.ascontiguousarray(values.swapaxes(0, 1)).reshape(fields, rows * nodes)


class Across:
    r"""Conduction along a surface between rows of cells; those of a point contact end in ever wider rows.

    .. math:: w_j\frac{\partial A_j}{\partial t}=\chi\Big[\frac{A_{j+1}-A_j}{d_{j+1/2}}
       -\frac{A_j-A_{j-1}}{d_{j-1/2}}\Big],

    w the width of a row, d the distance between two, solved exactly in time in the modes of the difference,
    and positive at any step. Heat leaves a point contact through its sides into rows beyond the mesh, as in
    a free half-space; the rows of a strip are periodic. Film and body carry heat along x alone, row by row.

    `reach`: distance beyond the mesh that heat can diffuse [m].

    `rows`: number of rows. `inner`: those of the mesh among them.
    `modes`, `inverse`: columns are the modes, shape (rows, rows), and its inverse.
    `decay`: rate of decay of each over :math:`\chi` [1/m^2], shape (rows,).
    """

    def __init__(self, grid: Grid, reach: float) -> None:
        of_mesh = grid.n // grid.shape[-1]
        beyond = 0
        if len(grid.axes) > 1 and not grid.periodic:
            beyond = int(np.ceil(np.log1p(reach / grid.spacings[0] * (WIDENING - 1.0)) / np.log(WIDENING)))
        self.rows, self.inner = of_mesh + 2 * beyond, slice(beyond, beyond + of_mesh)
        widths = WIDENING ** np.maximum(
            np.abs(np.arange(self.rows) - 0.5 * (self.rows - 1)) - 0.5 * (of_mesh - 1), 0
        )
        widths *= grid.spacings[0]
        scaled = np.eye(self.rows) / np.sqrt(widths)
        steps = np.diff(scaled, axis=0, append=scaled[:1] if grid.periodic else scaled[-1:])
        steps /= np.sqrt(0.5 * (widths + np.roll(widths, -1)))[:, None]
        decay, modes = np.linalg.eigh(steps.T @ steps)
        self.modes, self.inverse = modes / np.sqrt(widths)[:, None], modes.T * np.sqrt(widths)
        self.decay = np.maximum(decay, 0.0)

    def mixed(self, values: np.ndarray, matrix: np.ndarray) -> np.ndarray:
        """Product of a matrix and the rows of a flat field, which may have further axes."""
        return (matrix @ values.reshape(self.rows, -1)).reshape(values.shape)

    def spread(self, values: np.ndarray, area: float) -> np.ndarray:
        r"""Values after conduction between the rows.

        `area`: :math:`\chi t` [m^2].
        """
        return self.mixed(values, (self.modes * np.exp(-self.decay * area)) @ self.inverse)
