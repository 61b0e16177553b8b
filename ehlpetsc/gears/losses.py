r"""Friction losses of a gear mesh.

Power lost in the mesh over the transmitted power is :math:`\mu_m H_V` (Niemann & Winter, Maschinenelemente
2). The energy lost on one engagement is :math:`\int\mu w'|u_1-u_2|dt`, and one pair engages each base pitch.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ehlpetsc.gears.geometry import GearPair
    from ehlpetsc.gears.path import Path


def gear_loss_factor(path: Path) -> float:
    r"""Loss factor H_V of the load sharing of a path.

    .. math:: H_V=\frac{1}{p_b}\int_A^E\frac{w'}{w'_\mathrm{mesh}}\frac{|u_1-u_2|}{v_b}d\rho

    with the speed :math:`v_b=\omega_1r_{b1}` along the line of action.
    """
    return loss(path, 1.0)


def loss(path: Path, friction: float | np.ndarray) -> float:
    r"""Power lost over the transmitted power, with friction coefficients along the path.

    Parameters
    ----------
    friction
        :math:`\mu` at the samples of the path, shape (n,).
    """
    pair = path.pair
    sliding = np.abs(path.speed_1 - path.speed_2) / pair.base_speed
    integrand = friction * path.load / pair.normal_load * sliding
    return float(0.5 * (integrand[1:] + integrand[:-1]) @ np.diff(path.rho) / pair.base_pitch)


def mean_friction(path: Path, friction: float | np.ndarray) -> float:
    """Mean coefficient of friction of the mesh: the loss over H_V."""
    return loss(path, friction) / gear_loss_factor(path)


def ohlendorf_loss_factor(pair: GearPair) -> float:
    r"""Loss factor H_V from tooth numbers and contact ratios, Ohlendorf (1958).

    .. math:: H_V=\frac{\pi(i+1)}{z_1i}(1-\varepsilon_\alpha+\varepsilon_1^2+\varepsilon_2^2)

    with the gear ratio i and the contact ratios :math:`\varepsilon_{1,2}` from C to E and from A to C.
    """
    points, i = pair.points, pair.teeth[1] / pair.teeth[0]
    e_1 = (points["E"] - points["C"]) / pair.base_pitch
    e_2 = (points["C"] - points["A"]) / pair.base_pitch
    factor = np.pi * (i + 1.0) / (pair.teeth[0] * i)
    return float(factor * (1.0 - pair.contact_ratio + e_1**2 + e_2**2))
