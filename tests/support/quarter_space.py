"""Quarter space under pressures cos(k x) along its edge, by finite elements.

The displacements are (u sin kx, v cos kx, w cos kx) of y and z alone: a plane problem of three components.
"""

import numpy as np
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import splu
from scipy.special import iti0k0

DEPTH = 12.0  # 1/k: beyond it waves have vanished
GROWTH, LARGEST = 1.35, 1.2  # from element to element; size of the largest one in 1/k
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(3)
NO_EDGE = 30.0  # argument from which on the integral of K0 does not change


def graded(first, k, begin=(0.0,)):
    """Ends of elements that grow from a size on, as far as `DEPTH` beyond the given ones."""
    ends, step = list(begin), first
    last = ends[-1]
    while ends[-1] < last + DEPTH / k:
        ends.append(ends[-1] + step)
        step = min(GROWTH * step, LARGEST / k)
    return np.array(ends)


def quadratic(s):
    """Three shape functions on an element from -1 to 1, and their derivatives."""
    return np.array([0.5 * s * (s - 1.0), 1.0 - s * s, 0.5 * s * (s + 1.0)]), np.array(
        [s - 0.5, -2.0 * s, s + 0.5]
    )


def element_matrices(h_y, h_z, k, poisson_ratio):
    """Stiffness of elements of sizes h_y, h_z, shape (elements, 27, 27), of E = 1."""
    mu = 0.5 / (1.0 + poisson_ratio)
    law = np.diag([2.0 * mu] * 3 + [mu] * 3)
    law[:3, :3] += poisson_ratio / ((1.0 + poisson_ratio) * (1.0 - 2.0 * poisson_ratio))
    u, v, w = slice(0, 9), slice(9, 18), slice(18, 27)
    whole = np.zeros((len(h_y), 27, 27))
    for s, weight_s in zip(POINTS, WEIGHTS, strict=True):
        of_y, by_y = quadratic(s)
        for t, weight_t in zip(POINTS, WEIGHTS, strict=True):
            of_z, by_z = quadratic(t)
            m = np.outer(of_y, of_z).ravel()
            m_y = 2.0 / h_y[:, None] * np.outer(by_y, of_z).ravel()
            m_z = 2.0 / h_z[:, None] * np.outer(of_y, by_z).ravel()
            strain = np.zeros((len(h_y), 6, 27))
            strain[:, 0, u], strain[:, 1, v], strain[:, 2, w] = k * m, m_y, m_z
            strain[:, 3, u], strain[:, 3, v] = m_y, -k * m
            strain[:, 4, u], strain[:, 4, w] = m_z, -k * m
            strain[:, 5, v], strain[:, 5, w] = m_z, m_y
            weight = 0.25 * weight_s * weight_t * h_y * h_z
            whole += weight[:, None, None] * np.einsum("eai,ab,ebj->eij", strain, law, strain, optimize=True)
    return whole


def compliance(k, width, rows, parts, poisson_ratio, is_mirrored=False):
    """Deflection of rows of a width from the edge on by unit pressures cos(k x) on each, E = 1.

    `parts`: elements of a row. `is_mirrored`: the face of the edge has no shear and no displacement, as with
    pressures mirrored about it, instead of being free.
    """
    y = graded(width / parts, k, width / parts * np.arange(rows * parts + 1))
    z = graded(min(0.12 / k, 0.5 * width / parts), k)
    n, m = 2 * len(y) - 1, 2 * len(z) - 1
    a, b = (
        index.ravel() for index in np.meshgrid(np.arange(len(y) - 1), np.arange(len(z) - 1), indexing="ij")
    )
    inner = np.repeat(np.arange(3), 3), np.tile(np.arange(3), 3)
    place = (2 * a[:, None] + inner[0]) * m + 2 * b[:, None] + inner[1]
    dofs = np.concatenate([place, place + n * m, place + 2 * n * m], axis=1)
    matrices = element_matrices(np.diff(y)[a], np.diff(z)[b], k, poisson_ratio)
    pairs = np.repeat(dofs, 27, axis=1).ravel(), np.tile(dofs, (1, 27)).ravel()
    matrix = csc_matrix((matrices.ravel(), pairs), shape=(3 * n * m, 3 * n * m))
    force = np.zeros((3 * n * m, rows))
    for element in range(rows * parts):
        for s, weight in zip(POINTS, WEIGHTS, strict=True):
            loaded = 2 * n * m + (2 * element + np.arange(3)) * m
            force[loaded, element // parts] += 0.5 * width / parts * weight * quadratic(s)[0]
    grid = np.arange(n * m).reshape(n, m)
    held = [*(grid[:, -1] + c * n * m for c in range(3)), grid[-1] + n * m]  # far below; far away: symmetry
    held += [grid[0] + n * m] * is_mirrored
    free = np.setdiff1d(np.arange(3 * n * m), np.concatenate(held))
    found = np.zeros_like(force)
    symmetric = dict(permc_spec="MMD_AT_PLUS_A", options=dict(SymmetricMode=True))
    found[free] = splu(matrix[free][:, free].tocsc(), **symmetric).solve(force[free])
    nodes = np.interp(0.5 * np.arange(n), np.arange(len(y)), y)
    centres = (np.arange(rows) + 0.5) * width
    return np.array([np.interp(centres, nodes, column) for column in found[2 * n * m + grid[:, 0]].T]).T


def half_space(k, width, rows, poisson_ratio, mirrored):
    """As :func:`compliance`, of a half-space with pressures mirrored about the edge times a factor."""
    ends, centres = k * width * np.arange(rows + 1), k * width * (np.arange(rows)[:, None] + 0.5)

    def integral(z):  # of K0 from 0
        return np.sign(z) * iti0k0(np.minimum(np.abs(z), NO_EDGE))[1]

    direct, image = (np.diff(integral(ends[None] + side * centres), axis=1) for side in (-1.0, 1.0))
    return 2.0 * (1.0 - poisson_ratio**2) / (np.pi * k) * (direct + mirrored * image)
