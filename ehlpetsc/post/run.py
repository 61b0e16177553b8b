"""Post-processing of one result file, in tasks over surfaces and depths."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ehlpetsc import __version__
from ehlpetsc.base.errors import OutputError
from ehlpetsc.base.materials import DEFAULT, FATIGUE_KEYS
from ehlpetsc.case.loading import Case
from ehlpetsc.post.contents import attributes_of, datasets_of, write_result
from ehlpetsc.post.criteria import CRITERIA
from ehlpetsc.post.fatigue.accumulate import Counter, Counting
from ehlpetsc.post.loads import Loads
from ehlpetsc.post.prepare import Prepared, Settings, prepare
from ehlpetsc.post.stresses.body_stress import QUANTUM
from ehlpetsc.post.stresses.histories import HistoryCollector, runs_of_points, workers
from ehlpetsc.results.post_result import SURFACES, PostResult

MAX_HISTORY_BYTES = 1e9  # of histories in memory; frames are read several times if they need more
DEPTHS_AT_ONCE = 4  # with common reading and transforms of the loads


class Job(NamedTuple):
    """One result file and the settings of its processing.

    `depths` overrides the depths of the case, `settings` ("table.key=value") other keys; the strain rule of
    `counting` is that of the case, whose criterion is added to `criteria`.
    """

    path: str
    output: str
    surfaces: tuple[str, ...] = SURFACES
    depths: tuple[float, ...] | None = None
    counting: Counting = Counting()
    jobs: int = 1
    criteria: tuple[str, ...] = ()
    settings: tuple[str, ...] = ()

    def overrides(self) -> list:
        """Overrides of the case, see `ehlpetsc.load`."""
        depths = () if self.depths is None else (("post.depths", list(self.depths)),)
        return [*self.settings, *depths]

    def of_case(self, case: Case) -> Job:
        """The job with the strain rule and the criterion of a case."""
        own = () if case.post.criterion == "von-mises" else (case.post.criterion,)
        criteria = tuple(name for name in CRITERIA if name in (*self.criteria, *own))
        return self._replace(counting=self.counting._replace(strain=case.post.strain), criteria=criteria)

    def fingerprint(self) -> str:
        """Hash of the settings and of the version of the result file."""
        source = Path(self.path).stat()
        items = [__version__, *self._replace(output="", jobs=1), source.st_size, source.st_mtime_ns]
        return hashlib.sha256(json.dumps(items).encode()).hexdigest()

    def is_done(self) -> bool:
        """Whether the output exists, made by this job."""
        try:
            return PostResult(self.output).attrs.get("fingerprint") == self.fingerprint()
        except OutputError:
            return False


class Task(NamedTuple):
    """Depths of one surface that one task processes."""

    surface: str
    depths: tuple[float, ...]


class Counters:
    """Columns of results of blocks of histories: damage of the paper, then other criteria."""

    def __init__(
        self, settings: Settings, surface: str, counting: Counting, criteria: Sequence[str], samples: int
    ) -> None:
        material = settings.material(surface)
        self.parts: list[Any] = [Counter(material, counting, samples)]
        if criteria:
            from ehlpetsc.post.criteria.search import counter_of  # slow to compile: only if requested

            options = counting.residue, counting.strain, samples
            self.parts += [counter_of(name, material, settings.criteria, *options) for name in criteria]

    def __call__(
        self, stress: np.ndarray, lengths: np.ndarray, out: np.ndarray, residual: float = 0.0
    ) -> None:
        """Stress (points, 3, samples), lengths (points,) -> out (points, columns); `residual` in Pa."""
        first = 0
        for counter in self.parts:
            values = np.empty((len(out), len(counter.columns)))
            counter(stress, lengths, values, residual)
            out[:, first : first + values.shape[1]] = values
            first += values.shape[1]


def columns(criteria: Sequence[str]) -> list[tuple[str, str]]:
    """Pairs (criterion, column) of the criteria other than the paper's, in the order of the results."""
    if not criteria:
        return []
    from ehlpetsc.post.criteria.search import columns_of  # as above

    return [(name, column) for name in criteria for column in columns_of(name)]


def run(
    job: Job,
    report: Callable[[str], None] = lambda text: None,
    progress: Callable[[float, int], None] = lambda done, of: None,
) -> None:
    """Compute damage and statistics of one result file and write them to `job.output`, replacing it.

    `report` is called with warnings and notes, `progress` with the finished and all depths of surfaces.

    Raises
    ------
    OutputError, CaseError
        The result file or its case cannot be read.
    PostError
        The result file is not suitable for damage.
    OSError
        The output cannot be written, as on a full disk; no file is left.
    """
    job.counting.check()
    with Loads(job.path, job.overrides()) as loads:
        identity = job.fingerprint()
        job = job.of_case(loads.case)
        prepared = prepare(loads, job.surfaces, report)
        _note_material(loads.case, job.criteria, report)
        _note_heat(loads, job.surfaces, report)
        if prepared.settings.residual_stress and job.counting.mean_stress == "none" and not job.criteria:
            report("note: residual_stress changes nothing without --mean-stress morrow or --criterion")
        computed = _compute(job, prepared, progress)
        depths = np.array(prepared.settings.depths)
        datasets: dict[str, Any] = {"damage/s": prepared.s, "damage/z_over_a": depths}
        for surface, values in computed.items():
            found, notes = datasets_of(prepared, surface, values, columns(job.criteria))
            datasets |= found
            for note in notes:
                report(note)
        attributes = attributes_of(prepared) | _settings_of(job, loads.case)
        write_result(job.output, datasets, attributes | {"fingerprint": identity})


def _settings_of(job: Job, case: Case) -> dict[str, Any]:
    """Root attributes: settings of the job."""
    return {
        "material": ", ".join(case.contact.material or (DEFAULT,)),
        "settings": "\n".join(job.settings),
        "residual_stress": np.array(case.post.residual_stress or (), float).reshape(-1, 2),
        **job.counting._asdict(),
    }


def _note_material(case: Case, criteria: Sequence[str], report: Callable[[str], None]) -> None:
    """Report the default steel if the case names none, and the assumptions of Dang Van's limits."""
    if case.contact.material is None and all(getattr(case.post, key) is None for key in FATIGUE_KEYS):
        report(f"note: fatigue constants of {DEFAULT}, as in the paper; contact.material names another steel")
    if "dang-van" in criteria:
        report(
            "note: dang-van holds where the steel has shaken down to elastic cycles; torsion_limit and "
            "bending_limit left out are those of bearing steel (ISO 281)"
        )


def _note_heat(loads: Loads, surfaces: Sequence[str], report: Callable[[str], None]) -> None:
    """Report the treatment of heat in the result."""
    if loads.case.heat is None:
        return
    if cold := [surface for surface in surfaces if surface not in loads.heated([surface])]:
        names = ", ".join(f'"temperature_{surface}"' for surface in cold)
        report(f"note: no surface temperatures in it: list {names} in output.fields of the case for them")
    report("note: thermal stresses are not computed: damage is that of pressure and shear stress alone")


def _compute(job: Job, prepared: Prepared, progress: Callable[[float, int], None]) -> dict[str, np.ndarray]:
    """Results (depths, points, columns) of each surface."""
    depths, done = prepared.settings.depths, 0
    number = -(-len(depths) // DEPTHS_AT_ONCE)  # of tasks of about equal size
    found: dict[str, dict[float, np.ndarray]] = {surface: {} for surface in prepared.motions}
    with workers(job.jobs) as map_:
        for surface, values in found.items():
            for task in (Task(surface, depths[k::number]) for k in range(number)):

                def task_progress(fraction: float, done: int = done, task: Task = task) -> None:
                    progress(done + fraction * len(task.depths), len(found) * len(depths))

                values |= zip(task.depths, solve(job, prepared, task, map_, task_progress), strict=True)
                done += len(task.depths)
    return {surface: np.stack([values[depth] for depth in depths]) for surface, values in found.items()}


def solve(
    job: Job,
    prepared: Prepared,
    task: Task,
    map_: Callable = map,
    progress: Callable[[float], None] = lambda fraction: None,
) -> np.ndarray:
    """Damage, cycles, peak range, criteria (depths, points, 3 ...) of a task; nan for incomplete points."""
    loads, motion = prepared.loads, prepared.motions[task.surface]
    width = len(Counter.columns) + len(columns(job.criteria))
    out = np.full((len(task.depths), prepared.s.size, width), np.nan)
    residual = [prepared.settings.residual(depth) for depth in task.depths]
    if not motion.complete.any():
        return out
    lengths = motion.leave - motion.enter + 3
    runs = runs_of_points(motion, MAX_HISTORY_BYTES, len(task.depths))
    frames = sum(motion.leave[points].max() + 1 - motion.enter[points].min() for points in runs)
    done = 0

    def finish(counter: Counters, depth: int, first: int, last: int, histories: np.ndarray) -> None:
        counter(histories, lengths[first:last], out[depth, first:last], residual[depth])

    def advance(count: int) -> None:
        nonlocal done
        done += count
        progress(done / frames)

    make = partial(Counters, prepared.settings, task.surface, job.counting, job.criteria)
    counters = list(map_(make, [motion.samples() + 2] * job.jobs))
    depths, quantum = np.array(task.depths) * loads.a / loads.dx, QUANTUM * loads.p0
    collect = HistoryCollector(loads, task.surface, motion, depths, quantum, map_, advance)
    for points in runs:
        collect(points, [partial(finish, counter) for counter in counters])
    return out
