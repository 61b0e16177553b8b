"""Pieces of work in processes of their own, with a time limit, and one word for how each ended."""

import os
import signal
import sys
import time


def process(work, report, limit):
    """Exit status and output of work(); negative status: a signal, None: a hang."""
    child = os.fork()
    if child == 0:
        descriptor = os.open(report, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(descriptor, 1)
        os.dup2(descriptor, 2)
        sys.stdout = open(1, "w", closefd=False)
        sys.stderr = open(2, "w", errors="backslashreplace", closefd=False)  # as Python opens it
        status = 1
        try:
            status = work()
        except SystemExit as end:
            status = end.code if isinstance(end.code, int) else 1
        except BaseException:
            import traceback

            traceback.print_exc()
        finally:
            sys.stdout.flush()
            sys.stderr.flush()
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


WORDS = {0: "done", 2: "refused", 3: "not converged", 4: "stopped"}
BAD = ("traceback", "hang", "signal", "different", "changed")


def word_of(status, report):
    """Outcome as a word of `WORDS` or `BAD`."""
    if status is None:
        return "hang"
    if status < 0:
        return "signal"
    if "Traceback (most" in report or status not in WORDS:
        return "traceback"
    if status == 2 and not any(": " in line for line in report.splitlines()):
        return "traceback"  # no word of why
    return WORDS[status]


def beside_others(folder, inputs, work, limit):
    """Outcome, one word, and output of work() in a folder of these files only."""
    for path in folder.iterdir():
        path.unlink()
    for name, content in inputs.items():
        (folder / name).write_bytes(content)

    def inside():
        os.chdir(folder)
        return int(work())

    status, report = process(inside, folder / "report", limit)
    word = word_of(status, report)
    changed = any((folder / name).read_bytes() != inputs[name] for name in inputs)
    if word not in BAD and (changed or list(folder.glob(".*.tmp*"))):
        word = "changed"
    return word, f"{status} {report[-1500:]}"
