"""Traction on both surfaces: shear of the film and friction of the solids."""

from typing import Any

import numpy as np

from ehlpetsc.physics.laws import viscosity
from ehlpetsc.physics.rheology import wall_shear


def shear_stresses(
    fluid: Any,
    solids: np.ndarray,
    dx: float,
    sliding: float,
    oil: np.ndarray,
    h: np.ndarray,
    sheared: np.ndarray,
    mean: np.ndarray | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """Shear stress [Pa] in +x on surfaces 1 (upper) and 2 (lower).

    In the film :func:`ehlpetsc.physics.rheology.wall_shear` under the oil's pressure, times the fraction of
    the gap in which oil is sheared; between the solids their friction, + on surface 2 and - on surface 1
    where u1 > u2, none in pure rolling. Where both act, they are added: a boundary film of some nanometres is
    then sheared with the bulk viscosity, which overestimates its shear stress.

    Parameters
    ----------
    fluid
        None: dry.
    solids
        Friction between the solids [Pa], 0 out of contact.
    dx
        Spacing of the nodes [m].
    sliding
        u1 - u2 [m/s].
    oil
        Pressure of the oil [Pa].
    h
        Film [m].
    sheared
        Fraction of the gap in which oil is sheared: 1 less the void fraction, 0 without a film.
    mean
        Mean shear stress of the film [Pa], not negative; None: isothermal.
    """
    shear_2 = np.sign(sliding) * solids
    shear_1 = -shear_2
    if fluid is None:
        return shear_1, shear_2
    film, gradient = np.where(sheared > 0.0, h, 1.0), np.gradient(oil, dx)
    if mean is None:
        lower, upper = wall_shear(film, gradient, viscosity(oil, fluid)[0], fluid, sliding, oil)
    else:
        lower, upper = (np.sign(sliding) * mean + sign * 0.5 * film * gradient for sign in (-1.0, 1.0))
    return shear_1 - upper * sheared, shear_2 + lower * sheared
