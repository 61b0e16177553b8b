"""Level of the fatigue constants: scaled to the life of a smooth contact in a test; standards beside it."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import brentq

from ehlpetsc.post.counting import count_of
from ehlpetsc.post.smooth_histories import damages, unit_histories

if TYPE_CHECKING:
    from ehlpetsc.base.case import Case
    from ehlpetsc.post.criteria.planes import Criteria
    from ehlpetsc.post.fatigue.strain_life import Material

FACTORS = math.log(0.1), math.log(10.0)  # on the fatigue strength: logarithms of their bounds
ISO_6336 = (1.5e9, 5e7), (2.4e9, 1e5)  # contact stress [Pa] and load cycles, case-hardened steel
ISO_281_LIMIT = 1.5e9  # Pa, contact stress at the fatigue limit of bearing steel


def scaled_to_test(case: Case, material: Material, constants: Criteria) -> Material:
    """Material whose fatigue strength lets the smooth line contact live as in a test, `post.life_at`.

    sigma_f' and K' are multiplied by one factor, which scales the stress of a life. The line contact has no
    friction, and the criterion is that of the case.
    """
    if case.post.life_at is None:
        return material
    pressure, passes = case.post.life_at
    depths, unit = unit_histories(0.0, material.poisson_ratio, 0.0)
    histories, none = pressure * unit, np.zeros(len(depths))

    def scaled(logarithm: float) -> Material:
        factor = math.exp(logarithm)
        strength, cyclic = factor * material.fatigue_strength, factor * material.hardening_coefficient
        return replace(material, fatigue_strength=strength, cyclic_strength=cyclic)

    def excess(logarithm: float) -> float:
        count = count_of(case, scaled(logarithm), constants, case.post.criterion)
        return math.log(damages(histories, none, count).max() * passes)

    return scaled(brentq(excess, *FACTORS, xtol=1e-6))


def standard_line(pressure: float) -> str:
    """Line on the life of the smooth contact of case-hardened steel by standards at a pressure [Pa]."""
    (low, long), (high, short) = ISO_6336
    exponent = math.log(long / short) / math.log(high / low)
    cycles = long * (low / pressure) ** exponent
    given = (
        f"{cycles:.2g}"
        if low <= pressure <= high
        else f"over {long:g}"
        if pressure < low
        else f"under {short:g}"
    )
    side = "above" if pressure > ISO_281_LIMIT else "below"
    return (
        f"case-hardened steel by standards, smooth, {1e-9 * pressure:.3g} GPa: {given} load cycles (ISO "
        f"6336-5, 1 % failures); {side} the fatigue limit, {1e-9 * ISO_281_LIMIT:g} GPa (ISO 281)"
    )
