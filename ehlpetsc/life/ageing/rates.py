r"""Rates of wear and damage over a jump: of the round solved at its begin, and how they change.

Rates change smoothly as wear changes the surface, and at once where cells break out. Between two break-outs
they are extrapolated linearly from the last two rounds,

.. math:: f(t) = f_n + t\,\frac{f_n-f_{n-1}}{h_{n-1}},\qquad y_{n+1} = y_n + \int_0^{h_n} f\,dt

(Adams-Bashforth of two steps): the error of wear and damage falls with the square of the jumps. After a
break-out, and in the first jump of all, rates are constant.
"""

from typing import NamedTuple

import numpy as np

from ehlpetsc.life.ageing import laws

MAX_EXTRAPOLATION = 2.0  # length of a jump over the previous one, up to which rates are extrapolated


class Rates(NamedTuple):
    """Wear, damage and worn volume of a pass at the start of a jump, and their changes per pass.

    Attributes
    ----------
    wear : ndarray, shape (n,)
        [m].
    damage : ndarray, shape (cells, n)
    volume : float
        Worn off [m^2].
    slopes : tuple of (ndarray, ndarray, float)
        Changes of the three per pass; by default none.
    """

    wear: np.ndarray
    damage: np.ndarray
    volume: float
    slopes: tuple = (0.0, 0.0, 0.0)

    def continued(self, before, passes):
        """Rates with the slopes since a previous round.

        No rate falls below 0 or doubles within `MAX_EXTRAPOLATION` times as many passes.

        Parameters
        ----------
        before : (ndarray, ndarray, float)
            Rates of that round.
        passes : int
            Since it.
        """
        slopes = []
        for new, old in zip(self[:3], before, strict=True):
            bound = new / (MAX_EXTRAPOLATION * passes)
            slopes.append(np.clip((new - old) / passes, -bound, bound))
        return self._replace(slopes=tuple(slopes))

    def without(self, columns):
        """Rates without damage in some columns.

        Parameters
        ----------
        columns : ndarray of bool, shape (n,)
        """
        return self._replace(damage=np.where(columns, 0.0, self.damage))

    def after(self, passes):
        """Wear [m], damage and worn volume [m^2] of a number of passes."""
        return tuple(
            laws.sum_over(passes, rate, slope) for rate, slope in zip(self[:3], self.slopes, strict=True)
        )

    def passes_to_wear(self, depth):
        """Passes after which a depth of wear is reached [m], shape (n,)."""
        return laws.passes_to(depth, self.wear, self.slopes[0])

    def passes_to_damage(self, damage):
        """Passes after which an amount of damage is added, shape (cells, n)."""
        return laws.passes_to(damage, self.damage, self.slopes[1])
