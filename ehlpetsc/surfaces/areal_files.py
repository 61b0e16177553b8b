"""Areal maps: matrices as text or ``.npy``, and the formats of the packages x3pio, sdfio and surfalize."""

from __future__ import annotations

import functools
import warnings
from collections.abc import Callable
from os import PathLike
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ehlpetsc.base.errors import ProfileError
from ehlpetsc.surfaces.gaps import filled
from ehlpetsc.surfaces.outliers import SPIKE_WIDTH, map_spikes, no_data_value
from ehlpetsc.surfaces.profile_files import MAX_ABSCISSA, TEXT, UNITS
from ehlpetsc.surfaces.text_columns import text_columns, units_in

MIN_POINTS = 4  # along either side
OF_PROFILES = {".smd"}  # besides text


class MapLayout(NamedTuple):
    """Layout of the file of a map; the keys of a profile file that apply to maps too.

    `unit`: of the heights, a key of `UNITS`; default: m.
    `spacing`, `spacing_across`: distance of the columns and of the rows [m], of a matrix; the second by
        default as the first.
    `decimal`, `header_lines`: see :class:`.profile_files.Layout`.
    `fill_gaps`: width of the widest patch of missing heights that is filled [m].
    `bridge_spikes`: whether spikes are taken for missing heights, and filled.
    """

    unit: str | None = None
    spacing: float | None = None
    spacing_across: float | None = None
    decimal: str | None = None
    header_lines: int | None = None
    fill_gaps: float | None = None
    bridge_spikes: bool = False


class Map(NamedTuple):
    """Heights on a uniform grid.

    `z`: m, positive out of the metal, shape (ny, nx).
    `dx`, `dy`: distances of the columns and of the rows [m].
    `notes`: notes on the processing of the numbers.
    """

    z: np.ndarray
    dx: float
    dy: float
    notes: tuple[str, ...] = ()


def is_map(path: str | PathLike, layout: MapLayout) -> bool:
    """Whether a file holds a map: by its suffix or, of text, a matrix, for which a spacing is stated."""
    path = Path(path)
    if path.suffix.lower() not in TEXT:
        return path.suffix.lower() not in OF_PROFILES
    return layout.spacing is not None and path.is_file() and len(_columns_of(path, layout)[0]) >= MIN_POINTS


def read_map(path: str | PathLike, layout: MapLayout | None = None) -> Map:
    """Map in a file, missing heights filled.

    Text: a matrix, one line a row along x, in the layouts of profile files. ``.npy``: a matrix. Other formats
    by the packages named in `READERS`, if they are installed.
    """
    path = Path(path)
    try:
        if not path.is_file():
            raise ProfileError(f"no such file: {path}")
        state = path.stat()
        return _read(path, layout or MapLayout(), state.st_mtime_ns, state.st_size)
    except (OSError, ValueError) as error:  # ValueError: a name no file system takes
        raise ProfileError(f"cannot be read: {error}") from None


@functools.lru_cache(maxsize=4)  # one reading for check, summary and run
def _read(path: Path, layout: MapLayout, _modified: int, _size: int) -> Map:
    suffix = path.suffix.lower()
    read = _matrix if suffix in TEXT or suffix == ".npy" else _instrument_file
    found = checked(read(path, layout), layout)
    found.z.flags.writeable = False
    return found


def _matrix(path: Path, layout: MapLayout) -> Map:
    if layout.spacing is None:
        raise ProfileError("a matrix of heights needs spacing = distance of its columns in m")
    if path.suffix.lower() == ".npy":
        z = np.load(path)
        if z.dtype.kind not in "fiu":
            raise ProfileError(f"numbers of type {z.dtype}; allowed: real numbers")
    else:
        columns, header = _columns_of(path, layout)
        if layout.unit is None and (named := set(units_in(header)) - {"m"}):
            raise ProfileError(
                f"its header names {' and '.join(sorted(named))}; write unit for the heights, spacing is in m"
            )
        z = columns.T
    return Map(UNITS[layout.unit or "m"] * z, layout.spacing, layout.spacing_across or layout.spacing)


def _columns_of(path: Path, layout: MapLayout) -> tuple[np.ndarray, str]:
    state = path.stat()
    return _text(path, layout.decimal, layout.header_lines, state.st_mtime_ns, state.st_size)


@functools.lru_cache(maxsize=2)
def _text(
    path: Path, decimal: str | None, header_lines: int | None, _modified: int, _size: int
) -> tuple[np.ndarray, str]:
    return text_columns(path, decimal, header_lines)


def _instrument_file(path: Path, layout: MapLayout) -> Map:
    """Map in a file that includes its units and spacings."""
    file_keys = MapLayout._fields[: MapLayout._fields.index("fill_gaps")]
    stated = [key for key in file_keys if getattr(layout, key) is not None]
    if stated:
        raise ProfileError(f"{stated[0]}: {path.suffix!r} includes it; leave it out")
    package, read = READERS.get(path.suffix.lower(), ("surfalize", _by_surfalize))
    try:
        return read(path)
    except ModuleNotFoundError as error:
        if error.name != package:
            raise ProfileError(f"{package} cannot be loaded: {error}") from None
        raise ProfileError(
            f"format {path.suffix!r} needs the package {package} (pip install {package}); without it, "
            "allowed: .npy or text, a matrix of heights in m, with spacing"
        ) from None
    except ProfileError:
        raise
    except Exception as error:  # various exceptions on a damaged file
        raise ProfileError(f"{package} cannot read it: {str(error).partition(chr(10))[0]}") from None


def _by_x3pio(path: Path) -> Map:
    import x3pio

    layer = x3pio.read(str(path)).layers[0]
    if not isinstance(layer, x3pio.SurfaceLayer):
        raise ProfileError("no map in it; allowed: a surface on a grid")
    return Map(layer.z, *layer.spacing)


def _by_sdfio(path: Path) -> Map:
    import sdfio

    file = sdfio.read(str(path))
    return Map(file.data, file.header.x_scale, file.header.y_scale)


def _by_surfalize(path: Path) -> Map:
    import surfalize

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that spacings differ
        surface = surfalize.Surface.load(str(path))
    return Map(UNITS["um"] * surface.data, UNITS["um"] * surface.step_x, UNITS["um"] * surface.step_y)


READERS: dict[str, tuple[str, Callable[[Path], Map]]] = {
    ".x3p": ("x3pio", _by_x3pio),
    ".sdf": ("sdfio", _by_sdfio),
}  # all others: surfalize


def checked(found: Map, layout: MapLayout) -> Map:
    """Map without missing heights; ProfileError for a faulty one."""
    z, dx, dy, notes = found
    z = np.array(np.ma.filled(np.ma.asarray(z, float), np.nan))
    if z.ndim != 2 or min(z.shape) < MIN_POINTS:
        shape = " x ".join(map(str, z.shape))
        raise ProfileError(f"{shape} heights; allowed: a matrix of {MIN_POINTS} x {MIN_POINTS} or more")
    if not (0 < dx < MAX_ABSCISSA and 0 < dy < MAX_ABSCISSA):
        raise ProfileError(f"spacings {dx:g} and {dy:g} m; allowed: above 0")
    no_data = ""
    while (value := no_data_value(_to_and_fro(z))) is not None:
        no_data += f", {np.count_nonzero(z == value)} of them the value {value:.6g} m far from all others"
        z[z == value] = np.nan
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


def _to_and_fro(z: np.ndarray) -> np.ndarray:
    """Heights along a path of neighbours: every second row from its end."""
    path = z.copy()
    path[1::2] = z[1::2, ::-1]
    return path.ravel()
