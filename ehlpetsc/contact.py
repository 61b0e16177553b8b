r"""The discrete contact problem: one interleaved system for q, h and the approach h00.

Unknowns (q_0, h_0, q_1, h_1, ..., h00); rows in the same places, as SNESVI pairs row with unknown:

* in q's place the deflection in second differences,
  :math:`\frac{\pi}{\Delta x}(\delta^2h-\Delta x^2-\delta^2\phi)-\sum_kf_kp_{i+k}=0`
  (Holmes et al. 2005, eq. (2)); at the two end nodes the whole integral with h00;
* in h's place Reynolds, :class:`ehlpetsc.reynolds.Reynolds`, or p itself in a dry contact, both
  complementary to the bound h >= 0;
* last the load, :math:`\sum p\,\Delta x=\pi/2`.

The matrix holds the near field of the deflection, the residual and the operator of the Krylov method
the whole of it: the matrix is the operator's preconditioner.
"""
import numpy as np

from ehlpetsc import elasticity
from ehlpetsc.reynolds import Reynolds

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
    past : reynolds.Storage or None
        Previous time levels; None: steady.
    """

    def __init__(self, case, scales, film_scale, first, last):
        self.n, self.x = scales.nx, scales.x
        self.dx = self.x[1] - self.x[0]
        self.first, self.last = first, last
        self.near = min(case.mesh.near_field, self.n - 1)
        self.dry = case.fluid is None
        self.film_scale = film_scale
        if not self.dry:
            self.reynolds = Reynolds(case.fluid, scales, film_scale, first, last)
        self.gap, self.past = np.zeros(self.n), None
        self._kernels()
        self._pattern()

    @property
    def load_is_local(self):
        return self.last == self.n

    def _kernels(self):
        n, near = self.n, self.near
        self.curvature = elasticity.curvature_kernel(n)
        self.exact = elasticity.SymmetricToeplitz(self.curvature)
        far = self.curvature.copy()
        far[: near + 1] = 0.0
        self.far = elasticity.SymmetricToeplitz(far)
        self.logarithm = elasticity.deflection_kernel(n) - np.log(self.dx)
        self.end_scale = 1.0 / self.dx
        self.inside = np.arange(max(self.first, 1), min(self.last, n - 1))

    def pressure(self, q):
        """Pressure in p0."""
        return q if self.dry else np.maximum(q, 0.0)

    def slope(self, q):
        """dp/dq."""
        return np.ones_like(q) if self.dry else (q > 0.0) * 1.0

    def deflection(self, p):
        r"""Elastic deflection :math:`-\frac1\pi\int p\ln|x-s|ds` at every node, in a^2/R."""
        return (self.dx / np.pi) * elasticity.SymmetricToeplitz(self.logarithm)(p)

    def film(self, p, h00):
        """Film of the integral form, in a^2/R."""
        return h00 + 0.5 * self.x**2 + self.gap + self.deflection(p)

    def _end_deflection(self, p, node):
        kernel = self.logarithm if node == 0 else self.logarithm[::-1]
        return (self.dx / np.pi) * (kernel @ p)

    def residual(self, q, h, h00):
        """Local rows, interleaved, of the whole state; shape of the local part of the vector."""
        p = self.pressure(q)
        out = np.empty(2 * (self.last - self.first) + self.load_is_local)
        i = self.inside
        fixed = h - 0.5 * self.x**2 - self.gap  # the parabola's second difference is dx^2 exactly
        bend = (np.pi / self.dx) * (fixed[i - 1] - 2 * fixed[i] + fixed[i + 1])
        out[2 * (i - self.first)] = bend - self.exact(p)[i]
        for node in (0, self.n - 1):
            if self.first <= node < self.last:
                rigid = fixed[node] - h00
                out[2 * (node - self.first)] = self.end_scale * (rigid - self._end_deflection(p, node))
        if self.dry:
            flow = p[self.first:self.last]
        else:
            flow, self.flow_values, self.inlet_values = self.reynolds.evaluate(q, h, self.past)
        out[1: 2 * (self.last - self.first): 2] = flow
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
            if self.dry or i == 0:
                rows.append(np.array([2 * i, 2 * i + 1]))
            else:
                c = self.reynolds.columns[i - self.reynolds.rows[0]]
                rows.append(c[c >= 0])
        if self.load_is_local:
            rows.append(np.append(2 * np.arange(n), 2 * n))
        self.pattern_rows = np.concatenate([[0], np.cumsum([len(r) for r in rows])]).astype(np.int32)
        self.pattern_columns = np.concatenate(rows).astype(np.int32)

    def deflection_rows(self, slope):
        """Row pointers, columns and values of the local deflection rows, near field."""
        n, near = self.n, self.near
        i = np.arange(self.first, self.last)
        node = i[:, None] + np.arange(-near, near + 1)
        valid = (node >= 0) & (node < n)
        safe = np.clip(node, 0, n - 1)
        distance = np.abs(np.arange(-near, near + 1))
        weight = np.maximum(slope, 0.0)[safe]
        pressure = -self.curvature[distance] * weight
        for end in (0, n - 1):
            if self.first <= end < self.last:
                whole = (-self.end_scale * self.dx / np.pi) * self.logarithm[distance]
                pressure[end - self.first] = whole * weight[end - self.first]
        diagonal = near
        pressure[:, diagonal] += np.where(slope[i] > 0.0, 0.0, LEAK)
        film_node = i[:, None] + np.array([-1, 0, 1])
        film = np.tile((np.pi / self.dx) * np.array([1.0, -2.0, 1.0]), (len(i), 1))
        film_valid = (film_node >= 0) & (film_node < n)
        approach = np.full((len(i), 1), -1)
        approach_value = np.zeros((len(i), 1))
        for end in (0, n - 1):
            if self.first <= end < self.last:
                k = end - self.first
                film[k], film_valid[k] = (0.0, self.end_scale, 0.0), (False, True, False)
                approach[k], approach_value[k] = 2 * n, -self.end_scale
        pressures, films = np.where(valid, 2 * node, -1), np.where(film_valid, 2 * film_node + 1, -1)
        columns = np.hstack([pressures, films, approach])
        return columns.astype(np.int32), np.hstack([pressure, film, approach_value])

    def far_product(self, v_p):
        """What the matrix lacks of the deflection rows: local nodes x (row of v_p = dp)."""
        local = -self.far(v_p)[self.first:self.last]
        for end in (0, self.n - 1):
            if self.first <= end < self.last:
                kernel = self.logarithm if end == 0 else self.logarithm[::-1]
                near = slice(0, self.near + 1) if end == 0 else slice(self.n - 1 - self.near, self.n)
                whole = kernel @ v_p - kernel[near] @ v_p[near]
                local[end - self.first] = -self.end_scale * self.dx / np.pi * whole
        return local
