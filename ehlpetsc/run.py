"""One case on all ranks: read, solve, write, report. Rank 0 alone reads the case and writes files."""
import signal
import sys
import time as clock
from pathlib import Path

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from ehlpetsc.case import CaseError, load
from ehlpetsc.explain import dowson_higginson, warnings
from ehlpetsc.march import Failed, March, State
from ehlpetsc.output import OutputError, ResultWriter, load_restart, save_restart
from ehlpetsc.report import Progress, summary_line
from ehlpetsc.roughness import Roughness
from ehlpetsc.scales import Scales
from ehlpetsc.solver import NotConverged, Solver, set_defaults

DONE, BAD_INPUT, NOT_CONVERGED, STOPPED = 0, 2, 3, 4


class StopRequest:
    """SIGTERM, SIGINT or SIGUSR1 on any rank, or the time limit: the step in hand is finished first."""

    def __init__(self, minutes):
        self.asked = False
        self.until = clock.monotonic() + 60.0 * minutes if minutes else np.inf
        for name in (signal.SIGTERM, signal.SIGINT, signal.SIGUSR1):
            signal.signal(name, self._ask)

    def _ask(self, *_):
        self.asked = True

    def __call__(self, comm):
        return comm.allreduce(self.asked or clock.monotonic() > self.until, MPI.LOR)


def read_case(comm, path, overrides):
    """The case on every rank, or None where it is faulty (told on rank 0)."""
    case = None
    if comm.rank == 0:
        try:
            case = load(path, overrides)
        except CaseError as error:
            print("\n".join(error.faults), file=sys.stderr, flush=True)
    return comm.bcast(case)


def expected_film(case, scales):
    """Film scale in a^2/R that divides the Reynolds rows and sets the smooth start."""
    if case.fluid is None:
        return 1.0
    return max(dowson_higginson(scales, case.fluid.pressure_viscosity) / scales.h, 1e-6)


class Run:
    """A case being run: holds march, writer, progress and restart file."""

    def __init__(self, comm, case, options):
        self.comm, self.case, self.root = comm, case, comm.rank == 0
        self.scales = Scales.of(case)
        self.roughness = Roughness.of(case, self.scales)
        film = expected_film(case, self.scales)
        self.march = March(Solver(case, self.scales, film), self.scales, self.roughness, film)
        self.output = Path(options.getString("ehl_output", Path(case.path).stem + ".h5"))
        self.restart = self.output.with_suffix(".restart.h5")
        self.stop = StopRequest(options.getReal("ehl_time_limit", 0.0))
        self.writer = None
        self.totals = {"newton": 0, "h_min": np.inf, "p_max": 0.0, "contacts": 0, "load_error": 0.0, "mass_error": 0.0}

    def open_writer(self, step=None, count=None):
        """Create or continue the result file on rank 0; the same verdict on every rank."""
        fault = None
        if self.root:
            s, c = self.scales, self.case
            fields = [f for f in c.output.fields if c.fluid is not None or f != "void_fraction"]
            profiles = {"fast": None, "slow": None}
            if self.roughness is not None:
                for side in profiles:
                    p = getattr(self.roughness, side)
                    profiles[side] = p and (p.s, p.z, p.speed, {"ra": p.ra, "rq": p.rq, "rsk": p.rsk})
            attributes = {
                "a": s.a, "p0": s.p0, "h_scale": s.h, "u1": s.u1, "u2": s.u2, "ranks": self.comm.size,
                "petsc_options": " ".join(f"-{k} {v}".strip() for k, v in PETSc.Options().getAll().items()),
                "versions": {"petsc": ".".join(map(str, PETSc.Sys.getVersion()))},
            }
            try:
                self.writer = ResultWriter(
                    self.output, case_text=c.text, title=c.title, x=s.x * s.a, scalars_attrs=attributes, fields=fields,
                    every=c.output.every, precision=c.output.precision, profiles=profiles, resume_step=step,
                    contact_count=count)
            except OutputError as error:
                fault = str(error)
        fault = self.comm.bcast(fault)
        if fault:
            raise OutputError(fault)

    def store(self, state, started):
        """Write one accepted state; totals for the summary."""
        scalars, fields, in_contact = self.march.scalars(self.case, state, started)
        fault = None
        if self.root:
            try:
                self.writer.append(state.step, state.time, fields, scalars, in_contact)
            except OutputError as error:
                fault = str(error)
        fault = self.comm.bcast(fault)
        if fault:
            raise OutputError(fault)
        t = self.totals
        t["newton"] += scalars["newton"]
        t["contacts"] += scalars["contacts"]
        t["h_min"] = min(t["h_min"], scalars["h_min"])
        for name in ("p_max", "load_error", "mass_error"):
            t[name] = max(t[name], scalars[name])
        return scalars

    def checkpoint(self, state):
        """Write the restart file beside the result, on rank 0."""
        if not self.root:
            return
        self.writer.flush()
        arrays = {"q": state.q, "h": state.h, "contact_count": self.writer.contact_count,
                  "smooth_q": self.march.smooth[0], "smooth_h": self.march.smooth[1]}
        for name in ("m", "m_older"):
            if getattr(state, name) is not None:
                arrays[name] = getattr(state, name)
        attributes = {"h00": state.h00, "time": state.time, "dt": state.dt or 0.0,
                      "dt_next": state.dt_next or 0.0, "step": state.step}
        save_restart(self.restart, arrays, attributes)

    def resume(self, path):
        """State of a restart file."""
        arrays, attributes = load_restart(path)
        if len(arrays["q"]) != self.scales.nx:
            raise OutputError(f"{path}: has {len(arrays['q'])} nodes, the case {self.scales.nx}")
        self.march.smooth = (arrays["smooth_q"], arrays["smooth_h"])
        state = State(arrays["q"], arrays["h"], float(attributes["h00"]), m=arrays.get("m"),
                      m_older=arrays.get("m_older"), time=float(attributes["time"]),
                      dt=float(attributes["dt"]) or None, dt_next=float(attributes["dt_next"]) or None,
                      step=int(attributes["step"]))
        return state, arrays["contact_count"]

    def go(self, restart):
        """Run to the end. Returns the exit status."""
        begun = clock.monotonic()
        if restart:
            state, count = self.resume(restart)
            self.open_writer(state.step, count)
        else:
            state = self.march.start(NotConverged)
            self.open_writer()
            self.store(state, begun)
        status, failure = "done", None
        if self.case.time is not None:
            state, status, failure = self._march(state)
        if self.root:
            self.writer.close(status)
            self._report(state, status, failure, clock.monotonic() - begun)
        return {"done": DONE, "stopped": STOPPED}.get(status, NOT_CONVERGED)

    def _march(self, state):
        s = self.scales
        progress = Progress(state.time, s.duration) if self.root else None
        saved = clock.monotonic()
        status, failure = "done", None
        while state.time < s.duration * (1.0 - 1e-9):
            if self.stop(self.comm):
                status = "stopped"
                break
            started = clock.monotonic()
            try:
                state = self.march.advance(state, NotConverged, s.dt)
            except Failed as error:
                status, failure = "not converged", str(error)
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
        return state, status, failure

    def _report(self, state, status, failure, wall):
        if failure:
            print(f"ehlpetsc: not converged: {failure}. Last good state: {self.restart}", file=sys.stderr, flush=True)
        elif status == "stopped":
            print(f"ehlpetsc: stopped at step {state.step}; go on with -ehl_restart {self.restart}", flush=True)
        print(f"result: {self.output}")
        print(summary_line(status, steps=state.step, wall=wall, **self.totals), flush=True)


def run(path, overrides):
    """Run a case file on all ranks; returns the exit status."""
    comm = MPI.COMM_WORLD
    case = read_case(comm, path, overrides)
    if case is None:
        return BAD_INPUT
    options = PETSc.Options()
    set_defaults(options, case.petsc, comm.size)
    restart = options.getString("ehl_restart", "")
    try:
        this = Run(comm, case, options)
        if this.root:
            for line in warnings(case, this.scales):
                print(f"warning: {line}", flush=True)
        return this.go(restart)
    except OutputError as error:
        if comm.rank == 0:
            print(f"ehlpetsc: {error}", file=sys.stderr, flush=True)
        return BAD_INPUT
    except Failed as error:
        if comm.rank == 0:
            print(f"ehlpetsc: not converged: {error}", file=sys.stderr, flush=True)
        return NOT_CONVERGED
