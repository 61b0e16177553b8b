"""Unknowns of the banded preconditioner.

The kernel of the deflection reaches far, the second difference of the film does not: a band stays narrow if
the pressure is the first unknown of every node. A contact model therefore writes its derivatives in a pair of
its own choice (`ContactModel.band_entries`) and translates the solution back (`ContactModel.from_band`).
"""

from typing import NamedTuple

import numpy as np


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

    def same_deflection(self, other):
        """Whether the deflection rows of another state are the same."""
        return all((one == two).all() for one, two in zip(self[:3], other[:3], strict=True))
