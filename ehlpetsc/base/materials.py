r"""Steels and oils by name: elastic constants, hardness, fatigue constants and the pressure a steel bears.

A case names one steel for both solids or one for each (``contact.material``); the fatigue constants and the
pressure at which solids yield then belong to the same steel. Constants that tests have given are quoted; for
the others those of Roessle and Fatemi (2000), Int. J. Fatigue 22, 495, from the Brinell hardness HB of 150 to
700, an estimate that tests of the very steel replace:

.. math::
    \sigma_f' = (4.25\,HB + 225)\ \mathrm{MPa}, \quad
    \varepsilon_f' = \frac{0.32\,HB^2 - 487\,HB + 191000}{E/\mathrm{MPa}}, \quad b = -0.09, \quad c = -0.56

with :math:`n'=b/c` and :math:`K'=\sigma_f'/\varepsilon_f'^{n'}`, so that both curves agree. The estimates
are checked against a published application of the method to another steel (Metals 15 (2025) 780, table of
the Roessle-Fatemi method); the original article itself was not available.

Hardnesses are nominal, of the condition beside the name of a steel, and from data sheets that quote
the standards, not from these: EN 10084 for 16MnCr5 (Akrostal: at least 60 HRC carburised, quenched and
tempered), EN ISO 683-17 for 100Cr6 (Lucefin: 62 HRC tempered at 250 C, 59 HRC at 300 C), DIN 50150 for
42CrMo4 (995 MPa: 310 HV, 295 HB, 31 HRC). SAE4340 has none: the paper that gives its constants does not give
its hardness, and no formula here needs it. Steels without tests and hardness are left out.

Oils are mineral ones of a viscosity index of 95 to 100, with figures typical of the data sheets of gear and
hydraulic oils of their ISO VG class: kinematic viscosities at 40 and 100 degrees C, density at 15 degrees C.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import pi, sqrt

MEAN_STRESSES = ("none", "morrow", "goodman", "gerber", "swt", "walker")  # corrections
PLASTIC_STRAIN = 0.002  # that defines the cyclic yield strength
FLOW_FACTOR = (2 + pi) / sqrt(3)  # 2.97
HRC_60 = 654  # HB of 60 HRC, ASTM E140
ISO_MODULUS = 206e9  # Pa, ISO 6336-2
FATIGUE_KEYS = ("fatigue_strength", "fatigue_ductility", "b", "c", "cyclic_hardening", "cyclic_strength")


@dataclass(frozen=True)
class Steel:
    """Elastic, strain-life (sigma_f' [Pa], eps_f', b, c) and cyclic (n') constants of a steel, SI units."""

    youngs_modulus: float
    poisson_ratio: float
    fatigue_strength: float
    fatigue_ductility: float
    b: float
    c: float
    cyclic_hardening: float


def flow_pressure(strength: float, hardening: float) -> float:
    r"""Mean pressure [Pa] under which a half plane flows: :math:`(2+\pi)\,Y/\sqrt3 = 2.97\,Y`.

    Prandtl's slip lines with von Mises' shear yield stress (Johnson (1985), Contact Mechanics, section 6.2),
    :math:`Y=K'\,0.002^{n'}` the cyclic yield stress at 0.2 % plastic strain, of K' [Pa] and n'.
    """
    return FLOW_FACTOR * strength * PLASTIC_STRAIN**hardening


def steel_of_hardness(hardness: float, youngs_modulus: float, poisson_ratio: float = 0.3) -> Steel:
    """Steel with the constants of Roessle and Fatemi (2000), of a Brinell hardness of 150 to 700 HB."""
    if not 150 <= hardness <= 700:
        raise ValueError(f"hardness = {hardness:g} HB: allowed: 150 to 700")
    ductility = (0.32 * hardness**2 - 487 * hardness + 191000) / (1e-6 * youngs_modulus)
    strength = 1e6 * (4.25 * hardness + 225)
    return Steel(youngs_modulus, poisson_ratio, strength, ductility, -0.09, -0.56, 0.09 / 0.56)


STEELS = {
    "16MnCr5": steel_of_hardness(HRC_60, ISO_MODULUS),  # case-hardened surface, nominally 60 HRC
    "100Cr6": steel_of_hardness(HRC_60, 207e9),  # hardened, tempered at 250 to 300 C, nominally 60 HRC
    "42CrMo4": steel_of_hardness(295, ISO_MODULUS),  # quenched, tempered to 1000 MPa, nominally 295 HB
    # Holmes, Qiao, Evans and Snidle (2005), Table 1; n' of the paper, K' from both curves
    "SAE4340": Steel(207e9, 0.3, 2.0e9, 0.48, -0.091, -0.60, 0.15),
}
DEFAULT = "SAE4340"


@dataclass(frozen=True)
class Grade:
    """Oil of an ISO VG class: kinematic viscosities at 40 and 100 C [m^2/s], density at 15 C [kg/m^3]."""

    v40: float
    v100: float
    density: float

    def density_at(self, temperature: float) -> float:
        """Density [kg/m^3] at a temperature [K]."""
        return self.density * (1.0 - OIL_EXPANSION * (temperature - 288.15))


OIL_EXPANSION = 7e-4  # 1/K, of mineral oils
GRADES = {
    "ISO VG 32": Grade(32e-6, 5.4e-6, 875.0),
    "ISO VG 46": Grade(46e-6, 6.7e-6, 879.0),
    "ISO VG 68": Grade(68e-6, 8.7e-6, 887.0),
    "ISO VG 100": Grade(100e-6, 11.4e-6, 891.0),
    "ISO VG 150": Grade(150e-6, 15.0e-6, 897.0),
    "ISO VG 220": Grade(220e-6, 19.4e-6, 899.0),
    "ISO VG 320": Grade(320e-6, 25.0e-6, 903.0),
    "ISO VG 460": Grade(460e-6, 30.8e-6, 904.0),
}


def named_steels(material: str | list[str] | tuple[str, str] | None) -> tuple[Steel, Steel]:
    """Steel of each surface by ``contact.material``, by default the default steel; KeyError: unknown."""
    first, second = [material or DEFAULT] * 2 if material is None or isinstance(material, str) else material
    return STEELS[first], STEELS[second]


def fatigue_constants(steel: Steel, post: Mapping[str, float]) -> dict[str, float]:
    """Fatigue constants of a steel by key, overridden by `[post]`; K' follows unless `[post]` has it."""
    constants = {key: getattr(steel, key) for key in FATIGUE_KEYS if key != "cyclic_strength"}
    constants |= {key: post[key] for key in FATIGUE_KEYS if post.get(key) is not None}
    cyclic = constants["fatigue_strength"] / constants["fatigue_ductility"] ** constants["cyclic_hardening"]
    return {"cyclic_strength": cyclic} | constants
