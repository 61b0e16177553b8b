r"""Discrete Reynolds equation with mass-conserving cavitation and direct contact.

.. math:: F \equiv \frac{\partial \rho h(1-\theta)}{\partial t}
   + \frac{\partial}{\partial x}\Big[\rho u h(1-\theta)
   - \frac{\rho h^3 S}{12\eta}\frac{\partial p}{\partial x}\Big],
   \qquad h\ge0,\quad F\ge0,\quad hF=0

(Holmes et al. 2005, eq. (1), its sign turned; where h = 0 it is left out, eq. (11)). One unknown q a
node carries pressure and cavitation: p = max(q, 0), void fraction = max(-q, 0). Lengths in x are in
half widths, films in a^2/R, pressures in p0; F is divided by u times a film scale, so that the sum
over nodes is the relative mass imbalance.

Finite volumes, one node a cell: :mod:`ehlpetsc.discretisation.finite_volumes`.
"""

import numpy as np

from ehlpetsc.discretisation.finite_volumes import OWN, STENCIL, M, balance, extrapolated, nodal
from ehlpetsc.physics import rheology

ROUNDING = 1e-12  # pressure in p0: the ambient one of the inlet is zero give or take this


def full_of_oil(q):
    """Nodes with a pressure and no void; which side of zero rounding is on must not matter."""
    return q > -ROUNDING


class Storage:
    r"""Film contents of the previous time levels: what BDF2 needs of the past.

    Parameters
    ----------
    m, m_older : ndarray, shape (nx,)
        :math:`\rho h(1-\theta)` one and two steps ago.
    dt, dt_older : float
        Step in hand and last step, in units of a/u; `dt_older` None starts with backward Euler.
    """

    def __init__(self, m, m_older, dt, dt_older=None):
        self.m, self.dt = m, dt
        self.k = 0.0 if dt_older is None else dt / (dt + dt_older)
        self.w = m if dt_older is None else extrapolated(m, m_older, self.k * dt / dt_older)


class Reynolds:
    """Rows of the Reynolds equation for the nodes first .. last-1 of a mesh.

    Parameters
    ----------
    fluid : case.Fluid
    scales : scales.Scales
    film_scale : float
        What F is divided by, in a^2/R.
    first, last : int
        Nodes whose rows are evaluated here.
    """

    def __init__(self, fluid, scales, film_scale, first, last):
        self.fluid, self.scales, self.film_scale = fluid, scales, film_scale
        n = scales.nx
        self.local = slice(first, last)
        self.rows = slice(max(first, 1), last)
        self.has_inlet, self.has_outlet = first == 0, last == n
        self.nodes = slice(max(self.rows.start - 2, 0), min(last + 1, n))  # all that the local rows need
        self.dx = scales.x[1] - scales.x[0]
        self.inlet = None if fluid.inlet_film is None else fluid.inlet_film / scales.h
        self.columns = self._columns(np.arange(first, last), n)

    def _columns(self, rows, n):
        """Numbers of the unknowns of each local row, shape (local nodes, 8); -1: none."""
        node = rows[:, None] + np.arange(-2, 2)
        both = np.stack([2 * node, 2 * node + 1], axis=2)
        both[(node < 0) | (node >= n) | ((rows[:, None] == 0) & (node != 0))] = -1
        return both.reshape(len(rows), 2 * STENCIL).astype(np.int32)

    def mass(self, q, h):
        r"""Film content :math:`\rho h(1-\theta)` and its derivatives with respect to q and h."""
        return self._content(q, h, rheology.density(np.maximum(q, 0.0) * self.scales.p0, self.fluid))

    def _content(self, q, h, density):
        full, (rho, drho) = full_of_oil(q), density
        left = 1.0 + np.minimum(q, 0.0)
        return rho * left * h, np.where(full, drho * self.scales.p0, 1.0) * h, rho * left

    def _at(self, q, h):
        """Properties of the nodes that the local rows need."""
        q, h = q[self.nodes], h[self.nodes]
        if self.has_outlet:  # beyond the outlet: same film, no pressure
            q, h = np.append(q, 0.0), np.append(h, h[-1])
        s, p = self.scales, np.maximum(q, 0.0)
        rho, drho = density = rheology.density(p * s.p0, self.fluid)
        ln_eta, dln_eta = rheology.viscosity(p * s.p0, self.fluid)
        unit, content = 1.0 / (s.u * s.h), self._content(q, h, density)
        return nodal(
            p,
            full_of_oil(q),
            s.h * h,
            *content,
            unit * rho,
            unit * s.p0 * drho,
            np.exp(-ln_eta) / self.fluid.viscosity,
            s.p0 * dln_eta,
        )

    def evaluate(self, q, h, past):
        """Residual of the local rows and its derivatives.

        Parameters
        ----------
        q, h : ndarray, shape (nx,)
        past : Storage or None
            None: steady.

        Returns
        -------
        residual : ndarray, shape (local nodes,)
        values : ndarray, shape (local nodes, 8)
            Entries for ``columns``.
        """
        s, rows = self.scales, self.rows
        at, first = self._at(q, h), rows.start - self.nodes.start
        stress = np.inf if self.fluid.eyring_stress is None else self.fluid.eyring_stress
        law = s.p0 / (s.a * self.dx), s.h, stress, abs(s.u1 - s.u2) / stress
        then = at[M, first:], at[M, first:], 0.0, 0.0
        if past is not None:
            then = past.m[rows], past.w[rows], past.k, self.dx / past.dt
        residual = np.empty(self.local.stop - self.local.start)
        values = np.zeros((len(residual), 2 * STENCIL))
        inner = slice(int(self.has_inlet), None)
        balance(at, first, law, *then, residual[inner], values[inner])
        if self.has_outlet:
            values[-1, OWN + 1] += values[-1, OWN + 3]
        residual /= self.film_scale
        values /= self.film_scale
        if self.has_inlet:
            residual[0], values[0, OWN : OWN + 2] = self._inlet(q[0], h[0])
        return residual, values

    def _inlet(self, q, h):
        """Row 0: ambient pressure where flooded, the given oil film where starved."""
        if self.inlet is None or self.inlet >= h:
            return q, (1.0, 0.0)
        return q + 1.0 - self.inlet / h, (1.0, self.inlet / h**2)
