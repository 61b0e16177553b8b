r"""Block tridiagonal matrix of a contact with the far deflection, by M more unknowns in every group of nodes.

A group of `GROUP` nodes has the unknowns (h_2, h_1, Q_1 .. Q_M, q_1 .. q_4, h_3, h_4): sums of
:func:`exponentials` and the pairs of its nodes, in an order in which those that the group behind or
before couples to are contiguous (:mod:`.block_lu`). Three dense rows, the whole deflection at both end nodes
and the load, are stored separately. A rank has the groups of its nodes, the last one of several from right to
left; the coefficients of other ranks' groups are stored as those of a group before or behind.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ehlpetsc.base.compiled import compiled
from ehlpetsc.discretisation.ehl_problem import EHLProblem
from ehlpetsc.discretisation.finite_volumes import Q_OWN
from ehlpetsc.discretisation.line.deflection import SECOND_DIFFERENCE
from ehlpetsc.nonlinear.line.block_lu import FROM_LEFT, FROM_RIGHT, LEFT, ROW_WIDTH, SIZE, STRIDE
from ehlpetsc.nonlinear.line.jacobian import pivot_regularisation
from ehlpetsc.nonlinear.line.node_pairs import BandEntries, same_deflection

GROUP = 4  # nodes; wider bands cost more than they save iterations, narrower ones need more exponentials
TERMS = 3  # exponentials; a fourth would save iterations of GMRES, and cost more in the band
ERROR_REACH = 0.1  # half-widths within which the relative error counts; beyond it counts less
SLOWEST, FASTEST = 0.4, 1.4  # rates: over the reach, and over a group


def grouped_kernel(kernel: np.ndarray) -> np.ndarray:
    """Mean of a kernel (n,) over the nodes of two groups, at distances 0, 1, ... groups."""
    apart = np.arange(1 - GROUP, GROUP)
    weights = (GROUP - np.abs(apart)) / GROUP**2
    distance = np.arange(len(kernel) // GROUP - 1)
    return kernel[np.abs(GROUP * distance[:, None] + apart)] @ weights


def exponentials(kernel: np.ndarray, nodes_per_half_width: float) -> tuple[np.ndarray, np.ndarray]:
    r"""Rates and weights of the exponentials for a kernel, fitted from a distance of two groups on.

    The kernel of the differential deflection falls as :math:`1/k^2` over the whole mesh. Cut off, it leaves
    the long waves of pressure to the Krylov method; as :math:`\sum_mw_me^{-\lambda_md}` of the distance d it
    is the solution of M three-point recurrences,

    .. math:: -Q_{d-1}+2\cosh\lambda\,Q_d-Q_{d+1}=2\sinh\lambda\;p_d,

    M unknowns more with neighbours only. Distances are between groups of `GROUP` nodes: near by, where that
    would be too coarse, the kernel is taken as it is.

    `kernel`: :func:`ehlpetsc.elasticity.half_plane.curvature_kernel`, shape (n,).

    The kernel at a distance of d groups is about ``weights @ exp(-rates * d)``, both of shape (TERMS,).
    """
    far = grouped_kernel(kernel)[2:]
    reach = max(ERROR_REACH * nodes_per_half_width / GROUP, 1.0)
    rates = np.geomspace(SLOWEST / reach, FASTEST, TERMS)
    distance = 2.0 + np.arange(len(far))
    weight = 1.0 / (far * (1.0 + distance / reach))
    terms = np.exp(-np.outer(distance, rates))
    return rates, np.linalg.lstsq(terms * weight[:, None], far * weight, rcond=None)[0]


FILMS = np.array([1, 0, SIZE - 2, SIZE - 1])  # places in a group of its nodes' films
FIRST_SUM = 2
FIRST_PRESSURE = FIRST_SUM + TERMS


class BandedJacobian:
    """Indices and values of the local entries.

    `problem`: its first node must begin a group.

    `groups`, `size`: local groups, and the room that their unknowns take.
    `dofs`: numbers of the unknowns (q, h, q, h, ...) of the local nodes, shape (2 nodes,).
    `end_groups`: numbers of the unknowns of the first and of the last group, and of the room behind them,
        shape (2, STRIDE).
    `entries`: of the state last filled in.
    `dense`: of the same state: deflection at both end nodes that the band lacks, and the load, shape (3,
        size).
    """

    def __init__(self, problem: EHLProblem):
        self.problem = problem
        self.nodes = np.arange(problem.first, problem.last)
        self.rates, self.weights = exponentials(problem.deflection.curvature, 1.0 / problem.dx)
        self.groups = -(-len(self.nodes) // GROUP)
        self.is_mirrored = problem.first > 0 and problem.last == problem.n
        self.size = self.groups * STRIDE
        self.dofs = np.stack([self._pressure(self.nodes), self._film(self.nodes)], axis=1).ravel()
        self.end_groups = np.stack([np.arange(STRIDE), np.arange(self.size - STRIDE, self.size)])
        self.values = np.zeros(self.size * ROW_WIDTH + 1)  # the last one: entries that do not exist
        self.columns = self.values[:-1].reshape(self.groups, ROW_WIDTH, STRIDE)
        self._recurrences()
        self._padding()
        self._under_films()
        self._under_pressures()
        self._under_reynolds()
        self.under_pressure = self._dense_rows()
        self.entries: BandEntries = None

    def _group(self, node: np.ndarray | int) -> Any:
        return (node - self.problem.first) // GROUP

    def _in_group(self, node: np.ndarray) -> np.ndarray:
        return (node - self.problem.first) % GROUP

    def _dof(self, group: np.ndarray, k: np.ndarray) -> np.ndarray:
        """Number of the k-th unknown of a group; from the right end of the mesh where mirrored."""
        if self.is_mirrored:
            group, k = self.groups - 1 - group, SIZE - 1 - k
        return group * STRIDE + k

    def _sums(self, group: np.ndarray) -> np.ndarray:
        """Numbers of the sums of groups, one row each."""
        return self._dof(np.asarray(group)[:, None], FIRST_SUM + np.arange(TERMS))

    def _pressure(self, node: np.ndarray | int) -> Any:
        """Number of q of a node."""
        return self._dof(self._group(node), FIRST_PRESSURE + self._in_group(node))

    def _film(self, node: np.ndarray) -> np.ndarray:
        """Number of h of a node."""
        return self._dof(self._group(node), FILMS[self._in_group(node)])

    def _index_of(self, row: np.ndarray, column: np.ndarray) -> np.ndarray:
        """Index of an entry in `values`; the last one where it does not exist."""
        (group, r), (other, c) = np.divmod(row, STRIDE), np.divmod(column, STRIDE)
        coupled = np.abs(other - group) <= 1
        starts = np.choose(
            np.where(coupled, other - group + 1, 1), [-FROM_LEFT, LEFT, LEFT + SIZE - FROM_RIGHT]
        )
        return np.where(coupled, (group * ROW_WIDTH + starts + c) * STRIDE + r, self.values.size - 1)

    def _recurrences(self) -> None:
        p, groups = self.problem, np.arange(self.groups)
        row = self._sums(groups)
        self.values[self._index_of(row, row)] = 2.0 * np.cosh(self.rates)
        for towards, outer, at_end in ((-1, 0, p.first == 0), (1, -1, p.last == p.n)):
            beyond = self._index_of(row, self._sums(groups + towards))
            self.values[beyond] = -1.0
            if at_end:  # no pressure beyond: the sum decays as the exponential
                self.values[beyond[outer]] = 0.0
                self.values[self._index_of(row[outer], row[outer])] -= np.exp(-self.rates)

    def _padding(self) -> None:
        """Unknowns of a last group that is not full: zero."""
        none = np.arange(self.nodes[-1] + 1, self.problem.first + self.groups * GROUP)
        for spare in (self._pressure(none), self._film(none)):
            self.values[self._index_of(spare, spare)] = 1.0

    def _under_films(self) -> None:
        """Entries of the deflection rows: films (nodes of the window, values, indices), and sums."""
        d, inner = self.problem.deflection, self._inner()
        ends = np.array(d.ends, dtype=int)
        row = self._pressure(inner)
        steps = list(zip((-1, 0, 1), SECOND_DIFFERENCE, strict=True))
        nodes = np.concatenate([*(inner + k for k, _ in steps), ends])
        self.film_nodes = nodes - self.problem.window.start
        self.by_film = np.repeat(
            [*(d.curvature_coefficient * value for _, value in steps), d.end_row_coefficient],
            [*[len(inner)] * 3, len(ends)],
        )
        rows = np.concatenate([row, row, row, self._pressure(ends)])
        self.film_place = self._index_of(rows, self._film(nodes))
        self.values[self._index_of(row[:, None], self._sums(self._group(inner)))] = -self.weights

    def _under_pressures(self) -> None:
        """Entries of recurrences and deflection rows in the columns of first unknowns."""
        p, inner, d = self.problem, self._inner(), self.problem.deflection
        repeated = np.repeat(self.nodes, TERMS)
        rows = [self._sums(self._group(self.nodes)).ravel()]
        nodes, values = [repeated], [np.tile(-2.0 * np.sinh(self.rates), len(self.nodes))]
        bend, bent = dict(zip((-1, 0, 1), SECOND_DIFFERENCE, strict=True)), [np.zeros(len(repeated))]
        for k in range(1 - 2 * GROUP, 2 * GROUP):
            group_distance = np.abs(self._group(inner + k) - self._group(inner))
            near = (group_distance <= 1) & (inner + k >= 0) & (inner + k < p.n)
            rows.append(self._pressure(inner[near]))
            nodes.append(inner[near] + k)
            far = np.exp(-np.outer(group_distance[near], self.rates)) @ self.weights
            values.append(far - d.curvature[abs(k)])
            bent.append(np.full(near.sum(), d.curvature_coefficient * bend.get(k, 0.0)))
        for end in d.ends:
            near = self._nodes_in_group_of(end)
            rows.append(np.full(len(near), self._pressure(end)))
            nodes.append(near)
            values.append(d.end_row(end)[near])
            bent.append(np.where(near == end, d.end_row_coefficient, 0.0))
        node, self.by_pressure = np.concatenate(nodes), np.concatenate(values)
        self.by_depth, self.pressure_nodes = np.concatenate(bent), node - p.window.start
        self.pressure_place = self._index_of(np.concatenate(rows), self._pressure(node))
        pressures = self._pressure(self.nodes)
        self.diagonal = self._index_of(pressures, pressures)

    def _inner(self) -> np.ndarray:
        return self.nodes[(self.nodes > 0) & (self.nodes < self.problem.n - 1)]

    def _dense_rows(self) -> np.ndarray:
        """Under the local pressures: what the band lacks of the end nodes' deflection, and the load."""
        p = self.problem
        rows = np.empty((3, len(self.nodes)))
        for k, end in enumerate((0, p.n - 1)):
            rows[k] = p.deflection.end_row(end)[self.nodes]
            if end in p.deflection.ends:
                rows[k, self._nodes_in_group_of(end) - p.first] = 0.0
        rows[2] = p.dx
        return rows

    def _nodes_in_group_of(self, end: int) -> np.ndarray:
        """Nodes of an end node's own group."""
        return self.nodes[self._group(self.nodes) == self._group(end)]

    def _under_reynolds(self) -> None:
        """Indices of the Reynolds stencil, q and h of the nodes i-2 .. i+1 in each row."""
        p = self.problem
        node = self.nodes[:, None] + np.arange(-2, 2)
        columns = np.stack([self._pressure(node), self._film(node)], axis=2).reshape(len(node), -1)
        on_mesh = np.repeat((node >= 0) & (node < p.n), 2, axis=1)
        self.stencil = np.clip(node, 0, p.n - 1) - p.window.start
        place = self._index_of(self._film(self.nodes)[:, None], columns)
        self.reynolds_place = np.where(on_mesh, place, self.values.size - 1)

    def fill(self, entries: BandEntries, inactive_nodes: np.ndarray) -> np.ndarray:
        """Entries at one state.

        `inactive_nodes`: local nodes whose second unknown is not in the system.

        Returns as :class:`.block_lu.BlockLU` takes them, shape (groups, WIDTH, STRIDE).
        """
        self._fill_deflection(entries)
        place_entries(
            entries.reynolds_derivatives, self.reynolds_place, inactive_nodes, Q_OWN + 1, self.values
        )
        return self.columns

    def _fill_deflection(self, entries: BandEntries) -> None:
        """Refill what a change of contact or cavity touches."""
        before, self.entries = self.entries, entries
        pressure, depth, film = entries[:3]
        if before is not None and same_deflection((pressure, depth, film), tuple(before[:3])):
            return
        changed = np.ones(len(pressure), dtype=bool)
        if before is not None:
            changed = np.any([now != old for now, old in zip(entries[:3], before[:3], strict=True)], axis=0)
        stale = np.flatnonzero(changed[self.film_nodes])
        self.values[self.film_place[stale]] = self.by_film[stale] * film[self.film_nodes[stale]]
        stale = np.flatnonzero(changed[self.pressure_nodes])
        node = self.pressure_nodes[stale]
        values = self.by_pressure[stale] * pressure[node] + self.by_depth[stale] * depth[node]
        self.values[self.pressure_place[stale]] = values
        pressure, depth, changed = (array[self.problem.owned] for array in (pressure, depth, changed))
        local = np.flatnonzero(changed)
        self.values[self.diagonal[local]] += pivot_regularisation(pressure[local], depth[local])
        self.dense = np.zeros((len(self.under_pressure), self.size))
        self.dense[:, self.dofs[::2]] = self.under_pressure * pressure


@compiled
def place_entries(
    entries: np.ndarray,
    places: np.ndarray,
    inactive_nodes: np.ndarray,
    diagonal: np.ndarray,
    values: np.ndarray,
) -> None:
    """Put rows of entries at their places among values; of a row inactive_nodes, a one on its diagonal alone.

    Parameters
    ----------
    entries : shape (rows, width)
    places : shape (rows, width)
    diagonal
        Column of the entry on the diagonal.
    """
    for i in range(entries.shape[0]):
        for k in range(entries.shape[1]):
            values[places[i, k]] = entries[i, k]
    for i in inactive_nodes:
        for k in range(entries.shape[1]):
            values[places[i, k]] = 1.0 if k == diagonal else 0.0
