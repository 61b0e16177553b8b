r"""Discrete Reynolds equation with mass-conserving cavitation.

.. math:: F \equiv \frac{\partial \rho h(1-\theta)}{\partial t}
   + \frac{\partial}{\partial x}\Big[\rho u h(1-\theta)
   - \frac{\rho h^3 S}{12\eta}\frac{\partial p}{\partial x}\Big] = 0

(Holmes et al. 2005, eq. (1), its sign turned), p the oil's pressure. One unknown q a node carries pressure
and cavitation: p = max(q, 0), void fraction = max(-q, 0). Lengths in x are in
half widths, films in a^2/R, pressures in p0; F is divided by u times a film scale, so that the sum
over nodes is the relative mass imbalance.

Finite volumes, one node a cell: :mod:`ehlpetsc.discretisation.finite_volumes`.
"""

import numpy as np

from ehlpetsc.discretisation.contact_model import full_of_oil
from ehlpetsc.discretisation.finite_volumes import OWN, STENCIL, M, balance, extrapolated, nodal
from ehlpetsc.discretisation.interleaving import both_of, count
from ehlpetsc.physics import rheology


class FilmHistory:
    r"""Film contents of the previous time levels: what BDF2 needs of the past.

    Parameters
    ----------
    m, m_older : ndarray, shape (nx,)
        :math:`\rho h(1-\theta)` one and two steps ago.
    dt, dt_older : float
        Step in hand and last step, in units of a/u; `dt_older` None starts with backward Euler.

    Attributes
    ----------
    k : float
        How far the extrapolation of the two levels of a step goes.
    carried : ndarray, shape (nx,)
        The extrapolation of the two older levels.
    """

    def __init__(self, m, m_older, dt, dt_older=None):
        self.m, self.dt = m, dt
        self.k = 0.0 if dt_older is None else dt / (dt + dt_older)
        self.carried = m if dt_older is None else extrapolated(m, m_older, self.k * dt / dt_older)


class Reynolds:
    """Rows of the Reynolds equation for the nodes first .. last-1 of a mesh.

    Parameters
    ----------
    scales : scales.Scales
    film_scale : float
        What F is divided by, in a^2/R.
    first, last : int
        Nodes whose rows are evaluated here.

    Attributes
    ----------
    columns : ndarray of int, shape (local nodes, 8)
        Places of the unknowns in the rows: q and h of the nodes i-2 .. i+1; -1: none.
    """

    def __init__(self, scales, film_scale, first, last):
        self.scales, self.film_scale = scales, film_scale
        n = scales.nx
        self.local = slice(first, last)
        self.rows = slice(max(first, 1), last)
        self.has_inlet, self.has_outlet = first == 0, last == n
        self.nodes = slice(max(self.rows.start - 2, 0), min(last + 1, n))  # all that the local rows need
        self.dx = scales.x[1] - scales.x[0]
        self.columns = self._columns(np.arange(first, last), n)

    def _columns(self, rows, n):
        node = rows[:, None] + np.arange(-2, 2)
        both = both_of(node)
        both[(node < 0) | (node >= n) | ((rows[:, None] == 0) & (node != 0))] = -1
        return both.reshape(len(rows), count(STENCIL)).astype(np.int32)

    def content(self, q, h, fluid):
        r"""Film content :math:`\rho h(1-\theta)` and its derivatives with respect to q and h."""
        return self._content(q, h, rheology.density(np.maximum(q, 0.0) * self.scales.p0, fluid))

    def _content(self, q, h, density):
        full, (rho, drho) = full_of_oil(q), density
        left = 1.0 + np.minimum(q, 0.0)
        return rho * left * h, np.where(full, drho * self.scales.p0, 1.0) * h, rho * left

    def _at(self, q, h, fluid):
        """Properties of the nodes that the local rows need."""
        q, h = q[self.nodes], h[self.nodes]
        if self.has_outlet:  # beyond the outlet: same film, no pressure
            q, h = np.append(q, 0.0), np.append(h, h[-1])
        s, p = self.scales, np.maximum(q, 0.0)
        rho, drho = density = rheology.density(p * s.p0, fluid)
        ln_eta, dln_eta = rheology.viscosity(p * s.p0, fluid)
        unit, content = 1.0 / (s.u * s.h), self._content(q, h, density)
        return nodal(
            p,
            full_of_oil(q),
            s.h * h,
            *content,
            unit * rho,
            unit * s.p0 * drho,
            np.exp(-ln_eta) / fluid.viscosity,
            s.p0 * dln_eta,
        )

    def evaluate(self, q, h, inputs):
        """Imbalance F of the local rows and its derivatives.

        Parameters
        ----------
        q, h : ndarray, shape (nx,)
        inputs : ehl_problem.StepInputs

        Returns
        -------
        imbalance : ndarray, shape (local nodes,)
        derivatives : ndarray, shape (local nodes, 8)
            With respect to the unknowns of `columns`, h the second one of a node.
        """
        s, rows, fluid, history = self.scales, self.rows, inputs.fluid, inputs.history
        at, first = self._at(q, h, fluid), rows.start - self.nodes.start
        eyring = np.inf if fluid.eyring_stress is None else fluid.eyring_stress
        law = s.p0 / (s.a * self.dx), s.h, eyring, abs(s.u1 - s.u2) / eyring
        then = at[M, first:], at[M, first:], 0.0, 0.0
        if history is not None:
            then = history.m[rows], history.carried[rows], history.k, self.dx / history.dt
        imbalance = np.empty(self.local.stop - self.local.start)
        derivatives = np.zeros((len(imbalance), count(STENCIL)))
        inner = slice(int(self.has_inlet), None)
        balance(at, first, law, *then, imbalance[inner], derivatives[inner])
        if self.has_outlet:
            derivatives[-1, OWN + 1] += derivatives[-1, OWN + 3]
            derivatives[-1, OWN + 2 :] = 0.0
        imbalance /= self.film_scale
        derivatives /= self.film_scale
        if self.has_inlet:
            imbalance[0], derivatives[0, OWN : OWN + 2] = _inlet(q[0], h[0], inputs.inlet_film)
        return imbalance, derivatives


def _inlet(q, h, oil_film):
    """Row 0: ambient pressure where flooded, the given oil film where starved."""
    if oil_film is None or oil_film >= h:
        return q, (1.0, 0.0)
    return q + 1.0 - oil_film / h, (1.0, oil_film / h**2)
