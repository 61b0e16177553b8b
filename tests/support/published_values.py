"""Published and independently computed reference values."""

from typing import NamedTuple

import numpy as np

from support import ROOT


class Film(NamedTuple):
    """A smooth steady film: conditions, and least and central film thickness [um]."""

    viscosity: float
    speed: float
    slide_roll_ratio: float
    h_min: float
    h_central: float


SMOOTH_FILMS = (
    Film(0.010, 5.0, 0.25, 0.22747, 0.26211),
    Film(0.005, 5.0, 0.25, 0.14216, 0.16314),
    Film(0.002, 5.0, 0.25, 0.07672, 0.08751),
    Film(0.005, 25.0, 0.10, 0.43387, 0.50144),
)
"""Table 1 contact and Eyring stress on [-4, 1.5] a: dense solutions extrapolated to zero mesh size, 0.2 %."""

SMOOTH_FILMS_BY_MESH = (
    Film(0.005, 5.0, 0.25, 0.141250, 0.161532),
    Film(0.005, 5.0, 0.25, 0.141722, 0.162430),
    Film(0.005, 5.0, 0.25, 0.141839, 0.162654),
)
"""The second of `SMOOTH_FILMS` on [-2.5, 1.5] a, on a/100, a/200 and a/400."""


class MoesPoint(NamedTuple):
    """Dimensionless films of a Newtonian, incompressible Barus fluid."""

    M: float
    L: float
    h_min: float
    h_central: float


MOES_POINTS = (MoesPoint(20.0, 10.0, 3.966, 5.262), MoesPoint(100.0, 11.0, 3.488, 4.656))
"""Computed by a dense solver."""

WAVINESS = {4.0: 0.030, 2.0: 0.073, 1.0: 0.183, 0.5: 0.394, 0.25: 0.660, 0.125: 0.839}
"""Wavelength/b -> amplitude ratio at M=100, L=11, Ai/Hc=0.1, pure rolling; Venner et al. 1997, table 1."""


class Bounds(NamedTuple):
    """A value and its uncertainty."""

    value: float
    uncertainty: float


RIDGE = {
    "film at the centre": Bounds(0.148e-6, 0.001e-6),
    "h_min": Bounds(0.1253e-6, 0.0005e-6),
    "p_max": Bounds(1.179e9, 0.002e9),
}
"""Gaussian ridge 0.1 um exp(-((X-Xc)/0.1)^2) at Xc = 0, Table 1, eta0 = 0.005, u = 5, xi = 0.25 [m, m, Pa].

It travels at 0.875 u from Xc = -2 with the load held; computed by a dense solver."""

SHC_320 = np.genfromtxt(ROOT / "tests" / "data" / "shc_320.csv", delimiter=",", names=True)
"""SHC 320: viscosities [mPa s] and densities [kg/m^3] by temperature [degrees C] and pressure [bar].

Measured by flucon for IMKT Hannover 2014; from github.com/ngocminhdao88/dao_masterarbeit,
ViscosityDataSHC320.xlsx.
"""
