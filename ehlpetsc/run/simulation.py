"""One case on the ranks of one communicator: solve, write, report. Rank 0 alone writes files."""

import sys
import time as clock
from pathlib import Path

import mpi4py
import numpy as np
import petsc4py
from mpi4py import MPI
from petsc4py import PETSc

from ehlpetsc.errors import NotConverged, OutputError
from ehlpetsc.nonlinear import events as log
from ehlpetsc.nonlinear.newton import NewtonSolver
from ehlpetsc.nonlinear.scheme import solver_of
from ehlpetsc.physics.film_formulas import expected_film
from ehlpetsc.physics.scales import Scales
from ehlpetsc.results.writer import ResultWriter
from ehlpetsc.run import checkpoint
from ehlpetsc.run.describe import banner, warnings
from ehlpetsc.run.progress import Progress, summary_line
from ehlpetsc.stepping.observables import observe
from ehlpetsc.stepping.step_control import on_level
from ehlpetsc.stepping.time_stepping import TimeStepping
from ehlpetsc.surfaces.roughness import Roughness

DONE, NOT_CONVERGED, STOPPED = 0, 3, 4
FOLLOWED = ("snes_monitor", "snes_vi_monitor", "snes_converged_reason", "ksp_monitor", "ksp_converged_reason")
GREATEST = ("p_max", "load_error", "mass_error")  # of the run, in the summary


def on_root(comm, action, *arguments):
    """What `action` returns on rank 0, None on the others; its OutputError is raised on every rank."""
    answer = fault = None
    if comm.rank == 0:
        try:
            answer = action(*arguments)
        except OutputError as error:
            fault = str(error)
    fault = comm.bcast(fault)
    if fault:
        raise OutputError(fault)
    return answer


class Run:
    """A case being run: holds march, writer, progress and restart file.

    Parameters
    ----------
    comm : mpi4py communicator
    case : case.Case
    options : petsc4py.PETSc.Options
    stop : callable
        Asked before every step with the communicator: whether to end there.
    output : path-like
        Result file; the restart file gets its name too.
    out, err : file, optional
        Where rank 0 speaks; standard output and error by default.
    """

    def __init__(self, comm, case, options, stop, output, out=None, err=None):
        self.comm, self.case, self.root, self.stop = comm, case, comm.rank == 0, stop
        self.out, self.err = out or sys.stdout, err or sys.stderr
        self.scales = Scales.of(case)
        self.roughness = Roughness.of(case, self.scales)
        film = expected_film(case, self.scales)
        self.views = taken_out(options, ("snes_view", "ksp_view"))
        self.follow = any(options.hasName(name) for name in FOLLOWED)
        solver = solver_of(case, self.scales, film, PETSc.Comm(comm), options)
        self.march = TimeStepping(solver, self.scales, self.roughness, film)
        self.output = Path(output)
        self.restart = self.output.with_suffix(".restart.h5")
        self.writer = self.failure = None
        self.totals = {"newton": 0, "h_min": np.inf, "contacts": 0} | dict.fromkeys(GREATEST, 0.0)

    def announce(self):
        """Say on rank 0 what is about to run, and what the user should know before."""
        if self.root:
            for line in banner(self.case, self.scales, self.roughness, self.comm.size):
                print(line, file=self.out)
            for line in warnings(self.case, self.scales):
                print(f"warning: {line}", file=self.out, flush=True)

    def open_writer(self, step=None, count=None):
        """Create or continue the result file, on rank 0."""
        self.writer = on_root(self.comm, self._new_writer, step, count)

    def _new_writer(self, step, count):
        s, c = self.scales, self.case
        fields = [f for f in c.output.fields if c.fluid is not None or f != "void_fraction"]
        profiles = {"fast": None, "slow": None}
        if self.roughness is not None:
            for side in profiles:
                p = getattr(self.roughness, side)
                profiles[side] = p and (p.s, p.z, p.speed, {"ra": p.ra, "rq": p.rq, "rsk": p.rsk})
        attributes = {
            "a": s.a,
            "p0": s.p0,
            "h_scale": s.h,
            "u1": s.u1,
            "u2": s.u2,
            "ranks": self.comm.size,
            "petsc_options": " ".join(f"-{k} {v}".strip() for k, v in PETSc.Options().getAll().items()),
            "versions": libraries(),
        }
        return ResultWriter(
            self.output,
            case_text=c.text,
            title=c.title,
            x=s.x * s.a,
            scalars_attrs=attributes,
            fields=fields,
            every=c.output.every,
            precision=c.output.precision,
            profiles=profiles,
            resume_step=step,
            contact_count=count,
        )

    def store(self, state, started):
        """Write one accepted state; totals for the summary."""
        scalars, fields, in_contact = observe(self.case, self.scales, self.march.problem, state, started)
        every = self.case.output.every
        frame = every == 1 or self.case.time is None or on_level(state.time, every * self.scales.dt)
        with log.OUTPUT:
            on_root(
                self.comm,
                lambda: self.writer.append(state.step, state.time, fields, scalars, in_contact, frame),
            )
        t = self.totals
        t["newton"] += scalars["newton"]
        t["contacts"] += scalars["contacts"]
        t["h_min"] = min(t["h_min"], scalars["h_min"])
        for name in GREATEST:
            t[name] = max(t[name], scalars[name])
        return scalars

    def checkpoint(self, state):
        """Write the restart file beside the result, on rank 0."""

        def write():
            self.writer.flush()
            checkpoint.save(
                self.restart,
                state,
                self.march.smooth,
                self.writer.contact_count,
                self.totals,
                self.case,
                self.scales,
                self.march.problem.model,
            )

        on_root(self.comm, write)

    def resume(self, path):
        """State and contact count of a restart file."""
        state, self.march.smooth, count, totals, notes = checkpoint.load(
            path, self.case, self.scales, self.march.problem.model
        )
        self.totals |= totals
        if self.root:
            print(f"restart: {path}, step {state.step}, {1e6 * state.time:.4f} us", file=self.out)
            for note in notes:
                print(f"restart: {note}", file=self.out, flush=True)
        return state, count

    def go(self, restart):
        """Run to the end. Returns the exit status."""
        begun = clock.monotonic()
        if restart:
            state, count = self.resume(restart)
            self.open_writer(state.step, count)
        else:
            self._follow("steady start")
            with log.START:
                state = self.march.start()
            self._view()
            self.open_writer()
            self.store(state, begun)
        status = "done"
        if self.case.time is not None:
            with log.STEPS:
                state, status = self._march(state)
        on_root(self.comm, lambda: self.writer.close(status))
        if self.root:
            self._report(state, status, clock.monotonic() - begun)
        return {"done": DONE, "stopped": STOPPED}.get(status, NOT_CONVERGED)

    def _follow(self, what):
        """Head PETSc's own lines, where the user asked for some."""
        if self.follow:
            PETSc.Sys.Print(what, comm=self.comm)

    def _view(self):
        """-snes_view and -ksp_view once, after the first solve: PETSc would repeat them at every step."""
        solver = self.march.solver
        for name in self.views if isinstance(solver, NewtonSolver) else ():
            (solver.snes if name == "snes_view" else solver.snes.ksp).view()

    def _march(self, state):
        s = self.scales
        progress = Progress(state.time, s.duration, self.out) if self.root else None
        saved = clock.monotonic()
        status = "done"
        while state.time < s.duration * (1.0 - 1e-9):
            if self.stop(self.comm):
                status = "stopped"
                break
            started = clock.monotonic()
            self._follow(f"step {state.step + 1} from {1e6 * state.time:.4f} us")
            try:
                state = self.march.advance(state)
            except NotConverged as error:
                status, self.failure = "not converged", str(error)
                break
            scalars = self.store(state, started)
            if progress:
                progress.step(state.step, state.time, scalars)
            if self.comm.bcast(clock.monotonic() - saved > 60.0 * self.case.output.checkpoint):
                self.checkpoint(state)
                saved = clock.monotonic()
        if progress:
            progress.close()
        if status != "done":
            self.checkpoint(state)
        return state, status

    def _report(self, state, status, wall):
        if self.failure:
            print(
                f"ehlpetsc: not converged: {self.failure}. Last good state: {self.restart}",
                file=self.err,
                flush=True,
            )
        elif status == "stopped":
            print(
                f"ehlpetsc: stopped at step {state.step}; go on with -ehl_restart {self.restart}",
                file=self.out,
            )
        print(f"result: {self.output}", file=self.out)
        print(summary_line(status, steps=state.step, wall=wall, **self.totals), file=self.out, flush=True)


def taken_out(options, names):
    """Those of the names that stand in PETSc's table without a value, taken out of it."""
    found = [name for name in names if options.hasName(name) and not options.getString(name, "")]
    for name in found:
        options.delValue(name)
    return found


def libraries():
    """Names and versions of what computes, for the result file."""
    petsc = ".".join(map(str, PETSc.Sys.getVersion()))
    mpi = MPI.Get_library_version().split(",")[0].rstrip("\0")
    return {"petsc": petsc, "petsc4py": petsc4py.__version__, "mpi4py": mpi4py.__version__, "mpi": mpi}
