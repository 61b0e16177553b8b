"""Rows of a contact without oil, in place of the Reynolds equation: the Reynolds unknown vanishes.

In direct contact q is then the pressure of the solids, complementary to the gap; in mixed contact, whose
solids have a pressure of their own, q = 0.
"""

import numpy as np

from ehlpetsc.discretisation.finite_volumes import OWN, STENCIL
from ehlpetsc.discretisation.unknowns import dofs_of, n_dofs


class NoOil:
    """Rows of the nodes first .. last-1; interface of :class:`.reynolds.Reynolds`.

    Parameters
    ----------
    first, last : int
    start : int
        First node of the arrays that are passed in.
    """

    def __init__(self, first, last, start=0):
        self.owned, local = slice(first - start, last - start), last - first
        self.columns = np.full((local, n_dofs(STENCIL)), -1, dtype=np.int32)
        self.columns[:, OWN : OWN + 2] = dofs_of(np.arange(first, last, dtype=np.int32))
        self._derivatives = np.zeros((local, n_dofs(STENCIL)))
        self._derivatives[:, OWN] = 1.0

    def mass_per_area(self, q, h, fluid):
        """Return None: there is no oil."""
        return None

    def evaluate(self, q, h, inputs):
        """See :meth:`.reynolds.Reynolds.evaluate`."""
        return q[self.owned], self._derivatives
