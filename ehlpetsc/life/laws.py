r"""Laws of a surface over its life: size of a jump, damage of cells under a receding surface, micropits.

A body is divided into columns along its surface and cells of depth Z below the surface as made. Wear and
pits lower the surface of a column to the depth r; a cell at Z is then at the depth :math:`z=Z-r`. A pass adds
:math:`D(s,z)`, and N passes add N times as much (Palmgren-Miner), of which D = 1 is failure. Wear takes off
the cells in which damage accumulates (Morales-Espejel and Brizmer, Tribology Transactions 54 (2011) 625).
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

FINE_CELLS = 12  # cells of equal thickness below the surface as made
CELL_GROWTH = 1.25  # of the thickness of the cells below them

WEAKENED_DAMAGE = 0.95  # damage from which cells break out with a failed one
WALL_SLOPE = 3.0**-0.5  # of the walls of a pit: 30 degrees


def sum_over(passes: float, rate: float | np.ndarray, slope: float) -> float | np.ndarray:
    """Sum over passes of a rate that changes by `slope` from pass to pass."""
    return passes * rate + 0.5 * passes**2 * slope


def passes_to(amount: float | np.ndarray, rate: float | np.ndarray, slope: float | np.ndarray) -> np.ndarray:
    r"""Number of passes after which the sum of a changing rate has an amount; inf: never.

    .. math:: t=\frac{2c}{f\,(1+\sqrt{1+2sc/f^2})}\quad\text{of}\quad c = ft+\tfrac12st^2

    `amount`, `rate`, `slope`: c > 0, f >= 0 and s.
    """
    positive = np.where(np.asarray(rate) > 0.0, rate, 1.0)
    constant = amount / positive
    root = 1.0 + 2.0 * slope * constant / positive
    passes = 2.0 * constant / (1.0 + np.sqrt(np.maximum(root, 0.0)))
    return np.where((np.asarray(rate) > 0.0) & (root >= 0.0), passes, np.inf)


def cell_edges(thickness: float, deepest: float) -> np.ndarray:
    """Depths of the edges of the cells of a column [m]: equal ones at the surface, growing below.

    The growth is chosen, near `CELL_GROWTH`, so that the last edge is the deepest depth. Cells therefore
    change continuously with their thickness.

    `thickness`: of the first cells [m]. `deepest`: last edge [m].
    """
    fine = FINE_CELLS * thickness
    terms = 1.0 + max(deepest - fine, 0.0) / thickness * (1.0 - 1.0 / CELL_GROWTH)
    growing = round(np.log(terms) / np.log(CELL_GROWTH))
    if not growing:  # equal cells alone
        return np.linspace(0.0, deepest, min(max(round(deepest / thickness), 1), FINE_CELLS) + 1)
    powers = np.arange(1, growing + 1)
    growth = brentq(lambda g: fine + thickness * (g**powers).sum() - deepest, 0.0, 2.0 * CELL_GROWTH)
    edges = np.append(thickness * np.arange(FINE_CELLS + 1), fine + thickness * np.cumsum(growth**powers))
    edges[-1] = deepest
    return edges


def below(depths: np.ndarray, columns: np.ndarray) -> np.ndarray:
    """Depths (n,) as an axis ahead of those of the columns."""
    return np.reshape(depths, (-1, *(1,) * columns.ndim))


def regions(mask: np.ndarray, across: bool) -> tuple[np.ndarray, int]:
    """Numbers from 1 of the connected regions of a mask, shape of the mask, and their count.

    `across`: whether the last axis but one is across a strip, which repeats there: its first and last rows
    are neighbours.
    """
    from scipy.ndimage import label
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    numbers, count = label(mask)
    if not across:
        return numbers, int(count)
    first, last = numbers[..., 0, :], numbers[..., -1, :]
    both = (first > 0) & (last > 0)
    pairs = coo_matrix((both[both], (first[both], last[both])), shape=(count + 1, count + 1))
    merged, number_of = connected_components(pairs, directed=False)  # 0, beside the regions, stays alone
    return number_of[numbers], merged - 1


def cell_depths(edges: np.ndarray, recession: np.ndarray) -> np.ndarray:
    """Depths of the centres of cells below the present surface [m]; nan where a cell is gone.

    `edges`: shape (cells + 1,). `recession`: depth of the present surface below that as made [m], shape
    (columns,) or (rows, columns). Of a cell that is worn in part the centre of the rest counts.
    """
    top = np.maximum(below(edges[:-1], recession), recession)
    bottom = below(edges[1:], recession)
    return np.where(bottom > recession, 0.5 * (top + bottom) - recession, np.nan)


def damage_at(depths: np.ndarray, damage: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Damage of a pass at given depths, interpolated between the computed ones in each column.

    Straight lines of ln D over depth, of D where one end is 0; 0 below the deepest.

    `depths`: increasing from 0 [m], shape (n,). `damage`: shape (n, columns). `at`: depths [m]; nan: 0, shape
    (cells, columns). Columns may have an axis of rows before them.
    """
    if len(depths) == 1:
        return np.where(at <= depths[0], damage[0], 0.0)
    exists = np.isfinite(at)
    z = np.where(exists, np.maximum(at, depths[0]), depths[-1])
    k = np.clip(np.searchsorted(depths, z, "right") - 1, 0, len(depths) - 2)
    weight = (z - depths[k]) / (depths[k + 1] - depths[k])
    low, high = np.take_along_axis(damage, k, 0), np.take_along_axis(damage, k + 1, 0)
    both_positive = (low > 0.0) & (high > 0.0)
    logs = np.log(np.where(both_positive, low, 1.0)), np.log(np.where(both_positive, high, 1.0))
    interpolated = np.where(
        both_positive, np.exp(logs[0] + weight * (logs[1] - logs[0])), low + weight * (high - low)
    )
    return np.where(exists & (z <= depths[-1]), interpolated, 0.0)


def broken_out(
    damage: np.ndarray, edges: np.ndarray, recession: np.ndarray, rule: str = "above"
) -> np.ndarray:
    """Depths to which columns break out below the surface as made [m], `recession` where nothing does.

    A failed cell breaks out with the weakened cells connected with it: left alone, they would fail within few
    passes, so that the depth of a pit is independent of the length of the jump. By the rule

    * ``above`` all cells above it break out too: a crack that starts below the surface reaches it at once,
      compared with the passes to its start (Brandao, Seabra and Castro, WIT Trans. Eng. Sci. 66 (2010) 3);
    * ``connected`` only cells that are connected with the surface by failed or weakened ones break out, with
      the cells above them: a crack does not grow.

    `damage`: shape (cells, *columns). `edges`: [m], shape (cells + 1,). `recession`: depth of the present
    surface [m], shape (columns,), of a strip (rows, columns).
    """
    bottoms = below(edges[1:], recession)
    remains = bottoms > recession
    failed = remains & (damage >= 1.0)
    if not failed.any():
        return np.array(recession, float)
    numbers, _ = regions(remains & (damage >= WEAKENED_DAMAGE), recession.ndim > 1)
    breaking = numbers[failed]
    if rule == "connected":
        top = remains.argmax(axis=0)[None]
        at_surface = np.take_along_axis(numbers, top, 0)[0][remains.any(axis=0)]
        breaking = np.intersect1d(at_surface, breaking)
    bottom = np.where(np.isin(numbers, breaking), bottoms, 0.0).max(axis=0)
    return np.maximum(bottom, recession)


def with_walls(bottom: np.ndarray, recession: np.ndarray, widths: tuple[float, ...]) -> np.ndarray:
    """Depths of pits whose walls rise at 30 degrees from the cells that break out, in all directions [m].

    Cracks of micropits grow at a shallow angle to the surface (Rycerz and Kadiric, Tribology Letters 67
    (2019) 63), and the width of a pit is then independent of that of the columns.

    `bottom`: as of :func:`broken_out` [m], shape (columns,), of a strip (rows, columns). `recession`: depth
    of the surface before [m]. `widths`: of a column along each of these axes [m].
    """
    rows, columns = (1, *bottom.shape)[-2:]
    bottoms, depth = bottom.reshape(rows, columns), recession.reshape(rows, columns).copy()
    breaks = np.argwhere(bottoms > depth)
    if not len(breaks):
        return np.array(recession, float)
    width, across = widths[-1], widths[0]
    reach = (bottoms.max() - depth.min()) / WALL_SLOPE
    beside, turned = min(int(reach / width), columns), min(int(reach / across), (rows - 1) // 2 + 1)
    turns = np.arange(max(-turned, -((rows - 1) // 2)), min(turned, rows // 2) + 1)
    along = np.arange(-beside, beside + 1)
    rise = WALL_SLOPE * np.hypot(width * along, (across * turns)[:, None])
    for row, column in breaks:
        first, last = max(column - beside, 0), min(column + beside + 1, columns)
        wall = rise[:, first - column + beside : last - column + beside]
        place = ((row + turns) % rows)[:, None], np.arange(first, last)
        depth[place] = np.maximum(depth[place], bottoms[row, column] - wall)
    return depth.reshape(bottom.shape)
