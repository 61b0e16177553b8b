r"""State of the heat at a time level: its fields by rows of nodes along x, its fixed point in a steady start.

Fixed points :math:`x=g(x)` by Anderson's acceleration (Walker & Ni 2011) are those of the fluxes of a film
and both walls for a given flow, and of all that a solve of the film takes from the temperatures of the last
one: alone they would oscillate where fast, warm films heat by their own flow.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from ehlpetsc.physics.contact.grid import Grid

MIN_TEMPERATURE_RISE = 1e-3  # K
WIDENING = 1.5  # of the widths of rows beyond the sides of the mesh
DEPTH = 6  # changes of x and g that are combined
MIXING_ITERATIONS = 200
MIXING_ACCURACY = 1e-11  # of the maximum
MIN_SINGULAR_VALUE = 1e-12  # of the maximum, in the least squares of fluxes
MIN_SINGULAR_VALUE_OF_RECORDS = 1e-8
FAR = 0.3  # of the maximum rise of temperature: after a larger change a record is taken as it is
LAGGED = (
    *("film", "base", "profile", "pressure", "source", "rubbing", "spread", "flow"),
    *("wall_1", "wall_2", "flux_1", "flux_2"),
)


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


def mixing(
    function: Callable[[np.ndarray], np.ndarray], start: np.ndarray, of_change: float = 0.0
) -> np.ndarray:
    """Fixed point of a function; the last argument that the function had.

    `of_change`: fraction of the first change that is accurate.
    """
    x: np.ndarray = start
    steps: list[np.ndarray] = []
    residuals: list[np.ndarray] = []
    least = 0.0
    for _ in range(MIXING_ITERATIONS):
        new = function(x)
        f = new - x
        change = np.abs(f).max()
        least = least or of_change * change
        if change <= max(MIXING_ACCURACY * max(np.abs(new).max(), 1e-300), least):
            return x
        steps, residuals = [*steps, x][-DEPTH:], [*residuals, f][-DEPTH:]
        x = combined(steps, residuals, 1.0, MIN_SINGULAR_VALUE)
    return x


def combined(
    steps: Sequence[np.ndarray],
    residuals: Sequence[np.ndarray],
    weights: np.ndarray | float,
    min_singular_value: float,
) -> np.ndarray:
    """Next x from those so far and g(x) - x, whose combination is least in the norm with the weights."""
    f, new = residuals[-1], steps[-1] + residuals[-1]
    if len(steps) == 1:
        return new
    differences, moved = np.diff(np.array(residuals), axis=0), np.diff(np.array(steps), axis=0)
    gamma = np.linalg.lstsq((differences * weights).T, f * weights, rcond=min_singular_value)[0]
    return new - gamma @ (moved + differences)


def mixed_record(pairs: Sequence[tuple[HeatRecord, HeatRecord]], cold: float) -> HeatRecord:
    """Record for the next solve, from those before and after the last ones; `cold` is unheated oil [K]."""
    after = pairs[-1][1]
    near = [pair for pair in pairs if pair[0].levels and _is_near(*pair, cold)]
    if not near or near[-1] is not pairs[-1]:
        return after
    before, found = (np.array([_lagged(pair[k]) for pair in near[-DEPTH:]]) for k in (0, 1))
    scales = [np.full(getattr(after, name).size, np.abs(getattr(after, name)).max()) for name in LAGGED]
    weights = 1.0 / np.maximum(np.concatenate(scales), 1e-300)
    x = combined(list(before), list(found - before), weights, MIN_SINGULAR_VALUE_OF_RECORDS)
    ends = np.cumsum([getattr(after, name).size for name in LAGGED])
    fields: dict[str, Any] = dict(zip(LAGGED, np.split(x, ends[:-1]), strict=True))
    return after._replace(**fields)


def _lagged(record: HeatRecord) -> np.ndarray:
    return np.concatenate([getattr(record, name) for name in LAGGED])


def _is_near(before: HeatRecord, after: HeatRecord, cold: float) -> bool:
    return np.abs(after.film - before.film).max() < FAR * np.abs(after.film - cold).max()
