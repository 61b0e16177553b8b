r"""Mean-stress corrections: the fully reversed range equivalent to a stress range about a mean stress.

With the amplitude :math:`\sigma_a`, the mean :math:`\sigma_m` and :math:`\sigma_{max}=\sigma_a+\sigma_m`:

.. math::
    \text{Goodman:}\quad \sigma_{ar} = \frac{\sigma_a}{1-\sigma_m/\sigma_u} \qquad
    \text{Gerber:}\quad \sigma_{ar} = \frac{\sigma_a}{1-(\max(\sigma_m,0)/\sigma_u)^2}

    \text{Smith, Watson, Topper:}\quad \sigma_{ar} = \sqrt{\sigma_{max}\sigma_a} \qquad
    \text{Walker:}\quad \sigma_{ar} = \sigma_{max}^{1-\gamma}\sigma_a^\gamma

Morrow's subtracts :math:`\sigma_m` from the fatigue strength instead
(:mod:`ehlpetsc.post.fatigue.strain_life`). Gerber's parabola would shorten lives under compression; here
compression has no effect. A cycle that is never in tension has no damage by Smith, Watson and Topper and by
Walker.

Dowling (2004), SAE Technical Paper 2004-01-2227. Estimates without tests: :math:`\sigma_u=3.45\,HB` MPa with
HB from :math:`\sigma_f'` by Roessle and Fatemi (2000); for steels
:math:`\gamma=0.8818-0.0002\,\sigma_u/\mathrm{MPa}` by Dowling, Calhoun and Arcari (2009), Fatigue Fract.
Engng Mater. Struct. 32, 163.
"""

from __future__ import annotations

from math import inf, sqrt

from ehlpetsc.base.compiled import compiled


@compiled(error_model="python", nogil=True)
def goodman(width: float, mean: float, tensile_strength: float, exponent: float) -> float:
    """Fully reversed range of a range and a mean stress [Pa]; infinite from the tensile strength on."""
    return width / (1.0 - mean / tensile_strength) if mean < tensile_strength else inf


@compiled(error_model="python", nogil=True)
def gerber(width: float, mean: float, tensile_strength: float, exponent: float) -> float:
    """Fully reversed range of a range and a mean stress [Pa]; infinite from the tensile strength on."""
    share = max(mean, 0.0) / tensile_strength
    return width / (1.0 - share * share) if share < 1.0 else inf


@compiled(error_model="python", nogil=True)
def swt(width: float, mean: float, tensile_strength: float, exponent: float) -> float:
    """Fully reversed range of a range and a mean stress [Pa], by Smith, Watson and Topper."""
    return sqrt(width * max(width + 2.0 * mean, 0.0))


@compiled(error_model="python", nogil=True)
def walker(width: float, mean: float, tensile_strength: float, exponent: float) -> float:
    """Fully reversed range of a range and a mean stress [Pa], with Walker's exponent gamma."""
    return width**exponent * max(width + 2.0 * mean, 0.0) ** (1.0 - exponent)


CORRECTIONS = {"goodman": goodman, "gerber": gerber, "swt": swt, "walker": walker}


@compiled(error_model="python", nogil=True)
def reversed_range(number: int, width: float, mean: float, tensile_strength: float, exponent: float) -> float:
    """Fully reversed range [Pa] by the correction with this number in `MEAN_STRESSES`."""
    if number == 2:
        return goodman(width, mean, tensile_strength, exponent)
    if number == 3:
        return gerber(width, mean, tensile_strength, exponent)
    if number == 4:
        return swt(width, mean, tensile_strength, exponent)
    return walker(width, mean, tensile_strength, exponent)
