r"""Speeds of both surfaces over the rows of nodes: spin about the normal, a ball in its groove.

Two bodies that roll and turn about the normal of the contact have at its point (x, y) the velocities

.. math:: u_i(y)=u_i\Big(1\mp\frac{y^2}{2R_cR_i}\Big)+\omega_iy,\qquad v_i(x)=-\omega_ix,

the upper sign of body 1. A ball in a groove touches it on a surface that is curved across, of the radius
:math:`R_c`: the ball, body 1, is nearer to its axis beside the middle, the raceway, body 2, farther from the
axis of an inner ring (:math:`R_2>0`) or nearer to that of an outer one (:math:`R_2<0`). Both speeds agree
along two lines at most, and slide past each other elsewhere (Heathcote, Proc. Inst. Automobile Eng. 15 (1921)
569): :math:`u_1-u_2` changes by :math:`-uy^2/(2R_cR_x)`, :math:`R_x` the reduced radius.

With the share :math:`\kappa_1` of body 1 in the compliance of both (a half of equal bodies), the surface of
contact has the curvature :math:`1/R_c=1/r-\kappa_1/R_y`, r the radius of the ball. It follows with
:math:`R_2` from the reduced radii and that of the groove, :math:`1/r=1/R_y+1/r_g`,
:math:`1/R_2=1/R_x-1/r`.

Each row of nodes has its speeds :math:`u_i(y)`, which carry its film. The speeds across, :math:`v_i`, are
part of the sliding that shears the film and heats it. Left out are the oil that their mean,
:math:`-(\omega_1+\omega_2)x/2`, carries across, which is nothing where both bodies turn at opposite speeds,
the sliding across in the flow of a shear-thinning oil under its pressure gradient, and the difference of
speed between rows in the conduction of heat into the bodies, which move as in the middle.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, Self

import numpy as np

from ehlpetsc.elasticity.bodies import Bodies

if TYPE_CHECKING:
    from ehlpetsc.base.case import Case, Contact
    from ehlpetsc.physics.contact.grid import Grid
    from ehlpetsc.physics.operation import Conditions


MAX_IMAGINARY = 1e-9  # over the magnitude: of a root that is real


class Slip(NamedTuple):
    """Sliding velocity of surface 1 over surface 2 at the nodes, flat.

    `speed`: its magnitude [m/s]. `along`, `across`: components of its direction; 0 where nothing slides.
    """

    speed: np.ndarray
    along: np.ndarray
    across: np.ndarray


class SpeedsAcross(NamedTuple):
    """Variation of both speeds over the rows of nodes.

    `curvatures`: of the parabolas of both speeds over y, relative [1/m^2].
    `spins`: speeds of both bodies about the normal [rad/s]; positive: rows of positive y are the faster ones.
    `y`: of the rows [m], shape (ny,); of a line contact 0. `x`: of the nodes of a row [m], shape (nx,).
    """

    curvatures: tuple[float, float]
    spins: tuple[float, float]
    y: np.ndarray
    x: np.ndarray

    @classmethod
    def of(cls, case: Case, grid: Grid, a: float) -> Self:
        """Speeds of a case on its nodes; `a`: half-width [m]."""
        spins = (case.motion.spin if case.motion else None) or (0.0, 0.0)
        y = a * grid.axes[0] if len(grid.axes) > 1 else np.zeros(1)
        return cls(_curvatures(case.contact), spins, y, a * grid.x)

    @property
    def varies(self) -> bool:
        """Whether rows differ in speed."""
        return any(self.curvatures) or any(self.spins)

    @property
    def spin(self) -> float:
        """Speed of body 1 about the normal over that of body 2 [rad/s]."""
        return self.spins[0] - self.spins[1]

    def surfaces(self, conditions: Conditions) -> tuple[np.ndarray, np.ndarray]:
        """Speeds of surfaces 1 and 2 along x [m/s], shape (ny,)."""
        given = zip((conditions.u1, conditions.u2), self.curvatures, self.spins, strict=True)
        u1, u2 = (u * (1.0 + curvature * self.y**2) + spin * self.y for u, curvature, spin in given)
        return u1, u2

    def entrainment(self, conditions: Conditions) -> np.ndarray:
        """Mean of both speeds along x [m/s], shape (ny,)."""
        u1, u2 = self.surfaces(conditions)
        return 0.5 * (u1 + u2)

    def sliding(self, conditions: Conditions) -> np.ndarray:
        """Sliding speed u1 - u2 along x [m/s], shape (ny,)."""
        u1, u2 = self.surfaces(conditions)
        return u1 - u2

    def rolling_rows(self, conditions: Conditions) -> list[float]:
        """Places y at which nothing slides along x [m], increasing."""
        of_y2 = conditions.u1 * self.curvatures[0] - conditions.u2 * self.curvatures[1]
        roots = np.roots((of_y2, self.spin, conditions.sliding))
        return sorted({float(root.real) for root in roots if abs(root.imag) <= MAX_IMAGINARY * abs(root)})

    def slip(self, conditions: Conditions) -> Slip:
        """Sliding velocity at the nodes."""
        if not self.varies:
            n, sliding = len(self.y) * len(self.x), conditions.sliding
            return Slip(np.full(n, abs(sliding)), np.full(n, np.sign(sliding)), np.zeros(n))
        along, across = np.meshgrid(self.sliding(conditions), -self.spin * self.x, indexing="ij")
        speed = np.hypot(along, across)
        moves = np.where(speed > 0.0, speed, 1.0)
        return Slip(speed.ravel(), (along / moves).ravel(), (across / moves).ravel())

    def step_speed(self, conditions: Conditions) -> float:
        """Speed by which time steps count [m/s]: of the film, or of either surface past it, in any row."""
        u1, u2 = self.surfaces(conditions)
        return float(np.maximum(np.abs(0.5 * (u1 + u2)), 0.5 * np.abs(u1 - u2)).max())


def _curvatures(contact: Contact) -> tuple[float, float]:
    """Curvatures of both speeds over y, over the speed in the middle [1/m^2]; 0 without a groove."""
    if contact.groove_radius is None:
        return 0.0, 0.0
    ball = 1.0 / contact.radius_across + 1.0 / contact.groove_radius
    of_contact = ball - Bodies.of(contact).shares[0] / contact.radius_across
    raceway = 1.0 / contact.radius - ball
    return -0.5 * of_contact * ball, 0.5 * of_contact * raceway
