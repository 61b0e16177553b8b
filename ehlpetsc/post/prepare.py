"""What every task of a result file needs, worked out once: settings, body points, their passages."""

from typing import NamedTuple

import numpy as np

from ehlpetsc.errors import PostError
from ehlpetsc.post.inputs.gaps import find_gaps, frames_missed, steps_between
from ehlpetsc.post.inputs.loads import Loads
from ehlpetsc.post.inputs.plausibility import check_movement, check_scales, nominal_movement
from ehlpetsc.post.inputs.settings import Settings, parse_case, read_settings
from ehlpetsc.post.inputs.survey import survey
from ehlpetsc.post.stresses.body_points import body_points, passage

MOST_POINTS = 5_000_000
SLOWEST = 1e-3  # of the faster surface's speed: nobody waits for less
EVERY_LOSS = {2: (5, 6), 4: (16, 14), 8: (35, 24)}
# % of the median point's damage at z/a = 0 and 0.01, by steps between frames: cases/table1_damage.toml,
# thinned by tests/benchmarks/post_every.py


class Prepared(NamedTuple):
    """A result file ready to be computed from.

    Attributes
    ----------
    loads : Loads
    settings : Settings
    every : int
        Steps between stored frames.
    s : ndarray (ns,)
        Body points, m.
    motions : dict
        Passage by surface; complete only where no frame is missing.
    missed : dict
        Frames missing while each point was among the nodes, (ns,), by surface.
    digest : str
        Of all that the damage depends on.
    """

    loads: Loads
    settings: Settings
    every: int
    s: np.ndarray
    motions: dict
    missed: dict
    digest: str


def prepare(loads, surfaces, depths, report):
    """Check a result file against its own case and find out which body points can be computed.

    Parameters
    ----------
    loads : Loads
    surfaces : sequence of str
    depths : sequence of float or None
        Instead of those of the case.
    report : callable(str)
        Gets warnings.

    Raises
    ------
    PostError
        The file is not fit for damage; the text says why.
    """
    case = parse_case(loads.case)
    settings = read_settings(case, depths)
    loads.check(surfaces)
    _check_frames(loads, transient=bool(case["time"]))
    check_scales(loads, case)
    check_movement(loads, case, steps_between(loads))
    gaps = find_gaps(loads, nominal_movement(case))
    s, motions = _motions(loads, surfaces)
    missed = {name: frames_missed(gaps, motion, loads.x.size) for name, motion in motions.items()}
    digest = survey(loads, case, surfaces)
    whole = {name: m._replace(complete=m.complete & (missed[name] == 0)) for name, m in motions.items()}
    _warn(loads, gaps, motions, whole, report)
    return Prepared(loads, settings, gaps.every, s, whole, missed, digest)


def _check_frames(loads, transient):
    if loads.time.size < 2:
        what = "holds one stored frame" if transient else "is a steady run with one frame"
        if loads.time.size == 0:
            what = "holds no stored frame"
        raise PostError(f"it {what}: damage needs the stress history, a [time] section and output.every = 1")


def _motions(loads, surfaces):
    speeds = [loads.speeds[surface] for surface in surfaces]
    moved = max(map(abs, speeds)) * (loads.time[-1] - loads.time[0])
    if moved / loads.dx + loads.x.size > MOST_POINTS:
        raise PostError(
            f"the surfaces moved {moved / loads.dx:.3g} nodes: more than {MOST_POINTS} body points"
        )
    s = body_points(loads.x, loads.dx, loads.time, speeds)
    motions = {
        surface: passage(s, loads.x, loads.dx, loads.time, speed)
        for surface, speed in zip(surfaces, speeds, strict=True)
    }
    if not any(motion.complete.any() for motion in motions.values()):
        width = (loads.x[-1] - loads.x[0]) / loads.a
        raise PostError(
            f"no body point passed the whole contact: the surfaces moved {moved / loads.a:.3g} half widths, "
            f"the domain is {width:.3g} wide; raise time.travel"
        )
    return s, motions


def _warn(loads, gaps, motions, whole, report):
    if loads.status not in ("done", "unknown"):
        report(f'warning: the run\'s status is "{loads.status}": only its stored frames are used')
    if gaps.every > 1:
        steps = min(EVERY_LOSS, key=lambda known: abs(known - gaps.every))
        top, below = EVERY_LOSS[steps]
        report(
            f"warning: stored with output.every = {gaps.every}: peaks between frames are lost; with every "
            f"{steps} two measured surfaces lost {top} % of a typical point's damage at z = 0 and {below} % "
            "at z/a = 0.01, more where damage is largest"
        )
    _tell_gaps(loads, gaps, motions, whole, report)
    for surface, motion in motions.items():
        if not motion.complete.any():
            report(
                f"warning: no point of the {surface} surface passed the whole contact: its damage is nan"
                f"{_travel_needed(loads, surface)}"
            )


def _travel_needed(loads, surface):
    """What lets points of a surface go from one end of the mesh to the other; empty if it stands still."""
    speed, fastest = abs(loads.speeds[surface]), max(map(abs, loads.speeds.values()))
    if speed < SLOWEST * fastest:
        return ""
    width = (loads.x[-1] - loads.x[0]) / loads.a
    return f"; time.travel = {np.ceil(10 * width * fastest / speed + 0.5) / 10:g} or more lets some through"


def _tell_gaps(loads, gaps, motions, whole, report):
    """Points that were in the contact while frames are missing have no damage; PostError if none is left."""
    if not gaps.after.size:
        return
    frame = gaps.after[0]
    where = f"after t = {loads.time[frame]:.6g} s"
    if loads.step is not None:
        where = f"after step {loads.step[frame]}"
    places = f"{gaps.after.size} places, first" if gaps.after.size > 1 else "one place,"
    what = f"{gaps.missing.sum()} frames are missing in {places} {where}"
    if not any(motion.complete.any() for motion in whole.values()):
        raise PostError(
            f"{what}, while every point that passed was in the contact: peaks are lost, so no damage is given"
        )
    for surface, motion in motions.items():
        passed, left = motion.complete.sum(), whole[surface].complete.sum()
        if left < passed:
            report(
                f"warning: {what}: {passed - left} of {passed} points of the {surface} surface were in the "
                f"contact then; their damage is nan (damage/{surface}_missed)"
            )
