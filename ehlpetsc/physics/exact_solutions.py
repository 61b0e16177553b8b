"""Exact solution of the dry smooth line contact (Hertz)."""

import numpy as np


def hertz_pressure(x: np.ndarray, a: float, p0: float) -> np.ndarray:
    r"""Pressure of a dry smooth cylinder, :math:`p_0\sqrt{1-(x/a)^2}`, 0 outside (Johnson 1985, eq. 4.44).

    Parameters
    ----------
    x
        Distance from the centre [m].
    a, p0
        Half-width [m] and maximum pressure [Pa].
    """
    return p0 * np.sqrt(np.maximum(1.0 - (np.asarray(x) / a) ** 2, 0.0))


def hertz_gap(x: np.ndarray, a: float, radius: float) -> np.ndarray:
    r"""Gap outside the contact of a dry smooth cylinder [m], 0 inside.

    :math:`\frac{a^2}{2R}\left[X\sqrt{X^2-1}-\ln(X+\sqrt{X^2-1})\right]`, :math:`X=|x|/a`: the parabola
    and the deflection by the pressure of `hertz_pressure` (Johnson 1985, section 4.2).
    """
    ratio = np.maximum(np.abs(x) / a, 1.0)
    root = np.sqrt(ratio**2 - 1.0)
    return a**2 / (2.0 * radius) * (ratio * root - np.log(ratio + root))
