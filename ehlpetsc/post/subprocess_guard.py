"""Work in a separate process, because HDF5 may crash on a damaged file or never return."""

import contextlib
import mmap
import os
import select
import signal
import struct
import sys
import traceback

from ehlpetsc.errors import ExitStatus
from ehlpetsc.results.hdf5.lazy_dataset import announced_to

MAX_READ_SECONDS = 60  # of one read of some megabytes, which otherwise never ends
MAX_STOP_SECONDS = 10  # until a child has ended after a signal
STOP_SIGNALS = (signal.SIGTERM, signal.SIGINT)
NOTE_HEADER = struct.Struct("<QQ")


class _Note:
    """Name of the dataset being read and number of reads, in memory shared by both processes."""

    def __init__(self):
        self._shared, self._count = mmap.mmap(-1, 1024), 0

    def write(self, dataset):
        """`dataset` is being read; empty: none."""
        text = dataset.encode(errors="replace")[: len(self._shared) - NOTE_HEADER.size]
        self._count += 1
        self._shared[: NOTE_HEADER.size + len(text)] = NOTE_HEADER.pack(self._count, len(text)) + text

    def read(self):
        """(count, dataset)."""
        count, size = NOTE_HEADER.unpack(self._shared[: NOTE_HEADER.size])
        return count, self._shared[NOTE_HEADER.size : NOTE_HEADER.size + size].decode(errors="replace")


def stop_on_signals():
    """Let the first SIGTERM or SIGINT raise KeyboardInterrupt; returns a function that tests for a signal."""
    requested = []

    def stop(*_):
        if not requested:
            requested.append(True)
            raise KeyboardInterrupt

    for number in STOP_SIGNALS:
        signal.signal(number, stop)
    return lambda: bool(requested)


class SubprocessGuard:
    """Runs functions in forked processes, whose crashes do not affect this process.

    Parameters
    ----------
    say : callable(str)
        Called with one line about a process that crashed or hung.
    """

    def __init__(self, say):
        self.say = say
        self._child, self._asked = None, False
        for number in STOP_SIGNALS:
            signal.signal(number, self._stop)

    def _stop(self, *_):
        self._asked = True
        if self._child:
            os.kill(self._child, signal.SIGTERM)

    def __call__(self, name, work):
        """Exit status of the function work(); `name` is that of its file."""
        note = _Note()
        ours, theirs = os.pipe()
        sys.stdout.flush()
        sys.stderr.flush()
        child = os.fork()
        if child == 0:
            os.close(ours)
            self._run_child(work, note)
        self._child = child
        os.close(theirs)
        try:
            hung = self._wait(ours, note)
        finally:
            os.close(ours)
        status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        self._child = None
        return self._explain(name, status, note, hung)

    def _run_child(self, work, note):
        """Run in the child; never returns."""
        status = ExitStatus.BUG
        try:
            stop_on_signals()
            if self._asked:
                raise KeyboardInterrupt
            with announced_to(note.write):
                status = work()
        except (KeyboardInterrupt, BrokenPipeError):
            status = ExitStatus.STOPPED
        except BaseException:
            traceback.print_exc()
        finally:
            for stream in filter(None, (sys.stdout, sys.stderr)):
                with contextlib.suppress(OSError):  # closed by the reader
                    stream.flush()
            os._exit(status)

    def _wait(self, pipe, note):
        """Wait until the child's end of the pipe closes; True if the child had to be killed."""
        before, same, stopping = None, 0, 0
        while not select.select([pipe], [], [], 1.0)[0]:
            now = note.read()
            same = same + 1 if now == before and now[1] else 0
            before = now
            if self._asked:
                if not stopping:
                    os.kill(self._child, signal.SIGTERM)  # the first signal came before the child existed
                stopping += 1
            if same >= MAX_READ_SECONDS or stopping >= MAX_STOP_SECONDS:
                os.kill(self._child, signal.SIGKILL)
                return True
        return False

    def _explain(self, name, status, note, hung):
        dataset = note.read()[1]
        if self._asked:
            return ExitStatus.STOPPED
        if status >= 0:
            return status
        if hung:
            self.say(f"{name}: {dataset}: HDF5 does not return from reading it, the file is damaged")
            return ExitStatus.BAD_INPUT
        killed_by = signal.Signals(-status).name
        if dataset and -status != signal.SIGKILL:
            self.say(f"{name}: {dataset}: HDF5 crashes on it ({killed_by}), the file is damaged")
            return ExitStatus.BAD_INPUT
        if -status == signal.SIGKILL:
            self.say(f"{name}: killed, as when memory runs out; the same command continues from there")
            return ExitStatus.STOPPED
        self.say(f"{name}: crashed ({killed_by}) while nothing was being read: a bug")
        return ExitStatus.BUG
