r"""The contact's matrix with the far deflection in it: a band with M unknowns more to a group of nodes.

A group of `GROUP` nodes has the unknowns (Q_1 .. Q_M, q, h, q, h): those of :mod:`.exponential_kernel` and
the pairs of its nodes, and is coupled with its two neighbours alone. What does not fit, three dense rows
(the whole deflection at both end nodes; the load), is kept apart. A rank holds the groups of its nodes,
and of the entries that reach into its neighbours' groups one block at either end.
"""

import numpy as np

from ehlpetsc.discretisation.deflection import SECOND_DIFFERENCE
from ehlpetsc.discretisation.finite_volumes import OWN
from ehlpetsc.nonlinear.operators.jacobian_operator import leaks
from ehlpetsc.nonlinear.preconditioner.exponential_kernel import GROUP, exponentials


class BandedJacobian:
    """Places and values of the local entries.

    Parameters
    ----------
    problem : ehl_problem.EHLProblem
        Its first node must begin a group.

    Attributes
    ----------
    size : int
        Unknowns of a group.
    order : int
        Local unknowns.
    half : int
        Half-bandwidth.
    place : ndarray, shape (2 nodes,)
        Numbers in the band of the unknowns (q, h, q, h, ...) of the local nodes.
    groups_at_ends : ndarray, shape (2, size)
        Those of the unknowns of the first and of the last group.
    backwards : bool
        Whether the band numbers the local unknowns from the last to the first, so that the last rank's
        neighbour is where its elimination ends, as the first one's is: what comes from there is then solved
        for without forward substitution.
    entries : node_variables.BandEntries or None
        Of the state last filled in.
    dense : ndarray, shape (3, nodes)
        Of the same: what the band lacks of both end nodes' deflection, and the load, under
        the local first unknowns.
    beside : tuple of ndarray
        Unknowns of the last group to the left, and of the first to the right, that local rows contain.
    """

    def __init__(self, problem):
        self.problem = problem
        self.nodes = np.arange(problem.first, problem.last)
        self.rates, self.weights = exponentials(problem.deflection.curvature, 1.0 / problem.dx)
        self.size = len(self.rates) + 2 * GROUP
        self.groups = -(-len(self.nodes) // GROUP)
        self.order = self.groups * self.size
        self.half = self.size + 2 * (GROUP - 1)
        self.height = 3 * self.half + 1
        self.backwards = problem.first > 0 and problem.last == problem.n
        place = np.stack([self._film(self.nodes) - 1, self._film(self.nodes)], axis=1).ravel()
        ends = np.stack([np.arange(self.size), np.arange(self.order - self.size, self.order)])
        self.place, self.groups_at_ends = self._in_band(place), self._in_band(ends)
        self.used = place[-1] + 1
        self.beside = self._in_other_rows()
        self.base = np.zeros(self.height * self.order + 2 * self.size**2 + 1)
        self._recurrences()
        self._under_films()
        self._under_pressures()
        self._under_reynolds()
        self.under_pressure = self._dense_rows()
        self.values = np.empty_like(self.base)  # kept: new pages cost as much as filling them
        self.entries = None

    def _in_other_rows(self):
        """Of a group: the sums, every pressure, and the films of two nodes (upwind) or one."""
        sums = len(self.rates)
        others = [q for q in range(self.size) if q < sums or (q - sums) % 2 == 0]
        return np.array(others + [self.size - 3, self.size - 1]), np.array(others + [sums + 1])

    def _group(self, node):
        return (node - self.problem.first) // GROUP

    def _film(self, node):
        """Number of h of a node; q's is one less."""
        local = node - self.problem.first
        return local // GROUP * self.size + len(self.rates) + 2 * (local % GROUP) + 1

    def _in_band(self, unknowns):
        return self.order - 1 - unknowns if self.backwards else unknowns

    def _at(self, row, column):
        """Place of an entry among `base`: the band, the block to the left, that to the right, nowhere."""
        left, right = self.height * self.order, self.height * self.order + self.size**2
        r, c = self._in_band(row), self._in_band(column)
        in_band = c * self.height + 2 * self.half + r - c
        to_left = left + row * self.size + column + self.size
        to_right = right + (row - (self.order - self.size)) * self.size + column - self.order
        place = np.where(column < 0, to_left, np.where(column < self.order, in_band, to_right))
        return np.where(column < -self.size, self.base.size - 1, place)

    def _recurrences(self):
        groups, p = np.arange(self.groups), self.problem
        ends = (p.first == 0, p.last == p.n)
        for m, rate in enumerate(self.rates):
            row = groups * self.size + m
            self.base[self._at(row, row)] = 2.0 * np.cosh(rate)
            for towards, at_end in ((-1, ends[0]), (1, ends[1])):
                inner = row[1:] if towards < 0 else row[:-1]
                outer = row[0] if towards < 0 else row[-1]
                self.base[self._at(inner, inner + towards * self.size)] = -1.0
                if at_end:  # no pressure beyond: the sum falls on as the exponential does
                    self.base[self._at(outer, outer)] -= np.exp(-rate)
                else:
                    self.base[self._at(outer, outer + towards * self.size)] = -1.0
        for spare in range(self.used, self.order):  # of a last group that is not full
            self.base[self._at(spare, spare)] = 1.0

    def _under_films(self):
        """What the deflection rows have of films (nodes of the window, values, places), and of the sums."""
        d, inner = self.problem.deflection, self._inner()
        ends = np.array(d.ends, dtype=int)
        row = self._film(inner) - 1
        steps = list(zip((-1, 0, 1), SECOND_DIFFERENCE, strict=True))
        nodes = np.concatenate([*(inner + k for k, _ in steps), ends])
        self.film_nodes = nodes - self.problem.window.start
        self.by_film = np.repeat(
            [*(d.stretch * value for _, value in steps), d.end_scale], [*[len(inner)] * 3, len(ends)]
        )
        rows = np.concatenate([row, row, row, self._film(ends) - 1])
        self.film_place = self._at(rows, self._film(nodes))
        sums = self._group(inner)[:, None] * self.size + np.arange(len(self.rates))
        self.base[self._at(row[:, None], sums)] = -self.weights

    def _under_pressures(self):
        """Under first unknowns, of recurrences and deflection rows: nodes in the window, values, places."""
        p, inner, d = self.problem, self._inner(), self.problem.deflection
        own = np.repeat(self.nodes, len(self.rates))
        rows = [self._group(own) * self.size + np.tile(np.arange(len(self.rates)), len(self.nodes))]
        nodes, values = [own], [np.tile(-2.0 * np.sinh(self.rates), len(self.nodes))]
        bend, bent = dict(zip((-1, 0, 1), SECOND_DIFFERENCE, strict=True)), [np.zeros(len(own))]
        for k in range(1 - 2 * GROUP, 2 * GROUP):
            apart = np.abs(self._group(inner + k) - self._group(inner))
            near = (apart <= 1) & (inner + k >= 0) & (inner + k < p.n)
            rows.append(self._film(inner[near]) - 1)
            nodes.append(inner[near] + k)
            far = np.exp(-np.outer(apart[near], self.rates)) @ self.weights
            values.append(far - d.curvature[abs(k)])
            bent.append(np.full(near.sum(), d.stretch * bend.get(k, 0.0)))
        for end in d.ends:
            near = self._beside(end)
            rows.append(np.full(len(near), self._film(end) - 1))
            nodes.append(near)
            values.append(d.end_row(end)[near])
            bent.append(np.where(near == end, d.end_scale, 0.0))
        nodes, self.by_pressure = np.concatenate(nodes), np.concatenate(values)
        self.by_depth, self.pressure_nodes = np.concatenate(bent), nodes - p.window.start
        self.pressure_place = self._at(np.concatenate(rows), self._film(nodes) - 1)
        self.diagonal = self._at(self._film(self.nodes) - 1, self._film(self.nodes) - 1)

    def _inner(self):
        return self.nodes[(self.nodes > 0) & (self.nodes < self.problem.n - 1)]

    def _dense_rows(self):
        """Under the local pressures: what the band lacks of the end nodes' deflection, and the load."""
        p = self.problem
        rows = np.empty((3, len(self.nodes)))
        for k, end in enumerate((0, p.n - 1)):
            rows[k] = p.deflection.end_row(end)[self.nodes]
            if end in p.deflection.ends:
                rows[k, self._beside(end) - p.first] = 0.0
        rows[2] = p.dx
        return rows

    def _beside(self, end):
        """Nodes of an end node's own group."""
        return self.nodes[self._group(self.nodes) == self._group(end)]

    def _under_reynolds(self):
        """Places of Reynolds' stencil, q and h of the nodes i-2 .. i+1 of the window in each row."""
        p = self.problem
        node = self.nodes[:, None] + np.arange(-2, 2)
        both = np.stack([self._film(node) - 1, self._film(node)], axis=2).reshape(len(node), -1)
        there = np.repeat((node >= 0) & (node < p.n), 2, axis=1)
        self.stencil = np.clip(node, 0, p.n - 1) - p.window.start
        place = self._at(self._film(self.nodes)[:, None], both)
        self.reynolds_place = np.where(there, place, self.base.size - 1)

    def fill(self, entries, dropped):
        """Values for one state.

        Parameters
        ----------
        entries : node_variables.BandEntries
        dropped : ndarray of int
            Local nodes whose second unknown stays as it is.

        Returns
        -------
        band : ndarray, shape (3 half + 1, order)
            In LAPACK's storage, Fortran order.
        left, right : ndarray, shape (size, len(beside))
            What the first and last group take from their neighbours on other ranks.
        """
        self._fill_deflection(entries)
        derivatives = entries.reynolds_derivatives
        if len(dropped):
            derivatives = derivatives.copy()
            derivatives[dropped] = 0.0
            derivatives[dropped, OWN + 1] = 1.0
        values, cut, block = self.values, self.height * self.order, self.size**2
        columns = (self.order, self.height)
        # LAPACK clears what is above the band itself
        values[:cut].reshape(columns)[:, self.half :] = self.base[:cut].reshape(columns)[:, self.half :]
        values[cut:] = self.base[cut:]
        values[self.reynolds_place] = derivatives
        blocks = values[cut : cut + 2 * block].reshape(2, self.size, self.size)
        left, right = (block[:, some] for block, some in zip(blocks, self.beside, strict=True))
        return values[:cut].reshape(columns).T, left, right

    def _fill_deflection(self, entries):
        """Refill what a change of contact or cavity touches."""
        before, self.entries = self.entries, entries
        pressure, depth, film = entries.p_first, entries.separation_first, entries.separation_second
        changed = film_changed = np.ones(len(pressure), dtype=bool)
        if before is not None:
            changed = (pressure != before.p_first) | (depth != before.separation_first)
            film_changed = film != before.separation_second
        if changed.any():
            some = np.flatnonzero(changed[self.pressure_nodes])
            node = self.pressure_nodes[some]
            values = self.by_pressure[some] * pressure[node] + self.by_depth[some] * depth[node]
            self.base[self.pressure_place[some]] = values
            own = self.problem.own
            local = np.flatnonzero(changed[own])
            self.base[self.diagonal[local]] += leaks(pressure[own][local], depth[own][local])
            self.dense = self.under_pressure * pressure[own]
        if film_changed.any():
            some = np.flatnonzero(film_changed[self.film_nodes])
            node = self.film_nodes[some]
            self.base[self.film_place[some]] = self.by_film[some] * film[node]
