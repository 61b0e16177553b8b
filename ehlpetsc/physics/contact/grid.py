"""Nodes of a contact: axes, shape, cells, what the solids look like before they deform, load."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ehlpetsc.physics.contact.shape import Shape


@dataclass(frozen=True)
class Surroundings:
    """Part of a contact beyond its mesh, which does not change.

    `gap`: deflection by the pressures there, at the nodes of the mesh in a^2/R, flat.
    `load`: integral of the pressure there, in p0 and a.
    `sides`: q and film [a^2/R] of the row of nodes below the first row and of that above the last one, shape
        (2, nx) each; None: the contact ends with the mesh.
    """

    gap: np.ndarray | float = 0.0
    load: float = 0.0
    sides: tuple[np.ndarray | None, np.ndarray | None] = (None, None)


NOTHING = Surroundings()


@dataclass(frozen=True)
class Grid:
    r"""Nodes of a contact, in half-widths a; fields over them are flat, x last and fastest.

    Attributes
    ----------
    axes
        Coordinates of the nodes along each axis, (x,) or (y, x).
    spacings
        Of the nodes along each axis [m].
    half_widths
        Of the dry smooth contact along each axis in a; infinite along the length of a line contact.
    shapes
        Gap of the undeformed solids along each axis.
    load
        Integral of the pressure over the nodes, in p0 and a.
    growth
        Exponent of load times radius in the square of the size of the dry contact.
    breadth
        Of the contact across the direction of motion in half-widths; of a line contact 1, of unit length.
    periodic
        Whether the first axis is periodic.
    middle
        Of the dry contact across, which a tilt moves.
    tilt
        Slope of the gap across with which a contact that aligns itself begins.
    origin
        Place across of the middle of maps of roughness.
    to_ends
        Rows between the first row and the end face of the body below it, and beyond the last row.
    surroundings
        Part of the contact beyond the mesh.
    """

    axes: tuple[np.ndarray, ...]
    spacings: tuple[float, ...]
    half_widths: tuple[float, ...]
    shapes: tuple[Shape, ...]
    load: float
    growth: float = 1.0
    breadth: float = 1.0
    periodic: bool = False
    middle: float = 0.0
    tilt: float = 0.0
    origin: float = 0.0
    to_ends: tuple[int, int] = (0, 0)
    surroundings: Surroundings = NOTHING

    @cached_property
    def shape(self) -> tuple[int, ...]:
        """Nodes along each axis."""
        return tuple(map(len, self.axes))

    @cached_property
    def n(self) -> int:
        """Number of nodes."""
        return math.prod(self.shape)

    @property
    def x(self) -> np.ndarray:
        """Coordinates along the direction of motion, shape (nx,)."""
        return self.axes[-1]

    @property
    def dx(self) -> float:
        """Difference of the coordinates along the direction of motion in half-widths."""
        return self.axes[-1][1] - self.axes[-1][0]

    @property
    def increments(self) -> tuple[float, ...]:
        """Differences of the coordinates along each axis in half-widths."""
        return tuple(axis[1] - axis[0] for axis in self.axes)

    @property
    def cell(self) -> float:
        """Size of a cell in half-widths: weight of a node in a sum over the contact."""
        return math.prod(self.increments)

    @property
    def node_size(self) -> float:
        """Weight of a node in a sum: length or area of its cell in m or m^2, in a strip by length."""
        return self.spacings[-1] / self.shape[0] if self.periodic else math.prod(self.spacings)

    @cached_property
    def coordinates(self) -> tuple[np.ndarray, ...]:
        """Coordinates of all nodes along each axis, flat."""
        return tuple(axis.ravel() for axis in np.meshgrid(*self.axes, indexing="ij"))

    @cached_property
    def parabolas(self) -> np.ndarray:
        """Gap of the parabolas of the undeformed solids of the radius R in a^2/R, flat."""
        axes = zip(self.coordinates, self.shapes, strict=True)
        gaps = [shape.parabola(nodes) for nodes, shape in axes if shape.curvature]
        return sum(gaps[1:], start=gaps[0])

    @cached_property
    def profiles(self) -> np.ndarray:
        """Gap of the profiles of the undeformed solids and by the surroundings in a^2/R, flat."""
        axes = zip(self.axes, self.shapes, strict=True)
        gaps = np.meshgrid(*(shape.beside(nodes) for nodes, shape in axes), indexing="ij")
        return sum(gaps[1:], start=gaps[0]).ravel() + self.surroundings.gap

    def undeformed(self, curvature: float = 1.0, nodes: slice = slice(None)) -> np.ndarray:
        """Gap of the undeformed solids that touch in the middle in a^2/R, flat.

        `curvature`: R over the radius along x, which all parabolas follow and no profile.
        """
        return curvature * self.parabolas[nodes] + self.profiles[nodes]

    @cached_property
    def distance(self) -> np.ndarray:
        """Distance of all nodes from the contact's middle over the half-width in their direction, flat."""
        if len(self.axes) == 1:
            return np.abs(self.x)
        (y, x), (b, a) = self.coordinates, self.half_widths
        return np.sqrt(((y - self.middle) / b) ** 2 + (x / a) ** 2)

    @property
    def is_hertzian(self) -> bool:
        """Whether `room` is that of the shape."""
        return all(shape.profile is None for shape in self.shapes)

    @property
    def widening(self) -> float:
        """Largest half-width of the dry contact in half-widths a."""
        return 1.0

    def room(self, share: float, radius: float) -> np.ndarray:
        """Square of the dry smooth pressure in half-widths, negative outside the contact, flat.

        `share`: of the load. `radius`: along x over R.
        """
        return (share * radius) ** self.growth - self.distance**2

    def mean_inside(self, values: np.ndarray, radius: float, pressure: np.ndarray) -> float:
        """Mean of a flat field within a multiple of the dry contact."""
        return float(values[self.inside(radius)].mean())

    def inside(self, radius: float) -> np.ndarray:
        """Mask of the nodes within a multiple of the dry contact, at least of those in its middle, flat."""
        return self.distance <= max(radius, self.distance.min())

    def interpolated(self, values: np.ndarray, onto: Grid) -> np.ndarray:
        """A flat field at the nodes of another grid, by monotone cubics along each axis."""
        from scipy.interpolate import PchipInterpolator  # few runs need it

        field = values.reshape(self.shape)
        for k, (axis, nodes) in enumerate(zip(self.axes, onto.axes, strict=True)):
            with np.errstate(over="ignore"):  # slopes that vanish
                field = PchipInterpolator(axis, field, axis=k)(np.clip(nodes, axis[0], axis[-1]))
        return field.ravel()

    def edges(self) -> dict[str, np.ndarray]:
        """Nodes at each end of the domain, flat indices by the key that moves it."""
        nodes = self.rows(np.arange(self.n))
        ends = {"inlet": nodes[:, 0], "outlet": nodes[:, -1]}
        if len(self.axes) > 1 and not self.periodic:
            ends["width"] = np.concatenate([nodes[0], nodes[-1]])
        return ends

    def rows(self, values: np.ndarray) -> np.ndarray:
        """View of a flat field as rows along x, shape (rows, nx)."""
        return values.reshape(-1, self.shape[-1])

    def at_columns(self, values: np.ndarray, columns: slice) -> np.ndarray:
        """Values of a flat field at some columns of nodes along x, flat."""
        return self.rows(values)[:, columns].ravel()

    def as_rows(self, of_columns: np.ndarray) -> np.ndarray:
        """Rows along x of the flat values of some columns, shape (rows, columns)."""
        return of_columns.reshape(*of_columns.shape[:-1], self.n // self.shape[-1], -1)
