"""Missing heights of an areal map."""

from __future__ import annotations

import numpy as np

from ehlpetsc.base.errors import ProfileError

MIN_PRESENT = 0.5  # of the heights of a map


def filled(
    z: np.ndarray, dx: float, dy: float, widest: float | None, source: str = ""
) -> tuple[np.ndarray, str]:
    """Map with missing heights filled by a membrane, the solution of Laplace's equation in each gap.

    Rows and columns at the edges without any height are cut off.

    `z`: m, nan where it is missing, shape (ny, nx).
    `widest`: width of the widest gap that is filled [m]; None: none.
    `source`: of messages, on the values that are none.

    Returns the map and a note on it.
    """
    missing = np.isnan(z)
    count = int(missing.sum())
    if missing.all():
        raise ProfileError("all heights are missing")
    rows, columns = (np.flatnonzero(~missing.all(axis=axis)) for axis in (1, 0))
    inside = slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)
    z, missing = z[inside], missing[inside]
    if missing.mean() > 1 - MIN_PRESENT:
        raise ProfileError(
            f"{count} heights missing{source}; allowed: no more than half of those between the first and "
            "the last"
        )
    width = gap_width(missing, dx, dy)
    if width > (widest or 0.0):
        raise ProfileError(
            f"{count} heights missing{source}, the widest gap {width:.3g} m; write fill_gaps = "
            f"{width * 1.06:.2g} or more to have gaps of that width filled [m]"
        )
    note = (
        f"{count} missing heights filled or, at the edges, cut off{source}; widest gap {1e6 * width:.3g} um"
    )
    return _with_membrane(z, missing, dx, dy) if missing.any() else z, note


def gap_width(missing: np.ndarray, dx: float, dy: float) -> float:
    """Width [m] of the widest gap: of the largest circle in it, between the points around it."""
    from scipy.ndimage import distance_transform_edt

    return 2.0 * float(distance_transform_edt(missing, sampling=(dy, dx)).max()) if missing.any() else 0.0


def _with_membrane(z: np.ndarray, missing: np.ndarray, dx: float, dy: float) -> np.ndarray:
    """Map with second differences of sum 0 at missing points; level across the edges of the map."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.linalg import spsolve

    number = np.full(z.shape, -1)
    number[missing] = np.arange(missing.sum())
    rows, columns, values = [], [], []
    right, diagonal = np.zeros(missing.sum()), np.zeros(missing.sum())
    for axis, step in ((0, dy), (1, dx)):
        weight = 1.0 / step**2
        lower, upper = (np.take(number, range(k, z.shape[axis] - 1 + k), axis).ravel() for k in (0, 1))
        z_lower, z_upper = (np.take(z, range(k, z.shape[axis] - 1 + k), axis).ravel() for k in (0, 1))
        for own, other, height in ((lower, upper, z_upper), (upper, lower, z_lower)):
            unknown, both = own >= 0, (own >= 0) & (other >= 0)
            np.add.at(diagonal, own[unknown], weight)
            rows.append(own[both])
            columns.append(other[both])
            values.append(np.full(both.sum(), -weight))
            beside = unknown & (other < 0)
            np.add.at(right, own[beside], weight * height[beside])
    everyone = np.arange(len(right))
    entries = np.concatenate([*values, diagonal])
    places = np.concatenate([*rows, everyone]), np.concatenate([*columns, everyone])
    whole = z.copy()
    whole[missing] = spsolve(coo_matrix((entries, places)).tocsc(), right)
    return whole
