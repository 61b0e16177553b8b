"""What a mesh keeps of roughness that moves with or against the film, by the nodes to its wave."""

from __future__ import annotations

import tempfile
import time
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ehlpetsc.api import read_result, solve
from ehlpetsc.case.loading import load
from ehlpetsc.post.run import Job, run
from ehlpetsc.results.post_result import PostResult
from ehlpetsc.run.simulation import Simulation
from support import ROOT
from support.points import point

LINE = {"contact.boundary_film": 1e-10, "contact.model": "mixed", "surface": {}}  # the film stays far above
PERIODS = 3  # fitted, at the end of a run


class Kept(NamedTuple):
    """Amplitude of the film over that of the wave; ripple of the pressure over p0 and the relative wave.

    `film`: in the middle.
    `ripple`: root mean square of its amplitudes over the middle half of the contact, along the motion. Two
        waves of nearly one amplitude pass each other there, that of the surface and the one that it leaves in
        the film, so that the amplitude at a single node may be a small difference of both.
    `newton`, `steps`: iterations and steps of the pass. `seconds`: its processor time.
    """

    film: float
    ripple: float
    newton: int
    steps: int
    seconds: float


def line_wave(
    wavelength: float, nodes: int, sliding: float = 0.0, side: int = 1, courant: float = 1.0, **more: Any
) -> Kept:
    """A small wave on one surface of a line contact, M = 100, L = 11.

    `wavelength`: in half-widths. `nodes`: to a wavelength. `sliding`: slide/roll ratio. `side`: surface.
    """
    tables = {"mesh.points_per_half_width": round(nodes / wavelength), "motion.slide_roll_ratio": sliding}
    return _kept(ROOT / "cases" / "waviness.toml", LINE | tables | more, wavelength, side, courant, 0.02)


def point_wave(
    wavelength: float, nodes: int, sliding: float = 0.0, side: int = 1, courant: float = 1.0, **more: Any
) -> Kept:
    """A small wave along and across on one surface of a circular contact, M = 200, L = 10."""
    tables = point(200.0, 10.0, round(nodes / wavelength), {"motion.slide_roll_ratio": sliding})
    return _kept(tables, more, wavelength, side, courant, 0.05)


def _kept(
    case: Path | dict, more: dict, wavelength: float, side: int, courant: float, amplitude: float
) -> Kept:
    """The wave enters a smooth steady film, and is followed in the middle when it has filled the contact."""
    smooth = Simulation(load(case, more | {"time": None}))
    state, s = smooth.advance(), smooth.scales
    middle = np.unravel_index(np.argmin(s.grid.distance), s.grid.shape)
    film, along = state.film_thickness[middle], (*middle[:-1], np.abs(s.x) <= 0.5)
    before = state.pressure[along]
    wave = {"kind": "sine", "amplitude": amplitude * film, "wavelength": wavelength * s.a}
    if len(middle) > 1:
        wave["wavelength_across"] = wavelength * s.a
    speed = (s.u1, s.u2)[side - 1]
    travel = ((1.0 - s.x[0]) / min(s.u, speed) + PERIODS * wavelength / speed) * s.u_max
    moving = {"surface": {str(side): {"synthetic": wave}}, "time": {"travel": travel, "courant": courant}}
    begin, newton, rows = time.process_time(), 0, []
    for state in Simulation(load(case, more | moving)):
        newton += state.newton
        rows.append((state.time, state.film_thickness[middle] - film, state.pressure[along] - before))
    seconds = time.process_time() - begin
    t, film_change, pressure_change = map(np.array, zip(*rows, strict=True))
    period = wavelength * s.a / speed
    last = t > t[-1] - PERIODS * period * (1.0 - 1e-9)
    fit = (t[last], period)
    return Kept(
        float(_amplitudes(film_change[last], *fit)) / (amplitude * film),
        float(np.sqrt(np.mean(_amplitudes(pressure_change[last], *fit) ** 2))) / (amplitude * s.p0),
        newton,
        len(rows) - 1,
        seconds,
    )


def _amplitudes(values: np.ndarray, t: np.ndarray, period: float) -> np.ndarray:
    """Amplitudes of the wave of one period in values with a linear trend, by time along the first axis."""
    phase = 2.0 * np.pi * t / period
    terms = np.stack([np.cos(phase), np.sin(phase), np.ones_like(t), t - t[-1]], axis=1)
    return np.hypot(*np.linalg.lstsq(terms, values, rcond=None)[0][:2])


class Pass(NamedTuple):
    """Means over the last 40 % of a pass of measured profiles with a compliant layer, and its cost.

    `damage`: mean of both surfaces at z = 0.05 a, nan if it was not asked for.
    """

    friction: float
    share: float
    mass_error: float
    damage: float
    newton: int
    steps: int
    seconds: float


# so that damage follows: what stresses need in each step, and the depth
STORED = ["pressure", "film_thickness", "shear_stress_1", "shear_stress_2"]
FOR_DAMAGE = {"output": {"fields": STORED, "every": 1}, "post.depths": [0.05]}


def mean_damage(path: Path) -> float:
    """Mean damage of the surfaces of a result computed with `FOR_DAMAGE`, where points have passed whole."""
    run(Job(str(path), str(post := path.with_suffix(".post.h5"))))
    found = PostResult(post)
    passed = [k for k in found.surfaces if found.complete[k].any()]
    return float(np.mean([found.damage[k][0, ..., found.complete[k]].mean() for k in passed]))


def mixed_pass(points: int, courant: float = 1.0, damage: bool = False) -> Pass:
    """`compliant_mixed.toml` on `points` nodes a half-width, 13.4 times as many as to its shortest wave."""
    changes = {"mesh.points_per_half_width": points, "time.courant": courant}
    changes |= FOR_DAMAGE if damage else {}
    case = load(ROOT / "cases" / "compliant_mixed.toml", changes)
    with tempfile.TemporaryDirectory() as folder:
        path, begin = Path(folder) / "pass.h5", time.process_time()
        solve(case, output=path).close()
        seconds = time.process_time() - begin
        with read_result(path) as result:
            names = "friction_coefficient", "contact_share", "mass_error", "newton"
            friction, share, mass_error, newton = (result.steps(name) for name in names)
        found = mean_damage(path) if damage else np.nan
    late = slice(len(friction) * 6 // 10, None)
    means = float(friction[late].mean()), float(share[late].mean())
    return Pass(*means, float(mass_error.max()), found, int(newton.sum()), len(newton) - 1, seconds)
