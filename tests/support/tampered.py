"""The program with an accident at one step of one rank: ``tampered.py ACCIDENT RANK STEP arguments``.

ACCIDENT is "raise", an error in the code, "late", the end of the time limit, "lost", the folder "out" removed
with all that is in it, or the name of a signal that the rank gets during the step; "SIGKILL@2": of pass 2.
With "index" the rank is killed as it is about to put an index in its place for the STEP-th time.
"""

import gc
import math
import os
import shutil
import signal
import sys
import time
from types import SimpleNamespace

from ehlpetsc.__main__ import main
from ehlpetsc.base.environment import need_solver
from ehlpetsc.commands.run import parse


def kill_at_index(rank, count):
    from mpi4py import MPI

    from ehlpetsc.results import output_guard

    replace, seen = os.replace, []

    def killing(beside, path):
        seen.extend([path] * str(path).endswith(".json"))
        if len(seen) == count and MPI.COMM_WORLD.rank == rank:
            os.kill(os.getpid(), signal.SIGKILL)
        replace(beside, path)

    output_guard.os = SimpleNamespace(**{name: getattr(os, name) for name in dir(os)} | {"replace": killing})


def tamper(accident, rank, step):
    from mpi4py import MPI

    from ehlpetsc.run import ranks as stop
    from ehlpetsc.run.simulation import Simulation

    advance = Simulation.advance
    accident, _, of_pass = accident.partition("@")

    def with_accident(self, **given):
        state, of_this = self.dimensionless, not of_pass or self.pass_number == int(of_pass)
        if of_this and state and state.step + 1 == step and MPI.COMM_WORLD.rank == rank:
            if accident == "raise":
                raise ValueError("an accident")
            if accident == "late":
                stop.clock = SimpleNamespace(monotonic=lambda: math.inf, sleep=time.sleep)
                return advance(self, **given)
            if accident == "lost":
                shutil.rmtree("out")
                return advance(self, **given)
            os.kill(os.getpid(), getattr(signal, accident))
        return advance(self, **given)

    Simulation.advance = with_accident


if __name__ == "__main__":
    accident, rank, step, *rest = sys.argv[1:]
    need_solver()
    import petsc4py

    petsc4py.init([sys.argv[0], *parse(rest).petsc])  # what is tampered with imports PETSc
    if accident == "index":
        kill_at_index(int(rank), int(step))
    else:
        tamper(accident, int(rank), int(step))
    gc.disable()
    status = main(rest)
    if petsc4py.PETSc.COMM_WORLD.rank != int(rank):
        gc.collect()  # what an error has left goes at another time on each rank
    sys.exit(status)
