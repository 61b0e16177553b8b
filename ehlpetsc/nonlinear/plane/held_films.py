r"""Pressures settled with the films held, after a Newton step: edges of cavities, thin oil.

Newton's method moves an edge that advances into a cavity by a node an iteration, and each node that changes
its kind needs another sparse matrix; where the film is set, viscosity that is exponential in a pressure takes
it further iterations. Both are a matter of the cells nearby, whose films hardly depend on these pressures:
the balance of the cells around nodes that have changed, in which only their own q move, is a sparse system
of some hundred unknowns. A few Newton steps of it leave the next one of the whole system little to do
(nonlinear elimination). Where the oil is stiff, its pressure follows from the film, and nothing is settled.

Most of these cells depend on none or a few of the others: the system falls apart into islands. Numbered
breadth first from one end of its island, each cell is a few places from those on which it depends, and
elimination in a band takes a tenth of the time of a sparse solver for any system. There is no search for
pivots, as the balance of a cell depends most on its own pressure.

Gain: on 97 x 97 nodes the rough contacts of `tests/benchmarks/plane.py` take 4.95 (rigid) and
5.24 (layer) Newton iterations a step in place of 7.57 and 8.10, and 27 and 26 % less time; a smooth wave
takes as long.
"""

from __future__ import annotations

import numpy as np

from ehlpetsc.base.compiled import compiled, unsigned
from ehlpetsc.discretisation.contact.node_state import AMBIENT_TOLERANCE, limit_cavitation, open_cavity
from ehlpetsc.discretisation.finite_volumes import (
    M_Q,
    ONE,
    STENCIL,
    M,
    flux_through,
    law_of_row,
    positive_extrapolation,
)
from ehlpetsc.discretisation.plane.cross_flow import flux_across
from ehlpetsc.discretisation.reynolds import Reynolds
from ehlpetsc.discretisation.step_inputs import StepInputs
from ehlpetsc.nonlinear.plane.screened_poisson import MIDDLE, neighbour
from ehlpetsc.physics.oil.rheology import FlowLaw

HIGHEST = 0.1  # p0: pressures above it follow from the film; settled ones to .15 cost half an iteration more
MOVED = 0.02  # p0: change of a pressure to be settled; .01 brings an iteration more than none
GROWTH = 2  # nodes around a changed one whose q move
STEPS = 3  # of the local system
LARGEST = 0.3  # p0: change of a pressure in one of them
SETTLED = 1e-3  # p0: change of all pressures that ends them
FREE, HELD = -1, -2  # places of nodes that are not in the local system
MAX_PRODUCTS = 2e7  # of an island, 20 ms: larger ones are left to Newton's method for the whole system
UNSEEN = -1  # place of a cell in no island yet


class HeldFilms:
    """Balance of single cells of the local nodes, whose films do not change.

    `q`, `film`: of the window.
    """

    def __init__(self, reynolds: Reynolds, inputs: StepInputs, q: np.ndarray, film: np.ndarray):
        self.reynolds, self.inputs, self.oil = reynolds, inputs, inputs.oil.begin()
        self.at, self.storage = reynolds.properties(q, film, self.oil), reynolds.storage(inputs)
        self.laws = reynolds.face_law(inputs, reynolds.dx), reynolds.face_law(inputs, reynolds.dy)
        self.speeds = reynolds.speeds(inputs)
        self.film, self.of_mesh = film[reynolds.owned], np.arange(reynolds.local.start, reynolds.local.stop)

    def balance(self, nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Residual of some cells, none at the inlet, and derivatives by q of their stencils, (nodes, 6)."""
        r, tables = self.reynolds, (self.inputs.flow_table, self.inputs.cross_flow_table)
        laws = *self.laws, *self.speeds, tuple(self.inputs.flow)
        rows = np.empty(len(nodes)), np.empty((len(nodes), STENCIL))
        balance_at(self.at, nodes, r.n_x, laws, tables, self.storage, (r.dy, r.dx), rows)
        return rows

    def update(self, nodes: np.ndarray, q: np.ndarray) -> None:
        """Set q of some nodes."""
        n_x, values = self.reynolds.n_x, np.empty((len(self.at), len(nodes)))
        self.oil.fill(q, self.film[nodes], self.of_mesh[nodes], values)
        self.at[:, (nodes // n_x + 1) * (n_x + 1) + nodes % n_x] = values


def settle(cells: HeldFilms, q: np.ndarray, changed: np.ndarray) -> None:
    """Change q of the local nodes, in place, around some of them that have changed."""
    (n_y, n_x), place = cells.reynolds.shape, np.full(len(q), FREE, dtype=np.int32)
    place[q > HIGHEST] = HELD
    nodes = around(changed, GROWTH, n_y, n_x, place)
    for _ in range(STEPS if len(nodes) else 0):
        rows, by = cells.balance(nodes)
        change = solution(nodes, by, (n_x, len(q), False), place, rows)
        if not np.isfinite(change).all():
            return
        flipped = moved(q, nodes, change)
        if not len(flipped) and np.abs(change).max() < SETTLED:
            return
        cells.update(nodes, q[nodes])
        place[nodes] = FREE
        near = around(flipped, 1, n_y, n_x, place)
        place[near] = FREE
        nodes = around(np.concatenate([nodes, near]), 0, n_y, n_x, place)


@compiled
def around(nodes: np.ndarray, reach: int, n_y: int, n_x: int, place: np.ndarray) -> np.ndarray:
    """Free nodes up to some distance, none of the inlet; `place` becomes their index among them."""
    count = 0
    found = np.empty(len(nodes) * (2 * reach * (reach + 1) + 1), dtype=np.int64)
    for node in nodes:
        y, x = node // n_x, node % n_x
        for j in range(max(y - reach, 0), min(y + reach, n_y - 1) + 1):
            left = reach - abs(j - y)
            for i in range(max(x - left, 1), min(x + left, n_x - 1) + 1):
                if place[j * n_x + i] == FREE:
                    place[j * n_x + i] = count
                    found[count] = j * n_x + i
                    count += 1
    return found[:count].copy()


@compiled
def balance_at(
    at: np.ndarray,
    nodes: np.ndarray,
    n_x: int,
    laws: tuple,
    tables: tuple,
    storage: tuple,
    weights: tuple,
    rows: tuple,
) -> None:
    """Mass balance of some local nodes, none at the inlet, as :class:`.reynolds.Reynolds` sums it up.

    `tables`, `weights`: of the fluxes along x and across.
    `laws`: the same, speeds of the rows and of the faces between them, see
        :meth:`.reynolds.Reynolds.speeds`, and the shear law.
    `rows`: filled in: residual, shape (nodes,); derivatives by q of the `STENCIL` alone, (nodes, 6).
    """
    (along, across, of_rows, of_faces, flow), (m_old, extrapolated, k, rate) = laws, storage
    law = FlowLaw(*flow)
    table_x, table_y = tables
    (weight_x, weight_y), (residual, derivatives), stride = weights, rows, unsigned(n_x + 1)
    for j in range(len(nodes)):
        node, by = unsigned(nodes[j]), derivatives[j]
        row, i = node // unsigned(n_x), node % unsigned(n_x)
        here, along_row = (row + ONE) * stride + i, law_of_row(along, of_rows, row)
        of_below, of_above = law_of_row(across, of_faces, row), law_of_row(across, of_faces, row + ONE)
        behind = here - ONE - ONE if i > ONE else here - ONE
        inflow = flux_through(at, behind, here - ONE, here, table_x, along_row)
        outflow = flux_through(at, here - ONE, here, here + ONE, table_x, along_row)
        below = flux_across(at, here - stride, here, table_y, of_below, law)
        above = flux_across(at, here, here + stride, table_y, of_above, law)
        stored, by_m, _ = positive_extrapolation(at[M, here], m_old[node], k)
        residual[j] = weight_x * (outflow[0] - inflow[0]) + (stored - extrapolated[node]) * rate
        residual[j] += weight_y * (above[0] - below[0])
        by[0], by[1] = -weight_x * inflow[1], weight_x * (outflow[1] - inflow[3])
        by[2] = weight_x * (outflow[3] - inflow[5]) + by_m * at[M_Q, here] * rate
        by[2] += weight_y * (above[1] - below[3])
        by[3], by[4], by[5] = weight_x * outflow[5], -weight_y * below[1], weight_y * above[3]


@compiled
def moved(q: np.ndarray, nodes: np.ndarray, change: np.ndarray) -> np.ndarray:
    """Subtract changes, limited, from q in place; return the nodes that change between void and oil."""
    flipped, count = np.empty(len(nodes), dtype=np.int64), 0
    for k in range(len(nodes)):
        before = q[nodes[k]]
        limited = min(max(change[k], -LARGEST), LARGEST)
        new = before - limit_cavitation(before, open_cavity(before, limited))
        q[nodes[k]] = new
        if (new > -AMBIENT_TOLERANCE) != (before > -AMBIENT_TOLERANCE):
            flipped[count] = nodes[k]
            count += 1
    return flipped[:count].copy()


@compiled
def solution(
    nodes: np.ndarray, by: np.ndarray, mesh: tuple, place: np.ndarray, rows: np.ndarray
) -> np.ndarray:
    """Solution of the rows of some nodes, shape (nodes,), zero in islands of more than `MAX_PRODUCTS`.

    `by`: coefficients of the nodes of the stencil, (nodes, 6). `mesh`: as of
    :func:`.screened_poisson.neighbour`. `place`: of the nodes of the mesh in `nodes`; negative: not in the
    system. `rows`: right-hand sides.
    """
    near, beside, count = dependences(nodes, by, mesh, place)
    order = np.empty(len(nodes), dtype=np.int64)
    at, solved = np.full(len(nodes), UNSEEN), np.empty(len(nodes))
    for cell in range(len(nodes)):
        if at[cell] == UNSEEN:
            size = numbered(cell, beside, count, order, at)
            for k in range(size):
                at[order[k]] = UNSEEN
            size = numbered(order[size - 1], beside, count, order, at)  # from one end
            solve_band(order[:size], at, near, by, rows, solved)
    return solved


@compiled
def dependences(
    nodes: np.ndarray, by: np.ndarray, mesh: tuple, place: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Cells on which each one depends, (nodes, 6), -1: none; those beside it, both ways, and their number."""
    near, beside = np.full((len(nodes), STENCIL), -1), np.empty((len(nodes), 2 * STENCIL), dtype=np.int64)
    count = np.zeros(len(nodes), dtype=np.int64)
    for cell in range(len(nodes)):
        for k in range(STENCIL):
            node = neighbour(nodes[cell], k, mesh)
            if node < 0 or place[node] < 0 or (by[cell, k] == 0.0 and k != MIDDLE):
                continue
            other = near[cell, k] = place[node]
            if other != cell:
                beside[cell, count[cell]], beside[other, count[other]] = other, cell
                count[cell] += 1
                count[other] += 1
    return near, beside, count


@compiled
def numbered(cell: int, beside: np.ndarray, count: np.ndarray, order: np.ndarray, at: np.ndarray) -> int:
    """Number the cells of an island breadth first; fill in their `order`, and the places `at` it."""
    order[0], at[cell], size, k = cell, 0, 1, 0
    while k < size:
        for n in range(count[order[k]]):
            other = beside[order[k], n]
            if at[other] == UNSEEN:
                order[size], at[other] = other, size
                size += 1
        k += 1
    return size


@compiled
def solve_band(
    order: np.ndarray, at: np.ndarray, near: np.ndarray, by: np.ndarray, rows: np.ndarray, solved: np.ndarray
) -> None:
    """Fill in the solution of the cells of an island; of one that is too large no change."""
    size, reach = len(order), 0
    for k in range(size):
        for n in range(STENCIL):
            if near[order[k], n] >= 0:
                reach = max(reach, abs(at[near[order[k], n]] - k))
    if size * reach**2 > MAX_PRODUCTS:
        solved[order] = 0.0
        return
    band, x = np.zeros((size, 2 * reach + 1)), np.empty(size)  # the diagonal at the index reach
    for k in range(size):
        x[k] = rows[order[k]]
        for n in range(STENCIL):
            if near[order[k], n] >= 0:
                band[k, reach + at[near[order[k], n]] - k] += by[order[k], n]
    for k in range(size):
        for i in range(k + 1, min(k + reach + 1, size)):
            factor = band[i, reach + k - i] / band[k, reach]
            if factor != 0.0:
                x[i] -= factor * x[k]
                for j in range(1, min(reach + 1, size - k)):
                    band[i, reach + k - i + j] -= factor * band[k, reach + j]
    for k in range(size - 1, -1, -1):
        for j in range(1, min(reach + 1, size - k)):
            x[k] -= band[k, reach + j] * x[k + j]
        x[k] /= band[k, reach]
        solved[order[k]] = x[k]
