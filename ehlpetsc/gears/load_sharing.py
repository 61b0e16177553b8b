r"""Load of one tooth pair over the load of the mesh.

The flanks of loaded teeth meet before A and part after E, as the other pair bends: a tip edge touches there
off the line of action (`corner_gap`). All pairs that may touch, with stiffness k and gap g along the
line of action, approach each other by :math:`\delta` and carry :math:`k\max(\delta-g,0)`, in sum the load.

``stiffness``
    k is c' of ISO 6336-1 times the parabola :math:`0.55+1.8\xi(1-\xi)`, :math:`\xi` from A to E (Cai &
    Hayashi, J. Mech. Des. 116 (1994) 558, a fit to Weber & Banaschek's compliance; from memory).
``tip-relief``
    k is c'. Both with the linear relief :math:`C_a(1-s)` from A to B and from E to D; where
    :math:`\kappa=c'C_a/w'<1`, a load :math:`\frac12(1-\kappa)` is left at A.
``thirds``
    From a third at A to two thirds at B, linear, for teeth without relief (ISO/TR 13989-1); beyond A and E
    the third falls to zero as the load of an edge does with c', as much less the others.

A helical pair is cut into slices across the face, each a spur pair ahead of or behind the one in the middle,
which is the pair of the path; all slices approach by the same :math:`\delta`.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ehlpetsc.gears.geometry import GearPair

# compliance q' of ISO 6336-1, method B: 1, 1/z1, 1/z2, x1, x1/z1, x2, x2/z2, x1^2, x2^2 [mm um/N]
COMPLIANCE = (0.04723, 0.15551, 0.25791, -0.00635, -0.11654, -0.00193, -0.24188, 0.00529, 0.00182)
RULES = ("thirds", "tip-relief", "stiffness")
SLICES = 41  # of a helical pair
EDGE_SAMPLES = 2001
NEVER = 1.0  # m: gap of flanks that do not touch
PITCH_ROUNDING = 1e-9  # of the base pitch: a pair that near to A to E is not beyond them
END_STIFFNESS = 0.55  # of a pair at A and E, over that in the middle


def single_stiffness(pair: GearPair) -> float:
    r"""Maximum stiffness c' of a tooth pair per face width [Pa] of ISO 6336-1: steel discs.

    :math:`c'=0.8\,C_B\cos\beta/q'` with the virtual tooth numbers in q', and less below 100 N/mm; constants
    as in public code (GEARpie), the rest from memory.
    """
    if pair.mesh_stiffness is not None:
        return pair.mesh_stiffness
    beta, (x1, x2) = math.radians(pair.helix_angle), pair.shifts
    n1, n2 = (z / (math.cos(pair.base_helix_angle) ** 2 * math.cos(beta)) for z in pair.teeth)
    n2 = math.inf if pair.internal else n2  # of a ring, as in the standard
    terms = (1.0, 1.0 / n1, 1.0 / n2, x1, x1 / n1, x2, x2 / n2, x1 * x1, x2 * x2)
    q = sum(c * term for c, term in zip(COMPLIANCE, terms, strict=True))
    rack = 1.0 + 0.5 * (1.2 - pair.addendum - pair.tip_clearance)
    rack *= 1.0 - 0.02 * (20.0 - pair.pressure_angle)
    tangential = 2.0 * pair.torque / (pair.transverse_module * pair.teeth[0] * pair.face_width)
    return 0.8e9 * rack * math.cos(beta) / q * min(1.0, tangential / 100e3) ** 0.25


def share(pair: GearPair, rho: np.ndarray) -> np.ndarray:
    """Load of a tooth pair over that of the mesh, 0 to 1, at positions on the line of action [m]."""
    if pair.load is not None:
        at = np.asarray(pair.path) + pair.points["C"]
        return np.interp(rho, at, pair.load, left=0.0, right=0.0) / pair.normal_load
    if pair.rule == "thirds":
        return _thirds(pair, rho)
    loads, own = pair_loads(pair, rho)
    return loads[:, own] * (SLICES if pair.helix_angle else 1)


def gap(pair: GearPair, rho: np.ndarray) -> np.ndarray:
    """Gap of unloaded flanks [m]: tip relief, and beyond A and E the way of an edge."""
    return corner_gap(pair, rho) + pair.tip_relief * (1.0 - np.minimum(*_inwards(pair, rho)))


def corner_gap(pair: GearPair, rho: np.ndarray) -> np.ndarray:
    r"""Gap of unloaded flanks along the line of action [m]: 0 from A to E, inf where there is no flank.

    Beyond, a sharp tip of one gear is at :math:`(s,\gamma)` about the centre of the other, whose flank
    there is an involute of base radius r at :math:`\psi`: the gap is :math:`r(\gamma-\psi)`.
    """
    points, length, angle = pair.points, pair.line_of_action, pair.working_angle
    (r1, r2), found = pair.base_radii, np.zeros_like(rho)
    ends = ((points["A"], rho, r1, r2, 1), (length - points["E"], length - rho, r2, r1, 0))
    for end, here, flank, base, side in ends:
        beyond, tip = np.maximum(end - here, 0.0), 0.5 * pair.tip_diameter[side]
        turned = angle - math.acos(base / tip) - beyond / base
        x, y = pair.centre_distance - tip * np.cos(turned), tip * np.sin(turned)
        if flank < 0.0:  # seen from the centre of a ring
            x, y = -x, -y
        with np.errstate(invalid="ignore"):
            roll = np.sqrt((x * x + y * y) / flank**2 - 1.0)
        psi = (end - beyond) / flank - angle - roll + np.arctan(roll)
        found += np.where(beyond > 0.0, np.nan_to_num(flank * (np.arctan2(y, x) - psi), nan=np.inf), 0.0)
    return found


def stiffness(pair: GearPair, rho: np.ndarray) -> np.ndarray:
    """Stiffness of a tooth pair per face width [Pa]."""
    if pair.rule == "tip-relief":
        return np.full_like(rho, single_stiffness(pair))
    points = pair.points
    xi = np.clip((rho - points["A"]) / (points["E"] - points["A"]), 0.0, 1.0)
    return single_stiffness(pair) * (END_STIFFNESS + 4.0 * (1.0 - END_STIFFNESS) * xi * (1.0 - xi))


def _inwards(pair: GearPair, rho: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """s from A to B and from E to D, 0 to 1."""
    points = pair.points
    incoming = (rho - points["A"]) / (points["B"] - points["A"])
    leaving = (points["E"] - rho) / (points["E"] - points["D"])
    return np.clip(incoming, 0.0, 1.0), np.clip(leaving, 0.0, 1.0)


def pair_loads(pair: GearPair, rho: np.ndarray) -> tuple[np.ndarray, int]:
    """Loads of all pairs and slices over that of the mesh, shape (n, m), sum 1; column of the pair at rho."""
    slices = SLICES if pair.helix_angle else 1
    across = (np.arange(slices) - (slices - 1) // 2) / slices * pair.face_width
    reach = math.ceil(pair.contact_ratio + pair.overlap_ratio)
    behind = pair.base_pitch * np.arange(-reach, reach + 1)
    offsets = (across[:, None] * math.tan(pair.base_helix_angle) + behind).ravel()
    at = np.asarray(rho, dtype=float)[:, None] + offsets
    k, g = stiffness(pair, at) / slices, np.minimum(gap(pair, at), NEVER)
    order = np.argsort(g, axis=1)
    ranked_k, ranked_g = (np.take_along_axis(values, order, axis=1) for values in (k, g))
    # the approach is that of the first n in contact: of fewer or of more it is larger
    approach = (pair.normal_load + np.cumsum(ranked_k * ranked_g, axis=1)) / np.cumsum(ranked_k, axis=1)
    loads = k * np.maximum(approach.min(axis=1)[:, None] - g, 0.0)
    return loads / pair.normal_load, int(np.flatnonzero(offsets == 0.0)[0])


def _thirds(pair: GearPair, rho: np.ndarray) -> np.ndarray:
    rho, points, rounding = np.asarray(rho, dtype=float), pair.points, PITCH_ROUNDING * pair.base_pitch

    def is_beyond(at: np.ndarray) -> np.ndarray:
        return (at < points["A"] - rounding) | (at > points["E"] + rounding)

    def beyond(at: np.ndarray) -> np.ndarray:
        loaded = 1.0 - corner_gap(pair, at) * single_stiffness(pair) / pair.normal_load
        return np.where(is_beyond(at), np.maximum(loaded, 0.0) / 3.0, 0.0)

    alone = (rho > points["B"] + rounding) & (rho < points["D"] - rounding)
    inwards = np.minimum(*_inwards(pair, rho))  # 1 of a pair alone, in sum 1 of two
    edges = sum(beyond(rho + k * pair.base_pitch) for k in (-2, -1, 1, 2))
    inside = np.where(alone, 1.0, (1.0 + inwards) / 3.0) - inwards * edges
    return np.where(is_beyond(rho), beyond(rho), inside)


def edge_contact(pair: GearPair) -> dict[str, tuple[float, float]]:
    """Contact of the tip edges before A and after E: length along the path [m], and share of the load there.

    Beyond the path the load falls from that share to zero, on a contact that is no longer than the edge.
    """
    found, points = {}, pair.points
    for name, outwards in (("A", -1.0), ("E", 1.0)):
        way = np.linspace(0.0, 0.5 * pair.base_pitch, EDGE_SAMPLES)
        load = share(pair, points[name] + outwards * way)
        found[name] = float(way[load > 0.0].max(initial=0.0)), float(load[0])
    return found
