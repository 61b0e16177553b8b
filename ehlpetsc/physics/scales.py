"""Scales, speeds, nodes and dimensionless groups of a case."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np

from ehlpetsc.base.case import KINDS, Case
from ehlpetsc.elasticity.bodies import reduced_modulus
from ehlpetsc.physics.contact.geometry import Geometry
from ehlpetsc.physics.contact.grid import Grid
from ehlpetsc.physics.operation import Conditions
from ehlpetsc.physics.speeds_across import SpeedsAcross

NODE_TOLERANCE = 1e-9  # relative: half-widths, and x/a of nodes, nearer than this are equal


@dataclass(frozen=True)
class Scales:
    """Scales and dimensionless groups of a case.

    Attributes
    ----------
    geometry
        Kind of contact.
    grid
        Nodes.
    E, R, load
        E' [Pa], R along the direction of motion [m], load [N/m], of a point contact [N].
    extent
        Of the contact across, in the formulas of its geometry.
    a, b, p0, h
        Half-widths of the dry contact along and across [m], maximum pressure [Pa], film scale a^2/R [m].
    u, xi, u1, u2
        Mean speed [m/s], slide/roll ratio, u1 = u (1 + xi/2) of surface 1 and u2 = u (1 - xi/2) of surface 2;
        with xi < 0 surface 1 is the slower one. 0 where nothing moves.
    across
        Variation of u1 and u2, which are those of the middle, over the rows of nodes.
    eta0
        Viscosity at ambient pressure [Pa s]; None in a dry case.
    moes_m, moes_l
        Moes' M and L; None in a dry case.
    dt
        Time step [s], courant dx / max(u, |u1 - u2|/2) of the fastest row, with a tolerance the shortest one;
        None if steady.
    duration
        Time in which the faster surface covers the travel [s]; None in a steady case.
    """

    geometry: Geometry
    grid: Grid
    E: float
    R: float
    load: float
    extent: float
    a: float
    b: float
    p0: float
    h: float
    u: float
    xi: float
    u1: float
    u2: float
    across: SpeedsAcross
    eta0: float | None
    moes_m: float | None
    moes_l: float | None
    dt: float | None
    duration: float | None

    @property
    def x(self) -> np.ndarray:
        """Coordinates of the nodes along the direction of motion in half-widths, from the inlet on."""
        return self.grid.x

    @property
    def nx(self) -> int:
        """Number of nodes along the direction of motion."""
        return len(self.grid.x)

    @property
    def spacing(self) -> float:
        """Spacing of the nodes along the direction of motion [m]."""
        return self.grid.spacings[-1]

    @property
    def load_per_length(self) -> float:
        r"""Load per length across in the middle of the dry contact, :math:`\pi p_0a/2` [N/m]."""
        return 0.5 * np.pi * self.p0 * self.a

    @property
    def stiffness(self) -> float:
        r"""Deflection by p0 on a^2 at the distance a, :math:`2p_0R/(\pi E'a)`, in a^2/R."""
        return 2.0 * self.p0 * self.R / (np.pi * self.E * self.a)

    @property
    def u_max(self) -> float:
        """Speed of the faster surface [m/s], whichever way it moves."""
        return max(abs(self.u1), abs(self.u2))

    @property
    def conditions(self) -> Conditions:
        """Operating conditions of the reference state."""
        return Conditions(self.load, self.R, self.u1, self.u2)

    def size(self, conditions: Conditions) -> float:
        """Size of the dry contact of the conditions at an instant over that of the scales, at most 1."""
        ratio = conditions.load / self.load * (conditions.radius / self.R)
        return ratio ** (0.5 * self.grid.growth)

    def dry_pressure(self, conditions: Conditions) -> float:
        """Maximum pressure of the dry contact of the conditions at an instant [Pa]."""
        area = self.size(conditions) ** (2.0 / self.grid.growth - 1.0)  # in proportion: of a line its width
        return self.p0 * conditions.load / self.load / area

    @classmethod
    def of(cls, case: Case) -> Self:
        """Scales of a case, see `ehlpetsc.case.loading.Case`."""
        contact, mesh = case.contact, case.mesh
        modulus = reduced_modulus(contact.youngs_modulus, contact.poisson_ratio)
        geometry = KINDS[case.kind].part("geometry")
        extent, dry = geometry.extent(contact), geometry.dry(contact, modulus)
        a, b, p0 = dry
        u, xi = (case.motion.entrainment_speed, case.motion.slide_roll_ratio) if case.motion else (0.0, 0.0)
        u1, u2 = u * (1.0 + xi / 2.0), u * (1.0 - xi / 2.0)
        eta0 = moes_m = moes_l = dt = duration = None
        if case.fluid:
            eta0 = case.fluid.viscosity
            moes_m, moes_l = geometry.moes(
                eta0, u, case.fluid.pressure_viscosity, contact.load, contact.radius, modulus, extent
            )
        dx, grid = a / mesh.points_per_half_width, geometry.grid(contact, mesh, dry)
        across = SpeedsAcross.of(case, grid, a)
        if case.time:
            now = Conditions(contact.load, contact.radius, u1, u2)
            dt = case.time.shortest * dx / across.step_speed(now)
            duration = case.time.travel * a / max(abs(u1), abs(u2))
        return cls(
            geometry=geometry,
            grid=grid,
            E=modulus,
            R=contact.radius,
            load=contact.load,
            extent=extent,
            a=a,
            b=b,
            p0=p0,
            h=a * a / contact.radius,
            u=u,
            xi=xi,
            u1=u1,
            u2=u2,
            across=across,
            eta0=eta0,
            moes_m=moes_m,
            moes_l=moes_l,
            dt=dt,
            duration=duration,
        )
