"""Observed order of convergence and error estimates on meshes with successively halved spacing."""

import numpy as np


def observed_order(errors):
    """Observed order of convergence p: slope of log2(error) over refinements.

    Parameters
    ----------
    errors : sequence of float
        Errors, or differences of successive results, above zero; each with half the spacing of the previous
        one.

    Returns
    -------
    float
    """
    return float(-np.polyfit(np.arange(len(errors)), np.log2(errors), 1)[0])


def richardson_error(difference, order):
    r"""Error of the finer of two results by Richardson extrapolation, :math:`\Delta/(2^p-1)`.

    Parameters
    ----------
    difference : float
        Coarser result minus finer result, or its magnitude.
    order : float
    """
    return difference / (2.0**order - 1.0)
