r"""Contact of self-affine roughness: pressure as a function of mean separation, and real area of contact.

Persson (2007, Phys. Rev. Lett. 99, 125502; arXiv:0706.2762) derives from the elastic energy of the flattened
asperities that a nominally flat rough surface carries

.. math:: p_c(h)=\beta E^*e^{-h/(\gamma\sigma)},\qquad E^*=E'/2,

at the mean separation h, :math:`\sigma` the rms height. Akarapu, Sharp and Robbins (2011, Phys. Rev. Lett.
106, 204301; arXiv:1011.1479) find the same exponential, and area and stiffness linear in the load, in
simulations with many Hurst exponents, system sizes and Poisson ratios. Lorenz and Persson (2009;
arXiv:0810.0950) measure it between rubber and a road, with a decay length of the order of the rms height.
Persson and Scaraggi (2009, J. Phys.: Condens. Matter 21, 185002) add it to the pressure of the oil in mixed
lubrication, as is done here. Of all these only the abstracts were available, of the last one that of a later
article on it (arXiv:2603.26563). They state the laws; hence no equation numbers, and other constants.

Both constants follow from :math:`p=-dU/dh` with the energy of Yang and Persson (2008, J. Phys.:
Condens. Matter 20, 215214), as Almqvist, Campana, Prodanov and Persson (2011, J. Mech. Phys. Solids 59,
2355) use it,

.. math:: U=\frac{\pi E^*}2\int q^2C(q)\,P\,[g+(1-g)P^2]\,dq,

P the relative area of contact at the wavenumber q, C the spectrum, g = 0.45; g = 1 is the letter of 2007.
Formula and range of g (0.42 to 0.45) were compared with the open source of a later study of that energy
(github.com/xylcsi/PerssonModelFudgeFactor). For spectra without roll-off, Hurst exponents 0.5 to 0.9, over
one to three decades of wavelengths (`tests/verification/test_asperities.py`), the result is
:math:`\gamma=0.44\ldots0.54`,
and :math:`\beta=(1.4\ldots2.4)\,q_0\sigma` in the limit of light load, with :math:`q_0=2\pi/L` of the
longest wave of the roughness. One law holds from the first touch to flattened asperities,

.. math:: h-h_a=\frac{\gamma\sigma}3\ln\Big[1+\Big(\frac{\beta E^*}{p_c}\Big)^3
   -\Big(\frac{\beta E^*}H\Big)^3\Big],\qquad
   p_c=\beta E^*\Big[e^{3(h-h_a)/(\gamma\sigma)}-1+\Big(\frac{\beta E^*}H\Big)^3\Big]^{-1/3}.

- Far out it is the exponential.
- Above :math:`\beta E^*` the longest waves are flattened, and little more than the film
  :math:`h-h_a\approx\gamma\sigma(\beta E^*/p_c)^3/3` between the short ones is left: 18 pm at 4 GPa for 10 nm
  below 8 um. The power 3 is a fit of ours; with :math:`\gamma=0.5` and :math:`\beta=c\,q_0\sigma` the law of
  elastic asperities is within 0.14 sigma of the theory at all pressures, c being 0.74 to 1.25 for Hurst
  exponents 0.7 to 0.9, and 1.1 to 2.1 for 0.5 (one to three decades). Hence c = 1: the slope of the longest
  wave, 0.008 for 10 nm below 8 um.
- At the hardness H the contact is full: in Persson's theory all stress is absorbed at H
  (:func:`real_area_fraction`), so that area and separation at :math:`p_c=H` are those of complete contact,
  and :math:`p_c\le H` at any gap. H is left out for elastic asperities. That the cubes subtract is a choice:
  it keeps the law explicit both ways, smooth, and elastic where :math:`p_c\ll H`.
- Between solids with an adsorbed film each, h counts both films, :math:`h_a=` `adsorbed_film` together: the
  asperities touch as bare ones would at :math:`h-h_a`, and the film does not fall below :math:`h_a`. A larger
  :math:`\beta` has the same effect at light load, as a film of :math:`\gamma\sigma\ln(\beta/\beta_{theory})`.

Range: at light load the law holds for a large contact: over few waves of the layer the stiffness
:math:`-dp_c/dh` is not linear in the pressure (abstract of Pastewka et al. 2013, Phys. Rev. E 87, 062809;
arXiv:1210.4635), up to a pressure that was not available. The separation depends on the ratio of the longest
to the shortest wave too, the real area hardly on the Hurst exponent (abstract of Prodanov, Dapp and Mueser
2014, Tribol. Lett. 53, 433).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ehlpetsc.base.case import Contact
from ehlpetsc.base.compiled import compiled

MAX_DECAYS = 30.0  # separation over the decay length beyond which the law is an exponential in all digits
MAX_RATIO = 1e10  # of prefactor to pressure up to which the law differs from it
FULL_CONTACT = 1e-3  # film of full contact at the hardness over the decay length: 5 pm, as films are positive
STIFFNESS = 1.0  # beta over the slope 2 pi sigma/L of the longest wave of the layer
GAMMA = 0.5  # decay length of the pressure over the rms height
CONTACT_PRESSURE = 10e6  # Pa: nodes whose asperities carry more count as in contact
MIN_RELATIVE_HARDNESS = 0.2  # over the width of the stresses: below it all contact is plastic
PERCOLATION, CLOSING = 0.3, 0.9  # film over rms height below which no oil passes; decay above it
OPEN = 45.0  # film over rms height from which the factor is 1 in all digits
CHANNELS = 1.33e-4  # 4 w^2: a flow factor of 1e-4 at a film of zero
KAPPA = 2.0  # real area over nominal area, times E* h'_rms over the pressure, at light load


class LayerLaw(NamedTuple):
    """Constants of the law, in one unit of length and one of pressure."""

    decay: float  # gamma sigma
    prefactor: float  # beta E*
    closed: float = 0.0  # (beta E*/H)^3, 0 for elastic asperities
    full_contact: float = 0.0  # film in full contact


def layer_law(contact: Contact, modulus: float, pressure: float = 1.0, film: float = 1.0) -> LayerLaw:
    """Law of the table [contact] for E* [Pa], in units of `pressure` [Pa] and `film` [m]."""
    prefactor, hardness = contact.asperity_stiffness * modulus, contact.asperity_hardness
    closed = 0.0 if hardness is None else (prefactor / hardness) ** 3
    decay = GAMMA * contact.asperity_height / film
    rest = 0.0 if hardness is None else FULL_CONTACT * decay
    return LayerLaw(decay, prefactor / pressure, closed, contact.adsorbed_film / film + rest)


@compiled
def asperity_pressure(
    h: float, decay: float, prefactor: float, closed: float, full_contact: float
) -> tuple[float, float]:
    """Pressure of the asperities at a film h, and its derivative; arguments as in :class:`LayerLaw`.

    Beyond full contact, at the hardness, the pressure rises steeply with what is left of `FULL_CONTACT`.
    """
    ratio = (h - full_contact) / decay
    if ratio > MAX_DECAYS:
        pressure = prefactor * math.exp(-ratio)
        return pressure, -pressure / decay
    if ratio <= 0.0 and closed > 0.0:
        power, rest = _beyond_full_contact(closed), 1.0 + ratio / FULL_CONTACT
        pressure = prefactor * closed ** (-1.0 / 3.0) * rest**-power
        return pressure, -power * pressure / (rest * FULL_CONTACT * decay)
    flattened = math.expm1(3.0 * ratio)
    rest = flattened + closed
    pressure = prefactor * rest ** (-1.0 / 3.0)
    return pressure, -pressure * (1.0 + flattened) / (rest * decay)


@compiled
def flow_factor(h: float, height: float) -> tuple[float, float]:
    r"""Factor of the pressure flow through the layer, which percolates, and its derivative by the film h.

    .. math:: \phi=1-e^{-0.9g},\qquad g=\tfrac12\Big[y+\sqrt{y^2+4w^2}\Big],\qquad y=h/\sigma-0.3.

    No oil passes below 0.3 :math:`\sigma`, where contact closes the channels; w leaves 1e-4 at film zero.
    Within 0.035 of the flow computed through isotropic elastic roughness, Hurst exponent 0.8: .852, .794,
    .661, .441, .019 and 0 at 2.39, 1.96, 1.42, .88, .337 and .118 :math:`\sigma`. The shear flow has
    none, its factor being zero for surfaces of equal roughness.
    """
    above = h / height - PERCOLATION
    if above > OPEN:
        return 1.0, 0.0
    root = math.sqrt(above * above + CHANNELS)
    passing = 0.5 * (above + root)
    closed = math.exp(-CLOSING * passing)
    return 1.0 - closed, CLOSING * closed * passing / (root * height)


@compiled
def _beyond_full_contact(closed: float) -> float:
    """Exponent of the pressure over the rest of the film: slope of the law, or at least a tenth."""
    return max(FULL_CONTACT / closed, 0.1)


@compiled
def asperity_separation(
    pressure: float, decay: float, prefactor: float, closed: float, full_contact: float
) -> float:
    """Film at which asperities carry a positive pressure: the inverse of :func:`asperity_pressure`."""
    ratio = prefactor / pressure
    if ratio > MAX_RATIO:
        return full_contact + decay * math.log(ratio)
    cube = ratio * ratio * ratio
    if cube < closed:
        hardness = prefactor * closed ** (-1.0 / 3.0)
        rest = (hardness / pressure) ** (1.0 / _beyond_full_contact(closed))
        return full_contact + decay * FULL_CONTACT * (rest - 1.0)
    return full_contact + decay / 3.0 * math.log1p(cube - closed)


def asperity_pressures(h: np.ndarray, law: tuple) -> tuple[np.ndarray, np.ndarray]:
    """Arrays of :func:`asperity_pressure`, of the shape of h."""
    pressure, derivative = _pressures(np.ravel(h), tuple(law))
    return pressure.reshape(np.shape(h)), derivative.reshape(np.shape(h))


@compiled
def _pressures(h: np.ndarray, law: tuple) -> tuple[np.ndarray, np.ndarray]:
    pressure, derivative = np.empty(len(h)), np.empty(len(h))
    for i in range(len(h)):
        pressure[i], derivative[i] = asperity_pressure(h[i], *law)
    return pressure, derivative


def asperity_separations(pressure: np.ndarray, law: tuple) -> np.ndarray:
    """Array of :func:`asperity_separation`, of the shape of the pressure."""
    return _separations(np.ravel(pressure), tuple(law)).reshape(np.shape(pressure))


@compiled
def _separations(pressure: np.ndarray, law: tuple) -> np.ndarray:
    h = np.empty(len(pressure))
    for i in range(len(h)):
        h[i] = asperity_separation(pressure[i], *law)
    return h


def asperity_stiffness(height: float, longest_wave: float) -> float:
    """beta of a layer of this rms height and longest wave, both in m."""
    return STIFFNESS * 2.0 * math.pi * height / longest_wave


def real_area_fraction(pressure: np.ndarray, slope_modulus: float, hardness: float = np.inf) -> np.ndarray:
    r"""Real over nominal area of contact of asperities whose pressure is at most the hardness H.

    Persson's theory (2001, J. Chem. Phys. 115, 3840) makes the stress at growing magnification a diffusion
    from p with absorption at 0, where the solids are apart, and at H, where they flow,

    .. math:: \frac A{A_0}=1-\sum_{k=0}^\infty\Big[\mathrm{erfc}\frac{2kH+p}w
       -\mathrm{erfc}\frac{2(k+1)H-p}w\Big],\qquad w=\frac{2E^*h'_{rms}}{\sqrt\pi\,\kappa}:

    :math:`\mathrm{erf}(p/w)` of elastic asperities, p/H of steep ones, and complete contact at p = H. There
    :math:`\kappa=\sqrt{8/\pi}=1.6`; simulations give about 2 at light load (Hyun, Pei, Molinari & Robbins
    2004, Phys. Rev. E 70, 026117), the value used here.

    Parameters
    ----------
    pressure
    slope_modulus
        :math:`E^*h'_{rms}` in the unit of the pressure, h'_rms the rms slope of the roughness.
    hardness
        In the unit of the pressure.
    """
    from scipy.special import erf, erfc

    width = 2.0 * slope_modulus / (math.sqrt(math.pi) * KAPPA)
    if hardness == np.inf:
        return erf(pressure / width)
    if hardness < MIN_RELATIVE_HARDNESS * width:
        return np.minimum(pressure / hardness, 1.0)
    apart = np.zeros_like(pressure)
    for k in range(math.ceil(3.0 * width / hardness) + 1):  # beyond six widths erfc vanishes
        apart += erfc((2.0 * k * hardness + pressure) / width)
        apart -= erfc((2.0 * (k + 1.0) * hardness - pressure) / width)
    return np.where(pressure < hardness, 1.0 - apart, 1.0)
