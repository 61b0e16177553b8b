r"""Load of one tooth pair over the load of the mesh.

A single pair carries the load between B and D. Between A and B it shares the load with the pair one base
pitch ahead, between D and E with the pair one base pitch behind. With :math:`s=(\rho-\rho_A)/(\rho_B-\rho_A)`
from A to B, and mirrored from E to D:

``thirds``
    :math:`(1+s)/3`: from a third to two thirds, for teeth without relief (ISO/TR 13989-1). The load rises
    from two thirds to one over `JUMP_LENGTH` of the path outside B and D, because teeth bend.
``tip-relief``
    Two pairs of equal stiffness c' in parallel, separated by the linear relief :math:`C_a(1-s)` of the pair
    that comes into contact and :math:`C_as` of the pair that leaves, share the load by
    :math:`\frac12[1+\kappa(2s-1)]`, :math:`\kappa=c'C_a/w'`. With :math:`\kappa\ge1` the load begins at
    zero. A smaller relief would leave a load at the edge A; the load then increases from zero along the line
    :math:`s/\kappa`, and near B along its mirror image.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ehlpetsc.gears.geometry import GearPair

RULES = ("thirds", "tip-relief")
JUMP_LENGTH = 0.005  # of the path: rise from two thirds to the total load
MIN_RELIEF_RATIO = 0.05  # kappa: below it the load would rise within less than a twentieth of A to B


def thirds(s: np.ndarray, edge: float) -> np.ndarray:
    """Load fraction between A and B without tip relief.

    Parameters
    ----------
    s
        0 at A, 1 at B.
    edge
        Length of the rise to the total load, in s.
    """
    shared = (1.0 + s) / 3.0
    at_edge = (2.0 - edge) / 3.0
    return np.where(s <= 1.0 - edge, shared, at_edge + (1.0 - at_edge) * (s - 1.0 + edge) / edge)


def tip_relief(s: np.ndarray, ratio: float) -> np.ndarray:
    """Load fraction between A and B with tip relief; `ratio` is c' C_a / w'."""
    elastic = np.clip(0.5 * (1.0 + ratio * (2.0 * s - 1.0)), 0.0, 1.0)
    if ratio >= 1.0:
        return elastic
    return np.maximum(np.minimum(elastic, s / ratio), 1.0 - (1.0 - s) / ratio)


def relief_ratio(pair: GearPair) -> float:
    r""":math:`c'C_a/w'`: depth of relief over the deflection of one pair under the total load."""
    return pair.mesh_stiffness * pair.tip_relief / pair.normal_load


def _rule(pair: GearPair) -> tuple[Callable[[np.ndarray], np.ndarray], tuple[float, ...]]:
    """Load fraction as a function of s, and the values of s with a kink."""
    if pair.rule == "thirds":
        edge = min(JUMP_LENGTH * pair.contact_ratio / (pair.contact_ratio - 1.0), 0.5)
        return lambda s: thirds(s, edge), (1.0 - edge,)
    ratio = max(relief_ratio(pair), MIN_RELIEF_RATIO)
    # onset of the load, or intersection of s/ratio with the elastic line
    kink = 0.5 - 0.5 / ratio if ratio >= 1.0 else 0.5 * ratio / (1.0 + ratio)
    return lambda s: tip_relief(s, ratio), (kink, 1.0 - kink)


def kinks(pair: GearPair) -> list[float]:
    """Positions of kinks of the load of a pair other than A, B, D and E [m]."""
    points = pair.points
    return [
        end + s * (inner - end)
        for end, inner in ((points["A"], points["B"]), (points["E"], points["D"]))
        for s in _rule(pair)[1]
    ]


def share(pair: GearPair, rho: np.ndarray) -> np.ndarray:
    """Load of a tooth pair over that of the mesh, 0 to 1.

    Parameters
    ----------
    rho
        Positions between A and E [m].
    """
    points = pair.points
    incoming = (rho - points["A"]) / (points["B"] - points["A"])
    leaving = (points["E"] - rho) / (points["E"] - points["D"])
    return _rule(pair)[0](np.clip(np.minimum(incoming, leaving), 0.0, 1.0))
