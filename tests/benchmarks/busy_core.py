"""Two ranks beside a busy process, at the least: ``python3 tests/benchmarks/busy_core.py``, on two cores.

Two ranks compute 20 microseconds each and exchange, time and again, as in a Krylov iteration; nothing of the
program runs. Microseconds of a round alone, beside a process that computes all the time in the same session,
and in one of its own, whose scheduler's group weighs as much as that of both ranks; each with every rank on a
core of its own, and with ranks that the scheduler may move.

With weights equal, a process that always computes has half of the core that it shares with a rank. The other
rank cannot go on meanwhile: a round takes twice its time at the least, three times beside another session,
whose process has two thirds of the core.
"""

import json
import os
import subprocess
import sys
import time

WORK, SECONDS, REPEATS = 20e-6, 2.0, 3
ENVIRONMENT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
BUSY = (sys.executable, "-c", "while True: pass")


def inside(is_bound):
    """Run on every rank; the first one prints the microseconds of a round."""
    import numpy as np
    from mpi4py import MPI

    comm = MPI.COMM_WORLD
    os.sched_setaffinity(0, {comm.rank} if is_bound else range(comm.size))
    everyone, over = np.zeros((comm.size, 20)), np.zeros(1)
    comm.Barrier()
    begun, rounds = time.perf_counter(), 0
    while not over[0]:
        for _ in range(20):
            until = time.perf_counter() + WORK
            while time.perf_counter() < until:
                pass
            comm.Allgather(MPI.IN_PLACE, everyone)
        rounds, over[0] = rounds + 20, time.perf_counter() - begun > SECONDS
        comm.Bcast(over)
    if comm.rank == 0:
        print(json.dumps(1e6 * (time.perf_counter() - begun) / rounds), flush=True)


def measured(is_bound):
    """Microseconds of a round."""
    command = ["mpirun", "--bind-to", "none", "-n", "2", sys.executable, __file__, str(int(is_bound))]
    environment = os.environ | ENVIRONMENT
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


def main():
    """Measure and print."""
    for beside, session in (("alone", None), ("beside one of the same session", False), ("of another", True)):
        busy = None if session is None else subprocess.Popen(BUSY, start_new_session=session)
        try:
            for is_bound in (True, False):
                rounds = sorted(measured(is_bound) for _ in range(REPEATS))
                where = "each on its core" if is_bound else "moved"
                print(f"{beside}, {where}: " + ", ".join(f"{r:.0f}" for r in rounds) + " us", flush=True)
        finally:
            if busy:
                busy.kill()


if __name__ == "__main__":
    if len(sys.argv) > 1:
        inside(sys.argv[1] == "1")
    else:
        main()
