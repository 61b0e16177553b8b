r"""Depth field of a body on cells fixed to it.

A step's contribution at the nodes of the mesh is distributed to these cells by overlap, and the mesh gets the
means over its own cells back: both conserve the volume. Nothing is moved from cell to cell, hence nothing is
smeared, however far the body travels. In the plane each row of the mesh has cells of its own: bodies move
along x.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple, Self

import numpy as np

if TYPE_CHECKING:
    from ehlpetsc.physics.scales import Scales

CELLS_PER_MESH_CELL = 4  # cells of a body per cell of the mesh


class BodyField(NamedTuple):
    """Depth of one body over its abscissa.

    `spacing`: width of the cells [m].
    `first`: the abscissas of the edges are ``(first + k) spacing``.
    `depth`: mean depth of each cell [m], shape (cells,), in the plane (rows, cells).
    """

    spacing: float
    first: int
    depth: np.ndarray

    @classmethod
    def zero(cls, cell: float, rows: tuple[int, ...] = ()) -> Self:
        """Depth zero, for a mesh with cells of the width `cell` [m], in the plane of a number of rows."""
        return cls(cell / CELLS_PER_MESH_CELL, 0, np.zeros((*rows, 0)))

    @property
    def cells(self) -> int:
        """Number of cells along x."""
        return self.depth.shape[-1]

    @property
    def edges(self) -> np.ndarray:
        """Edges of the cells [m], shape (cells + 1,)."""
        return self.spacing * (self.first + np.arange(self.cells + 1))

    @property
    def volume(self) -> float:
        """Integral of the depth along x [m^2], in the plane summed over the rows."""
        return float(self.depth.sum() * self.spacing)

    def means(self, faces: np.ndarray) -> np.ndarray:
        """Mean depths [m] of each row between faces, increasing abscissas of the body [m], shape (n + 1,)."""
        if not self.cells:
            return np.zeros((*self.depth.shape[:-1], len(faces) - 1))
        return np.diff(_interpolated(faces, self.edges, _summed(self.depth) * self.spacing)) / np.diff(faces)

    def add(self, faces: np.ndarray, depth: np.ndarray) -> BodyField:
        """Field with depths [m] added between faces.

        `faces`: shape (n + 1,).
        `depth`: shape (n,), in the plane (rows, n).
        """
        where = np.flatnonzero(np.atleast_2d(depth).any(axis=0))
        if not len(where):
            return self
        faces = faces[where[0] : where[-1] + 2]
        wider = self._covering(faces[0], faces[-1])
        volume = _summed(depth[..., where[0] : where[-1] + 1] * np.diff(faces))
        added = np.diff(_interpolated(wider.edges, faces, volume)) / self.spacing
        return wider._replace(depth=wider.depth + np.maximum(added, 0.0))

    def _covering(self, begin: float, end: float) -> BodyField:
        """Field extended by cells of depth zero to reach from begin to end [m]."""
        first = int(np.floor(begin / self.spacing)) - 1
        last = int(np.ceil(end / self.spacing)) + 1
        rows = [(0, 0)] * (self.depth.ndim - 1)
        if not self.cells:
            return self._replace(first=first, depth=np.pad(self.depth, [*rows, (0, last - first)]))
        before, after = max(self.first - first, 0), max(last - self.first - self.cells, 0)
        if not before and not after:
            return self
        return self._replace(first=self.first - before, depth=np.pad(self.depth, [*rows, (before, after)]))


def _summed(values: np.ndarray) -> np.ndarray:
    """Sums of the values of each row before its edges, one more than values."""
    return np.concatenate([np.zeros((*values.shape[:-1], 1)), np.cumsum(values, axis=-1)], axis=-1)


def _interpolated(at: np.ndarray, x: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Linear interpolation of each row of values at `x`."""
    rows = [np.interp(at, x, row) for row in values.reshape(-1, len(x))]
    return np.reshape(rows, (*values.shape[:-1], len(at)))


class BodyFields(NamedTuple):
    """Depths of both bodies."""

    surface_1: BodyField
    surface_2: BodyField

    @classmethod
    def zero(cls, cell: float, rows: tuple[int, ...] = ()) -> Self:
        """Depth zero on both bodies, see :meth:`BodyField.zero`."""
        return cls(BodyField.zero(cell, rows), BodyField.zero(cell, rows))

    @property
    def volume(self) -> float:
        """Integral of both depths along x [m^2], in the plane summed over the rows."""
        return sum(field.volume for field in self)


class MeshOnBodies:
    """Cells of the mesh in the abscissas of both bodies.

    `offsets`: shift of the points of both bodies by the abscissas at which their profiles begin, negative for
        speeds above 0 [m].
    """

    def __init__(self, scales: Scales, offsets: Sequence[float] = (0.0, 0.0)) -> None:
        self.cell, self.offsets, self._rows = scales.spacing, offsets, scales.grid.shape[:-1]
        self._breadth = scales.grid.node_size / scales.spacing
        x = scales.x * scales.a
        self._faces = np.append(x - 0.5 * self.cell, x[-1] + 0.5 * self.cell)

    @property
    def zero(self) -> BodyFields:
        """Depth zero on both bodies."""
        return BodyFields.zero(self.cell, self._rows)

    def volume(self, fields: BodyFields) -> float:
        """Integral of both depths [m^2], of a point contact [m^3]; of a strip per metre of width."""
        return self._breadth * fields.volume

    def faces(self, travelled: Sequence[float]) -> list[np.ndarray]:
        """Faces of the mesh [m] in both bodies after distances travelled [m], shape (nx + 1,) each."""
        return [
            self._faces - distance + offset for distance, offset in zip(travelled, self.offsets, strict=True)
        ]

    def means(self, fields: BodyFields, travelled: Sequence[float]) -> list[np.ndarray]:
        """Means of both bodies' depths over the cells of the mesh [m], one for each node."""
        return [
            field.means(faces).ravel() for field, faces in zip(fields, self.faces(travelled), strict=True)
        ]

    def add(self, fields: BodyFields, travelled: Sequence[float], depths: Sequence[np.ndarray]) -> BodyFields:
        """Fields with depths at the nodes [m] of each body added.

        `travelled`: distances travelled by both bodies [m].
        """
        bodies = zip(fields, self.faces(travelled), depths, strict=True)
        shape = *self._rows, -1
        return BodyFields(*(field.add(faces, depth.reshape(shape)) for field, faces, depth in bodies))

    def at_points(self, fields: BodyFields, points: Sequence[np.ndarray | None]) -> list[np.ndarray | None]:
        """Mean depths [m] of each row around equally spaced points s of each body [m]; None: no points."""
        depths = []
        for field, s, offset in zip(fields, points, self.offsets, strict=True):
            half = None if s is None else 0.5 * (s[1] - s[0])
            depths.append(None if s is None else field.means(np.append(s - half, s[-1] + half) + offset))
        return depths
