"""Solve one pass: wear, fatigue damage of the points that passed the contact, friction; band of criteria."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, TypeVar

import numpy as np

from ehlpetsc.base.errors import ExitStatus, PostError, Stopped
from ehlpetsc.case.tables.surface import SIDES
from ehlpetsc.post.loads import Loads, PointPassage, Prepared, prepare
from ehlpetsc.post.run import Job, smooth_contacts, solve
from ehlpetsc.results.means import means
from ehlpetsc.run.ranks import on_root
from ehlpetsc.run.recorder import Output, Recorder
from ehlpetsc.run.simulation import AcceptedState, Simulation
from ehlpetsc.run.solve import solve as solve_run
from ehlpetsc.surfaces.motion.body_field import BodyField

if TYPE_CHECKING:
    from ehlpetsc.results.post_result import SmoothContact
    from ehlpetsc.run.ranks import StopRequest

T = TypeVar("T")


class OfBody(NamedTuple):
    """Effects of a pass on a body.

    `s`: abscissas in the body of the points that passed the whole contact [m], shape (points,). `depths`:
    below the present surface [m], shape (n,). `damage`: shape (n, *rows, points). `pressure`: largest one on
    each point [Pa], of all rows, shape (points,). `depth`: wear before and after the pass.
    """

    s: np.ndarray
    depths: np.ndarray
    damage: np.ndarray
    pressure: np.ndarray
    depth: tuple

    @property
    def volume(self) -> float:
        """Worn off [m^2], of a strip per metre of width."""
        before, after = self.depth
        return (after.volume - before.volume) / math.prod(after.depth.shape[:-1])


class Pass(NamedTuple):
    """A solved pass.

    `figures`: means over the time in which both surfaces fill the contact. `yielded`: largest depth by which
    a point yielded in this pass [m].
    """

    bodies: tuple
    figures: dict
    plastic: object
    yielded: float


NO_DEPTH = BodyField(1e-6, 0, np.zeros(0))


class PassProgress(Output):
    """Output that calls `show` with the share of a pass that is done."""

    def __init__(self, simulation: Simulation, show: Callable[[float], None]) -> None:
        self._simulation, self._show = simulation, show

    def write(self, state: AcceptedState) -> None:
        """Show the step."""
        self._show(float(state.time) / self._simulation.end)


def run_pass(
    simulation: Simulation,
    before: dict[str, tuple],
    file: Path,
    stop: StopRequest | None = None,
    show: Callable[[float], None] = lambda share: None,
) -> Pass:
    """Solve a pass to its end and evaluate it.

    `before`: records of the bodies, after the previous pass. `file`: result file, replaced. `show`: receives
    the share of the pass that is done. Raises `NotConverged`, `Stopped`, `OutputError`, `PostError`.
    """
    recorder = Recorder(simulation, file)
    with recorder:
        recorder.lock_output(overwrite=True)
        status, failure = solve_run(simulation, [recorder, PassProgress(simulation, show)], stop)
    if failure:
        raise failure
    if status is ExitStatus.STOPPED:
        raise Stopped
    damage, figures = on_root(simulation.comm, _evaluated, file, recorder.restart)
    records, offsets = simulation.dimensionless.records, simulation.scene.mesh_on_bodies.offsets
    bodies = tuple(
        OfBody(s + offset, z, d, p, depth)
        for (s, z, d, p), offset, depth in zip(damage, offsets, _depths(before, records, "wear"), strict=True)
    )
    yielded = deepest(_depths(before, records, "plastic_deformation"))
    return Pass(bodies, figures, records.get("plastic_deformation"), yielded)


def deepest(pairs: Iterable[tuple[BodyField, BodyField]]) -> float:
    """Largest depth added to a body anywhere [m]; `pairs`: depths of each body before and after."""
    return max(float(np.max(new.depth - old.means(new.edges), initial=0.0)) for old, new in pairs)


def _depths(before: dict[str, np.ndarray], after: dict, name: str) -> list[tuple[BodyField, BodyField]]:
    """Depths of both bodies before and after; zero where there is no record."""
    none = NO_DEPTH, NO_DEPTH
    old, new = (records[name].depth if name in records else none for records in (before, after))
    return list(zip(old, new, strict=True))


def _evaluated(file: Path, restart: Path) -> tuple[list[tuple], dict[str, float]]:
    """Points s, depths [m], damage and largest pressure [Pa] of both surfaces; figures of the run.

    Of the points that passed.
    """
    Path(restart).unlink(missing_ok=True)
    with Loads(file) as loads:
        figures = means(loads)
        prepared, damages = prepare(loads, SIDES, lambda text: None), []
        for side in SIDES:
            passed = prepared.motions[side].complete
            if np.count_nonzero(passed) < 2:
                raise PostError(
                    f"surface {side}: no stretch of it passed the whole contact; raise time.travel"
                )
            damage = damage_of_pass(prepared, side)[..., passed]
            pressure = largest_pressures(loads, prepared.motions[side])[passed]
            damages.append((prepared.s[passed], loads.a * prepared.depths, damage, pressure))
    return damages, figures


def largest_pressures(loads: Loads, motion: PointPassage) -> np.ndarray:
    """Largest pressure on each point of a body over its passage, of all rows [Pa]; 0: it met no node."""
    largest = np.zeros(motion.enter.size)
    for frame, pressure in enumerate(loads.frames("pressure", 0, loads.time.size)):
        of_rows = pressure.reshape(-1, loads.x.size).max(axis=0)
        at = motion.positions(frame, loads.x, loads.dx)
        inside = np.isfinite(at)
        largest[inside] = np.maximum(largest[inside], np.interp(at[inside], loads.x, of_rows))
    return largest


def damage_of_pass(prepared: Prepared, side: str, settings: tuple[str, ...] = ()) -> np.ndarray:
    """Damage of a surface by the criterion of the case (depths, *rows, points); nan of incomplete points.

    In double precision: a life sums it up, and its jumps and pits follow from it.
    """
    return _of_criterion(solve(prepared, side, _job(prepared, settings)), side)


def smooth_contacts_of(file: Path) -> tuple[SmoothContact, ...]:
    """Smooth contact of both surfaces by the criterion of the case of a result."""
    with Loads(file) as loads:
        prepared = prepare(loads, SIDES, lambda text: None)
        return tuple(_of_criterion(smooth_contacts(prepared, k, _job(prepared)), k) for k in SIDES)


def _job(prepared: Prepared, settings: tuple[str, ...] = ()) -> Job:
    return Job(str(prepared.loads.path), "", settings=settings, share=1.0, precision="float64")


def _of_criterion(found: dict[str, T], side: str) -> T:
    """Result of a surface by the criterion of the case, among results by the name of the damage."""
    return found.get(f"criteria/fatemi_socie/{side}_damage", found[f"damage/{side}"])


LIFE_CRITERIA = {  # name: post.criterion, post.mean_stress
    "von-mises": ("von-mises", "none"),
    "morrow": ("von-mises", "morrow"),
    "goodman": ("von-mises", "goodman"),
    "fatemi-socie": ("fatemi-socie", "none"),
}


def passes_to_failure(file: Path, settings: tuple[str, ...] = ()) -> tuple[float, float]:
    """Passes until D = 1 at the worst point of each surface, of the pass in a result file."""
    with Loads(file, settings) as loads:
        prepared = prepare(loads, SIDES, lambda text: None)
        worst = [float(np.nanmax(damage_of_pass(prepared, side, settings))) for side in SIDES]
    first, second = (1.0 / damage if damage > 0.0 else np.inf for damage in worst)
    return first, second


def band(file: Path) -> dict[str, tuple[float, float]]:
    """`passes_to_failure` by each of the `LIFE_CRITERIA`, of one solved pass, without wear.

    The criteria are fitted to the same strain-life tests and differ by the stresses that they count; none is
    tested for rolling contact. The band is the least uncertainty of a life; ratios of lives by one criterion
    are more certain.
    """
    return {
        name: passes_to_failure(file, (f"post.criterion={criterion}", f"post.mean_stress={mean}"))
        for name, (criterion, mean) in LIFE_CRITERIA.items()
    }


def lines_of(found: dict[str, tuple[float, float]], chosen: tuple[float, float]) -> Iterator[str]:
    """Lines of a band: ratios of each criterion to the `chosen` one, and the factor of the band."""
    for k, side in enumerate(SIDES):
        lives = [both[k] for both in found.values()]
        ratios = ", ".join(f"{name} {both[k] / chosen[k]:.2g}" for name, both in found.items())
        yield (
            f"first failure of surface {side} by criterion, over {chosen[k]:.3g} passes: {ratios} "
            f"(band of a factor {max(lives) / min(lives):.2g})"
        )
