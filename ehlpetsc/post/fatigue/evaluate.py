"""Evaluation of stress histories given as arrays of any shape."""

import numpy as np


def evaluate(sx, sz, txz, counter_of, residual_stress):
    """Results of a counter for each history.

    Parameters
    ----------
    sx, sz, txz : array_like, shape (..., samples)
        Pa.
    counter_of : callable(samples)
        Returns a counter with `columns`, which is called with stress (points, 3, samples), lengths (points,),
        out (points, columns) and the residual stress.
    residual_stress : float
        Pa.

    Returns
    -------
    list of float or ndarray, shape (...)
        One for each column.

    Raises
    ------
    ValueError
        Unequal shapes, nan.
    """
    stress = np.stack(
        np.broadcast_arrays(*(np.asarray(component, float) for component in (sx, sz, txz))), axis=-2
    )
    if not np.isfinite(stress).all():
        raise ValueError("stress histories must be finite")
    if not np.isfinite(residual_stress):
        raise ValueError("residual_stress must be a finite number")
    shape, samples = stress.shape[:-2], stress.shape[-1]
    counter = counter_of(samples)
    blocks = np.ascontiguousarray(stress).reshape(-1, 3, samples)
    out = np.empty((len(blocks), len(counter.columns)))
    counter(blocks, np.full(len(blocks), samples), out, residual_stress)
    return [column.reshape(shape)[()] for column in out.T]
