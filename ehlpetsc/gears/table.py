"""Table of the points of a path of contact, and the path as a CSV file for ``[operation]``."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ehlpetsc.base.materials import elastic_constants
from ehlpetsc.gears.path import describe, gear_loss_factor, ohlendorf_loss_factor
from ehlpetsc.physics.scales import hertz_line, reduced_modulus

if TYPE_CHECKING:
    from ehlpetsc.gears.path import Path

COLUMNS = ("time", "load", "radius", "speed 1", "speed 2")


def hertz(path: Path, contact: Mapping[str, Any]) -> tuple[np.ndarray, np.ndarray] | None:
    """Half width [m] and Hertz pressure [Pa] along a path; None without both moduli.

    Parameters
    ----------
    contact
        `youngs_modulus` and `poisson_ratio` of the solids, or their `material`.
    """
    try:
        modulus = reduced_modulus(*elastic_constants(contact))
        pairs = zip(path.load, path.radius, strict=True)
        stresses = [hertz_line(w, r, modulus) if w > 0 else (0.0, 0.0) for w, r in pairs]
    except (KeyError, TypeError, ValueError, ZeroDivisionError):
        return None
    values = np.array(stresses).T
    return (values[0], values[1]) if np.isfinite(values).all() else None


def rows(path: Path, stresses: tuple[np.ndarray, np.ndarray] | None = None) -> list[str]:
    """Lines of text: data of the pair, and a table of A to E.

    Parameters
    ----------
    stresses
        See :func:`hertz`.
    """
    pair = path.pair
    names = list(pair.points)
    where = [path.index(name) for name in names]
    sliding = path.speed_1 - path.speed_2
    arcs = pair.flank_arcs(path.rho)
    quantities = [
        ("time, us", 1e6 * path.time),
        ("rho 1, mm", 1e3 * path.rho),
        ("R, mm", 1e3 * path.radius),
        ("load, kN/m", 1e-3 * path.load),
        ("u1, m/s", path.speed_1),
        ("u2, m/s", path.speed_2),
        ("u, m/s", path.entrainment),
        ("u1 - u2, m/s", sliding),
        ("slide/roll", path.slide_roll_ratio),
        ("arc 1, mm", 1e3 * arcs[0]),
        ("arc 2, mm", 1e3 * arcs[1]),
    ]
    if stresses is not None:
        quantities += [("a, mm", 1e3 * stresses[0]), ("p0, GPa", 1e-9 * stresses[1])]
    lines = [
        *describe(path),
        f"gear loss factor H_V {gear_loss_factor(path):.4f} of this load sharing, "
        f"{ohlendorf_loss_factor(pair):.4f} of Ohlendorf",
    ]
    lines += ["", f"{'':14}" + "".join(f"{name:>11}" for name in names)]
    for name, values in quantities:
        lines.append(f"{name:14}" + "".join(f"{_shown(values[i]):>11}" for i in where))
    return lines


def _shown(value: float) -> str:
    digits = 3 - (math.floor(math.log10(abs(value))) if abs(value) > 1e-9 else 0)
    return f"{0.0 if abs(value) <= 1e-9 else value:.{min(max(digits, 0), 4)}f}"


def csv(path: Path) -> str:
    """Loaded part of the path as CSV text for ``[operation]``."""
    loaded = path.load > 0.0
    values = np.column_stack([path.time, path.load, path.radius, path.speed_1, path.speed_2])[loaded]
    values[:, 0] -= values[0, 0]
    lines = [", ".join(COLUMNS)] + [", ".join(f"{value:.12g}" for value in row) for row in values]
    return "\n".join(lines) + "\n"
