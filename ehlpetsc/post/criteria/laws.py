r"""Fatigue criteria other than the paper's: equations, sources, constants.

Fatemi & Socie (1988), Fatigue Fract. Engng Mater. Struct. 11: shear strain, and the normal stress that opens
a shear crack:

.. math::
    \frac{\Delta\gamma}{2}\Big(1+k\frac{\sigma_{n,\max}}{\sigma_y}\Big)
    = \frac{\tau_f'}{G}(2N)^b + \gamma_f'(2N)^c

with :math:`\tau_f'=\sigma_f'/\sqrt3`, :math:`\gamma_f'=\sqrt3\,\varepsilon_f'` (von Mises). k is fitted to
tests in torsion and in tension; 1 is customary for steel without tests. Torsion tests of a hardened
spring steel: McClaflin & Fatemi (2004), Int. J. Fatigue 26, 773.

Strain ranges come from elastic ones by the same rule as in the paper's criterion (13), the shear as
:math:`\Delta\gamma = \sqrt3\,\Delta\varepsilon(\sqrt3\Delta\tau)` with 3G for E. The maximum
normal stress is elastic and includes the residual stress; compression counts as zero, so that its benefit is
limited to a cycle that ends at zero stress.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, log, sqrt

from ehlpetsc.base.compiled import compiled
from ehlpetsc.base.errors import PostError
from ehlpetsc.post.fatigue.strain_life import Material, interpolate

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
            raise PostError(
                f"post.torsion_limit = {self.torsion_limit}: must be half of bending_limit or more "
                "(Dang Van's constant a would be negative)"
            )

    @property
    def hydrostatic_slope(self) -> float:
        """a of Dang Van's criterion."""
        return 3 * (self.torsion_limit / self.bending_limit - 0.5)

    def sensitivity(self, material: Material) -> float:
        """k/sigma_y of Fatemi and Socie, 1/Pa."""
        cyclic = material.hardening_coefficient * PLASTIC_STRAIN**material.cyclic_hardening
        return self.normal_sensitivity / (self.yield_strength or cyclic)


@compiled(error_model="python", nogil=True)
def cycle_damage(width: float, normal: float, law: tuple) -> float:
    """1/N of a cycle of sqrt(3) times the shear stress, of a range and a maximum normal stress [Pa].

    `law`: of :func:`.critical_plane.plane_law`.
    """
    _, _, sensitivity, curve, lives, _ = law
    if width <= 0:
        return 0.0
    parameter = interpolate(2 * log(width), curve)
    if normal > 0:
        parameter += log(1 + sensitivity * normal)
    return exp(min(interpolate(parameter, lives), 700.0))
