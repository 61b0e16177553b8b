"""Solve one pass: wear, fatigue damage of the points that passed the contact, friction."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ehlpetsc.base.errors import ExitStatus, OutputError, PostError, Stopped
from ehlpetsc.post.loads import Loads
from ehlpetsc.post.prepare import prepare
from ehlpetsc.post.run import Job, solve
from ehlpetsc.results.means import means
from ehlpetsc.results.reader import read_result
from ehlpetsc.run.outputs.recorder import Recorder
from ehlpetsc.run.simulation import Simulation
from ehlpetsc.run.solve import solve as solve_run
from ehlpetsc.surfaces.body_field import BodyField


class OfBody(NamedTuple):
    """Effects of a pass on a body.

    `s`: abscissas in the body of the points that passed the whole contact [m], shape (points,). `depths`:
    below the present surface [m], shape (n,). `damage`: shape (n, points). `depth`: wear before and after the
    pass.
    """

    s: np.ndarray
    depths: np.ndarray
    damage: np.ndarray
    depth: tuple

    @property
    def volume(self) -> float:
        """Worn off [m^2]."""
        before, after = self.depth
        return after.volume - before.volume


class Pass(NamedTuple):
    """A solved pass.

    `figures`: means over the time in which both surfaces fill the contact. `yielded`: largest depth by which
    a point yielded in this pass [m].
    """

    bodies: tuple
    figures: dict
    plastic: object
    yielded: float


SIDES = ("1", "2")
NO_DEPTH = BodyField(1e-6, 0, np.zeros(0))


def run_pass(simulation: Simulation, before: dict[str, tuple], file: Path, stop: Any = None) -> Pass:
    """Solve a pass to its end and evaluate it.

    `before`: records of the bodies, after the previous pass. `file`: result file, replaced. Raises
    `NotConverged`, `Stopped`, `OutputError`, `PostError`.
    """
    recorder = Recorder(simulation, file)
    with simulation.options, recorder:
        recorder.lock_output(overwrite=True)
        status, failure = solve_run(simulation, [recorder], stop)
    if failure:
        raise failure
    if status is ExitStatus.STOPPED:
        raise Stopped
    comm, records = simulation.comm, simulation.solution.records
    outcome = fault = None
    if comm.rank == 0:
        Path(recorder.restart).unlink(missing_ok=True)
        try:
            outcome = _damage(file), _means(file)
        except (PostError, OutputError) as error:
            fault = error
    outcome, fault = comm.bcast((outcome, fault))
    if fault:
        raise fault
    damage, figures = outcome
    offsets = simulation.scene.mesh_on_bodies.offsets
    worn = [_depths(before, records, "wear", k) for k in range(2)]
    set_ = [_depths(before, records, "plastic_deformation", k) for k in range(2)]
    bodies = tuple(
        OfBody(s + offset, z, d, depth)
        for (s, z, d), offset, depth in zip(damage, offsets, worn, strict=True)
    )
    return Pass(bodies, figures, records.get("plastic_deformation"), max(map(_largest_increase, set_)))


def _depths(before: dict[str, Any], after: dict, name: str, k: int) -> tuple[BodyField, ...]:
    """Depths of body k before and after; zero where there is no record."""
    depths = (records[name].depth[k] if name in records else NO_DEPTH for records in (before, after))
    return tuple(depths)


def _largest_increase(depths: tuple[BodyField, ...]) -> float:
    before, after = depths
    if not len(after.depth):
        return 0.0
    return float(np.max(after.depth - before.means(after.edges)))


def _means(file: Path) -> dict[str, float]:
    with read_result(file) as result:
        figures = means(result)
        figures["p_max"] = float(result.steps("p_max").max())
    return figures


def _damage(file: Path) -> list[tuple]:
    """Points s, depths [m] and damage of both surfaces, of the points that passed the whole contact."""
    with Loads(file) as loads:
        job, prepared = Job(str(file), ""), prepare(loads, SIDES, lambda text: None)
        damages = []
        for side in SIDES:
            motion, depths = prepared.motions[side], prepared.settings.depths
            passed = motion.complete
            if np.count_nonzero(passed) < 2:
                raise PostError(
                    f"surface {side}: no stretch of it passed the whole contact; raise time.travel"
                )
            values = solve(prepared, side, job)
            criterion = values.get(f"criteria/fatemi_socie/{side}_damage", values[f"damage/{side}"])
            damages.append((prepared.s[passed], loads.a * depths, criterion[:, passed]))
    return damages
