r"""Elastic-plastic range from an elastic range: unchanged, by Neuber's or by Glinka's rule.

.. math::
    \text{direct:}\quad \Delta\sigma = \Delta\sigma_e

    \text{Neuber:}\quad \Delta\sigma\,\Delta\varepsilon(\Delta\sigma) = \Delta\sigma_e^2/E

    \text{Glinka:}\quad \frac{\Delta\sigma^2}{4E}
        +\frac{\Delta\sigma}{n'+1}\Big(\frac{\Delta\sigma}{2K'}\Big)^{1/n'} = \frac{\Delta\sigma_e^2}{4E}

with the cyclic stress-strain curve :math:`\Delta\varepsilon(\Delta\sigma)` of
:mod:`ehlpetsc.post.fatigue.strain_life`, eq. (13). "direct" is the method of Holmes et al. (2005): the
elastic range enters (13) as the true range, so that above yield both stress and strain are too large.
Neuber (1961), J. Appl. Mech. 28, preserves the product of stress and strain (derived for prisms in shear);
Molski & Glinka (1981), Mater. Sci. Eng. 50, preserve the strain energy of a notch: Neuber's strains tend to
be too large, Glinka's too small. Both hold for a small yielding zone in an elastic body, as under an
asperity; ranges are on the doubled curve (Masing).
"""

from math import exp, log

from ehlpetsc.compiled import compiled

STRAINS = ("direct", "neuber", "glinka")
DEFAULT_STRAIN = "neuber"


@compiled(error_model="python", nogil=True)
def _sum_of_powers(first, first_slope, second, second_slope, target):
    """y at which exp(first + first_slope y) + exp(second + second_slope y) = exp(wanted), and d wanted/dy.

    The logarithm of the sum is convex and increasing in y; from the smaller of the one-term solutions,
    right of the root, Newton's method converges without overshoot.
    """
    y = min((target - first) / first_slope, (target - second) / second_slope)
    slope = first_slope
    for _ in range(60):
        e, p = first + first_slope * y, second + second_slope * y
        high = max(e, p)
        total = high + log(exp(e - high) + exp(p - high))
        weight = exp(e - total)
        slope = first_slope * weight + second_slope * (1 - weight)
        step = (total - target) / slope
        y -= step
        if abs(step) <= 1e-14 * (1 + abs(y)):
            break
    return y, slope


@compiled(error_model="python", nogil=True)
def log_local_range(log_elastic, modulus, hardening, exponent, rule):
    """ln of the elastic-plastic stress range from ln of the elastic one, and its slope d ln/d ln.

    `rule` is the index of the rule in `STRAINS`.
    """
    if rule == 0:
        return log_elastic, 1.0
    target = 2 * (log_elastic - log(2.0)) - log(modulus)  # (elastic amplitude)^2/E
    elastic = -2 * log(2.0) - log(modulus)
    plastic = -log(2.0) - log(2 * hardening) / exponent
    if rule == 2:
        plastic -= log((1 + exponent) / 2)  # of twice the strain energy
    y, slope = _sum_of_powers(elastic, 2.0, plastic, 1 + 1 / exponent, target)
    return y, 2 / slope
