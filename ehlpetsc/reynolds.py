r"""Discrete Reynolds equation with mass-conserving cavitation and direct contact.

.. math:: F \equiv \frac{\partial \rho h(1-\theta)}{\partial t}
   + \frac{\partial}{\partial x}\Big[\rho u h(1-\theta)
   - \frac{\rho h^3 S}{12\eta}\frac{\partial p}{\partial x}\Big],
   \qquad h\ge0,\quad F\ge0,\quad hF=0

(Holmes et al. 2005, eq. (1), its sign turned; where h = 0 it is left out, eq. (11)). One unknown q a
node carries pressure and cavitation: p = max(q, 0), void fraction = max(-q, 0). Lengths in x are in
half widths, films in a^2/R, pressures in p0; F is divided by u times a film scale, so that the sum
over nodes is the relative mass imbalance.

Finite volumes, one node a cell. The Couette flux and the storage are second-order upwind (BDF2 in
time), both by :func:`positive_extrapolation`: second order where the film is resolved, and never
a negative outflow, so that no node is emptied by the scheme itself. The pressure flow through a face takes
the mean of both nodes' :math:`\rho h^3S/(12\eta)`, as central differences do. With the viscosity at the
mean pressure instead, the flow out of a node would fall again when its pressure exceeds its neighbour's by
more than about 2/alpha: a fold, at which Newton's method cycles, and which asperities two nodes wide reach.
"""
import numpy as np

from ehlpetsc import rheology

STENCIL = 4  # nodes i-2 .. i+1 in row i
OWN = 4  # place of q_i in a row, before h_i


def positive_extrapolation(m, behind, k):
    r"""Extrapolate m from the values at `behind` and here, kept positive for m > 0.

    :math:`\max[m+k(m-m_b),\ m/2]`. Plain extrapolation of a film that goes to zero is negative, which empties
    the next cell and starts a cascade of false contacts. At m = 0 the slope is a half and not zero: a node
    that is to leave contact must feel its film, or Newton's method stalls there at any time step.

    Returns
    -------
    value, d_m, d_behind : ndarray
    """
    y = m + k * (m - behind)
    limited = y < 0.5 * m
    value = np.where(limited, 0.5 * m, y)
    d_m = np.where(limited, 0.5, 1.0 + k)
    d_behind = np.where(limited, 0.0, -k)
    return value, d_m, d_behind


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
        self.w = m if dt_older is None else positive_extrapolation(m, m_older, self.k * dt / dt_older)[0]


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
        self.rows = np.arange(max(first, 1), last)
        self.has_inlet, self.has_outlet = first == 0, last == n
        self.dx = scales.x[1] - scales.x[0]
        j = np.arange(self.rows[0] - 1, self.rows[-1] + 1)  # face j lies between nodes j and j+1
        self.nodes = slice(max(j[0] - 1, 0), min(last + 1, n))  # all that the local rows need
        j = j - self.nodes.start
        self.behind, self.sides = np.maximum(j - 1, 0), np.array([j, j + 1])
        self.second_order = np.where(j >= 1, 0.5, 0.0)
        self.here = slice(j[1], j[-1] + 1)  # the rows' own nodes among them
        self.sliding = scales.u1 - scales.u2
        self.inlet = None if fluid.inlet_film is None else fluid.inlet_film / scales.h
        self.columns = self._columns(n)

    def _columns(self, n):
        node = self.rows[:, None] + np.arange(-2, 2)
        node = np.where((node < 0) | (node >= n), -1, node)
        both = np.stack([np.where(node < 0, -1, 2 * node), np.where(node < 0, -1, 2 * node + 1)], axis=2)
        return both.reshape(len(self.rows), 2 * STENCIL).astype(np.int32)

    def mass(self, q, h):
        r"""Film content :math:`\rho h(1-\theta)` and its derivatives with respect to q and h."""
        return self._content(q, h, rheology.density(np.maximum(q, 0.0) * self.scales.p0, self.fluid))

    def _content(self, q, h, density):
        full, (rho, drho) = q > 0.0, density
        left = np.where(full, 1.0, 1.0 + q)
        return rho * left * h, np.where(full, drho * self.scales.p0, 1.0) * h, rho * left

    def _faces(self, q, h):
        """Mass flux through each face and its derivatives, (q, h) x (behind, left, right); film contents."""
        if self.has_outlet:  # beyond the outlet: same film, no pressure
            q, h = np.append(q, 0.0), np.append(h, h[-1])
        p, dp = np.maximum(q, 0.0), (q > 0.0) * 1.0
        density = rheology.density(p * self.scales.p0, self.fluid)
        m, m_q, m_h = mass = self._content(q, h, density)
        b, le, r = self.behind, *self.sides
        flux, by_left, by_behind = positive_extrapolation(m[le], m[b], self.second_order)
        per_length = self.scales.p0 / (self.scales.a * self.dx)
        slope = per_length * (p[r] - p[le])
        value, by_p, by_h, by_slope = self._conductance(p, h, slope, density)
        mean = 0.5 * (value[0] + value[1])
        flux = flux - mean * slope
        by_slope = (mean + 0.5 * (by_slope[0] + by_slope[1]) * slope) * per_length
        by_p, by_h = -0.5 * slope * by_p, -0.5 * slope * by_h
        if self.has_outlet:
            by_h[0, -1] += by_h[1, -1]
        return flux, (
            by_behind * m_q[b], by_behind * m_h[b],
            by_left * m_q[le] + (by_p[0] + by_slope) * dp[le], by_left * m_h[le] + by_h[0],
            (by_p[1] - by_slope) * dp[r], by_h[1],
        ), mass

    def _conductance(self, p, h, slope, density):
        r"""Mass flow per pressure gradient :math:`\rho h^3S/(12\eta)` of the nodes on both sides of faces.

        Returns value and derivatives with respect to p, h and slope, shape (2, faces).
        """
        s, sides, (rho, drho) = self.scales, self.sides, density
        ln_eta, dln_eta = rheology.viscosity(s.p0 * p, self.fluid)
        mob, mob_h, mob_slope, mob_eta = rheology.mobility(
            s.h * h[sides], slope, ln_eta[sides], self.fluid, self.sliding)
        unit = 1.0 / (s.u * s.h)
        carried = (unit * rho)[sides]
        by_p = (unit * s.p0 * drho)[sides] * mob + (s.p0 * dln_eta)[sides] * carried * mob_eta
        return carried * mob, by_p, s.h * carried * mob_h, carried * mob_slope

    def evaluate(self, q, h, past):
        """Residual of the local rows and its derivatives.

        Parameters
        ----------
        q, h : ndarray, shape (nx,)
        past : Storage or None
            None: steady.

        Returns
        -------
        residual : ndarray, shape (last-first,)
        values : ndarray, shape (number of rows but the inlet's, 8)
            Entries for ``columns``.
        inlet : tuple of float or None
            d(row 0)/dq and d/dh where node 0 is local.
        """
        flux, d, (m, m_q, m_h) = self._faces(q[self.nodes], h[self.nodes])
        rows, here = self.rows, self.here
        residual = np.diff(flux)
        values = np.zeros((len(rows), 2 * STENCIL))
        for side in (0, 1):  # q, then h
            values[:, 0 + side] = -d[0 + side][:-1]
            values[:, 2 + side] = d[0 + side][1:] - d[2 + side][:-1]
            values[:, 4 + side] = d[2 + side][1:] - d[4 + side][:-1]
            values[:, 6 + side] = d[4 + side][1:]
        if past is not None:
            stored, d_m, _ = positive_extrapolation(m[here], past.m[rows], past.k)
            residual += (stored - past.w[rows]) * (self.dx / past.dt)
            values[:, 4] += d_m * m_q[here] * (self.dx / past.dt)
            values[:, 5] += d_m * m_h[here] * (self.dx / past.dt)
        residual /= self.film_scale
        values /= self.film_scale
        if not self.has_inlet:
            return residual, values, None
        head, inlet = self._inlet(q[0], h[0])
        return np.concatenate([[head], residual]), values, inlet

    def _inlet(self, q, h):
        """Row 0: ambient pressure where flooded, the given oil film where starved."""
        if self.inlet is None or self.inlet >= h:
            return q, (1.0, 0.0)
        return q + 1.0 - self.inlet / h, (1.0, self.inlet / h**2)
