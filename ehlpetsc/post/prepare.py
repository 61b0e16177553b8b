"""Preparation of a result file: settings of its case, body points and their passages."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
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


class Prepared(NamedTuple):
    """Data of a result file for all tasks.

    `s`: body points (ns,) [m]. `motions`: passages by surface. `materials`: by surface. `criteria`: their
    constants. `depths`: z/a.
    """

    loads: Loads
    s: np.ndarray
    motions: dict[str, Passage]
    materials: dict[str, Material]
    criteria: Criteria
    depths: np.ndarray


def materials_of(case: Case) -> dict[str, Material]:
    """Constants of the fatigue curves of each surface."""
    contact, given = case.contact, case.post.as_dict()
    bodies = zip(contact.youngs_modulus, contact.poisson_ratio, named_steels(contact.material), strict=True)
    one, two = (Material(*elastic, **fatigue_constants(steel, given)) for *elastic, steel in bodies)
    mean = {"tensile_strength": case.post.tensile_strength, "walker_exponent": case.post.walker_exponent}
    return {"1": replace(one, **mean), "2": replace(two, **mean)}


def prepare(loads: Loads, surfaces: Sequence[str], report: Callable[[str], None]) -> Prepared:
    """Find the body points whose damage can be computed, and report what limits it.

    PostError if there are none, or if the fatigue limits contradict each other.
    """
    post = loads.case.post
    constants = {name: getattr(post, name) for name in Criteria.__dataclass_fields__}
    criteria = Criteria(**{name: value for name, value in constants.items() if value is not None})
    loads.check(surfaces)
    depths = np.unique(post.depths or DEPTHS).astype(float)
    prepared = Prepared(loads, *_motions(loads, surfaces), materials_of(loads.case), criteria, depths)
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
    if (every := prepared.loads.case.output.every) > 1:
        yield f"stored with output.every = {every}: peaks between frames are lost, too little damage"
    for surface, motion in prepared.motions.items():
        passed = np.count_nonzero(motion.complete)
        if passed < MIN_REPRESENTATIVE_POINTS:
            yield f"points of surface {surface} that passed the whole contact: {passed}; raise time.travel"
