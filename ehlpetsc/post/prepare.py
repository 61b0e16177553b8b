"""Preparation of a result file: settings of its case, body points and their passages."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from ehlpetsc.base.errors import PostError
from ehlpetsc.base.materials import fatigue_constants, named_steels
from ehlpetsc.case.loading import Case
from ehlpetsc.post.criteria.laws import Criteria
from ehlpetsc.post.fatigue.strain_life import Material
from ehlpetsc.post.loads import Loads
from ehlpetsc.post.stresses.body_points import NO_FLANK, Passage, body_points, passage

DEPTHS = (0.0, 0.01, 0.03, 0.05, 0.1, 0.2, 0.5, 0.7, 1.0)  # z/a: down to the stresses of the smooth contact
MIN_REPRESENTATIVE_POINTS = 30  # of a surface
END_TOLERANCE = 0.01  # of the duration: a last frame nearer to the end counts as at the end


class Settings(NamedTuple):
    """Depths z/a, material by surface, constants of the criteria, residual stress (z/a, Pa)."""

    depths: np.ndarray
    materials: dict[str, Material]
    criteria: Criteria = Criteria()
    residual_stress: tuple[tuple[float, float], ...] = ()

    def residual(self, depth: float) -> float:
        """Residual stress along the surface at a depth z/a [Pa], linearly interpolated."""
        return float(np.interp(depth, *np.array(self.residual_stress).T)) if self.residual_stress else 0.0


class Prepared(NamedTuple):
    """Data of a result file for all tasks: body points s (ns,) [m], passages by surface.

    `every` is the number of steps between stored frames.
    """

    loads: Loads
    settings: Settings
    every: int
    s: np.ndarray
    motions: dict[str, Passage]


def read_settings(case: Case) -> Settings:
    """Settings of `[post]`; PostError if the fatigue limits contradict each other."""
    post, contact = case.post, case.contact
    bodies = zip(contact.youngs_modulus, contact.poisson_ratio, named_steels(contact.material), strict=True)
    materials = {
        surface: Material(modulus, ratio, **fatigue_constants(steel, post.as_dict()))
        for surface, (modulus, ratio, steel) in zip(("1", "2"), bodies, strict=True)
    }
    constants = {name: getattr(post, name) for name in Criteria.__dataclass_fields__}
    try:
        criteria = Criteria(**{name: value for name, value in constants.items() if value is not None})
    except ValueError as fault:
        raise PostError(f"post.{fault}") from None
    depths = np.unique(post.depths or DEPTHS).astype(float)
    return Settings(depths, materials, criteria, tuple(map(tuple, post.residual_stress or ())))


def prepare(loads: Loads, surfaces: Sequence[str], report: Callable[[str], None]) -> Prepared:
    """Find the body points whose damage can be computed, and report what limits it."""
    settings = read_settings(loads.case)
    loads.check(surfaces)
    every = max(int(np.median(np.diff(loads.step))), 1)
    s, motions = _motions(loads, surfaces)
    prepared = Prepared(loads, settings, every, s, motions)
    for warning in _warnings(prepared):
        report(f"warning: {warning}")
    return prepared


def _motions(loads: Loads, surfaces: Sequence[str]) -> tuple[np.ndarray, dict[str, Passage]]:
    distances = [loads.travelled[surface] for surface in surfaces]
    moved = max(abs(distance[-1] - distance[0]) for distance in distances)
    s = body_points(loads.x, loads.dx, distances)
    motions = {
        surface: passage(s, loads.x, loads.dx, distance, _flank(loads, surface))
        for surface, distance in zip(surfaces, distances, strict=True)
    }
    if not any(motion.complete.any() for motion in motions.values()):
        width = (loads.x[-1] - loads.x[0]) / loads.a
        raise PostError(
            f"no body point passed the whole contact: the surfaces moved {moved / loads.a:.3g} half-widths, "
            f"the domain is {width:.3g} wide; raise time.travel"
        )
    return s, motions


def _flank(loads: Loads, surface: str) -> tuple[float, float]:
    """Points of a flank between the ends of its path of contact, if the run has reached its end."""
    case, number = loads.case, int(surface) - 1
    if case.gears is None:
        return NO_FLANK
    pair, begin = case.gears.pair, case.conditions.profile_offsets[number]
    arc = pair.flank_arcs(pair.points["E"])[number]
    ended = loads.time[-1] > (1.0 - END_TOLERANCE) * loads.operation.duration
    return begin - arc if ended else np.inf, begin


def _warnings(prepared: Prepared) -> Iterator[str]:
    if (status := prepared.loads.attrs["status"]) != "done":
        yield f'the run\'s status is "{status}": only its stored frames are used'
    if prepared.every > 1:
        yield f"stored with output.every = {prepared.every}: peaks between frames are lost, too little damage"
    for surface, motion in prepared.motions.items():
        passed = np.count_nonzero(motion.complete)
        if passed < MIN_REPRESENTATIVE_POINTS:
            yield f"points of surface {surface} that passed the whole contact: {passed}; raise time.travel"
