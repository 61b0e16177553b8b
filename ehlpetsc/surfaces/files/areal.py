"""Areal maps as files: text, ``.npy``, formats of instruments; their gaps."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

import numpy as np
from numpy.lib.format import MAGIC_PREFIX, read_array

from ehlpetsc.base.errors import ProfileError
from ehlpetsc.surfaces.files.instruments import by_package, read_instrument, read_once
from ehlpetsc.surfaces.files.profiles import MAX_ABSCISSA, TEXT_ENDINGS
from ehlpetsc.surfaces.files.softgauges import Map, Trace, read_softgauge
from ehlpetsc.surfaces.files.text import UNITS, Layout, text_columns
from ehlpetsc.surfaces.files.text_maps import MIN_POINTS, MIN_PRESENT, in_metres, is_matrix, listed, with_axes
from ehlpetsc.surfaces.filters import SPIKE_WIDTH, map_spikes, without_no_data


def is_map(path: str | PathLike, layout: Layout) -> bool:
    """Whether a file holds a map; one that cannot be read as a profile counts as one."""
    path = Path(path)
    if not path.is_file():
        return path.suffix.lower() not in TEXT_ENDINGS
    if path.suffix.lower() == ".npy":
        return True
    try:
        if not _is_text(path):
            return isinstance(read_instrument(path, layout), Map)
    except (ProfileError, OSError):
        return True
    columns, header = _columns_of(path, layout)
    return listed(columns, header) is not None or is_matrix(columns, header, layout)


@read_once
def read_map(path: Path, layout: Layout) -> Map:
    """Map in a file, missing heights filled.

    Text: a matrix, one line a row along x, in the layouts of profile files. ``.npy``: a matrix. Other formats
    as of :func:`.instruments.read_instrument`.
    """
    is_matrix = path.suffix.lower() == ".npy" or _is_text(path)
    found = (_matrix if is_matrix else read_instrument)(path, layout)
    if isinstance(found, Trace):
        raise ProfileError("a profile; allowed here: a map")
    if layout.mask:
        found = found._replace(z=_masked(found.z, path.parent / layout.mask))
    found = checked(found, layout)
    found.z.flags.writeable = False
    return found


def _matrix(path: Path, layout: Layout) -> Map:
    if path.suffix.lower() != ".npy":
        columns, header = _columns_of(path, layout)
        return Map(*in_metres(listed(columns, header) or with_axes(columns.T, header), header, layout))
    z = by_package("numpy", _by_numpy, path, "")
    if z.dtype.kind not in "fiu":
        raise ProfileError(f"numbers of type {z.dtype}; allowed: real numbers")
    _check_shape(z)
    return Map(*in_metres(with_axes(z.astype(float), ""), "", layout))


def _is_text(path: Path) -> bool:
    """Whether a file is read as text, by its name, and is not one of the formats that any name may have."""
    return path.suffix.lower() in TEXT_ENDINGS and read_softgauge(path) is None


def _masked(z: np.ndarray, path: Path) -> np.ndarray:
    """Heights that are missing where the matrix in a file is not 0."""
    if not path.is_file():
        raise ProfileError(f"mask: no such file: {path}")
    mask = _by_numpy(path) if path.suffix.lower() == ".npy" else text_columns(path, None, None)[0].T
    if mask.shape != z.shape:
        shapes = [" x ".join(map(str, values.shape)) for values in (mask, z)]
        raise ProfileError(
            f"mask: {path.name} has {shapes[0]} values; allowed: as many as heights, {shapes[1]}"
        )
    return np.where(mask != 0, np.nan, np.ma.filled(np.ma.asarray(z, float), np.nan))


def _by_numpy(path: Path) -> np.ndarray:
    with path.open("rb") as file:
        if file.read(len(MAGIC_PREFIX)) != MAGIC_PREFIX:  # np.load would read archives and pickles too
            raise ProfileError(
                "not a matrix as numpy.save writes it; allowed under .npy: one of real numbers"
            )
        file.seek(0)
        return read_array(file, allow_pickle=False)


@read_once
def _columns_of(path: Path, layout: Layout) -> tuple[np.ndarray, str]:
    return text_columns(path, layout.decimal, layout.header_lines)


def checked(found: Map, layout: Layout) -> Map:
    """Map without missing heights; ProfileError for a faulty one."""
    _, dx, dy, notes = found
    z, no_data = without_no_data(found.z, UNITS[layout.unit or "m"])
    _check_shape(z)
    if not (0 < dx < MAX_ABSCISSA and 0 < dy < MAX_ABSCISSA):
        raise ProfileError(f"spacings {dx:g} and {dy:g} m; allowed: above 0")
    wrong = np.abs(z) >= MAX_ABSCISSA
    if wrong.any():
        row, column = np.unravel_index(wrong.argmax(), z.shape)
        raise ProfileError(
            f"row {row + 1}, column {column + 1} is not a height below {MAX_ABSCISSA:g} m; allowed: finite "
            "heights, nan where they are missing"
        )
    widest = layout.fill_gaps or 0.0
    if layout.bridge_spikes and (is_spike := map_spikes(z)).any():
        z[is_spike] = np.nan
        widest = max(widest, (SPIKE_WIDTH + 1) * max(dx, dy))
        notes += (f"spikes: {np.count_nonzero(is_spike)} points in all, bridged",)
    if np.isnan(z).any():
        z, note = filled(z, dx, dy, widest, no_data)
        notes += (note,)
    return Map(z, dx, dy, notes)


def _check_shape(z: np.ndarray) -> None:
    if z.ndim != 2 or min(z.shape) < MIN_POINTS:
        shape = " x ".join(map(str, z.shape))
        raise ProfileError(f"{shape} heights; allowed: a matrix of {MIN_POINTS} x {MIN_POINTS} or more")


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
