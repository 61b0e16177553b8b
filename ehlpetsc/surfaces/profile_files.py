"""Reading, levelling and filtering of measured profiles."""

import re
from pathlib import Path

import numpy as np

from ehlpetsc.errors import ProfileError

TEXT = {".csv", ".txt", ".dat", ".asc", ".prf", ""}
SPACING_TOLERANCE = 0.01  # rounding in a file's abscissae, against a spacing that really varies


def read_profile(path):
    """Abscissae, from 0 on, and heights of a profile file.

    Two columns of text, x and z in metres, separated by a comma, semicolon, tab or spaces, ``#`` for comments
    and one line of column names allowed; any other format through the package SurfaceTopography where it is
    installed.

    Parameters
    ----------
    path : path-like

    Returns
    -------
    X, z : ndarray, shape (n,)
        Both in m, X increasing; heights positive out of the metal.

    Raises
    ------
    ProfileError
    """
    path = Path(path)
    try:
        if not path.is_file():
            raise ProfileError(f"no such file: {path}")
        columns = _text_columns(path) if path.suffix.lower() in TEXT else _surface_topography(path)
    except (OSError, ValueError) as error:  # ValueError: a name no file system takes
        raise ProfileError(f"cannot be read: {error}") from None
    return _checked(*columns)


def _text_columns(path):
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except UnicodeDecodeError:
        raise ProfileError("not text; allowed: two columns of numbers, x and z in m") from None
    rows, header_allowed = [], True
    for number, line in enumerate(lines, 1):
        words = re.split(r"[,;\s]+", line.partition("#")[0].strip(" \t\r,;"))
        if words == [""]:
            continue
        try:
            x, z = map(float, words)
        except ValueError:
            if not header_allowed:
                raise ProfileError(
                    f"line {number}: {line.strip()[:40]!r}; allowed: two numbers a line, x and z in m"
                ) from None
        else:
            rows.append((x, z))
        header_allowed = False
    return tuple(np.array(rows).reshape(-1, 2).T)


def _surface_topography(path):
    try:
        from SurfaceTopography import read_topography
    except ImportError:
        raise ProfileError(
            f"format {path.suffix!r} needs the package SurfaceTopography (pip install SurfaceTopography); "
            "without it, allowed: .csv or two-column text, x and z in m"
        ) from None
    try:
        topography = read_topography(str(path)).to_unit("m")
        if topography.dim == 1:
            return topography.positions_and_heights()
        x, _, z = topography.positions_and_heights()
    except Exception as error:  # its readers raise what they like on a damaged file
        lines = str(error).strip().splitlines()  # many: what each of its readers says to an unknown format
        reason = lines[0] if len(lines) == 1 else "in none of the formats it knows"
        raise ProfileError(f"SurfaceTopography cannot read it: {reason}") from None
    middle = z.shape[1] // 2  # of an areal map the central trace
    return x[:, middle], z[:, middle]


def _checked(x, z):
    x, z = np.asarray(x, float), np.ma.filled(np.ma.asarray(z, float), np.nan)
    if x.size < 4:
        raise ProfileError(f"{x.size} points; allowed: at least 4")
    bad = ~(np.isfinite(x) & np.isfinite(z))
    if bad.any():
        raise ProfileError(f"point {bad.argmax() + 1} is not a finite number; allowed: finite x and z in m")
    step = np.diff(x)
    if (step == 0).any():
        raise ProfileError(f"x = {x[(step == 0).argmax()]:g} stands twice; allowed: every x once")
    if (step < 0).any():
        raise ProfileError(f"x falls after x = {x[(step < 0).argmax()]:g}; allowed: x increasing")
    if x[-1] - x[0] > 10.0 or np.ptp(z) > 0.01:
        raise ProfileError(
            f"{x[-1] - x[0]:g} m long, {np.ptp(z):g} m valley to peak; allowed: x and z in m, not in mm or um"
        )
    return x - x[0], z
