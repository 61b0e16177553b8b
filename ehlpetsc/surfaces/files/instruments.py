"""Files of instruments, which include their units and spacings, and reading any file once."""

from __future__ import annotations

import contextlib
import functools
from collections.abc import Callable
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import numpy as np

from ehlpetsc.base.errors import ProfileError
from ehlpetsc.base.toml_file import similar_file
from ehlpetsc.surfaces.files.softgauges import Map, Trace, read_softgauge
from ehlpetsc.surfaces.files.text import Layout

DETECTED = Layout()
LAYOUT_KEYS = tuple(Layout.__dataclass_fields__)
KEYS_OF_TEXT = LAYOUT_KEYS[: LAYOUT_KEYS.index("fill_gaps")]
OWN_FORMATS = "ISO 5436-2, ISO 25178-71 and Gwyddion"
OTHERWISE = ".npy or text, a matrix of heights in m, with spacing, or of a profile x and z in m"

R = TypeVar("R")


def read_once(read: Callable[[Path, Layout], R]) -> Callable[..., R]:
    """Reading of a file, remembered for check, summary and run; ProfileError where it cannot be read."""

    @functools.lru_cache(maxsize=4)
    def remembered(path: Path, layout: Layout, _modified: int, _size: int) -> R:
        return read(path, layout)

    @functools.wraps(read)
    def reading(path: str | PathLike, layout: Layout = DETECTED) -> R:
        path = Path(path)
        try:
            if not path.is_file():
                fault = "a folder" if path.is_dir() else "no such file"
                raise ProfileError(f"{fault}: {path}{similar_file(path)}")
            state = path.stat()
            return remembered(path, layout, state.st_mtime_ns, state.st_size)
        except (OSError, ValueError) as error:  # ValueError: a name no file system takes
            raise ProfileError(f"cannot be read: {getattr(error, 'strerror', None) or error}") from None

    return reading


def by_package(package: str, read: Callable[[Path], R], path: Path, otherwise: str) -> R:
    """Content of a file, read by a package that need not be installed; `otherwise`: what needs none."""
    try:
        return read(path)
    except ModuleNotFoundError as error:
        if error.name != package:
            raise ProfileError(f"{package} cannot be loaded: {error}") from None
        raise ProfileError(
            f"format {path.suffix!r} needs the package {package} (pip install {package}); without it, "
            f"allowed: {otherwise}"
        ) from None
    except ProfileError:
        raise
    except Exception as error:  # various exceptions on a damaged file
        raise ProfileError(f"{package} cannot read it: {str(error).partition(chr(10))[0]}") from None


def _unknown(path: Path) -> Map | Trace:
    raise ProfileError(
        f"its first line is that of no format of {path.suffix!r}; allowed: one of {OWN_FORMATS}"
    )


def _by_surface_topography(path: Path) -> Map | Trace:
    import SurfaceTopography

    try:
        with contextlib.redirect_stdout(None):  # some of its readers print
            topography = SurfaceTopography.read_topography(str(path))
    except Exception as error:
        if type(error).__name__ != "CannotDetectFileFormat":
            raise
        allowed = f"{OTHERWISE}, or .x3p, .sdf, .sur"
        raise ProfileError(
            f"of no format that the installed SurfaceTopography reads; allowed: {allowed}"
        ) from None
    return _in_metres(topography)


def _by_container(path: Path) -> Map | Trace:
    """The one measurement of a file that may have several."""
    import SurfaceTopography

    reader = SurfaceTopography.open_container(str(path))  # it closes the file when it is forgotten
    measurements = reader.container()
    if len(measurements) != 1:
        raise ProfileError(f"{len(measurements)} measurements in it; allowed: one; export it by itself")
    return _in_metres(measurements[0])


def _in_metres(topography: Any) -> Map | Trace:
    """Content of a SurfaceTopography's topography."""
    if topography.unit is None:
        raise ProfileError(f"no unit of length in it; allowed: {OTHERWISE}")
    topography = topography.to_unit("m")
    if topography.dim == 1:
        return Trace(*topography.positions_and_heights())
    z = np.ma.filled(np.ma.asarray(topography.heights(), float), np.nan)
    return Map(z.T, *topography.pixel_size)


class Format(NamedTuple):
    """Format of files.

    `endings`: of their names, in lower case; (): all others.
    `read`: reading of one; None: no surfaces, or not read.
    `package`: of PyPI, by which it is read; "": none.
    """

    endings: tuple[str, ...]
    read: Callable[[Path], Map | Trace] | None
    package: str = ""


FORMATS = (
    Format((".smd", ".sdf", ".gsf"), _unknown),  # those of `read_softgauge`, by their first lines, are read
    Format(tuple(".npz .mat .xls .h5 .json .png .jpg .jpeg .bmp .vti".split()), None),
    Format((".zag",), _by_container, "SurfaceTopography"),
    Format((), _by_surface_topography, "SurfaceTopography"),
)


@read_once
def read_instrument(path: Path, layout: Layout) -> Map | Trace:
    """Map or profile of an instrument's file; ProfileError with the keys that the file includes."""
    ending = path.suffix.lower()
    form = next(form for form in FORMATS if ending in form.endings or not form.endings)
    if form.read is None:
        raise ProfileError(f"format {ending!r} is not read; allowed: {OTHERWISE}, or a format of instruments")
    if stated := [key for key in KEYS_OF_TEXT if getattr(layout, key) is not None]:
        raise ProfileError(f"{stated[0]}: for text files alone, {path.suffix!r} includes it; leave it out")
    return read_softgauge(path) or by_package(form.package, form.read, path, OTHERWISE)
