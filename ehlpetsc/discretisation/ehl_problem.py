r"""The discrete contact problem: one interleaved system for q, h and the approach h00.

Unknowns (q_0, h_0, q_1, h_1, ..., h00); rows in the same places, as SNESVI pairs row with unknown:

* in q's place the deflection in second differences,
  :math:`\frac{\pi}{\Delta x}(\delta^2h-\Delta x^2-\delta^2\phi)-\sum_kf_kp_{i+k}=0`
  (Holmes et al. 2005, eq. (2)); at the two end nodes the whole integral with h00;
* in h's place Reynolds, :class:`ehlpetsc.discretisation.reynolds.Reynolds`, or p itself in a dry
  contact, both complementary to the bound h >= 0;
* last the load, :math:`\sum p\,\Delta x=\pi/2`.

The matrix holds the near field of the deflection, the residual and the operator of the Krylov method
the whole of it.
"""

import numpy as np

from ehlpetsc.discretisation import elasticity
from ehlpetsc.discretisation.finite_volumes import OWN, STENCIL
from ehlpetsc.discretisation.reynolds import Reynolds, full_of_oil

LEAK = 1e-3  # of dp/dq at cavitated nodes, in the preconditioner alone: a pivot that is never zero


class ContactProblem:
    """Residual and Jacobian rows of the nodes first .. last-1.

    Parameters
    ----------
    case : case.Case
    scales : scales.Scales
    film_scale : float
        Expected film in a^2/R.
    first, last : int
        Local nodes; the rank that owns the last one owns the load row.

    Attributes
    ----------
    gap : ndarray, shape (nx,)
        What the roughness adds to the gap, in a^2/R; set before each solve.
    ends : list of int
        Local ones of the two end nodes.
    past : reynolds.Storage or None
        Previous time levels; None: steady.
    flow_columns, flow_values : ndarray, shape (local nodes, 8)
        Entries of the flow rows of the last residual: q and h of the nodes i-2 .. i+1; column -1: none.
    """

    def __init__(self, case, scales, film_scale, first, last):
        self.n, self.x = scales.nx, scales.x
        self.dx = self.x[1] - self.x[0]
        self.first, self.last = first, last
        self.near = min(case.mesh.near_field, self.n - 1)
        self.dry = case.fluid is None
        self.film_scale = film_scale
        if self.dry:
            own = 2 * np.arange(first, last, dtype=np.int32)
            self.flow_columns = np.full((last - first, 2 * STENCIL), -1, dtype=np.int32)
            self.flow_columns[:, OWN], self.flow_columns[:, OWN + 1] = own, own + 1
            self.flow_values = np.zeros(self.flow_columns.shape)
            self.flow_values[:, OWN] = 1.0
        else:
            self.reynolds = Reynolds(case.fluid, scales, film_scale, first, last)
            self.flow_columns = self.reynolds.columns
        self.gap, self.past = np.zeros(self.n), None
        self._kernels()
        self._pattern()
        self._deflection_rows()

    @property
    def load_is_local(self):
        return self.last == self.n

    def _kernels(self):
        n, near = self.n, self.near
        self.curvature = elasticity.curvature_kernel(n)
        self.exact = elasticity.SymmetricToeplitz(self.curvature, self.first, self.last)
        far = self.curvature.copy()
        far[: near + 1] = 0.0
        self.far = elasticity.SymmetricToeplitz(far, self.first, self.last)
        self.logarithm = elasticity.deflection_kernel(n) - np.log(self.dx)
        self.end_scale = 1.0 / self.dx
        self.inside = np.arange(max(self.first, 1), min(self.last, n - 1))
        self.ends = [end for end in (0, n - 1) if self.first <= end < self.last]

    def pressure(self, q):
        """Pressure in p0."""
        return q if self.dry else np.maximum(q, 0.0)

    def slope(self, q):
        """dp/dq."""
        return np.ones_like(q) if self.dry else full_of_oil(q) * 1.0

    def deflection(self, p):
        r"""Elastic deflection :math:`-\frac1\pi\int p\ln|x-s|ds` at every node, in a^2/R."""
        return (self.dx / np.pi) * elasticity.SymmetricToeplitz(self.logarithm)(p)

    def film(self, p, h00):
        """Film of the integral form, in a^2/R."""
        return h00 + 0.5 * self.x**2 + self.gap + self.deflection(p)

    def end_row(self, node):
        """Under every pressure in the deflection row of an end node, shape (nx,)."""
        kernel = self.logarithm if node == 0 else self.logarithm[::-1]
        return (-self.end_scale * self.dx / np.pi) * kernel

    def residual(self, q, h, h00):
        """Local rows, interleaved, of the whole state; shape of the local part of the vector."""
        p = self.pressure(q)
        out = np.empty(2 * (self.last - self.first) + self.load_is_local)
        i = self.inside
        fixed = h - 0.5 * self.x**2 - self.gap  # the parabola's second difference is dx^2 exactly
        bend = (np.pi / self.dx) * (fixed[i - 1] - 2 * fixed[i] + fixed[i + 1])
        out[2 * (i - self.first)] = bend - self.exact(p)[i - self.first]
        for end in self.ends:
            rigid = self.end_scale * (fixed[end] - h00)
            out[2 * (end - self.first)] = rigid + self.end_row(end) @ p
        if self.dry:
            flow = p[self.first : self.last]
        else:
            flow, self.flow_values = self.reynolds.evaluate(q, h, self.past)
        out[1 : 2 * (self.last - self.first) : 2] = flow
        if self.load_is_local:
            out[-1] = self.dx * p.sum() - 0.5 * np.pi
        return out

    def _pattern(self):
        """Compressed rows of the local part: the deflection's, Reynolds', the load's."""
        n, near = self.n, self.near
        rows = []
        for i in range(self.first, self.last):
            nodes = np.arange(max(i - near, 0), min(i + near, n - 1) + 1)
            films = [i] if i in (0, n - 1) else [i - 1, i, i + 1]
            extra = [2 * n] if i in (0, n - 1) else []
            rows.append(np.concatenate([2 * nodes, 2 * np.array(films) + 1, extra]))
            flow = self.flow_columns[i - self.first]
            rows.append(flow[flow >= 0])
        if self.load_is_local:
            rows.append(np.append(2 * np.arange(n), 2 * n))
        self.pattern_rows = np.concatenate([[0], np.cumsum([len(r) for r in rows])]).astype(np.int32)
        self.pattern_columns = np.concatenate(rows).astype(np.int32)

    def _deflection_rows(self):
        """Columns and values of the local deflection rows in oil, near field; column -1: no entry."""
        n, near = self.n, self.near
        i = np.arange(self.first, self.last)[:, None]
        distance = np.arange(-near, near + 1)
        self.near_nodes = np.clip(i + distance, 0, n - 1)
        pressures = np.where(self.near_nodes == i + distance, 2 * self.near_nodes, -1)
        by_pressure = np.tile(-self.curvature[np.abs(distance)], (len(i), 1))
        films = i + np.array([-1, 0, 1])
        films = np.where((films >= 0) & (films < n), 2 * films + 1, -1)
        by_film = np.tile((np.pi / self.dx) * np.array([1.0, -2.0, 1.0]), (len(i), 1))
        approach, by_approach = np.full((len(i), 1), -1), np.full((len(i), 1), -self.end_scale)
        for end in self.ends:
            k = end - self.first
            by_pressure[k] = self.end_row(end)[self.near_nodes[k]]
            films[k], by_film[k], approach[k] = (-1, 2 * end + 1, -1), self.end_scale, 2 * n
        self.deflection_columns = np.hstack([pressures, films, approach]).astype(np.int32)
        self.in_oil = np.hstack([by_pressure, by_film, by_approach])

    def deflection_rows(self, slope, rows):
        """Values of some local deflection rows at ``deflection_columns``, near field; `slope` is dp/dq."""
        values, width = self.in_oil[rows], 2 * self.near + 1
        values[:, :width] *= slope[self.near_nodes[rows]]
        values[:, self.near] += np.where(slope[self.first + rows] > 0.0, 0.0, LEAK)
        return values

    def near_rows(self, changed):
        """Local rows of the near field that `changed`, bool of shape (nx,), has nodes of."""
        return np.flatnonzero(changed[self.near_nodes].any(axis=1))

    def far_product(self, v_p):
        """What the matrix lacks of the deflection rows: local nodes x (row of v_p = dp)."""
        local = -self.far(v_p)
        for end in self.ends:
            far = slice(self.near + 1, self.n) if end == 0 else slice(0, self.n - 1 - self.near)
            local[end - self.first] = self.end_row(end)[far] @ v_p[far]
        return local
