"""Post-processing of one result file: stress histories of its body points, and their damage."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache, partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ehlpetsc.base.compiled import compiled
from ehlpetsc.base.errors import OutputError, PostError
from ehlpetsc.base.materials import DEFAULT, FATIGUE_KEYS
from ehlpetsc.base.version import __version__
from ehlpetsc.case.assumptions import COMMANDS, SMOOTH, refusal
from ehlpetsc.case.loading import Case
from ehlpetsc.post.contents import attributes_of, datasets_of, write_result
from ehlpetsc.post.counting import count_of
from ehlpetsc.post.criteria import CRITERIA
from ehlpetsc.post.loads import Loads, PointPassage, Prepared, prepare
from ehlpetsc.post.smooth_contact import smooth_contact
from ehlpetsc.post.stresses.body_stress import QUANTA, BodyStress, offset_weights
from ehlpetsc.results.post_result import UPPER_FIRST, PostResult, SmoothContact

MAX_HISTORY_NUMBERS = 2.5e8  # of histories in memory; frames are read several times if they need more
FRAMES_PER_READ = 144
PLANE_COLUMNS = ("damage", "inclination", "tilt")  # of `criteria.critical_plane.PlaneDamage`
DEPTHS_AT_ONCE = 16  # with common reading and transforms of the loads


class Job(NamedTuple):
    """One result file and the settings of its processing.

    `settings` ("table.key=value") override keys of the case, whose criterion is added to `criteria`.
    `share`: of the points of a plane, the worst ones, whose critical planes are sought (see
    :func:`.criteria.critical_plane.count_on_planes`). `precision`: of stress histories.
    """

    path: str
    output: str
    surfaces: tuple[str, ...] = UPPER_FIRST
    jobs: int = 1
    criteria: tuple[str, ...] = ()
    settings: tuple[str, ...] = ()
    share: float = 0.01
    precision: str = "float32"

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


def run(
    job: Job,
    report: Callable[[str], None] = lambda text: None,
    show: Callable[[float], None] = lambda share: None,
) -> None:
    """Compute damage and statistics of one result file and write them to `job.output`, replacing it.

    `report` is called with warnings and notes, `show` with the share of the work that is done.
    """
    with Loads(job.path, job.settings) as loads:
        identity = job.fingerprint()
        try:
            prepared = prepare(loads, job.surfaces, report)
        except PostError as fault:
            raise PostError(f"{job.path}: {fault}") from None
        for note in _notes(job, loads):
            report(note)
        points = sum(motion.complete.sum() for motion in prepared.motions.values())
        done, total = 0.0, 2.0 * len(prepared.depths) * points

        def advance(points: float) -> None:
            nonlocal done
            done += points
            show(done / total)

        datasets: dict[str, Any] = {"damage/s": prepared.s, "damage/z_over_a": prepared.depths}
        if loads.y is not None:
            datasets["damage/y"] = loads.y
        for surface in prepared.motions:
            datasets |= solve(prepared, surface, job, advance)
            datasets |= datasets_of(prepared, surface, datasets[f"damage/{surface}"], report)
            for name, smooth in smooth_contacts(prepared, surface, job).items():
                datasets |= {"smooth/depth": smooth.depths, f"smooth/{name}": smooth.damage}
        provenance = {"settings": "\n".join(job.settings), "fingerprint": identity}
        attributes = attributes_of(prepared) | provenance
        write_result(job.output, datasets, attributes)


def _notes(job: Job, loads: Loads) -> Iterator[str]:
    """Notes on defaults and on the treatment of heat and of residual stress."""
    case = loads.case
    if case.contact.material is None and all(getattr(case.post, key) is None for key in FATIGUE_KEYS):
        yield f"note: fatigue constants of {DEFAULT}, as in the paper; contact.material names another steel"
    if "dang-van" in _criteria(job, case):
        yield (
            "note: dang-van holds where the steel has shaken down to elastic cycles; torsion_limit and "
            "bending_limit left out are those of bearing steel (ISO 281)"
        )
    if case.heat is not None:
        if cold := [surface for surface in job.surfaces if not loads.is_heated(surface)]:
            names = ", ".join(f'"temperature_{surface}"' for surface in cold)
            yield f"note: no surface temperatures in it: list {names} in output.fields of the case for them"
        yield "note: thermal stresses are not computed: damage is that of pressure and shear stress alone"
    if case.post.residual_stress and case.post.mean_stress == "none" and not _criteria(job, case):
        yield "note: residual_stress changes nothing without --mean-stress or --criterion"


def _criteria(job: Job, case: Case) -> set[str]:
    """Criteria beside the paper's damage."""
    return {*job.criteria, case.post.criterion} & {*CRITERIA}


def solve(
    prepared: Prepared, surface: str, job: Job, advance: Callable[[float], None] = lambda points: None
) -> dict[str, np.ndarray]:
    """Damage, cycles, peak range and criteria of a surface (depths, *rows, points) by name in the file.

    nan for incomplete points. `advance` is called with numbers of points at a depth whose stresses are
    computed, then with those that are counted.
    """
    depths = prepared.depths
    blocks = np.array_split(depths, max(-(-len(depths) // DEPTHS_AT_ONCE), min(job.jobs, len(depths))))
    work = partial(_solve_depths, prepared, surface, job, advance)
    found = list(ThreadPoolExecutor(job.jobs).map(work, blocks) if job.jobs > 1 else map(work, blocks))
    return {name: np.concatenate([values[name] for values in found]) for name in found[0]}


def _solve_depths(
    prepared: Prepared, surface: str, job: Job, advance: Callable[[float], None], depths: np.ndarray
) -> dict[str, np.ndarray]:
    loads, motion, table = prepared.loads, prepared.motions[surface], prepared.loads.case.post.residual_stress
    counts = _counts(prepared, surface, job)
    names = [name for columns, _ in counts for name in columns]
    shape = len(depths), *loads.rows, prepared.s.size
    out = {name: np.full(shape, np.nan) for name in names}
    lengths = motion.leave - motion.enter + 3
    stress = _stresses(loads, depths * loads.a / loads.dx, prepared.materials[surface].poisson_ratio)
    quantum = QUANTA[job.precision] * loads.p0
    for points in runs_of_points(motion, MAX_HISTORY_NUMBERS / job.jobs, stress.numbers_per_sample):
        of_rows = np.repeat(lengths[points], math.prod(loads.rows))
        show = partial(_advance_by, advance, points.size * depths.size)
        found = histories(loads, surface, motion, stress, points, quantum, job.precision, show)
        for k, stresses in enumerate(found):
            residual = float(np.interp(depths[k], *np.transpose(table))) if table else 0.0
            for columns, count in counts:
                values = count(stresses.reshape(-1, *stresses.shape[-2:]), of_rows, residual)
                for name, column in zip(columns, values.T, strict=True):
                    out[name][k][..., points] = column.reshape(points.size, *loads.rows).T
            advance(len(points))
    return out


def smooth_contacts(prepared: Prepared, surface: str, job: Job) -> dict[str, SmoothContact]:
    """Smooth contact of a surface by each criterion of damage, by the name of the damage in the file.

    None of a case whose smooth contact is not Hertz's.
    """
    if refusal(prepared.loads.case, SMOOTH, COMMANDS[SMOOTH]):
        return {}
    ratio, counts = prepared.materials[surface].poisson_ratio, _counts(prepared, surface, job)
    return {
        names[0]: smooth_contact(prepared.loads, ratio, count)
        for names, count in counts
        if not names[0].endswith("utilisation")  # of a fatigue limit, not of a pass
    }


@compiled(error_model="python", nogil=True)
def _collect(
    stress: np.ndarray, begin: int, first: int, motion: tuple, quantum: float, histories: np.ndarray
) -> None:
    """Copy stresses (frames, components, ny, n) of frames from `begin` on into histories.

    Histories (points, ny, components, samples), point by point from `first` on, rounded to a multiple of the
    quantum if it is not zero.
    """
    shift, enter, leave = motion
    inverse, end = 1.0 / quantum if quantum else 0.0, begin + stress.shape[0]
    for row in range(stress.shape[2]):
        for component in range(stress.shape[1]):
            for place in range(histories.shape[0]):  # of a row and a component: within the cache
                j = first + place
                history = histories[place, row, component]
                for frame in range(max(begin, enter[j]), min(end, leave[j] + 1)):
                    value = stress[frame - begin, component, row, j + shift[frame]]
                    rounded = np.rint(value * inverse) * quantum if quantum else value
                    history[frame - enter[j] + 1] = rounded


def runs_of_points(motion: PointPassage, numbers: float, numbers_per_sample: int) -> list[np.ndarray]:
    """Split the complete points into ranges of consecutive ones with at most `numbers` in their histories."""
    points = np.flatnonzero(motion.complete)
    samples = (motion.leave - motion.enter + 3)[points].max(initial=1)
    room = max(1, int(numbers / (numbers_per_sample * samples)))
    runs: list[np.ndarray] = []
    for stretch in np.split(points, np.flatnonzero(np.diff(points) > 1) + 1):
        runs += np.array_split(stretch, -(-stretch.size // room)) if stretch.size else []
    return runs


def histories(
    loads: Loads,
    surface: str,
    motion: PointPassage,
    stress: BodyStress,
    points: np.ndarray,
    quantum: float,
    dtype: type | str = np.float32,
    show: Callable[[float], None] = lambda share: None,
) -> np.ndarray:
    """Stress histories of consecutive points, multiples of `quantum` [Pa].

    `show` is called with the share of the frames of a batch after each.

    Shape (nz, points, 3, samples); of a plane (nz, points, ny, 6, samples). Of a point the first
    leave - enter + 3 samples count: it is unstressed before it enters and after it leaves, so that its
    history begins and ends with zero.
    """
    samples = int((motion.leave - motion.enter)[points].max()) + 3
    shape = len(stress.tables), points.size, *stress.rows, stress.components, samples
    found: np.ndarray = np.zeros(shape, dtype)
    by_row = found.reshape(*shape[:2], -1, *shape[-2:])
    weights, places = offset_weights(motion.offset), (motion.shift, motion.enter, motion.leave)
    start, end = motion.enter[points].min(), motion.leave[points].max() + 1
    for begin in range(start, end, FRAMES_PER_READ):
        pressure, shear = loads.read(surface, begin, min(begin + FRAMES_PER_READ, end))
        for at in range(0, len(pressure), stress.frames_at_once):
            batch = slice(at, at + stress.frames_at_once)
            spectra = stress.transform(pressure[batch], shear[batch])
            of_frames = weights[begin + at : begin + at + len(spectra)]
            for depth, rows in enumerate(by_row):
                fields = stress(depth, spectra, of_frames)
                fields = fields.reshape(*fields.shape[:2], -1, fields.shape[-1])
                _collect(fields, begin + at, points[0], places, quantum, rows)
            show(len(spectra) / (end - start))
    return found


def _stresses(loads: Loads, depths: np.ndarray, poisson_ratio: float) -> BodyStress:
    """Stresses of the half plane or of the half-space at depths in elements."""
    if not loads.rows:
        return BodyStress(loads.x.size, depths)
    (ny,), width = loads.rows, loads.dy / loads.dx
    return _block_stress(ny, loads.x.size, width, tuple(depths), poisson_ratio, loads.is_periodic)


def _advance_by(advance: Callable[[float], None], points: int, share: float) -> None:
    """Report a share of some points as computed."""
    advance(share * points)


@lru_cache(maxsize=1)  # for both surfaces, and the passes of a life
def _block_stress(
    ny: int, nx: int, width: float, depths: tuple[float, ...], poisson_ratio: float, is_periodic: bool
) -> BodyStress:
    from ehlpetsc.post.stresses.block_stress import BlockStress

    return BlockStress(ny, nx, width, np.array(depths), poisson_ratio, is_periodic)


def _counts(prepared: Prepared, surface: str, job: Job) -> list[tuple[list[str], Callable]]:
    """Names of results and function of histories of the paper's damage and of each criterion."""
    material, constants, case = prepared.materials[surface], prepared.criteria, prepared.loads.case
    names = [f"damage/{surface}", f"damage/{surface}_cycles", f"damage/{surface}_peak_range"]
    counts: list[tuple[list[str], Callable]] = [(names, count_of(case, material, constants, "von-mises"))]
    if "fatemi-socie" in _criteria(job, case):
        names = [f"criteria/fatemi_socie/{surface}_{column}" for column in PLANE_COLUMNS]
        counts.append((names, count_of(case, material, constants, "fatemi-socie", job.share)))
    if "dang-van" in _criteria(job, case):
        from ehlpetsc.post.criteria.dang_van import count_utilisation

        count = partial(count_utilisation, poisson_ratio=material.poisson_ratio, constants=constants)
        counts.append(([f"criteria/dang_van/{surface}_utilisation"], count))
    return counts
