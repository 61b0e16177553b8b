"""Effects of a solved pass on both bodies."""

from typing import NamedTuple

import numpy as np


class OfBody(NamedTuple):
    """Effects of a pass on a body.

    Attributes
    ----------
    s : ndarray, shape (points,)
        Abscissas in the body of the points that passed the whole contact [m].
    depths : ndarray, shape (n,)
        Below the present surface [m].
    damage : ndarray, shape (n, points)
    depth : pair of surfaces.body_field.BodyField
        Wear before and after the pass.
    """

    s: np.ndarray
    depths: np.ndarray
    damage: np.ndarray
    depth: tuple

    @property
    def volume(self):
        """Worn off [m^2]."""
        before, after = self.depth
        return after.volume - before.volume


class Pass(NamedTuple):
    """A solved pass.

    Attributes
    ----------
    bodies : pair of OfBody
    figures : dict of str to float
        Means over the time in which both surfaces fill the contact.
    plastic : effects.plastic_deformation.PlasticRecord or None
    yielded : float
        Largest depth by which a point yielded in this pass [m].
    """

    bodies: tuple
    figures: dict
    plastic: object
    yielded: float
