"""Unknowns of the banded preconditioner.

The kernel of the deflection reaches far, the second difference of the film does not: a band stays narrow if
the pressure is the first unknown of every node. A contact model therefore writes its derivatives in a pair of
its own choice (`ContactModel.band_entries`) and translates the solution back (`ContactModel.from_band`).
"""

from typing import NamedTuple

import numpy as np

from ehlpetsc.compiled import compiled


class BandEntries(NamedTuple):
    """Derivatives of a state in the unknowns of the band.

    Attributes
    ----------
    p_first, separation_first, separation_second : ndarray
        Of the pressure by the first, of the separation by both unknowns of each node of the window.
    reynolds_derivatives : ndarray, shape (local nodes, 8)
        Of the local Reynolds rows by both unknowns of the nodes i-2 .. i+1.
    """

    p_first: np.ndarray
    separation_first: np.ndarray
    separation_second: np.ndarray
    reynolds_derivatives: np.ndarray


@compiled
def same_deflection(pressure, depth, film, old_pressure, old_depth, old_film):
    """Whether the deflection rows of two states have the same entries."""
    for i in range(len(pressure)):
        if pressure[i] != old_pressure[i] or depth[i] != old_depth[i] or film[i] != old_film[i]:
            return False
    return True
