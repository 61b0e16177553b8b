"""Preparation of a result file: settings, body points and their passages."""

from typing import NamedTuple

import numpy as np

from ehlpetsc.errors import PostError
from ehlpetsc.post.inputs.consistency import check_scales, check_time_step
from ehlpetsc.post.inputs.gaps import find_gaps, frames_missed
from ehlpetsc.post.inputs.input_checks import input_digest
from ehlpetsc.post.inputs.loads import Loads
from ehlpetsc.post.inputs.settings import Settings, read_settings
from ehlpetsc.post.stresses.body_points import NO_FLANK, body_points, passage

MAX_POINTS = 5_000_000
MIN_REPRESENTATIVE_POINTS = 30  # of a surface
END_TOLERANCE = 0.01  # of the duration: a last frame nearer to the end counts as at the end
MIN_SPEED = 1e-3  # of the faster surface's speed: slower surfaces take too long to pass
DAMAGE_LOSS = {2: (5, 6), 4: (16, 14), 8: (35, 24)}
# % of the median point's damage at z/a = 0 and 0.01, by steps between frames: cases/table1_damage.toml,
# thinned by tests/benchmarks/post_every.py


class Prepared(NamedTuple):
    """Checked data of a result file, for all tasks.

    Attributes
    ----------
    loads : Loads
    settings : Settings
    every : int
        Steps between stored frames.
    s : ndarray (ns,)
        Body points, m.
    motions : dict
        Passage by surface; complete only without missing frames.
    missed : dict
        Frames missing while each point was among the nodes, (ns,), by surface.
    digest : str
        Digest of all inputs of the damage.
    """

    loads: Loads
    settings: Settings
    every: int
    s: np.ndarray
    motions: dict
    missed: dict
    digest: str


def prepare(loads, surfaces, report):
    """Check a result file against its case and find the body points that can be computed.

    Parameters
    ----------
    loads : Loads
    surfaces : sequence of str
    report : callable(str)
        Called with warnings.

    Raises
    ------
    PostError
        The file is not suitable for damage; the message states the reason.
    """
    settings = read_settings(loads.case)
    loads.check(surfaces)
    _check_frames(loads)
    check_scales(loads)
    check_time_step(loads)
    gaps = find_gaps(loads)
    s, motions = _motions(loads, surfaces)
    missed = {name: frames_missed(gaps, motion, loads.x.size) for name, motion in motions.items()}
    digest = input_digest(loads, surfaces)
    complete = {name: m._replace(complete=m.complete & (missed[name] == 0)) for name, m in motions.items()}
    _warn(loads, gaps, motions, complete, report)
    return Prepared(loads, settings, gaps.every, s, complete, missed, digest)


def _check_frames(loads):
    if loads.time.size < 2 or loads.case.time is None:
        reason = "holds one stored frame" if loads.case.time else "is a steady run"
        if loads.time.size == 0:
            reason = "holds no stored frame"
        raise PostError(
            f"it {reason}: damage needs the stress history, a [time] section and output.every = 1"
        )


def _motions(loads, surfaces):
    distances = [loads.travelled[surface] for surface in surfaces]
    moved = max(abs(distance[-1] - distance[0]) for distance in distances)
    if moved / loads.dx + loads.x.size > MAX_POINTS:
        raise PostError(
            f"the surfaces moved {moved / loads.dx:.3g} nodes: more than {MAX_POINTS} body points"
        )
    s = body_points(loads.x, loads.dx, distances)
    try:
        motions = {
            surface: passage(s, loads.x, loads.dx, distance, _flank(loads, surface))
            for surface, distance in zip(surfaces, distances, strict=True)
        }
    except ValueError as fault:
        raise PostError(str(fault)) from None
    if not any(motion.complete.any() for motion in motions.values()):
        width = (loads.x[-1] - loads.x[0]) / loads.a
        raise PostError(
            f"no body point passed the whole contact: the surfaces moved {moved / loads.a:.3g} half widths, "
            f"the domain is {width:.3g} wide; raise time.travel"
        )
    return s, motions


def _flank(loads, surface):
    """Points of a flank between the ends of its path of contact, if the run has reached its end."""
    case, number = loads.case, int(surface) - 1
    if case.gears is None:
        return NO_FLANK
    pair, begin = case.gears.pair, case.conditions.profile_offsets[number]
    arc = pair.flank_arcs(pair.points["E"])[number]
    ended = loads.time[-1] > (1.0 - END_TOLERANCE) * loads.operation.duration
    return begin - arc if ended else np.inf, begin


def _warn(loads, gaps, motions, complete, report):
    if loads.status not in ("done", "unknown"):
        report(f'warning: the run\'s status is "{loads.status}": only its stored frames are used')
    if gaps.every > 1:
        steps = min(DAMAGE_LOSS, key=lambda studied: abs(studied - gaps.every))
        top, below = DAMAGE_LOSS[steps]
        report(
            f"warning: stored with output.every = {gaps.every}: peaks between frames are lost; with every "
            f"{steps} two measured surfaces lost {top} % of a typical point's damage at z = 0 and {below} % "
            "at z/a = 0.01, more where damage is largest"
        )
    _report_gaps(loads, gaps, motions, complete, report)
    for surface, motion in complete.items():
        passed = np.count_nonzero(motion.complete)
        if not motions[surface].complete.any():
            report(
                f"warning: no point of surface {surface} passed the whole contact: its damage is nan"
                f"{_travel_needed(loads, surface, 'lets some through')}"
            )
        elif passed < MIN_REPRESENTATIVE_POINTS:
            report(
                f"warning: only {passed} point{'s' if passed > 1 else ''} of surface {surface} passed "
                "the whole contact, and its damage is theirs"
                f"{_travel_needed(loads, surface, 'lets a half width through', 1.0)}"
            )


def _travel_needed(loads, surface, why, passed=0.0):
    """Text of the travel for `passed` half widths of a surface to cross the mesh; "" if it hardly moves."""
    distance, longest = (abs(w[-1] - w[0]) for w in (loads.travelled[surface], _longest(loads)))
    if distance < MIN_SPEED * longest:
        return ""
    width = (loads.x[-1] - loads.x[0]) / loads.a + passed
    return f"; time.travel = {np.ceil(10 * width * longest / distance + 0.5) / 10:g} or more {why}"


def _longest(loads):
    return max(loads.travelled.values(), key=lambda distances: abs(distances[-1] - distances[0]))


def _report_gaps(loads, gaps, motions, complete, report):
    """Report points without damage because of missing frames; PostError if no point is left."""
    if not gaps.after.size:
        return
    frame = gaps.after[0]
    where = f"after step {loads.step[frame]}"
    positions = f"{gaps.after.size} places, first" if gaps.after.size > 1 else "one place,"
    lost = f"{gaps.missing.sum()} frames are missing in {positions} {where}"
    if not any(motion.complete.any() for motion in complete.values()):
        raise PostError(
            f"{lost}, while every point that passed was in the contact: peaks are lost, so no damage is given"
        )
    for surface, motion in motions.items():
        passed, left = motion.complete.sum(), complete[surface].complete.sum()
        if left < passed:
            report(
                f"warning: {lost}: {passed - left} of {passed} points of surface {surface} were in the "
                f"contact then; their damage is nan (damage/{surface}_missed)"
            )
