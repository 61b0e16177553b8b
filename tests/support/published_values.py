"""Published and independently computed reference values."""

from typing import NamedTuple


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

SHC_320 = {
    20: (
        [
            922.6,
            1369.7,
            1972,
            2857.4,
            4044.8,
            5789.4,
            8083,
            11000,
            15785,
            21671,
            29613,
            39985,
            53809,
            73801,
            100840,
            139600,
        ],
        [
            858.73,
            871.43,
            882.79,
            893.1,
            902.56,
            911.32,
            919.48,
            927.13,
            934.33,
            941.15,
            947.63,
            953.8,
            959.7,
            965.35,
            970.78,
            976,
        ],
    ),
    40: (
        [
            271.35,
            387.52,
            526.62,
            694.88,
            942.5,
            1237.3,
            1549,
            2004.7,
            2522.3,
            3369.3,
            4141,
            5197.9,
            6652.6,
            8395.5,
            10422,
            13379,
            16600,
        ],
        [
            846.85,
            860.57,
            872.73,
            883.68,
            893.67,
            902.88,
            911.42,
            919.41,
            926.91,
            934,
            940.71,
            947.1,
            953.2,
            959.03,
            964.63,
            970.01,
            975.19,
        ],
    ),
    80: (
        [
            54.724,
            71.161,
            89.024,
            109.85,
            131.12,
            158.51,
            190.55,
            228.95,
            277.32,
            321.07,
            368.4,
            429.02,
            515.97,
            584.24,
            704.09,
            792.17,
            907.16,
        ],
        [
            823.1,
            839.19,
            853.14,
            865.5,
            876.63,
            886.79,
            896.15,
            904.85,
            912.97,
            920.61,
            927.82,
            934.65,
            941.16,
            947.37,
            953.31,
            959.01,
            964.49,
        ],
    ),
    100: (
        [
            30.059,
            38.322,
            47.748,
            57.844,
            70.186,
            81.004,
            93.046,
            111.23,
            128.06,
            149.11,
            164.38,
            191.13,
            219.62,
            252.81,
            285.47,
            323.92,
            358.4,
        ],
        [
            811.22,
            828.7,
            843.65,
            856.78,
            868.54,
            879.21,
            888.99,
            898.06,
            906.5,
            914.42,
            921.89,
            928.96,
            935.67,
            942.07,
            948.19,
            954.06,
            959.69,
        ],
    ),
}
"""SHC 320: viscosities [mPa s] and densities [kg/m^3] at 0, 250, 500 ... bar by temperature [degrees C].

Measured by flucon for IMKT Hannover 2014; from github.com/ngocminhdao88/dao_masterarbeit,
ViscosityDataSHC320.xlsx.
"""
