"""The passes of a life: one is solved, those like it are jumped, the next one meets the changed surfaces."""

import time as clock
import tomllib
from pathlib import Path

import h5py
import numpy as np

from ehlpetsc.case.loading import Case, load
from ehlpetsc.errors import CaseError, OutputError
from ehlpetsc.life import laws
from ehlpetsc.life.body import LifeBody
from ehlpetsc.life.history import LifeHistory, read_life
from ehlpetsc.results.hdf5.attributes import plain
from ehlpetsc.results.hdf5.opening import open_for_reading

PASS = ".pass.h5"  # ending of the last pass's result, beside the life
CELL = 0.25  # of the combined Rq: thickness of the first cells
NEEDED = ("pressure", "shear_stress_1", "shear_stress_2")


def run_life(case, output=None, *, overwrite=False, comm=None, show=None, stop=None, most=None):
    """Run the life of a case's surfaces, or continue it.

    Parameters
    ----------
    case : case.loading.Case, or what `ehlpetsc.load` takes
        With a table [life].
    output : path-like, optional
        By default ``CASE.life.h5`` in the present folder. A life of the very same case there is continued.
    overwrite : bool
        Whether to begin anew and replace what lies there.
    comm : mpi4py communicator, optional
        Its ranks share each pass.
    show : callable(str), optional
        Gets a line for each solved pass.
    stop : run.stop.StopRequest, optional
    most : int, optional
        Number of passes to solve now, to continue later.

    Returns
    -------
    history.LifeHistory

    Raises
    ------
    CaseError, OutputError, PostError, NotConverged, Stopped
    """
    from ehlpetsc.api import need_solver

    need_solver()
    from mpi4py import MPI

    from ehlpetsc.results.output_guard import Lock
    from ehlpetsc.run.on_root import on_root

    case = case if isinstance(case, Case) else load(case)
    check_case(case)
    comm = comm or MPI.COMM_SELF
    path = Path(f"{Path(case.path).stem}.life.h5" if output is None else output)
    on_root(comm, check_files, path, case)
    lock = Lock(path, "wait for it, or give another -o")
    on_root(comm, lock.acquire)
    try:
        history = comm.bcast(on_root(comm, stored_or_new, case, path, overwrite))
        life = _Life(case, path, comm, history, show or (lambda text: None))
        return life.run(stop, most)
    finally:
        lock.release()


def check_case(case):
    """Refuse a case that has no life; CaseError."""
    faults = []
    if case.life is None:
        faults.append("no [life] table; allowed: a case with one")
    if case.series:
        faults.append("[life] with a [series]: allowed: one of its members, --set KEY=VALUE")
    if case.time is None:
        faults.append("[life] needs [time]: passes of surfaces in motion")
    if not (case.surface.body_1 or case.surface.body_2):
        faults.append("[life] needs a rough surface: jumps are a share of its Rq")
    if case.gears or case.operation:
        faults.append("[life] with changing conditions: allowed: constant ones")
    if case.output.every != 1 or not set(NEEDED) <= set(case.output.fields):
        faults.append(f"[life] needs output.every = 1 and the fields {', '.join(NEEDED)}")
    if faults:
        raise CaseError([f"{case.path}: {fault}" for fault in faults])


def check_files(path, case):
    """Refuse to write over an input, over what is no life, and over a result that is none of a life's passes.

    Parameters
    ----------
    path : Path
        The life.
    case : case.loading.Case

    Raises
    ------
    OutputError
    """
    from ehlpetsc.results.output_guard import check_derived, check_output_path, exists, inputs_of

    check_derived(path, inputs_of(case), {".h5": b"\x89HDF"})
    one_pass = path.with_suffix(PASS)
    check_output_path(one_pass, inputs_of(case), "-o")
    if exists(one_pass) and one_pass.stat().st_size and not _is_pass(one_pass):
        raise OutputError(f"{one_pass}: exists and is no pass of a life; remove it or give another -o")


def _is_pass(path):
    """Whether a file is the result of a life's pass, or one of HDF5 that a killed run has left damaged."""
    try:
        with open_for_reading(path) as file:
            return "life" in tomllib.loads(str(plain(file.attrs.get("case", ""))))
    except OutputError:
        return h5py.is_hdf5(path)
    except ValueError:
        return False


def stored_or_new(case, path, overwrite):
    """The life that lies at `path`, or a new one; OutputError where it is another one's."""
    if path.exists() and not overwrite:
        history = read_life(path)
        if history.case != case.text:
            raise OutputError(f"{path}: the life of another case; give another -o, or --overwrite to lose it")
        return history
    return LifeHistory(case.text, case.title)


class _Life:
    def __init__(self, case, path, comm, history, show):
        from ehlpetsc.physics.scales import Scales

        self.case, self.path, self.comm, self.history, self.show = case, path, comm, history, show
        self.scales = Scales.of(case)
        self.bodies = history.bodies[-1] if history.bodies else None
        self.position_count = case.life.partners if case.time.pass_shift else 1
        self.stretches = None

    def run(self, stop, most):
        """Solve passes until the life is over."""
        from ehlpetsc.effects.effect import flat

        passes, solved = int(self.case.life.passes), 0
        limit = min(self.case.life.max_solved - len(self.history.rows), most or self.case.life.max_solved)
        while self.history.done < passes and solved < limit:
            begun = clock.monotonic()
            one, simulation = self._solve(stop)
            if self.bodies is None:
                self.bodies = tuple(self._new(simulation, one, k) for k in range(2))
            row = self._jump(one, passes, simulation.scene.rq)
            plastic = flat(one.plastic, "plastic_deformation") if one.plastic else {}
            self.history.add(row, self.bodies, plastic)
            if self.comm.rank == 0:
                self.history.save(self.path)
            solved += 1
            self._show(row, passes, clock.monotonic() - begun)
        if self.history.done < passes and len(self.history.rows) >= self.case.life.max_solved:
            self.show(f"note: life.max_solved = {self.case.life.max_solved} reached before life.passes")
        return self.history

    def _solve(self, stop):
        from ehlpetsc.life.one_pass import run_pass, start

        position = len(self.history.rows) % self.position_count
        simulation, records = start(self.case, self.comm, self.scales, position, {}), {}
        if self.bodies is not None:
            records = self._records(simulation)
            simulation = start(self.case, self.comm, self.scales, position, records)
        return run_pass(simulation, records, self.path.with_suffix(PASS), stop), simulation

    def _records(self, simulation):
        """Records of the effects for the next pass."""
        from ehlpetsc.effects.effect import unflat
        from ehlpetsc.effects.plastic_deformation import PlasticRecord
        from ehlpetsc.effects.wear import WearRecord
        from ehlpetsc.surfaces.body_field import BodyFields

        mesh = simulation.scene.mesh_on_bodies
        ends = simulation.operation.travelled(0.0), simulation.operation.travelled(self.scales.duration)
        fields = []
        for k, body in enumerate(self.bodies):
            faces = np.concatenate([mesh.faces(way)[k][[0, -1]] for way in ends])
            fields.append(body.gap_field(self._stretch(simulation, k), (faces.min(), faces.max())))
        records = {"wear": WearRecord(BodyFields(*fields))}
        if self.history.plastic:
            records["plastic_deformation"] = unflat(
                PlasticRecord, self.history.plastic, "plastic_deformation"
            )
        return records

    def _stretch(self, simulation, k):
        """Abscissas of the columns of body k in this position; those of the first one, shifted."""
        body, count = self.bodies[k], self.position_count
        offset = simulation.scene.mesh_on_bodies.offsets[k]
        if count == 1 or k == 0:
            return body.s[0], body.s[-1]
        reach = abs((count - 1) * self.case.time.pass_shift)
        length = body.s[-1] - body.s[0] - np.ceil(reach / self.scales.dx) * self.scales.dx
        first = body.s[0] if self._sign(simulation) > 0 else body.s[-1] - length
        return first + offset, first + offset + length

    def _sign(self, simulation):
        """Direction in which the positions of body 2 follow each other on it."""
        speed = self.scales.u2
        return -1.0 if (speed > 0.0) == (self.case.time.pass_shift > 0.0) else 1.0

    def _new(self, simulation, one, k):
        """Columns of a body from the points of the first pass; of body 2 in all of its positions."""
        s, dx = one.bodies[k].s, self.scales.dx
        profile = simulation.roughness.side("12"[k])
        if profile is not None and profile.is_moving:  # not where its heights come in over the ramp
            X = (
                self.scales.x[0] * self.scales.a - s
                if profile.speed > 0
                else s - self.scales.x[-1] * self.scales.a
            )
            s = s[X >= profile.ramp * (1.0 - 1e-9)]
        if k == 1 and self.position_count > 1:
            more = int(np.ceil(abs((self.position_count - 1) * self.case.time.pass_shift) / dx))
            extra = dx * np.arange(1, more + 1)
            s = (
                np.append(s, s[-1] + extra)
                if self._sign(simulation) > 0
                else np.append(s[0] - extra[::-1], s)
            )
        height = profile.height(s) if profile else np.zeros(len(s))
        edges = laws.cell_edges(CELL * simulation.scene.rq, one.bodies[k].depths[-1] + 1e-12)
        return LifeBody.new(s, height, edges)

    def _jump(self, one, passes, rq):
        """Jump with the pass; its figures."""
        life, done = self.case.life, self.history.done
        rates = [body.rates(of) for body, of in zip(self.bodies, one.bodies, strict=True)]
        jump = passes - done
        for body, (wear, added) in zip(self.bodies, rates, strict=True):
            there = np.where(body.is_there, body.damage, np.nan)
            jump = laws.passes_to_jump(jump, wear, life.wear_jump * rq, added, there, life.damage_jump)
        if one.yielded > life.wear_jump * rq:  # it decays from pass to pass: not to be multiplied
            jump = 1
        self.bodies = tuple(
            body.after(wear, added, jump, done, life.pits, of.volume)
            for body, (wear, added), of in zip(self.bodies, rates, one.bodies, strict=True)
        )
        row = {"passes": done + jump, "jump": jump, "p_max": one.figures["p_max"]}
        row["friction"] = one.figures.get("friction_coefficient", np.nan)
        row["contact_share"] = one.figures.get("contact_share", np.nan)
        for k, (body, (wear, added)) in enumerate(zip(self.bodies, rates, strict=True), 1):
            row |= {f"pits_{k}": body.pits, f"pitted_share_{k}": body.pitted_share, f"ra_{k}": body.ra}
            row |= {f"wear_volume_{k}": body.volume, f"damage_{k}": body.largest_damage}
            row |= {f"wear_rate_{k}": float(wear.max()), f"damage_rate_{k}": float(added.max())}
        return row

    def _show(self, row, passes, wall):
        left = passes - row["passes"]
        shown = [f"{row['passes']:.4g} passes of {passes:.4g}, {len(self.history.rows)} solved"]
        for k in (1, 2):
            shown.append(
                f"surface {k}: D {row[f'damage_{k}']:.3g}, {row[f'pits_{k}']} pits on "
                f"{row[f'pitted_share_{k}']:.1%}, worn {1e12 * row[f'wear_volume_{k}']:.4g} um^2, "
                f"Ra {1e6 * row[f'ra_{k}']:.4f} um"
            )
        shown.append(f"friction {row['friction']:.4f}, {wall:.0f} s")
        if left:
            shown.append(f"at this jump {left / row['jump']:.3g} to solve")
        self.show("; ".join(shown))
