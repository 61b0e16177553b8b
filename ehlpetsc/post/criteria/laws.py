r"""Fatigue criteria other than the paper's: equations, sources, constants.

Shear strain alone, and Fatemi & Socie (1988), Fatigue Fract. Engng Mater. Struct. 11, with the normal stress
that opens a shear crack:

.. math::
    \frac{\Delta\gamma}{2} \quad\text{or}\quad
    \frac{\Delta\gamma}{2}\Big(1+k\frac{\sigma_{n,\max}}{\sigma_y}\Big)
    = \frac{\tau_f'}{G}(2N)^b + \gamma_f'(2N)^c

with :math:`\tau_f'=\sigma_f'/\sqrt3`, :math:`\gamma_f'=\sqrt3\,\varepsilon_f'` (von Mises). k is fitted to
tests in torsion and in tension; 1 is customary for steel without tests. Torsion tests of a hardened
spring steel: McClaflin & Fatemi (2004), Int. J. Fatigue 26, 773. Smith, Watson & Topper (1970), J. Mater. 5,
is uniaxial; on a plane it was proposed by Socie (1987), J. Eng. Mater. Technol. 109, for tensile cracks:

.. math::
    \sigma_{n,\max}\frac{\Delta\varepsilon_n}{2}
    = \frac{\sigma_f'^2}{E}(2N)^{2b} + \sigma_f'\varepsilon_f'(2N)^{b+c}

Strain ranges come from elastic ones by the same rule as in the paper's criterion (13), the shear as
:math:`\Delta\gamma = \sqrt3\,\Delta\varepsilon(\sqrt3\Delta\tau)` with 3G for E, a normal strain as that of
the uniaxial stress :math:`E\Delta\varepsilon_n`. The maximum normal stress is elastic and includes the
residual stress; compression counts as zero, so that its benefit is limited to a cycle that ends at zero
stress.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, log, sqrt

import numpy as np

from ehlpetsc.post.fatigue.strain_life import (
    MAX_RANGE,
    MIN_RANGE,
    Material,
    curve_table,
    log_local_range,
    log_reversals,
    log_strain_amplitude,
    rule_of,
)

PLASTIC_STRAIN = 0.002  # that defines the cyclic yield strength


@dataclass(frozen=True)
class Criteria:
    """Constants of the criteria in addition to those of the strain-life curves, SI units.

    The limits by default: 375 MPa, the amplitude 0.25 p of the shear stress parallel to the surface at the
    Hertz pressure of 1.5 GPa, the fatigue limit of bearing steel in ISO 281:2007 (in a point contact a von
    Mises stress of 0.9 GPa), and sqrt(3) of it in bending.
    """

    normal_sensitivity: float = 1.0  # k of Fatemi and Socie; 1 is customary without tests
    yield_strength: float | None = None  # sigma_y; None: cyclic, at 0.2 % plastic strain, K' 0.002^n'
    torsion_limit: float = 375e6  # tau_w of Dang Van
    bending_limit: float = 375e6 * sqrt(3)  # sigma_w of Dang Van

    def __post_init__(self) -> None:
        if self.torsion_limit < self.bending_limit / 2:
            raise ValueError(
                f"torsion_limit = {self.torsion_limit}: must be half of bending_limit or more (Dang Van's "
                "constant a would be negative)"
            )

    @property
    def hydrostatic_slope(self) -> float:
        """a of Dang Van's criterion."""
        return 3 * (self.torsion_limit / self.bending_limit - 0.5)

    def sensitivity(self, material: Material) -> float:
        """k/sigma_y of Fatemi and Socie, 1/Pa."""
        cyclic = material.hardening_coefficient * PLASTIC_STRAIN**material.cyclic_hardening
        return self.normal_sensitivity / (self.yield_strength or cyclic)


def _amplitude_table(modulus: float, material: Material, rule: int) -> np.ndarray:
    """ln of the strain amplitude over ln of the squared elastic range (Pa), with `modulus` for E."""
    _, hardening, exponent, strength, *_ = material.constants()

    def log_amplitude(log_squared: float) -> tuple[float, float]:
        local, rate = log_local_range(log_squared / 2, modulus, hardening, exponent, rule)
        value = log_strain_amplitude(local, modulus, hardening, exponent)
        elastic = exp(local - log(2 * modulus) - value)
        return value, (elastic + (1 - elastic) / exponent) * rate / 2

    return curve_table(2 * log(MIN_RANGE * strength), 2 * log(MAX_RANGE * strength), log_amplitude)


def _life_table(
    curve: tuple[float, float], strength: float, modulus: float, ductility: float, b: float, c: float
) -> np.ndarray:
    """ln(1/N) over ln P of strength/modulus (2N)^b + ductility (2N)^c = P, in the range of the amplitudes."""

    def log_damage(log_parameter: float) -> tuple[float, float]:
        y = log_reversals(log_parameter, strength, modulus, ductility, b, c)
        elastic = exp(log(strength / modulus) + b * y - log_parameter)
        return log(2.0) - y, -1 / (b * elastic + c * (1 - elastic))

    start, stop = curve
    return curve_table(start, stop, log_damage)


def shear_tables(material: Material, strain: str = "direct") -> tuple[np.ndarray, np.ndarray]:
    """Amplitude and life tables of both shear criteria, strains over sqrt(3): uniaxial with 3G for E."""
    modulus = 1.5 * material.youngs_modulus / (1 + material.poisson_ratio)
    amplitudes = _amplitude_table(modulus, material, rule_of(strain))
    _, _, _, strength, ductility, b, c = material.constants()
    ends = amplitudes[0, 0], amplitudes[-2, 0]
    return amplitudes, _life_table(ends, strength, modulus, ductility, b, c)


def swt_tables(material: Material, strain: str = "direct") -> tuple[np.ndarray, np.ndarray]:
    """Amplitude and life tables of Smith, Watson and Topper's criterion."""
    modulus, _, _, strength, ductility, b, c = material.constants()
    amplitudes = _amplitude_table(modulus, material, rule_of(strain))
    ends = amplitudes[0, 0] + log(MIN_RANGE * strength), amplitudes[-2, 0] + log(MAX_RANGE * strength)
    return amplitudes, _life_table(ends, strength**2, modulus, strength * ductility, 2 * b, b + c)
