"""Solve one pass: wear, fatigue damage of the points that passed the contact, friction."""

from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ehlpetsc.errors import ExitStatus, OutputError, PostError, Stopped
from ehlpetsc.post.fatigue.accumulate import Counting
from ehlpetsc.post.inputs.loads import Loads
from ehlpetsc.post.prepare import prepare
from ehlpetsc.post.run import Job, Task, solve
from ehlpetsc.results.means import means
from ehlpetsc.results.reader import read_result
from ehlpetsc.run.outputs.recorder import Recorder
from ehlpetsc.run.simulation import Simulation
from ehlpetsc.run.solve import solve as solve_run
from ehlpetsc.surfaces.body_field import BodyField


class OfBody(NamedTuple):
    """Effects of a pass on a body.

    Attributes
    ----------
    s : ndarray, shape (points,)
        Abscissas in the body of the points that passed the whole contact [m].
    depths : ndarray, shape (n,)
        Below the present surface [m].
    damage : ndarray, shape (n, points)
    depth : pair of surfaces.body_field.BodyField
        Wear before and after the pass.
    """

    s: np.ndarray
    depths: np.ndarray
    damage: np.ndarray
    depth: tuple

    @property
    def volume(self):
        """Worn off [m^2]."""
        before, after = self.depth
        return after.volume - before.volume


class Pass(NamedTuple):
    """A solved pass.

    Attributes
    ----------
    bodies : pair of OfBody
    figures : dict of str to float
        Means over the time in which both surfaces fill the contact.
    plastic : effects.plastic_deformation.PlasticRecord or None
    yielded : float
        Largest depth by which a point yielded in this pass [m].
    """

    bodies: tuple
    figures: dict
    plastic: object
    yielded: float


SIDES = ("1", "2")
NO_DEPTH = BodyField(1e-6, 0, np.zeros(0))


@dataclass(frozen=True)
class Before:
    """State before a pass, used instead of the `Simulation` of the previous pass."""

    case: object
    scales: object
    solution: object
    pass_number: int = 0
    finished: bool = True


class Records(NamedTuple):
    """Records of effects by name."""

    records: dict


def start(case, comm, scales, position, records):
    """The simulation of a pass.

    Parameters
    ----------
    case : case.loading.Case
    comm : mpi4py communicator
    scales : physics.scales.Scales
    position : int
        Of surface 2, from 0, in units of `time.pass_shift`.
    records : dict of str to NamedTuple
        Of the bodies, after the previous pass.
    """
    before = Before(case, scales, Records(records)) if records else None
    return Simulation(case, comm, after=before, pass_number=position + 1)


def run_pass(simulation, before, file, stop=None):
    """Solve a pass to its end and evaluate it.

    Parameters
    ----------
    simulation : run.simulation.Simulation
    before : dict of str to NamedTuple
        Records as of :func:`start`.
    file : Path
        Result file, replaced.
    stop : run.stop.StopRequest, optional

    Returns
    -------
    one_pass.Pass

    Raises
    ------
    NotConverged, Stopped, OutputError, PostError
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


def _depths(before, after, name, k):
    """Depths of body k before and after; zero where there is no record."""
    depths = (records[name].depth[k] if name in records else NO_DEPTH for records in (before, after))
    return tuple(depths)


def _largest_increase(depths):
    before, after = depths
    if not len(after.depth):
        return 0.0
    return float(np.max(after.depth - before.means(after.edges)))


def _means(file):
    with read_result(file) as result:
        figures = means(result)
        figures["p_max"] = float(result.steps("p_max").max())
    return figures


def _damage(file):
    """Points s, depths [m] and damage of both surfaces, of the points that passed the whole contact."""
    with Loads(file) as loads:
        job = Job(str(file), "", counting=Counting(strain=loads.case.post.strain))
        prepared = prepare(loads, SIDES, lambda text: None)
        damages = []
        for side in SIDES:
            motion, depths = prepared.motions[side], prepared.settings.depths
            passed = motion.complete
            if np.count_nonzero(passed) < 2:
                raise PostError(
                    f"surface {side}: no stretch of it passed the whole contact; raise time.travel"
                )
            values = solve(job, prepared, Task(side, depths))[..., 0]
            damages.append((prepared.s[passed], loads.a * np.array(depths), values[:, passed]))
    return damages
