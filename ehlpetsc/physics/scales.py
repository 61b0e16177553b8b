"""Dry smooth contact (Hertz); scales, speeds, mesh and dimensionless groups of a case."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Self

import numpy as np

from ehlpetsc.physics.operation import Conditions

if TYPE_CHECKING:
    from ehlpetsc.case.tables import Case


def reduced_modulus(youngs_modulus: Sequence[float], poisson_ratio: Sequence[float]) -> float:
    r"""Reduced modulus E' [Pa], :math:`2/E'=(1-\nu_1^2)/E_1+(1-\nu_2^2)/E_2`.

    Parameters
    ----------
    youngs_modulus, poisson_ratio
        E1, E2 [Pa] and nu1, nu2.
    """
    return 2.0 / sum((1.0 - nu * nu) / e for e, nu in zip(youngs_modulus, poisson_ratio, strict=True))


def hertz_line(load: float, radius: float, modulus: float) -> tuple[float, float]:
    r"""Half-width [m] and maximum pressure [Pa] of the dry smooth line contact.

    :math:`a=\sqrt{8w'R/(\pi E')}`, :math:`p_0=2w'/(\pi a)` (Johnson 1985, section 4.2).

    Parameters
    ----------
    load
        w' [N/m].
    radius
        R [m].
    modulus
        E' [Pa].
    """
    a = math.sqrt(8.0 * load * radius / (math.pi * modulus))
    return a, 2.0 * load / (math.pi * a)


def hertz_pressure(x: np.ndarray, a: float, p0: float) -> np.ndarray:
    r"""Pressure of a dry smooth cylinder, :math:`p_0\sqrt{1-(x/a)^2}`, 0 outside (Johnson 1985, eq. 4.44).

    Parameters
    ----------
    x
        Distance from the centre [m].
    a, p0
        Half-width [m] and maximum pressure [Pa].
    """
    return p0 * np.sqrt(np.maximum(1.0 - (np.asarray(x) / a) ** 2, 0.0))


def moes_groups(
    viscosity: float, speed: float, alpha: float, load: float, radius: float, modulus: float
) -> tuple[float, float]:
    r"""Moes' load and lubricant numbers of a line contact.

    :math:`U=\eta_0u/(E'R)`, :math:`M=w'/(E'R)\,(2U)^{-1/2}`, :math:`L=\alpha E'(2U)^{1/4}`, u the mean speed.
    """
    two_u = 2.0 * viscosity * speed / (modulus * radius)
    return load / (modulus * radius * math.sqrt(two_u)), alpha * modulus * two_u**0.25


@dataclass(frozen=True)
class Scales:
    """Scales and dimensionless groups of a case.

    Attributes
    ----------
    E, R, load
        E' [Pa], R [m], w' [N/m].
    a, p0, h
        Hertz half-width [m], maximum pressure [Pa], film scale a^2/R [m].
    u, xi, u1, u2
        Mean speed [m/s], slide/roll ratio, u1 = u (1 + xi/2) of surface 1 and u2 = u (1 - xi/2) of surface 2;
        with xi < 0 surface 1 is the slower one. 0 where nothing moves.
    eta0
        Viscosity at ambient pressure [Pa s]; None in a dry case.
    moes_m, moes_l
        Moes' M and L; None in a dry case.
    nx
        Number of nodes.
    x
        Nodes in half-widths, from the inlet on, shape (nx,).
    dx
        Spacing of the nodes [m].
    dt
        Time step [s], courant dx / u_max; None in a steady case.
    duration
        Time in which the faster surface covers the travel [s]; None in a steady case.
    """

    E: float
    R: float
    load: float
    a: float
    p0: float
    h: float
    u: float
    xi: float
    u1: float
    u2: float
    eta0: float | None
    moes_m: float | None
    moes_l: float | None
    nx: int
    x: np.ndarray
    dx: float
    dt: float | None
    duration: float | None

    @property
    def u_max(self) -> float:
        """Speed of the faster surface [m/s], whichever way it moves."""
        return max(abs(self.u1), abs(self.u2))

    @property
    def conditions(self) -> Conditions:
        """Operating conditions of the reference state."""
        return Conditions(self.load, self.R, self.u1, self.u2)

    @classmethod
    def of(cls, case: Case) -> Self:
        """Scales of a case, see `ehlpetsc.case.loading.Case`."""
        contact, mesh = case.contact, case.mesh
        modulus = reduced_modulus(contact.youngs_modulus, contact.poisson_ratio)
        a, p0 = hertz_line(contact.load, contact.radius, modulus)
        u, xi = (case.motion.entrainment_speed, case.motion.slide_roll_ratio) if case.motion else (0.0, 0.0)
        u1, u2 = u * (1.0 + xi / 2.0), u * (1.0 - xi / 2.0)
        eta0 = moes_m = moes_l = dt = duration = None
        if case.fluid:
            eta0 = case.fluid.viscosity
            moes_m, moes_l = moes_groups(
                eta0, u, case.fluid.pressure_viscosity, contact.load, contact.radius, modulus
            )
        dx = a / mesh.points_per_half_width
        if case.time:
            u_max = max(abs(u1), abs(u2))
            dt, duration = case.time.courant * dx / u_max, case.time.travel * a / u_max
        nx = mesh.nodes
        return cls(
            E=modulus,
            R=contact.radius,
            load=contact.load,
            a=a,
            p0=p0,
            h=a * a / contact.radius,
            u=u,
            xi=xi,
            u1=u1,
            u2=u2,
            eta0=eta0,
            moes_m=moes_m,
            moes_l=moes_l,
            nx=nx,
            x=mesh.inlet + np.arange(nx) / mesh.points_per_half_width,
            dx=dx,
            dt=dt,
            duration=duration,
        )
