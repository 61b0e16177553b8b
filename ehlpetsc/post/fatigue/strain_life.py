r"""Life of stress ranges: equivalent range, cyclic stress-strain curve, strain-life curve.

.. math::
    \Delta\sigma_v = \sqrt{\tfrac12[(\Delta\sigma_x-\Delta\sigma_y)^2+(\Delta\sigma_y-\Delta\sigma_z)^2
                     +(\Delta\sigma_z-\Delta\sigma_x)^2]+3\Delta\tau_{xz}^2}  \qquad (12)

    \Delta\varepsilon = \Delta\sigma_v/E + 2(\Delta\sigma_v/2K')^{1/n'}  \qquad (13)

    \Delta\varepsilon/2 = (\sigma_f'/E)(2N)^b + \varepsilon_f'(2N)^c  \qquad (14)

Holmes et al. 2005. K' is not in their Table 1; its default :math:`\sigma_f'/\varepsilon_f'^{n'}` makes the
two curves consistent.

Elastic-plastic range from an elastic range: unchanged, by Neuber's or by Glinka's rule.

.. math::
    \text{direct:}\quad \Delta\sigma = \Delta\sigma_e

    \text{Neuber:}\quad \Delta\sigma\,\Delta\varepsilon(\Delta\sigma) = \Delta\sigma_e^2/E

    \text{Glinka:}\quad \frac{\Delta\sigma^2}{4E}
        +\frac{\Delta\sigma}{n'+1}\Big(\frac{\Delta\sigma}{2K'}\Big)^{1/n'} = \frac{\Delta\sigma_e^2}{4E}

with the cyclic stress-strain curve :math:`\Delta\varepsilon(\Delta\sigma)` of eq. (13). "direct" is the
method of Holmes et al. (2005): the elastic range enters (13) as the true range, so that above yield both
stress and strain are too large. Neuber (1961), J. Appl. Mech. 28, preserves the product of stress and strain
(derived for prisms in shear); Molski & Glinka (1981), Mater. Sci. Eng. 50, preserve the strain energy of a
notch: Neuber's strains tend to be too large, Glinka's too small. Both hold for a small yielding zone in an
elastic body, as under an asperity; ranges are on the doubled curve (Masing).

Table of 1/N over the stress range, for the inner loop of the damage sum.

ln(1/N) over ln(dsv^2) by cubic Hermite interpolation between 4,096 values with exact slopes, straight lines
in logarithms (the power laws of the two curves' ends) outside. Relative error of 1/N below 1e-9, as tested.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache
from math import exp, inf, log

import numpy as np

from ehlpetsc.base.compiled import compiled

STRAINS = ("direct", "neuber", "glinka")
DEFAULT_STRAIN = "neuber"


@compiled(error_model="python", nogil=True)
def _sum_of_powers(
    first: float, first_slope: float, second: float, second_slope: float, target: float
) -> tuple[float, float]:
    """y at which exp(first + first_slope y) + exp(second + second_slope y) = exp(target), and d target/dy.

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
def log_local_range(
    log_elastic: float, modulus: float, hardening: float, exponent: float, rule: int
) -> tuple[float, float]:
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


EXP_LIMIT = 700.0  # exp of more overflows
MIN_BRINELL = 50.0  # HB, of estimates: the softest steels


@dataclass(frozen=True)
class Material:
    """Constants of the fatigue curves, SI units; defaults: SAE 4340 as in Table 1 of Holmes et al. 2005."""

    youngs_modulus: float = 207e9
    poisson_ratio: float = 0.3
    b: float = -0.091
    c: float = -0.60
    cyclic_hardening: float = 0.15
    fatigue_strength: float = 2.0e9
    fatigue_ductility: float = 0.48
    cyclic_strength: float | None = None
    tensile_strength: float | None = None
    walker_exponent: float | None = None

    @property
    def hardening_coefficient(self) -> float:
        """K' in Pa."""
        return self.cyclic_strength or self.fatigue_strength / self.fatigue_ductility**self.cyclic_hardening

    def mean_stress_constants(self) -> tuple[float, float]:
        """Tensile strength [Pa] and Walker's exponent, estimated unless given (see `mean_stress`)."""
        hardness = max(self.fatigue_strength / 1e6 - 225, 0.0) / 4.25
        tensile = self.tensile_strength or 3.45e6 * max(hardness, MIN_BRINELL)
        estimate = min(max(0.8818 - 0.0002e-6 * tensile, 0.0), 1.0)
        return tensile, estimate if self.walker_exponent is None else self.walker_exponent

    def constants(self) -> tuple[float, ...]:
        """Constants (E, K', n', sigma_f', eps_f', b, c) of the compiled functions."""
        curve = self.youngs_modulus, self.hardening_coefficient, self.cyclic_hardening
        return *curve, self.fatigue_strength, self.fatigue_ductility, self.b, self.c


@compiled(error_model="python", nogil=True)
def log_amplitude(
    log_squared: float, rule: int, modulus: float, hardening: float, exponent: float
) -> tuple[float, float]:
    """ln of half the strain range of eq. (13), and its slope, from ln of the squared elastic stress range."""
    local, rate = log_local_range(log_squared / 2, modulus, hardening, exponent, rule)
    elastic = local - log(2 * modulus)
    plastic = (local - log(2 * hardening)) / exponent
    high = max(elastic, plastic)
    value = high + log(exp(elastic - high) + exp(plastic - high))
    share = exp(elastic - value)
    return value, (share + (1 - share) / exponent) * rate / 2


@compiled(error_model="python", nogil=True)
def log_damage(
    amplitude: float, modulus: float, strength: float, ductility: float, b: float, c: float
) -> tuple[float, float]:
    """ln(1/N), and its slope, from ln of the strain amplitude, eq. (14).

    With a strength <= 0 (mean stress above it) only the plastic term remains.
    """
    plastic = log(ductility)
    if strength <= 0:
        return log(2.0) + (plastic - amplitude) / c, -1 / c
    y, slope = _sum_of_powers(log(strength / modulus), -b, plastic, -c, amplitude)
    return log(2.0) + y, 1 / slope


@compiled(error_model="python", nogil=True)
def cycle_damage(dsv: float, mean: float, rule: int, constants: tuple) -> float:
    """1/N of one cycle, directly from the equations; `constants` of a Material."""
    modulus, hardening, exponent, strength, ductility, b, c = constants
    if dsv <= 0:
        return 0.0
    if dsv == inf:
        return inf
    amplitude, _ = log_amplitude(2 * log(dsv), rule, modulus, hardening, exponent)
    return exp(min(log_damage(amplitude, modulus, strength - mean, ductility, b, c)[0], EXP_LIMIT))


def cycles_to_failure(
    dsv: np.ndarray, material: Material, mean_stress: float | np.ndarray = 0.0, strain: str = "direct"
) -> float | np.ndarray:
    """Cycles to failure N under a constant equivalent stress range, eqs. (13) and (14) inverted to rounding.

    `dsv`: equivalent stress range [Pa]; N is infinite at 0.
    `mean_stress`: subtracted from the fatigue strength in the elastic term of (14) (Morrow) [Pa].
    `strain`: rule applied to the elastic range before (13): "direct", "neuber" or "glinka".
    """
    rule, constants = STRAINS.index(strain), material.constants()
    dsv, mean = np.broadcast_arrays(np.asarray(dsv, float), np.asarray(mean_stress, float))
    if not (dsv >= 0).all() or np.isnan(mean).any():
        raise ValueError("stress ranges must be numbers of 0 or more")
    damages = [cycle_damage(*pair, rule, constants) for pair in zip(dsv.ravel(), mean.ravel(), strict=True)]
    with np.errstate(all="ignore"):
        return (1 / np.reshape(damages, dsv.shape))[()]


ENTRIES = 4096
MIN_RANGE, MAX_RANGE = 1e-6, 1e2  # of the fatigue strength


def curve_table(
    start: float, stop: float, value_and_slope: Callable[[float], tuple[float, float]]
) -> np.ndarray:
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
def life_table(material: Material, strain: str) -> np.ndarray:
    """Table of ln(1/N) over ln(dsv^2), dsv elastic; `strain`: rule applied before eq. (13).

    Cached: all histories of one material use the same table.
    """
    rule, constants = STRAINS.index(strain), material.constants()

    def value_and_slope(log_squared: float) -> tuple[float, float]:
        amplitude, rate = log_amplitude(log_squared, rule, *constants[:3])
        value, slope = log_damage(amplitude, constants[0], *constants[3:])
        return value, slope * rate

    return curve_table(*_ends(material), value_and_slope)


@lru_cache(maxsize=8)
def shear_tables(material: Material, strain: str) -> tuple[np.ndarray, np.ndarray]:
    """ln of the shear strain amplitude over sqrt(3) over ln of the squared range; ln(1/N) over the former.

    As uniaxial strains, with 3G for E.
    """
    shear = replace(material, youngs_modulus=1.5 * material.youngs_modulus / (1 + material.poisson_ratio))
    rule, constants = STRAINS.index(strain), shear.constants()
    amplitudes = curve_table(*_ends(shear), lambda squared: log_amplitude(squared, rule, *constants[:3]))
    ends = amplitudes[0, 0], amplitudes[-2, 0]
    return amplitudes, curve_table(*ends, lambda value: log_damage(value, constants[0], *constants[3:]))


def _ends(material: Material) -> tuple[float, float]:
    """ln of the squared stress ranges between which tables extend."""
    return 2 * log(MIN_RANGE * material.fatigue_strength), 2 * log(MAX_RANGE * material.fatigue_strength)


@compiled(error_model="python", nogil=True)
def interpolate(logarithm: float, table: np.ndarray) -> float:
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
def look_up(squared: float, table: np.ndarray) -> float:
    """1/N at the square of a stress range > 0."""
    return exp(min(interpolate(log(squared), table), EXP_LIMIT))
