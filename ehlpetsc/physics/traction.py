"""Traction of the film and of solids that touch on the two solids."""

import numpy as np

from ehlpetsc.physics import rheology


def shear_stresses(case, dx, sliding, oil, solids, h, void, touching):
    """Shear stress in +x on the fast (upper) and the slow (lower) solid.

    In the film :func:`ehlpetsc.physics.rheology.wall_shear` under the oil's pressure, less the void fraction;
    where solids touch ``boundary_friction * solids``, + on the slow solid and - on the fast one
    where u1 > u2, none in pure rolling. In mixed contact both act side by side, in direct contact solids
    leave no film.

    Parameters
    ----------
    case : case.loading.Case
    dx : float
        Spacing of the nodes [m].
    sliding : float
        u1 - u2 [m/s].
    oil, solids : ndarray, shape (nx,)
        Pressures [Pa].
    h, void : ndarray, shape (nx,)
        Film [m], void fraction.
    touching : ndarray of bool, shape (nx,)

    Returns
    -------
    fast, slow : ndarray, shape (nx,)
        [Pa]
    """
    slow = np.where(touching, case.contact.boundary_friction * np.sign(sliding) * solids, 0.0)
    fast = -slow
    if case.fluid is None:
        return fast, slow
    without = touching & (case.contact.model == "direct")
    ln_eta, _ = rheology.viscosity(oil, case.fluid)
    film = np.where(without, 1.0, h)
    lower, upper = rheology.wall_shear(film, np.gradient(oil, dx), ln_eta, case.fluid, sliding)
    left = np.where(without, 0.0, 1.0 - void)
    return fast - upper * left, slow + lower * left
