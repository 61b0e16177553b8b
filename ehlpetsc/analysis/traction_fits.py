r"""Fits of friction that other programs read: traction over slip, and the Stribeck curve over speed.

Traction in the dynamics of rolling bearings (Gupta 1984), over the sliding speed s,

.. math:: \kappa(s)=(A+Bs)e^{-Cs}+D,

has four constants with a meaning: traction without slip :math:`\kappa_0=A+D`, at infinite slip
:math:`\kappa_\infty=D`, and the maximum :math:`\kappa_m` at the slip :math:`u_m`, with
:math:`\kappa_m-D=(B/C)e^{-Cu_m}` and :math:`u_m=1/C-A/B`. A program that reads them finds :math:`y=Cu_m` from
:math:`e^{-y}/(y-1)=(\kappa_m-D)/(D-\kappa_0)`. Traction that rises all over gets a low maximum, as its
curve could not be found otherwise.

The Stribeck curve over the entrainment speed u, of friction models in machines (Bo & Pavelescu 1982), is

.. math:: \mu(u)=\mu_c+(\mu_s-\mu_c)e^{-(u/u_s)^\delta}+ku.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

EXPONENTS = (0.2, 4.0)  # bounds of delta
# bounds of C u_m: beyond them kappa_m differs too little from kappa_inf for C to be found from both
AT_MAXIMUM = (1.02, 5.0)


class Traction(NamedTuple):
    """Constants of a traction curve.

    Attributes
    ----------
    kappa_0, kappa_inf, kappa_m
        Traction without slip, at infinite slip, and its maximum.
    u_m
        Sliding speed of the maximum [m/s].
    misfit
        Root mean square of the differences over the largest traction.
    """

    kappa_0: float
    kappa_inf: float
    kappa_m: float
    u_m: float
    misfit: float


class Stribeck(NamedTuple):
    """Constants of a Stribeck curve.

    Attributes
    ----------
    mu_s, mu_c
        Friction at rest and of the descending branch.
    u_s
        Speed of the descent [m/s].
    delta
        Its exponent.
    k
        Slope of the viscous part [s/m].
    misfit
        Root mean square of the differences over the largest friction.
    """

    mu_s: float
    mu_c: float
    u_s: float
    delta: float
    k: float
    misfit: float


def traction(slip: np.ndarray, constants: np.ndarray) -> np.ndarray:
    """Traction at sliding speeds [m/s] with A, B [s/m], C [s/m], D."""
    a, b, c, d = constants
    return (a + b * slip) * np.exp(-c * slip) + d


def stribeck(speed: np.ndarray, constants: np.ndarray) -> np.ndarray:
    """Friction at speeds [m/s] with mu_s, mu_c, u_s [m/s], delta, k [s/m]."""
    mu_s, mu_c, u_s, delta, k = constants
    return mu_c + (mu_s - mu_c) * np.exp(-((speed / u_s) ** delta)) + k * speed


def fitted_traction(slip: np.ndarray, friction: np.ndarray) -> Traction:
    """Least squares of a traction curve, without traction at rest; slip in m/s, both of shape (points,)."""
    from scipy.optimize import least_squares

    largest, fastest = friction.max(), slip.max()

    def curve(values: np.ndarray) -> np.ndarray:
        d, c, at_maximum = values * (largest, 1.0 / fastest, 1.0)
        return np.array([-d, d * c / (at_maximum - 1.0), c, d])

    starts = [(1.0, c, at_maximum) for c in (0.5, 5.0, 50.0) for at_maximum in (2.0, 4.0)]
    bounds = (0.0, 1e-3, AT_MAXIMUM[0]), (10.0, 1e4, AT_MAXIMUM[1])
    found = min(
        (
            least_squares(lambda v: (traction(slip, curve(v)) - friction) / largest, start, bounds=bounds)
            for start in starts
        ),
        key=lambda one: one.cost,
    )
    constants = curve(found.x)
    u_m = found.x[2] / constants[2]
    kappa_m = float(traction(np.array([u_m]), constants)[0])
    return Traction(0.0, float(constants[3]), kappa_m, float(u_m), float(np.sqrt(np.mean(found.fun**2))))


def fitted_stribeck(speed: np.ndarray, friction: np.ndarray) -> Stribeck:
    """Least squares of a Stribeck curve; speed in m/s, both of shape (points,)."""
    from scipy.optimize import least_squares

    largest, middle = friction.max(), float(np.exp(np.log(speed).mean()))
    units = np.array([largest, largest, middle, 1.0, largest / speed.max()])
    lower, upper = (0.0, 0.0, 1e-3, EXPONENTS[0], -1.0), (10.0, 10.0, 1e3, EXPONENTS[1], 10.0)
    start = (friction[speed.argmin()] / largest, friction.min() / largest, 1.0, 1.0, 0.0)
    found = least_squares(
        lambda v: (stribeck(speed, v * units) - friction) / largest, start, bounds=(lower, upper)
    )
    mu_s, mu_c, u_s, delta, k = map(float, found.x * units)
    return Stribeck(mu_s, mu_c, u_s, delta, k, float(np.sqrt(np.mean(found.fun**2))))
