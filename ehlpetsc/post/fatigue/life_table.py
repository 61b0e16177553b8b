"""Table of 1/N over the stress range, for the inner loop of the damage sum.

ln(1/N) over ln(dsv^2) by cubic Hermite interpolation between 4,096 values with exact slopes, straight lines
in logarithms (the power laws of the two curves' ends) outside. Relative error of 1/N below 1e-9, as tested.
"""

from functools import lru_cache
from math import exp, log

import numpy as np

from ehlpetsc.compiled import compiled
from ehlpetsc.post.fatigue.elastic_plastic import log_local_range
from ehlpetsc.post.fatigue.strain_life import log_reversals, log_strain_amplitude, rule_of

ENTRIES = 4096
MIN_RANGE, MAX_RANGE = 1e-6, 1e2  # of the fatigue strength


def curve_table(start, stop, value_and_slope):
    """Table (ENTRIES + 1, 2) of a function of a logarithm and its slope per step between start and stop.

    `value_and_slope` takes the logarithm; the last row holds start and step.
    """
    step = (stop - start) / (ENTRIES - 1)
    table = np.empty((ENTRIES + 1, 2))
    for k in range(ENTRIES):
        value, slope = value_and_slope(start + k * step)
        table[k] = value, slope * step
    table[ENTRIES] = start, step
    return table


@lru_cache(maxsize=8)
def life_table(material, strain="direct"):
    """Table of ln(1/N) over ln(dsv^2), dsv elastic; `strain`: rule applied before eq. (13).

    Cached: all histories of one material use the same table.
    """
    modulus, hardening, exponent, strength, ductility, b, c = material.constants()
    rule = rule_of(strain)

    def log_damage(log_squared):
        local, rate = log_local_range(log_squared / 2, modulus, hardening, exponent, rule)
        amplitude = log_strain_amplitude(local, modulus, hardening, exponent)
        y = log_reversals(amplitude, strength, modulus, ductility, b, c)
        elastic = exp(local - log(2 * modulus) - amplitude)
        life = exp(log(strength / modulus) + b * y - amplitude)
        slope = (elastic + (1 - elastic) / exponent) / (b * life + c * (1 - life))
        return log(2.0) - y, -slope * rate / 2

    return curve_table(2 * log(MIN_RANGE * strength), 2 * log(MAX_RANGE * strength), log_damage)


@compiled(error_model="python", nogil=True)
def interpolate(logarithm, table):
    """Value of a :func:`curve_table` at a logarithm, extrapolated linearly beyond its ends."""
    last = table.shape[0] - 2
    position = (logarithm - table[last + 1, 0]) / table[last + 1, 1]
    if position <= 0:
        return table[0, 0] + position * table[0, 1]
    if position >= last:
        return table[last, 0] + (position - last) * table[last, 1]
    k = int(position)
    t = position - k
    low, high = table[k, 0], table[k + 1, 0]
    rise = high - low
    left, right = table[k, 1] - rise, rise - table[k + 1, 1]
    return low + t * (rise + (1 - t) * (left * (1 - t) + right * t))


@compiled(error_model="python", nogil=True)
def look_up(squared, table):
    """1/N at the square of a stress range > 0."""
    return exp(min(interpolate(log(squared), table), 700.0))
