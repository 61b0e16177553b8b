"""Traction on both surfaces: shear of the film and friction of the solids."""

import numpy as np

from ehlpetsc.physics.laws import viscosity
from ehlpetsc.physics.rheology import wall_shear


def shear_stresses(case, dx, sliding, oil, solids, h, sheared, ln_eta=None):
    """Shear stress in +x on surfaces 1 (upper) and 2 (lower).

    In the film :func:`ehlpetsc.physics.rheology.wall_shear` under the oil's pressure, times the fraction of
    the gap in which oil is sheared; between the solids ``boundary_friction * solids``, + on surface 2
    and - on surface 1 where u1 > u2, none in pure rolling. Where both act, they are added: a boundary film
    of some nanometres is then sheared with the bulk viscosity, which overestimates its shear stress.

    Parameters
    ----------
    case : case.loading.Case
    dx : float
        Spacing of the nodes [m].
    sliding : float
        u1 - u2 [m/s].
    oil, solids : ndarray, shape (nx,)
        Pressure of the oil; pressure of the friction between the solids, 0 out of contact [Pa].
    h : ndarray, shape (nx,)
        Film [m].
    sheared : ndarray, shape (nx,)
        Fraction of the gap in which oil is sheared: 1 less the void fraction, 0 without a film.
    ln_eta : ndarray, shape (nx,), optional
        ln(eta/eta0); by default of the isothermal law.

    Returns
    -------
    shear_1, shear_2 : ndarray, shape (nx,)
        [Pa]
    """
    shear_2 = case.contact.boundary_friction * np.sign(sliding) * solids
    shear_1 = -shear_2
    if case.fluid is None:
        return shear_1, shear_2
    if ln_eta is None:
        ln_eta, _ = viscosity(oil, case.fluid)
    film = np.where(sheared > 0.0, h, 1.0)
    lower, upper = wall_shear(film, np.gradient(oil, dx), ln_eta, case.fluid, sliding, oil)
    return shear_1 - upper * sheared, shear_2 + lower * sheared
