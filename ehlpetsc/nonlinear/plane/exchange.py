"""Exchange of unknowns, pressures and wave numbers in the plane between ranks, which own whole rows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from mpi4py import MPI

from ehlpetsc.base.errors import UsageError
from ehlpetsc.discretisation.ehl_problem import EHLProblem
from ehlpetsc.discretisation.plane.deflection import PressureSums, Transposition
from ehlpetsc.discretisation.unknowns import Share, Unknowns, border_of, n_dofs
from ehlpetsc.nonlinear.ranks import global_sum

MIN_ROWS = 4  # of a rank


def first_rows(n_y: int, ranks: int) -> list[int]:
    """First rows of all ranks, and the number of rows."""
    if ranks > max(n_y // MIN_ROWS, 1):
        raise UsageError(f"{ranks} ranks for {n_y} rows of nodes; allowed: at most {max(n_y // MIN_ROWS, 1)}")
    return [n_y * k // ranks for k in range(ranks + 1)]


def share_of(shape: Sequence[int], rows: Sequence[int], periodic: bool) -> tuple[Share, tuple[bool, bool]]:
    """Nodes of the rank of some rows, and whether the domain ends below and above them.

    The window has a row more on either side, of a periodic domain that of its other end.
    """
    (n_y, n_x), (begin, end) = shape, rows
    has_sides = (begin == 0 and not periodic), (end == n_y and not periodic)
    below, above = begin - (not has_sides[0]), end + (not has_sides[1])
    nodes: slice | np.ndarray = slice(below * n_x, above * n_x)
    if below < 0 or above > n_y:
        nodes = ((np.arange(below, above) % n_y)[:, None] * n_x + np.arange(n_x)).ravel()
    start = n_x * (not has_sides[0])
    return Share(begin * n_x, end * n_x, nodes, slice(start, start + (end - begin) * n_x)), has_sides


class RankTransposition(Transposition):
    """Transposition between rows and wave numbers along x by all ranks (`Alltoallv`).

    `cuts`: first rows of all ranks, and the number of rows.
    """

    def __init__(self, cuts: Sequence[int], ranks: MPI.Comm):
        self.ranks, self.cuts, self.rows = ranks, cuts, np.diff(cuts)

    def _cuts(self, count: int) -> np.ndarray:
        return np.array([count * k // self.ranks.size for k in range(self.ranks.size + 1)])

    def wave_numbers(self, count: int) -> slice:
        """See :class:`.deflection.Transposition`."""
        begin, end = self._cuts(count)[self.ranks.rank : self.ranks.rank + 2]
        return slice(int(begin), int(end))

    def to_waves(self, rows: np.ndarray, count: int) -> np.ndarray:
        """See :class:`.deflection.Transposition`."""
        cuts = self._cuts(count)
        mine, waves = len(rows), int(np.diff(cuts)[self.ranks.rank])
        sent = np.concatenate([rows[:, cuts[k] : cuts[k + 1]].ravel() for k in range(self.ranks.size)])
        received = np.empty((int(self.rows.sum()), waves), dtype=rows.dtype)
        self._all_to_all(sent, mine * np.diff(cuts), received, self.rows * waves)
        return received

    def to_rows(self, waves: np.ndarray, count: int) -> np.ndarray:
        """See :class:`.deflection.Transposition`."""
        cuts = self._cuts(count)
        mine, number = int(self.rows[self.ranks.rank]), waves.shape[1]
        received = np.empty(mine * count, dtype=waves.dtype)
        self._all_to_all(np.ascontiguousarray(waves), self.rows * number, received, mine * np.diff(cuts))
        parts = np.split(received, (mine * cuts[1:-1]).astype(int))
        return np.hstack([part.reshape(mine, -1) for part in parts])

    def local(self, nodes: int) -> slice:
        """See :class:`.deflection.Transposition`."""
        n_x, (begin, end) = nodes // self.cuts[-1], self.cuts[self.ranks.rank : self.ranks.rank + 2]
        return slice(begin * n_x, end * n_x)

    def gathered(self, local: np.ndarray) -> np.ndarray:
        """See :class:`.deflection.Transposition`."""
        return np.concatenate(self.ranks.allgather(local))

    def _all_to_all(
        self, sent: np.ndarray, counts: np.ndarray, received: np.ndarray, back: np.ndarray
    ) -> None:
        kind = MPI.DOUBLE_COMPLEX if sent.dtype == complex else MPI.COMPLEX
        self.ranks.Alltoallv([sent, counts.astype(np.int32), kind], [received, back.astype(np.int32), kind])


class PlaneExchange:
    """Exchange of the rows next to those of other ranks.

    `periodic`: whether the last rank is the neighbour of the first.
    """

    def __init__(self, problem: EHLProblem, ranks: MPI.Comm, periodic: bool):
        self.problem, self.ranks, self.n_x = problem, ranks, problem.grid.shape[-1]
        self.below, self.above = ranks.rank - 1, ranks.rank + 1
        if periodic:
            self.below, self.above = self.below % ranks.size, self.above % ranks.size
        elif self.above == ranks.size:
            self.above = MPI.PROC_NULL
        if self.below < 0:
            self.below = MPI.PROC_NULL

    def slab(self, rows: int) -> slice:
        """Own nodes in an array with some rows of the neighbours on either side."""
        p = self.problem
        start = rows * self.n_x if p.owned.start else 0
        return slice(start, start + p.local)

    def window(self, local: np.ndarray, rows: int = 1) -> np.ndarray:
        """Values of the local nodes with some rows of the neighbours on either side, by default the window.

        The values themselves where there is no neighbour.
        """
        p, own, count = self.problem, self.slab(rows), rows * self.n_x
        behind = count if p.share.window_size > p.owned.stop else 0
        if not (own.start or behind):
            return local
        window = np.empty((own.stop + behind, *local.shape[1:]), dtype=local.dtype)
        window[own] = local
        below, above = self._beside(local[:count], local[-count:])
        window[: own.start], window[own.stop :] = below[: own.start], above[:behind]
        return window

    def windows(self, local: Sequence[np.ndarray], rows: int) -> np.ndarray:
        """As :meth:`window` of several arrays of the local nodes, shape (arrays, nodes), by one message."""
        p, own, count = self.problem, self.slab(rows), rows * self.n_x
        behind = count if p.share.window_size > p.owned.stop else 0
        window = np.empty((len(local), own.stop + behind), dtype=np.result_type(*local))
        inner = window[:, own]
        for row, values in zip(inner, local, strict=True):
            row[:] = values
        below, above = self._beside(inner[:, :count], inner[:, -count:])
        window[:, : own.start], window[:, own.stop :] = below[:, : own.start], above[:, :behind]
        return window

    def _beside(self, lowest: np.ndarray, highest: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Rows of the neighbours below and above, from the own lowest and highest ones; any without one."""
        lowest, highest = np.ascontiguousarray(lowest), np.ascontiguousarray(highest)
        if self.ranks.size == 1:
            return highest, lowest
        below, above = np.empty_like(lowest), np.empty_like(lowest)
        self.ranks.Sendrecv(lowest, self.below, 0, above, self.above, 0)
        self.ranks.Sendrecv(highest, self.above, 1, below, self.below, 1)
        return below, above

    def with_border(self, numbers: np.ndarray, vector: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Sums of numbers over all ranks, and the border's unknowns, or rows, of a vector, by one message.

        The last rank has them behind its nodes.
        """
        border = border_of(vector, self.problem.local)
        if self.ranks.size == 1:
            return numbers, border
        sent = np.zeros(len(numbers) + self.problem.balance.unknowns)
        sent[: len(numbers)] = numbers
        if self.problem.owns_border:
            sent[len(numbers) :] = border
        return tuple(np.split(global_sum(self.ranks, sent), [len(numbers)]))

    def deflection(self, pressure: np.ndarray, precision: type) -> np.ndarray:
        """Deflection of the local nodes, computed in a precision, by the pressures of all ranks."""
        convolution = self.problem.deflection.convolution
        return convolution(pressure.astype(precision, copy=False)).astype(np.float64, copy=False)

    def sums(self, pressure: np.ndarray) -> PressureSums:
        """`PressureSums` of the pressures of all ranks."""
        return PressureSums(self.deflection(pressure, np.float64), self.forces(pressure))

    def forces(self, pressure: np.ndarray) -> np.ndarray:
        """Forces of the border by the pressures of all ranks."""
        return global_sum(self.ranks, self.local_forces(pressure))

    def local_forces(self, pressure: np.ndarray) -> np.ndarray:
        """Forces of the border by the local pressures."""
        return self.problem.balance.forces(pressure, self.problem.share.local)

    def unknowns(
        self, vector: np.ndarray, pressure: np.ndarray, flag: bool
    ) -> tuple[Unknowns, PressureSums, bool]:
        """See :class:`ehlpetsc.nonlinear.ranks.Exchange`."""
        pairs = vector[: n_dofs(self.problem.local)].reshape(-1, 2)
        q, w = np.ascontiguousarray(self.window(pairs).T)
        flags, border = self.with_border(np.array([float(flag)]), vector)
        return Unknowns(q, w, border), self.sums(pressure), bool(flags[0])
