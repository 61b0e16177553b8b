"""From a result file to a post-processing result: tasks over surfaces and depths."""

from functools import partial
from typing import NamedTuple

import numpy as np

from ehlpetsc.errors import PostError
from ehlpetsc.post.fatigue.accumulate import Counter, Counting
from ehlpetsc.post.fatigue.statistics import asperities, log_life, weibull_fit
from ehlpetsc.post.inputs.loads import SURFACES, Loads
from ehlpetsc.post.inputs.settings import read_settings
from ehlpetsc.post.outputs.store import Parts, fingerprint, stored_mark, write_result
from ehlpetsc.post.stresses.body_points import body_points, passage
from ehlpetsc.post.stresses.body_stress import QUANTUM
from ehlpetsc.post.stresses.gathering import Sweep, blocks, workers

MEMORY = 1e9  # bytes of open histories; too few and frames are gone through twice
DEPTHS_AT_ONCE = 4  # share reading and transforms of the loads
EVERY_LOSS = {2: (5, 6), 4: (16, 14), 8: (35, 24)}
# % of the median point's damage at z/a = 0 and 0.01, by steps between frames: cases/table1_damage.toml,
# thinned by tests/benchmarks/post_every.py


class Job(NamedTuple):
    """What is asked of one result file."""

    path: str
    output: str
    surfaces: tuple = SURFACES
    depths: tuple | None = None
    counting: Counting = Counting()
    regression: str = "x on y"
    jobs: int = 1


class Task(NamedTuple):
    """Some depths of one surface."""

    job: Job
    surface: str
    depths: tuple


def run(job, report=None, progress=None):
    """Compute damage and statistics of one result file and write them to `job.output`.

    Depths already done by an interrupted run with the same input and choices are taken over; a finished
    result of the same is left as it is.

    Parameters
    ----------
    job : Job
    report : callable(str), optional
        Gets warnings and what was done.
    progress : callable(done, of), optional
        Gets the share of the work done.

    Raises
    ------
    PostError
        The result file is not fit for damage; the text says why.
    """
    report = report or (lambda text: None)
    job.counting.check()
    with Loads(job.path) as loads:
        settings = read_settings(loads.case, job.depths)
        loads.check(job.surfaces)
        _check_frames(loads, settings)
        s, motions = _motions(loads, job.surfaces)
        _warn(loads, motions, report)
    mark = fingerprint(job.path, job[2:-1], loads.time.size, loads.case)
    if stored_mark(job.output) == mark:
        report(f"{job.output}: already there, of the same file and options")
        return
    parts = Parts(job.output, mark)
    missing = {surface: [d for d in settings.depths if parts.load(surface, d) is None] for surface in motions}
    with workers(job.jobs) as spread:
        try:
            _work_off(_tasks(job, missing), parts, spread, progress or (lambda done, of: None))
        except PostError:
            parts.remove()  # unlike an interruption, nothing to go on from
            raise
    results = {surface: np.stack([parts.load(surface, d) for d in settings.depths]) for surface in motions}
    _store(job, loads, settings, s, motions, results, mark, report)
    parts.remove()


def _check_frames(loads, settings):
    if loads.time.size < 2:
        what = "holds one stored frame" if settings.transient else "is a steady run with one frame"
        if loads.time.size == 0:
            what = "holds no stored frame"
        raise PostError(f"it {what}: damage needs the stress history, a [time] section and output.every = 1")


def _motions(loads, surfaces):
    speeds = [loads.speeds[surface] for surface in surfaces]
    s = body_points(loads.x, loads.dx, loads.time, speeds)
    motions = {
        surface: passage(s, loads.x, loads.dx, loads.time, speed)
        for surface, speed in zip(surfaces, speeds, strict=True)
    }
    if not any(motion.complete.any() for motion in motions.values()):
        moved = max(abs(speed) for speed in speeds) * (loads.time[-1] - loads.time[0]) / loads.a
        width = (loads.x[-1] - loads.x[0]) / loads.a
        raise PostError(
            f"no body point passed the whole contact: the surfaces moved {moved:.3g} half widths, the "
            f"domain is {width:.3g} wide; raise time.travel"
        )
    return s, motions


def _warn(loads, motions, report):
    if loads.status not in ("done", "unknown"):
        report(f'warning: the run\'s status is "{loads.status}": only its stored frames are used')
    if loads.every > 1:
        steps = min(EVERY_LOSS, key=lambda known: abs(known - loads.every))
        top, below = EVERY_LOSS[steps]
        report(
            f"warning: stored with output.every = {loads.every}: peaks between frames are lost; with every "
            f"{steps} two measured surfaces lost {top} % of a typical point's damage at z = 0 and {below} % "
            "at z/a = 0.01, more where damage is largest"
        )
    for surface, motion in motions.items():
        if not motion.complete.any():
            report(f"warning: no point of the {surface} surface passed the whole contact: its damage is nan")


def _tasks(job, missing):
    """Split the missing depths into tasks of about as many each."""
    tasks = []
    for surface, depths in missing.items():
        number = -(-len(depths) // DEPTHS_AT_ONCE)
        tasks += [Task(job, surface, tuple(depths[k::number])) for k in range(number)]
    return tasks


def _work_off(tasks, parts, spread, progress):
    total = sum(len(task.depths) for task in tasks)
    done = 0
    for task in tasks:

        def share(part, done=done, task=task):
            progress(done + part * len(task.depths), total)

        done += _keep(task, solve(task, spread, share), parts)


def _keep(task, values, parts):
    for depth, part in zip(task.depths, values, strict=True):
        parts.save(task.surface, depth, part)
    return len(task.depths)


def solve(task, spread=map, share=None):
    """Damage, cycles and peak range (depths, points, 3) of a task; nan at points that did not pass."""
    job, surface = task.job, task.surface
    with Loads(job.path) as loads:
        material = getattr(read_settings(loads.case, job.depths), surface)
        s, motions = _motions(loads, job.surfaces)
        motion = motions[surface]
        out = np.full((len(task.depths), s.size, 3), np.nan)
        if not motion.complete.any():
            return out
        lengths = motion.leave - motion.enter + 3
        runs = blocks(motion, MEMORY, len(task.depths), job.jobs)
        frames = sum(motion.leave[points].max() + 1 - motion.enter[points].min() for points, _ in runs)
        done = 0

        def finish(counter, depth, first, last, histories):
            counter(histories, lengths[first:last], out[depth, first:last])

        def advance(count):
            nonlocal done
            done += count
            if share:
                share(done / frames)

        counters = spread(partial(Counter, material, job.counting), [motion.samples() + 2] * job.jobs)
        depths = np.array(task.depths) * loads.a / loads.dx
        sweep = Sweep(
            loads,
            surface,
            motion,
            depths,
            QUANTUM * loads.p0,
            [partial(finish, counter) for counter in counters],
            spread,
            advance,
        )
        for points, slots in runs:
            sweep(points, slots)
        return out


def _store(job, loads, settings, s, motions, results, mark, report):
    datasets = {"damage/s": s, "damage/z_over_a": np.array(settings.depths)}
    first = _first_surface(loads, motions)
    groups = {"damage": {"surface": first}}
    for surface in motions:
        values, complete = results[surface], motions[surface].complete
        inner = "" if surface == first else f"{surface}/"
        datasets[f"damage/{surface}"] = values[..., 0]
        datasets[f"damage/{surface}_complete"] = complete.astype(np.uint8)
        other = f"{surface}_" if inner else ""
        datasets[f"damage/{other}cycles"] = values[..., 1]
        datasets[f"damage/{other}peak_range"] = values[..., 2]
        _statistics(
            job, loads, surface, inner, s, complete, values[..., 0], settings, datasets, groups, report
        )
    speeds = {f"speed_{name}": loads.speeds[name] for name in motions}
    mean = (loads.speeds["fast"] + loads.speeds["slow"]) / 2
    attrs = {
        "title": loads.title,
        "case": loads.case,
        "source": str(loads.path),
        "fingerprint": mark,
        "a": loads.a,
        "p0": loads.p0,
        "slide_roll_ratio": (loads.speeds["fast"] - loads.speeds["slow"]) / mean if mean else 0.0,
        "regression": job.regression,
        "every": loads.every,
        **speeds,
        **job.counting._asdict(),
    }
    write_result(job.output, datasets, attrs, groups)


def _first_surface(loads, motions):
    """The surface under the fixed names: the slow one, whose asperities meet more others, if it is rough."""
    for surface in motions:
        if loads.profiles[surface] is not None and motions[surface].complete.any():
            return surface
    return next(iter(motions))


def _statistics(job, loads, surface, inner, s, complete, damage, settings, datasets, groups, report):
    peaks = asperities(loads.profiles[surface], s, complete)
    under = damage[:, peaks.point]
    fits = np.array([weibull_fit(log_life(row), job.regression) for row in under]).reshape(-1, 3)
    beyond = (under >= 1).sum(axis=1)
    for name, values in (("s", peaks.s), ("height", peaks.height), ("damage", under)):
        datasets[f"asperities/{inner}{name}"] = values
    for name, values in (
        ("alpha", fits[:, 0]),
        ("beta", fits[:, 1]),
        ("r_squared", fits[:, 2]),
        ("at_least_one", beyond),
        ("undamaged", (under == 0).sum(axis=1)),
    ):
        datasets[f"weibull/{inner}{name}"] = values
    if loads.profiles[surface] is not None:
        datasets[f"profile/{surface}/s"], datasets[f"profile/{surface}/z"] = loads.profiles[surface]
    for group in ("asperities", "weibull"):
        groups[f"{group}/{inner}".rstrip("/")] = {"surface": surface}
    for depth, count in zip(settings.depths, beyond, strict=True):
        if count:
            report(
                f"note: {count} of {peaks.s.size} asperities of the {surface} surface have damage of 1 or "
                f"more at z/a = {depth:g}: failure in the first pass"
            )
