"""Quarter space under pressures p(y) cos(k x) on one face, the other one free, by finite elements.

The displacements are (u sin kx, v cos kx, w cos kx) of y and z alone: a plane problem of three components.
"""

import numpy as np
from scipy.optimize import brentq
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import splu

DEPTH, SMALLEST = 14.0, 0.04  # extents, and the first element at both faces, in 1/k


def _elements(count):
    """Ends of elements that grow geometrically from SMALLEST to DEPTH."""
    growth = brentq(lambda r: SMALLEST * (r**count - 1.0) / (r - 1.0) - DEPTH, 1.0001, 3.0)
    return SMALLEST * (growth ** np.arange(count + 1) - 1.0) / (growth - 1.0)


def _quadratic(s):
    return np.array([0.5 * s * (s - 1.0), 1.0 - s * s, 0.5 * s * (s + 1.0)]), np.array(
        [s - 0.5, -2.0 * s, s + 0.5]
    )


def deflection(pressure, poisson_ratio, is_mirrored, count=18):
    """Distances k y from the free face and the deflection there over that of a half-space by cos(k x).

    `pressure`: of arrays of y, linear in each element. `is_mirrored`: no shear and no displacement on the
    other face, as with pressures mirrored about it, instead of a free face.
    """
    ends = _elements(count)
    n, nodes = 2 * count + 1, np.interp(np.arange(2 * count + 1) / 2.0, np.arange(count + 1), ends)
    mu = 0.5 / (1.0 + poisson_ratio)
    stiffness = np.diag([2.0 * mu] * 3 + [mu] * 3)
    stiffness[:3, :3] += poisson_ratio / ((1.0 + poisson_ratio) * (1.0 - 2.0 * poisson_ratio))
    points, weights = np.polynomial.legendre.leggauss(3)
    u, v, w = slice(0, 9), slice(9, 18), slice(18, 27)
    entries, force = [], np.zeros(3 * n * n)
    for a, h_y in enumerate(np.diff(ends)):
        for b, h_z in enumerate(np.diff(ends)):
            element = np.zeros((27, 27))
            for s, weight_s in zip(points, weights, strict=True):
                of_y, by_y = _quadratic(s)
                for t, weight_t in zip(points, weights, strict=True):
                    of_z, by_z = _quadratic(t)
                    m = np.outer(of_y, of_z).ravel()
                    m_y = np.outer(by_y * 2.0 / h_y, of_z).ravel()
                    m_z = np.outer(of_y, by_z * 2.0 / h_z).ravel()
                    strain = np.zeros((6, 27))
                    strain[0, u], strain[1, v], strain[2, w] = m, m_y, m_z
                    strain[3, u], strain[3, v] = m_y, -m
                    strain[4, u], strain[4, w] = m_z, -m
                    strain[5, v], strain[5, w] = m_z, m_y
                    element += 0.25 * h_y * h_z * weight_s * weight_t * strain.T @ stiffness @ strain
            place = ((2 * a + np.arange(3))[:, None] * n + 2 * b + np.arange(3)).ravel()
            dofs = np.concatenate([place, place + n * n, place + 2 * n * n])
            entries.append((np.repeat(dofs, 27), np.tile(dofs, 27), element.ravel()))
        for s, weight in zip(points, weights, strict=True):
            y = 0.5 * (ends[a] + ends[a + 1]) + 0.5 * h_y * s
            force[2 * n * n + (2 * a + np.arange(3)) * n] += (
                0.5 * h_y * weight * pressure(y) * _quadratic(s)[0]
            )
    rows, columns, values = (np.concatenate(part) for part in zip(*entries, strict=True))
    matrix = csc_matrix((values, (rows, columns)), shape=(3 * n * n, 3 * n * n))
    grid = np.arange(n * n).reshape(n, n)
    held = [*(grid[:, -1] + c * n * n for c in range(3)), grid[-1] + n * n]  # far below; far away: symmetry
    held += [grid[0] + n * n] * is_mirrored
    free = np.setdiff1d(np.arange(3 * n * n), np.concatenate(held))
    found = np.zeros(3 * n * n)
    found[free] = splu(matrix[free][:, free].tocsc()).solve(force[free])
    return nodes, found[2 * n * n + grid[:, 0]] / (2.0 * (1.0 - poisson_ratio**2))
