"""Profiles that are implausible compared with half width, film and mesh, mostly by a wrong unit."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ehlpetsc.surfaces.profile_files import UNITS

if TYPE_CHECKING:
    from ehlpetsc.surfaces.profile_files import Layout
    from ehlpetsc.surfaces.samples import Samples

MAX_SPACING = 0.25  # half widths between two points: wider than asperities
MAX_RQ = 0.1  # half widths
MAX_RQ_RATIO = 30.0  # Rq over the elastic approach a^2/R, or over the film
MAX_SLOPE = 1.0  # root mean square
MIN_RQ = 1e-11  # m
MIN_CELLS = 4  # of the mesh, length of the profile
TYPICAL_SPACING, TYPICAL_RQ = (5e-9, 3e-5), (3e-10, 2e-5)  # m: of measured profiles


def absurd(samples: Samples, a: float, dx: float, approach: float, film: float) -> str | None:
    """Message on an implausible measured profile, with the likely unit; None: plausible.

    Parameters
    ----------
    a, dx
        Half width and spacing of the mesh [m].
    approach, film
        a^2/R and expected film [m].
    """
    rq = float(samples.z.std())
    slope = float(np.sqrt(np.mean((np.diff(samples.z) / np.diff(samples.X)) ** 2)))
    highest = min(MAX_RQ * a, MAX_RQ_RATIO * max(approach, film))
    if samples.spacing > MAX_SPACING * a:
        fault = f"points {_um(samples.spacing)} apart beside a half width of {_um(a)}"
    elif rq > highest:
        fault = (
            f"Rq {_um(rq)} beside a half width of {_um(a)}, a^2/R of {_um(approach)}, a film of {_um(film)}"
        )
    elif slope > MAX_SLOPE:
        fault = f"slopes of {slope:.3g} in the root mean square"
    elif 0.0 < rq < MIN_RQ:
        fault = f"Rq {_um(rq)}, less than an atom"
    elif samples.length < MIN_CELLS * dx:
        fault = f"{_um(samples.length)} long beside cells of the mesh of {_um(dx)}"
    else:
        return None
    return f"{fault}: not a profile of this contact"


def likely_unit(samples: Samples, layout: Layout, scale: float) -> str | None:
    """Keys that make a profile plausible, e.g. ``unit = "um"``; None if there are none.

    Parameters
    ----------
    layout
        Layout of the file.
    scale
        Factor on the heights in the case.
    """
    now = (layout.unit or "m", layout.x_unit or layout.unit or "m")
    rq, step = samples.z.std() / (abs(scale) or 1.0) / UNITS[now[0]], samples.spacing / UNITS[now[1]]
    of_x = [now[1]] if layout.spacing is not None else list(UNITS)
    pairs = [(unit, x_unit) for x_unit in of_x for unit in UNITS if (unit, x_unit) != now]
    for unit, x_unit in sorted(pairs, key=lambda pair: pair[0] != pair[1]):
        if _is_within(rq * UNITS[unit], TYPICAL_RQ) and _is_within(step * UNITS[x_unit], TYPICAL_SPACING):
            alone = x_unit == unit or layout.spacing is not None
            return f'unit = "{unit}"' + ("" if alone else f' and x_unit = "{x_unit}"')
    return None


def _is_within(value: float, limits: tuple[float, float]) -> bool:
    return limits[0] <= value <= limits[1]


def _um(length: float) -> str:
    return f"{1e6 * length:.3g} um"
