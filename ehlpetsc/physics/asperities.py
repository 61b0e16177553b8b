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
and :math:`\beta=(1.4\ldots2.4)\,q_0\sigma` in the limit of light load or :math:`(1.0\ldots1.7)\,q_0\sigma`
where :math:`0.5\sigma<h<3\sigma`, with :math:`q_0=2\pi/\lambda` of the longest wave of the roughness. Hence
:math:`\beta` is of the order of the slope of that wave: 0.008 to 0.02 for 10 nm below 8 um. A larger
:math:`\beta` measures the film from a plane lower by :math:`\gamma\sigma\ln(\beta/\beta_{theory})`, as
an adsorbed film of that thickness would: 20 to 24 nm for :math:`\beta=1` in this example.

Range: elastic asperities, :math:`p_c` below about :math:`\beta E^*/e`, where :math:`h>\gamma\sigma`. Thinner
films have the continuation :math:`p_c=\beta E^*\gamma\sigma/(e\,h)` with the same slope, which keeps h
positive. At light load the law holds for a large contact: over few waves of the layer the stiffness
:math:`-dp_c/dh` is not linear in the pressure (abstract of Pastewka et al. 2013, Phys. Rev. E 87, 062809;
arXiv:1210.4635), up to a pressure that was not available. The separation depends on the ratio of the longest
to the shortest wave too, the real area hardly on the Hurst exponent (abstract of Prodanov, Dapp and Mueser
2014, Tribol. Lett. 53, 433).
"""

import math

import numpy as np

from ehlpetsc.compiled import compiled

GAMMA = 0.5  # decay length of the pressure over the rms height
CONTACT_PRESSURE = 10e6  # Pa: nodes whose asperities carry more count as in contact
KAPPA = 2.0  # real area over nominal area, times E* h'_rms over the pressure, at light load


@compiled
def asperity_pressure(h: float, decay: float, prefactor: float) -> tuple[float, float]:
    r"""Pressure of the asperities at a separation, and its derivative.

    Parameters
    ----------
    h
        Mean separation, positive.
    decay
        :math:`\gamma\sigma` in the unit of h.
    prefactor
        :math:`\beta E^*`.

    Returns
    -------
    pressure, derivative : float
        In the unit of `prefactor`, and in this unit per unit of h.
    """
    if h >= decay:
        pressure = prefactor * math.exp(-h / decay)
        return pressure, -pressure / decay
    pressure = prefactor * math.exp(-1.0) * decay / h
    return pressure, -pressure / h


@compiled
def asperity_separation(pressure: float, decay: float, prefactor: float) -> float:
    """Separation at which asperities carry a positive pressure: the inverse of :func:`asperity_pressure`."""
    if pressure <= prefactor * math.exp(-1.0):
        return decay * math.log(prefactor / pressure)
    return prefactor * math.exp(-1.0) * decay / pressure


def asperity_pressures(h: np.ndarray, decay: float, prefactor: float) -> tuple[np.ndarray, np.ndarray]:
    """Arrays of :func:`asperity_pressure`, of the shape of h."""
    pressure, derivative = _pressures(np.ravel(h), decay, prefactor)
    return pressure.reshape(np.shape(h)), derivative.reshape(np.shape(h))


@compiled
def _pressures(h: np.ndarray, decay: float, prefactor: float) -> tuple[np.ndarray, np.ndarray]:
    pressure, derivative = np.empty(len(h)), np.empty(len(h))
    for i in range(len(h)):
        pressure[i], derivative[i] = asperity_pressure(h[i], decay, prefactor)
    return pressure, derivative


def asperity_separations(pressure: np.ndarray, decay: float, prefactor: float) -> np.ndarray:
    """Array of :func:`asperity_separation`, of the shape of the pressure."""
    return _separations(np.ravel(pressure), decay, prefactor).reshape(np.shape(pressure))


@compiled
def _separations(pressure: np.ndarray, decay: float, prefactor: float) -> np.ndarray:
    h = np.empty(len(pressure))
    for i in range(len(h)):
        h[i] = asperity_separation(pressure[i], decay, prefactor)
    return h


def real_area_fraction(pressure: np.ndarray, slope_modulus: float) -> np.ndarray:
    r"""Real over nominal area of contact, :math:`A/A_0=\mathrm{erf}\left(\frac{\sqrt\pi}{2}
    \frac{\kappa p}{E^*h'_{rms}}\right)`.

    Persson's law (2001, J. Chem. Phys. 115, 3840) has this form with :math:`\kappa=\sqrt{8/\pi}=1.6`;
    simulations give :math:`\kappa` about 2 at light load (Hyun, Pei, Molinari & Robbins 2004, Phys. Rev. E
    70, 026117), the value used here.

    Parameters
    ----------
    slope_modulus
        :math:`E^*h'_{rms}` in the unit of the pressure, h'_rms the rms slope of the roughness.
    """
    argument = 0.5 * math.sqrt(math.pi) * KAPPA / slope_modulus * np.asarray(pressure, dtype=float)
    return np.array([math.erf(value) for value in argument])
