"""Post-processing of one result file, in tasks over surfaces and depths."""

from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ehlpetsc.errors import OutputError, PostError
from ehlpetsc.materials import DEFAULT, FATIGUE_KEYS
from ehlpetsc.post.counters import PAPER, Counters, columns
from ehlpetsc.post.fatigue.accumulate import Counting
from ehlpetsc.post.inputs.loads import Loads
from ehlpetsc.post.outputs.contents import Contents
from ehlpetsc.post.outputs.depth_cache import DepthCache
from ehlpetsc.post.outputs.result_file import check_output, fingerprint, stored_fingerprint, write_result
from ehlpetsc.post.prepare import prepare
from ehlpetsc.post.stresses.body_stress import QUANTUM
from ehlpetsc.post.stresses.histories import HistoryCollector, runs_of_points, workers
from ehlpetsc.results.output_guard import Lock
from ehlpetsc.results.post_result import SURFACES

MAX_HISTORY_BYTES = 1e9  # of histories in memory; frames are read several times if they need more
ASPERITY_HALF_WIDTH = 0.02  # half widths on either side of a peak, over which the damage is the maximum
DEPTHS_AT_ONCE = 4  # with common reading and transforms of the loads


class Job(NamedTuple):
    """One result file and the settings of its processing.

    `depths` overrides the depths of the case, `settings` ("table.key=value") other keys; the strain rule of
    `counting` is that of the case.
    """

    path: str
    output: str
    surfaces: tuple = SURFACES
    depths: tuple | None = None
    counting: Counting = Counting()
    regression: str = "x on y"
    jobs: int = 1
    criteria: tuple = ()
    within: float = ASPERITY_HALF_WIDTH
    settings: tuple = ()

    def overrides(self):
        """Overrides of the case, see `ehlpetsc.load`."""
        depths = () if self.depths is None else (("post.depths", list(self.depths)),)
        return [*self.settings, *depths]


class Task(NamedTuple):
    """Depths of one surface that one task processes."""

    surface: str
    depths: tuple


def run(job, report=None, progress=None):
    """Compute damage and statistics of one result file and write them to `job.output`.

    Finished depths of an interrupted run with the same input and settings are reused; a finished result of
    the same input and settings is not computed again.

    Parameters
    ----------
    job : Job
    report : callable(str), optional
        Called with warnings and notes.
    progress : callable(done, of), optional
        Called with the finished work.

    Raises
    ------
    OutputError, CaseError
        The result file or its case cannot be read, or the output may not be overwritten.
    PostError
        The result file is not suitable for damage.
    OSError
        The output cannot be written, as on a full disk; no file is left.
    """
    report = report or (lambda text: None)
    job.counting.check()
    check_output(job.output, [job.path])
    with Loads(job.path, job.overrides()) as loads:
        job = job._replace(counting=job.counting._replace(strain=loads.case.post.strain))
        prepared = prepare(loads, job.surfaces, report)
        choices = job.counting, job.regression, job.criteria, job.within
        identity = fingerprint(prepared.digest, job.surfaces, prepared.settings, *choices)
        if stored_fingerprint(job.output) == identity:
            report(f"{job.output}: already there, of the same file and options")
            return
        _note_material(loads.case, job.criteria, report)
        _note_heat(loads, job.surfaces, report)
        if prepared.settings.residual_stress and job.counting.mean_stress == "none" and not job.criteria:
            report("note: residual_stress changes nothing without --mean-stress morrow or --criterion")
        if job.counting.ranges == "window":
            report("note: counting takes four to eleven times as long with --ranges window")
        lock = Lock(Path(job.output), "wait for it, or give another -o")
        with lock, DepthCache(job.output, identity) as cache:
            try:
                _compute(job, prepared, cache, progress or (lambda done, of: None))
                _store(job, prepared, cache, identity, report)
            except (PostError, OutputError, OSError):
                cache.remove()  # the run cannot be continued, unlike after an interruption
                raise
            cache.remove()


def _note_material(case, criteria, report):
    """Report the default steel if the case names none, and the assumptions of Dang Van's limits."""
    if case.contact.material is None and all(getattr(case.post, key) is None for key in FATIGUE_KEYS):
        report(f"note: fatigue constants of {DEFAULT}, as in the paper; contact.material names another steel")
    if "dang-van" in criteria:
        report(
            "note: dang-van holds where the steel has shaken down to elastic cycles; torsion_limit and "
            "bending_limit left out are those of bearing steel (ISO 281)"
        )


def _note_heat(loads, surfaces, report):
    """Report the treatment of heat in the result."""
    if loads.case.heat is None:
        return
    if cold := [surface for surface in surfaces if surface not in loads.heated([surface])]:
        names = ", ".join(f'"temperature_{surface}"' for surface in cold)
        report(f"note: no surface temperatures in it: list {names} in output.fields of the case for them")
    report("note: thermal stresses are not computed: damage is that of pressure and shear stress alone")


def _compute(job, prepared, cache, progress):
    depths = prepared.settings.depths
    missing = {surface: [d for d in depths if not cache.has(surface, d)] for surface in prepared.motions}
    tasks = _tasks(missing)
    total = sum(len(task.depths) for task in tasks)
    done = 0
    with workers(job.jobs) as map_:
        for task in tasks:

            def task_progress(fraction, done=done, task=task):
                progress(done + fraction * len(task.depths), total)

            values = solve(job, prepared, task, map_, task_progress)
            for depth, results in zip(task.depths, values, strict=True):
                cache.save(task.surface, depth, results)
            done += len(task.depths)


def _tasks(missing):
    """Split the missing depths into tasks of about equal size."""
    tasks = []
    for surface, depths in missing.items():
        number = -(-len(depths) // DEPTHS_AT_ONCE)
        tasks += [Task(surface, tuple(depths[k::number])) for k in range(number)]
    return tasks


def solve(job, prepared, task, map_=map, progress=None):
    """Damage, cycles, peak range, criteria (depths, points, 3 ...) of a task; nan for incomplete points."""
    loads, motion = prepared.loads, prepared.motions[task.surface]
    width = len(PAPER) + len(columns(job.criteria))
    out = np.full((len(task.depths), prepared.s.size, width), np.nan)
    residual = [prepared.settings.residual(depth) for depth in task.depths]
    if not motion.complete.any():
        return out
    lengths = motion.leave - motion.enter + 3
    runs = runs_of_points(motion, MAX_HISTORY_BYTES, len(task.depths))
    frames = sum(motion.leave[points].max() + 1 - motion.enter[points].min() for points in runs)
    done = 0

    def finish(counter, depth, first, last, histories):
        counter(histories, lengths[first:last], out[depth, first:last], residual[depth])

    def advance(count):
        nonlocal done
        done += count
        if progress:
            progress(done / frames)

    make = partial(Counters, prepared.settings, task.surface, job.counting, job.criteria)
    counters = list(map_(make, [motion.samples() + 2] * job.jobs))
    depths, quantum = np.array(task.depths) * loads.a / loads.dx, QUANTUM * loads.p0
    collect = HistoryCollector(loads, task.surface, motion, depths, quantum, map_, advance)
    for points in runs:
        collect(points, [partial(finish, counter) for counter in counters])
    return out


def _store(job, prepared, cache, identity, report):
    contents = Contents(prepared, job.regression, columns(job.criteria), job.within)
    for surface in prepared.motions:
        contents.add(surface, np.stack([cache.load(surface, d) for d in prepared.settings.depths]))
        contents.add_temperatures(surface)
    for note in contents.notes:
        report(note)
    attributes = contents.attributes(identity, job.counting, job.settings)
    write_result(job.output, contents.datasets, attributes, contents.groups)
