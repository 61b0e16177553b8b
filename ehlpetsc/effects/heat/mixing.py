"""Fixed point of the steady temperatures, by Anderson's mixing."""

import numpy as np

DEPTH = 6
ITERATIONS = 200
ACCURACY = 1e-11  # of the largest value


def mixing(function, start):
    r"""Fixed point :math:`x=g(x)` by Anderson's acceleration (Walker & Ni 2011).

    Parameters
    ----------
    function : callable
    start : ndarray

    Returns
    -------
    ndarray
        The last argument of the function.
    """
    x, steps, residuals = start, [], []
    for _ in range(ITERATIONS):
        new = function(x)
        f = new - x
        if np.abs(f).max() <= ACCURACY * max(np.abs(new).max(), 1e-300):
            return x
        steps, residuals = [*steps, x][-DEPTH:], [*residuals, f][-DEPTH:]
        if len(steps) == 1:
            x = new
            continue
        differences = np.diff(np.array(residuals), axis=0).T
        gamma = np.linalg.lstsq(differences, f, rcond=1e-12)[0]
        moved = np.diff(np.array(steps), axis=0).T
        x = new - (moved + differences) @ gamma
    return x
