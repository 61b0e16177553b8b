r"""Depth by which a body has yielded, kept in the body: cells of its own that travel with it.

What a step adds at the nodes of the mesh is shared out to these cells by overlap, and the mesh gets means
over its cells back: both keep the volume, and as nothing is ever moved from cell to cell, nothing is smeared
on the way, however far the body goes.
"""

from dataclasses import dataclass, replace

import numpy as np

FINER = 4  # cells of a body to a cell of the mesh


@dataclass(frozen=True)
class PermanentSet:
    """The set of one body.

    Attributes
    ----------
    spacing : float
        Width of its cells [m].
    first : int
        Edges lie at ``(first + k) spacing`` of the body's own abscissa.
    depth : ndarray, shape (cells,)
        Mean depth of each cell [m].
    """

    spacing: float
    first: int
    depth: np.ndarray

    @classmethod
    def none(cls, cell):
        """That of a body that has not yielded, under a mesh of so wide cells [m]."""
        return cls(cell / FINER, 0, np.zeros(0))

    @property
    def edges(self):
        """Edges of the cells [m], shape (cells + 1,)."""
        return self.spacing * (self.first + np.arange(len(self.depth) + 1))

    @property
    def volume(self):
        """Set of the whole body [m^2]."""
        return float(self.depth.sum() * self.spacing)

    def means(self, faces):
        """Mean depths [m] between faces, increasing abscissas of the body [m], shape (n + 1,)."""
        if not len(self.depth):
            return np.zeros(len(faces) - 1)
        below = np.concatenate([[0.0], np.cumsum(self.depth)]) * self.spacing
        return np.diff(np.interp(faces, self.edges, below)) / np.diff(faces)

    def laid_down(self, faces, depth):
        """The set with depths [m] added between faces.

        Parameters
        ----------
        faces : ndarray, shape (n + 1,)
        depth : ndarray, shape (n,)
        """
        where = np.flatnonzero(depth)
        if not len(where):
            return self
        faces = faces[where[0] : where[-1] + 2]
        wider = self._covering(faces[0], faces[-1])
        volume = np.concatenate([[0.0], np.cumsum(depth[where[0] : where[-1] + 1] * np.diff(faces))])
        added = np.diff(np.interp(wider.edges, faces, volume)) / self.spacing
        return replace(wider, depth=wider.depth + np.maximum(added, 0.0))

    def _covering(self, begin, end):
        """The same with cells of no depth added to reach from begin to end [m]."""
        first = int(np.floor(begin / self.spacing)) - 1
        last = int(np.ceil(end / self.spacing)) + 1
        if not len(self.depth):
            return replace(self, first=first, depth=np.zeros(last - first))
        before, after = max(self.first - first, 0), max(last - self.first - len(self.depth), 0)
        if not before and not after:
            return self
        return replace(self, first=self.first - before, depth=np.pad(self.depth, (before, after)))


class BothBodies:
    """The sets of both bodies, between the nodes of the mesh and the bodies.

    Parameters
    ----------
    scales : scales.Scales
    yield_pressures : (float, float) or None
        Of surface fast and slow [Pa]: the softer one takes all the depth, equal ones half each. None: they
        yield no more.
    offsets : (float, float)
        Abscissas at which both bodies begin to enter, as of :attr:`.profile.Profile.moved` [m].
    """

    def __init__(self, scales, yield_pressures, offsets=(0.0, 0.0)):
        self.cell, self.offsets = scales.dx, offsets
        places = scales.x * scales.a
        self.faces = np.append(places - 0.5 * self.cell, places[-1] + 0.5 * self.cell)
        fast, slow = yield_pressures or (0.0, 0.0)
        self.shares = (0.5, 0.5) if fast == slow else (float(fast < slow), float(slow < fast))

    def none(self):
        """Sets of two bodies that have not yielded."""
        return PermanentSet.none(self.cell), PermanentSet.none(self.cell)

    def depths(self, sets, travelled):
        """Sets of the fast and of the slow body at the nodes [m], means over the cells of the mesh.

        Parameters
        ----------
        sets : pair of PermanentSet
        travelled : (float, float)
            Ways of both bodies [m].
        """
        return [one.means(faces) for one, faces in zip(sets, self._faces(travelled), strict=True)]

    def laid_down(self, sets, travelled, depth):
        """The sets with what a step has added to both together, `depth` [m], shape (nx,)."""
        if not depth.any():
            return sets
        return tuple(
            one.laid_down(faces, share * depth)
            for one, faces, share in zip(sets, self._faces(travelled), self.shares, strict=True)
        )

    def at(self, side, one, s):
        """Mean depths [m] of the set of a body, 0: fast, around equally spaced points s of it [m]."""
        half = 0.5 * (s[1] - s[0])
        return one.means(np.append(s - half, s[-1] + half) + self.offsets[side])

    def _faces(self, travelled):
        return [self.faces - way + offset for way, offset in zip(travelled, self.offsets, strict=True)]
