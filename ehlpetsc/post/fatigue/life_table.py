"""1/N over the stress range as a table, for the inner loop of the damage sum.

ln(1/N) over ln(dsv^2) by cubic Hermite interpolation between 4,096 values with exact slopes, straight lines
in logarithms (the power laws of the two curves' ends) outside. Relative error of 1/N below 1e-9, as tested.
"""

from math import exp, log

import numpy as np

from ehlpetsc.post.fatigue.strain_life import log_reversals, log_strain_amplitude
from ehlpetsc.post.jit import njit

ENTRIES = 4096
LOWEST, HIGHEST = 1e-6, 1e2  # of the fatigue strength


def life_table(material):
    """Table of shape (ENTRIES + 1, 2): ln(1/N) and its slope per step; the last row holds start and step."""
    modulus, hardening, exponent, strength, ductility, b, c = material.constants()
    start, stop = 2 * log(LOWEST * strength), 2 * log(HIGHEST * strength)
    step = (stop - start) / (ENTRIES - 1)
    table = np.empty((ENTRIES + 1, 2))
    for k in range(ENTRIES):
        log_dsv = (start + k * step) / 2
        amplitude = log_strain_amplitude(log_dsv, modulus, hardening, exponent)
        y = log_reversals(amplitude, strength, modulus, ductility, b, c)
        elastic = exp(log_dsv - log(2 * modulus) - amplitude)
        life = exp(log(strength / modulus) + b * y - amplitude)
        slope = (elastic + (1 - elastic) / exponent) / (b * life + c * (1 - life))
        table[k] = log(2.0) - y, -slope * step / 2
    table[ENTRIES] = start, step
    return table


@njit(cache=True, nogil=True)
def look_up(squared, table):
    """1/N at the square of a stress range > 0."""
    last = table.shape[0] - 2
    place = (log(squared) - table[last + 1, 0]) / table[last + 1, 1]
    if place <= 0:
        return exp(table[0, 0] + place * table[0, 1])
    if place >= last:
        return exp(min(table[last, 0] + (place - last) * table[last, 1], 700.0))
    k = int(place)
    t = place - k
    low, high = table[k, 0], table[k + 1, 0]
    rise = high - low
    left, right = table[k, 1] - rise, rise - table[k + 1, 1]
    return exp(low + t * (rise + (1 - t) * (left * (1 - t) + right * t)))
