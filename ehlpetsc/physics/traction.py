"""Traction of the film and of dry nodes on the two solids."""

import numpy as np

from ehlpetsc.physics import rheology


def shear_stresses(case, scales, p, h, void, in_contact):
    """Shear stress in +x on the fast (upper) and the slow (lower) solid.

    In the film :func:`ehlpetsc.physics.rheology.wall_shear`, less the void fraction; at contact nodes
    ``boundary_friction * p``, + on the slow solid and - on the fast one where u1 > u2, none in pure rolling.

    Parameters
    ----------
    p, h, void : ndarray, shape (nx,)
        Pressure [Pa], film [m], void fraction.
    in_contact : ndarray of bool, shape (nx,)

    Returns
    -------
    fast, slow : ndarray, shape (nx,)
        [Pa]
    """
    sliding = scales.u1 - scales.u2
    slow = case.contact.boundary_friction * np.sign(sliding) * p
    fast = -slow
    if case.fluid is None:
        return np.where(in_contact, fast, 0.0), np.where(in_contact, slow, 0.0)
    film = np.where(in_contact, 1.0, h)
    ln_eta, _ = rheology.viscosity(p, case.fluid)
    lower, upper = rheology.wall_shear(film, np.gradient(p, scales.dx), ln_eta, case.fluid, sliding)
    left = 1.0 - void
    return np.where(in_contact, fast, -upper * left), np.where(in_contact, slow, lower * left)
