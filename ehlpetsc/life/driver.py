"""Life of two surfaces: solve a round, jump the passes like it, update the surfaces, repeat."""

from __future__ import annotations

import time as clock
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
from mpi4py import MPI

from ehlpetsc.base.command_line import ProgressLine, duration
from ehlpetsc.base.errors import CaseError, NotConverged
from ehlpetsc.case.loading import Case, load
from ehlpetsc.effects.depths import PlasticRecord
from ehlpetsc.effects.effect import flat, unflat
from ehlpetsc.life.body import LifeBody
from ehlpetsc.life.history import LifeFile, LifeHistory, stored_or_new
from ehlpetsc.life.jumps import Jumps
from ehlpetsc.life.one_pass import Pass, band, lines_of, passes_to_failure, run_pass, smooth_contacts_of
from ehlpetsc.life.positions import Positions, number_of_positions, with_shift
from ehlpetsc.life.remarks import (
    SMOOTH_FIGURES,
    depth_lines,
    limits,
    smooth_figures,
    smooth_lines,
    wear_lines,
)
from ehlpetsc.life.rounds import Ranks, Round
from ehlpetsc.physics.scales import Scales
from ehlpetsc.post.smooth_contact import worst_instant
from ehlpetsc.results.output_guard import Lock, check_derived, check_output_path, inputs_of
from ehlpetsc.run.forecast.cost import expected_work, solver_of
from ehlpetsc.run.forecast.speed import expected_seconds
from ehlpetsc.run.ranks import StopRequest, on_root
from ehlpetsc.run.simulation import Simulation
from ehlpetsc.surfaces.motion.profile_checks import mesh_warnings

MAX_LIFE_UNRESOLVED = 0.1  # of the height variance: more makes passes to failure those of the mesh
NEEDED_FIELDS = ("pressure", "shear_stress_1", "shear_stress_2")


def check_case(case: Case) -> None:
    """Check that a case has a life; CaseError."""
    faults = []
    if case.life is None:
        faults.append("no [life] table; allowed: a case with one")
    if case.series:
        faults.append("[life] with a [series] has a life for each member: allowed here: one of them")
    if case.time is None:
        faults.append("[life] needs [time]: passes of surfaces in motion")
    if not (case.surface.body_1 or case.surface.body_2):
        faults.append("[life] needs a rough surface: jumps are a share of its Rq")
    if case.conditions is not None and 0 in case.conditions.directions():
        faults.append("[life] needs surfaces that move one way: points would pass the contact several times")
    if case.output.every != 1 or not set(NEEDED_FIELDS) <= set(case.output.fields):
        faults.append(f"[life] needs output.every = 1 and the fields {', '.join(NEEDED_FIELDS)}")
    if faults:
        raise CaseError([f"{case.path}: {fault}" for fault in faults])


def pass_file(path: Path, position: int, positions: int) -> Path:
    """Result of the last solved pass in a position of surface 2, in the folder of the life `path`."""
    return path.with_suffix(".pass.h5" if positions == 1 else f".pass{position + 1}.h5")


def check_files(path: Path, case: Case) -> None:
    """Refuse to overwrite an input or a file that is not a life.

    `path`: the life. Raises `OutputError`.
    """
    check_derived(path, inputs_of(case), (".h5",))
    positions = number_of_positions(case)
    for position in range(positions):
        check_output_path(pass_file(path, position, positions), inputs_of(case), "-o")


def line_of(history: LifeHistory, seconds: float = 0.0) -> str:
    """Line of the last row, whose round took a wall clock time: worn areas in m^2."""
    row = history.rows[-1]
    values = {"solved": history.solved, "passes": row["passes"]}
    for name, label in (("damage", "D"), ("pitted_share", "pitted"), ("wear_volume", "worn")):
        values |= {f"{label}{k}": f"{row[f'{name}_{k}']:.3g}" for k in (1, 2)}
    values |= {"friction": f"{row['friction']:.4f}"} | ({"wall": duration(seconds)} if seconds else {})
    return " ".join(f"{name}={value}" for name, value in values.items())


def run_life(
    case: Case | Path,
    output: str | Path | None = None,
    *,
    overwrite: bool = False,
    unresolved: bool = False,
    comm: MPI.Comm | None = None,
    show: Callable | None = None,
    stop: StopRequest | None = None,
    most: int | None = None,
) -> LifeHistory:
    """Run the life of a case's surfaces, or continue it.

    Raises `CaseError`, `OutputError`, `PostError`, `NotConverged`, `Stopped`.

    Parameters
    ----------
    case
        With a table [life].
    output
        By default ``CASE.life.h5`` in the current folder. An existing life of the same case is continued.
    overwrite
        Whether to start again and replace an existing file.
    unresolved
        Whether to run also on a mesh that does not resolve the profiles.
    comm
        Its ranks share each round: a pass each, or all of them a single pass.
    show
        Receives a line before the first round and after each.
    most
        Number of rounds to solve in this call.
    """
    case = case if isinstance(case, Case) else load(case)
    check_case(case)
    case = with_shift(case)
    comm = comm or MPI.COMM_SELF
    path = Path(f"{Path(case.path).stem}.life.h5" if output is None else output)
    on_root(comm, check_files, path, case)
    lock = Lock(path)
    on_root(comm, lock.acquire)
    try:
        history = on_root(comm, stored_or_new, case, path, overwrite)
        life = _Life(case, path, comm, history, show, unresolved)
        return life.run(stop, most)
    finally:
        lock.release()


def _lines_of_band(file: Path) -> list[str]:
    """Lines on the criteria, of a solved pass."""
    return list(lines_of(band(file), passes_to_failure(file)))


class _Life:
    def __init__(
        self,
        case: Case,
        path: Path,
        comm: MPI.Comm,
        history: LifeHistory,
        show: Callable | None,
        unresolved: bool,
    ) -> None:
        self.case, self.path, self.comm, self.history, self._show = case, path, comm, history, show
        self._line = ProgressLine("life", 1.0) if show and comm.rank == 0 else None
        self._passes = 0  # of this round, solved by this rank
        self.scales = Scales.of(case)
        self.positions = Positions(case, self.scales)
        self.jumps = Jumps(case.life, self.positions.rq)
        self.ranks, self.file = Ranks(comm, self.positions.count), LifeFile(path)
        self._scene = self.positions.scene(0.0)
        faults = mesh_warnings(self._scene.roughness, self.scales, MAX_LIFE_UNRESOLVED)
        if faults and not unresolved:
            advice = "the life would depend on the mesh; allowed also: a longer short_cutoff, --unresolved"
            raise CaseError([f"{case.path}: {fault}; {advice}" for fault in faults])

    def show(self, text: str) -> None:
        """Show a line of text in place of the line of progress."""
        if self._line:
            self._line.clear()
        if self._show:
            self._show(text)

    def _show_share(self, of_pass: float) -> None:
        """Show the share of the life that is done, with a share of the pass of this rank."""
        if self._line:
            solved = self.history.solved + self.ranks.groups * (self._passes + of_pass)
            shares = solved / self.case.life.max_solved, self.history.done / self.jumps.passes
            self._line.reach(min(max(shares), 1.0))

    def run(self, stop: StopRequest | None, max_rounds: int | None) -> LifeHistory:
        """Solve rounds until the end of the life."""
        try:
            self._run(stop, max_rounds)
        except NotConverged:
            self.file.close("not converged")
            raise
        finally:
            if self._line:
                self._line.clear()
            self.file.close("done" if self.history.done >= self.jumps.passes else "stopped")
        if self.history.done < self.jumps.passes and self.history.solved >= self.case.life.max_solved:
            self.show(f"note: life.max_solved = {self.case.life.max_solved} reached before life.passes")
        for line in (*limits(self.history), *wear_lines(self.history, self.case)):
            self.show(line)
        return self.history

    def _run(self, stop: StopRequest | None, max_rounds: int | None) -> None:
        rounds = 0
        if not self.history.rows:
            self.positions.check_travel()
            for line in mesh_warnings(self._scene.roughness, self.scales):
                self.show(f"warning: {line}")
            amount = expected_work(self.case, self.scales, self._scene.roughness)
            seconds = expected_seconds(solver_of(self.case.kind), amount)
            each = "" if seconds is None else f" and {duration(seconds)} on one rank"
            steps, count = self._scene.operation.step_count(self.scales.dt), self.positions.count
            self.show(f"passes of a round: {count}, each of {steps} steps{each}")
        while not self._is_over and rounds != max_rounds:
            begun, self._passes = clock.monotonic(), 0
            solved_round = self._solve(stop)
            if self.history.rows:
                last = self.history.rows[-1]
                bodies, smooth = self.history.bodies[-1], {name: last[name] for name in SMOOTH_FIGURES}
            else:
                bodies, smooth = self._first_bodies(solved_round.passes[0])
            self._jump(solved_round, bodies, smooth)
            self.show(line_of(self.history, clock.monotonic() - begun))
            rounds += 1

    def _first_bodies(self, first: Pass) -> tuple[tuple[LifeBody, ...], dict[str, float]]:
        """Bodies as made, and figures of the smooth contact; shows lines on it and on the criteria."""
        file = pass_file(self.path, 0, self.positions.count)
        contacts = on_root(self.comm, smooth_contacts_of, file)
        pressure = worst_instant(self.scales, self._scene.operation)[1]
        figures = smooth_figures(contacts, self.positions.passes_2, pressure)
        for line in (*smooth_lines(figures), *depth_lines(first.bodies, figures)):
            self.show(line)
        if self._show:
            for line in on_root(self.comm, _lines_of_band, file):
                self.show(line)
        return tuple(map(self.positions.new_body, first.bodies, contacts, range(2))), figures

    @property
    def _is_over(self) -> bool:
        return self.history.done >= self.jumps.passes or self.history.solved >= self.case.life.max_solved

    def _solve(self, stop: StopRequest | None) -> Round:
        """The next round: of a single position while passes yield, as each changes the next."""
        solve, rows = partial(self._solve_pass, self._plastic()), self.history.rows
        every = self.positions.places(len(rows))
        yields = self.case.contact.yield_pressure is not None
        is_single = yields and (not rows or self.jumps.is_yielding(rows[-1]["yielded"]))
        positions = [every[self.history.solved % len(every)]] if is_single else every
        passes = self.ranks.solve(positions, solve, stop)
        solved_round = Round(passes, self.positions.passes_2, self.positions.drifts)
        rest = [position for position in every if position not in positions]
        if rest and not self.jumps.is_yielding(solved_round.yielded):  # a jump takes the mean of all
            rest_passes = self.ranks.solve(rest, solve, stop)
            solved_round = solved_round._replace(passes=[*solved_round.passes, *rest_passes])
        return solved_round

    def _solve_pass(
        self, plastic: PlasticRecord | None, place: float, comm: MPI.Comm, stop: StopRequest | None
    ) -> Pass:
        records = {}
        if self.history.rows:
            records = self.positions.records(self.history.bodies[-1], place, plastic)
        simulation = Simulation(self.case, comm, pass_number=place + 1.0, records=records)
        file = pass_file(self.path, int(place), self.positions.count)
        solved = run_pass(simulation, records, file, stop, self._show_share)
        self._passes += 1
        return self.positions.followed(solved, place)

    def _plastic(self) -> PlasticRecord | None:
        """Record of the plastic deformation after the last row; None without."""
        fields = self.history.plastic[-1] if self.history.rows else None
        return unflat(PlasticRecord, fields, "plastic_deformation") if fields else None

    def _jump(self, solved_round: Round, bodies: tuple[LifeBody, ...], smooth: dict[str, float]) -> None:
        """Jump with the rates of a solved round, and store the row.

        `smooth`: figures of the smooth contact.
        """
        done = self.history.done
        before = self.jumps.continuous_passes(self.history.rows, solved_round)
        after, jump, rates = self.jumps.jump(bodies, solved_round, done, before)
        row: dict[str, float] = {"passes": done + jump, "jump": jump, "solved": len(solved_round.passes)}
        row |= smooth | solved_round.figures(bodies) | {"yielded": solved_round.yielded, "broken_out": 0}
        for k, (body, rate, old) in enumerate(zip(after, rates, bodies, strict=True), 1):
            row["broken_out"] += int(np.count_nonzero(body.pit > old.pit))
            row |= {f"pits_{k}": body.pits, f"pitted_share_{k}": body.pitted_share, f"ra_{k}": body.ra}
            row |= {f"wear_volume_{k}": body.volume, f"damage_{k}": body.largest_damage}
            row |= {f"wear_rate_{k}": float(rate.wear.max()), f"damage_rate_{k}": float(rate.damage.max())}
        plastic = flat(solved_round.plastic, "plastic_deformation") if solved_round.plastic else {}
        self.history.add(row, after, plastic)
        on_root(self.comm, self.file.store, self.history)
