"""Thinning of densely sampled profiles to the resolution of a mesh."""

import numpy as np

MIN_THINNED_POINTS = 200_000  # points; a spline through fewer takes negligible time
MAX_POINTS_PER_CELL = 16  # points per cell of the mesh, or per shortest cut-off


def thinned(X, z, shortest):
    """Profile with `MAX_POINTS_PER_CELL` points per shortest wave, if it has more than twice as many.

    Every new point has the mean height of the old points around it, by the trapezoidal rule, corrected
    for curvature to the height at the point, :math:`z_j=m_j-(m_{j+1}-2m_j+m_{j-1})/24`, mirrored at the ends.
    Means over cells, which alone enter the solution, do not change: of a wave of two cells by less than
    3e-5 of its amplitude.

    Parameters
    ----------
    X, z : ndarray, shape (n,)
        m; X increasing.
    shortest : float
        Spacing of the mesh or cut-off of a filter [m].

    Returns
    -------
    X, z : ndarray
        The same arrays if the profile is not thinned.
    """
    count = max(int(MAX_POINTS_PER_CELL * (X[-1] - X[0]) / shortest), MAX_POINTS_PER_CELL) + 1
    if X.size < max(MIN_THINNED_POINTS, 2 * count):
        return X, z
    nearest = np.rint(np.linspace(0, X.size - 1, count)).astype(int)
    edges = np.concatenate([[0], (nearest[1:] + nearest[:-1]) // 2, [X.size - 1]])
    area = np.diff(X)
    area *= z[1:] + z[:-1]
    area = 0.5 * np.concatenate([[0.0], np.cumsum(area)])[edges]
    ends = X[edges]
    mean = np.diff(area) / np.diff(ends)
    places = 0.5 * (ends[1:] + ends[:-1])
    places[[0, -1]] = ends[[0, -1]]
    curvature = np.diff(np.concatenate([mean[1:2], mean, mean[-2:-1]]), 2)
    return places, mean - curvature / 24.0
