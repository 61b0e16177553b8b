"""Nodes to the waves of a case's surfaces, and the errors of its mesh to expect."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from ehlpetsc.run.forecast.domain import resolves_inlet
from ehlpetsc.surfaces.topography import WAVE_NODES

if TYPE_CHECKING:
    from ehlpetsc.case.tables import Case
    from ehlpetsc.case.tables.contact import Contact
    from ehlpetsc.physics.scales import Scales
    from ehlpetsc.surfaces.motion.roughness import Roughness
    from ehlpetsc.surfaces.topography import Topography

NODES = 6, 8, 12, 16, 32  # to the shortest wave; errors of tests/benchmarks/ACCURACY.md on them
WAVE_ERRORS = 0.11, 0.07, 0.039, 0.024, 0.0059  # film and pressure, the worst up to pure sliding
OPPOSED_ERRORS = 0.96, 0.96, 0.40, 0.081, 0.02  # the same at slide/roll 4, surfaces against each other
SLIDING, OPPOSED = 2.0, 3.0  # speed of the faster surface over the mean speed, of these two rows
FRICTION_ERRORS = 0.26, 0.16, 0.088, 0.053, 0.016  # in mixed contact with a layer, as the next two
DAMAGE_ERRORS = 0.30, 0.23, 0.16, 0.11, 0.038  # of either sign, the largest of seven contacts
SHARE_RATIOS = 5.6, 4.0, 2.7, 2.1, 1.34  # load on the solids over its limit
MIN_SHARE = 1e-3  # of the load, on the solids: of less the error of the gap is no factor
WAVES_ALONG = ("short_cutoff", "wavelength", "correlation")  # keys of the waves of a surface
WAVES = (*WAVES_ALONG, "wavelength_across", "correlation_across")
GROUND_WAVE = 1.35  # shortest wave over the correlation length: 0.5 % of the power density
SHORT_VARIANCE = 0.01  # of the heights: waves of less are not counted where no key gives the shortest one


def wave_lines(case: Case, s: Scales, rough: Roughness | None) -> list[str]:
    """Nodes on the waves of both surfaces, a line each, and the errors to expect; [] of smooth surfaces."""
    found = waves(case, s, rough)
    lines = [f"Waves of surface {side}: {words}" for side, (words, _) in found.items()]
    if not lines or case.time is None or case.fluid is None:
        return lines
    fewest = min(shortest for _, shortest in found.values()) / s.grid.spacings[-1]
    faster = s.u_max / abs(s.u) if s.u else math.inf
    return [*lines, expected_errors(fewest, faster, case.contact, resolves_inlet(case, s))]


def waves(case: Case, s: Scales, rough: Roughness | None) -> dict[str, tuple[str, float]]:
    """Text on the waves of each surface that has any, and the length of the shortest one along [m]."""
    found = {}
    for side, surface in (rough.sides if rough else {}).items():
        spec = case.surface.side(side)
        words, shortest = _of_keys(spec.synthetic or spec, s) or _of_heights(surface.given, s)
        if shortest:
            found[side] = words, shortest
    return found


def _of_keys(table: object, s: Scales) -> tuple[str, float] | None:
    """Text on the waves that a table of a surface gives, and the shortest one along [m]; None: none."""
    dy, dx = s.grid.spacings[0], s.grid.spacings[-1]
    given = {key: length for key in WAVES if (length := getattr(table, key, None))}
    along = [GROUND_WAVE * w if k == "correlation" else w for k, w in given.items() if k in WAVES_ALONG]
    if not along:
        return None
    nodes = [
        f"{key} of {1e6 * length:.4g} um: {length / (dy if key.endswith('across') else dx):.1f}"
        for key, length in given.items()
    ]
    nodes.append(f"{min(along) / dx:.3g} nodes to the shortest one, {1e6 * min(along):.4g} um")
    return "; ".join(nodes), min(along)


def _of_heights(given: Topography, s: Scales) -> tuple[str, float]:
    """Text on the shortest wave of heights without a key for it, and its length [m]; 0 of a plane.

    Waves shorter than it have `SHORT_VARIANCE` of the height variance.
    """
    dy, dx = s.grid.spacings[0], s.grid.spacings[-1]
    across = dy / dx if len(s.grid.spacings) > 1 else 0.0
    low, high = 0.0, 2.0 * max(given.length, dx)
    if given.unresolved_variance(high / WAVE_NODES, across * high / WAVE_NODES) <= SHORT_VARIANCE:
        return "", 0.0
    while high - low > 1e-3 * high:
        middle = 0.5 * (low + high)
        short = given.unresolved_variance(middle / WAVE_NODES, across * middle / WAVE_NODES)
        low, high = (low, middle) if short > SHORT_VARIANCE else (middle, high)
    share = f"{100 * SHORT_VARIANCE:g} % of the height variance is in waves under {1e6 * high:.4g} um"
    return f"no short_cutoff; {share}, {high / dx:.3g} nodes", high


def wave_error(nodes: float, faster: float) -> float:
    """Relative error of waves of film and pressure, interpolated in the rows of the benchmark of waves.

    `faster`: speed of the faster surface over the mean speed. The film carries its waves at the mean speed:
    next to a faster surface they are shorter than its own by this ratio.
    """
    nodes, between = nodes * min(1.0, OPPOSED / faster), np.clip(faster, SLIDING, OPPOSED) - SLIDING
    sliding, opposed = (math.log(at(nodes, row)) for row in (WAVE_ERRORS, OPPOSED_ERRORS))
    return math.exp(sliding + between / (OPPOSED - SLIDING) * (opposed - sliding))


def at(nodes: float, row: tuple[float, ...]) -> float:
    """Value for so many nodes to the shortest wave, of a row over `NODES`."""
    return float(np.exp(np.interp(np.log(max(nodes, 1e-9)), np.log(NODES), np.log(row))))


def expected_errors(nodes: float, faster: float, contact: Contact, inlet_is_resolved: bool) -> str:
    """Errors to expect with so many nodes to the shortest wave; `faster`: as of :func:`wave_error`."""
    bound = ", at least" * (nodes < NODES[0]) + ", at most" * (nodes > NODES[-1])
    text = f"Mesh error{bound}: {100.0 * wave_error(nodes, faster):.2g} % of the waves of film and pressure"
    if contact.asperity_height is None:
        return f"{text}; load and length of contact of rigid solids shrink with every finer mesh"
    friction = f"{100.0 * at(nodes, FRICTION_ERRORS):.2g} % in friction"
    if not inlet_is_resolved:
        friction = f"more than {friction}, as the mesh does not resolve the inlet"
    return (
        f"{text}; in mixed contact {friction}, +-{100.0 * at(nodes, DAMAGE_ERRORS):.2g} % in damage, "
        f"{at(nodes, SHARE_RATIOS):.2g} times the load on the solids above {MIN_SHARE:g} of the load"
    )
