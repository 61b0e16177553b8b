"""Pieces of work in processes of their own, with a time limit, and one word for how each ended."""

import os
import signal
import sys
import time
import traceback

WORDS = {0: "done", 2: "refused", 3: "not converged", 4: "stopped"}
BAD = ("traceback", "hang", "signal", "different", "changed")


def process(work, report, limit):
    """Exit status and output of work(); negative status: a signal, None: a hang."""
    child = os.fork()
    if child == 0:
        sys.stdout = sys.stderr = open(report, "w", errors="backslashreplace", buffering=1)
        os.dup2(sys.stdout.fileno(), 1)
        os.dup2(sys.stdout.fileno(), 2)
        status = 1
        try:
            status = work()
        except SystemExit as end:
            status = end.code if isinstance(end.code, int) else 1
        except BaseException:
            traceback.print_exc()
        finally:
            sys.stdout.flush()
            os._exit(status)
    until = time.monotonic() + limit
    while time.monotonic() < until:
        found, status = os.waitpid(child, os.WNOHANG)
        if found:
            return os.waitstatus_to_exitcode(status), report.read_text(errors="replace")
        time.sleep(0.005)
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    return None, report.read_text(errors="replace")


def word_of(status, report):
    """Outcome as a word of `WORDS` or `BAD`."""
    if status is None or status < 0:
        return "hang" if status is None else "signal"
    unexplained = status == 2 and not any(": " in line for line in report.splitlines())
    return "traceback" if "Traceback (most" in report or unexplained else WORDS.get(status, "traceback")
