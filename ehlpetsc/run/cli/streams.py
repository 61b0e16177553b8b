"""Keep a run alive when standard output or error cannot be written."""

import contextlib
import os
import sys


def harden_std_streams():
    """Keep this process alive when its standard output or error cannot be written.

    Later output is dropped, including the output of libraries in the process; the loss of standard output is
    reported once on standard error. Closed descriptors 0 to 2 are opened on /dev/null: otherwise the next
    file opened would get their number and receive the printed text.
    """
    for descriptor in range(3):
        try:
            os.fstat(descriptor)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # gets the lowest free number
    if hasattr(sys.stdout, "reconfigure"):
        sys.stdout.reconfigure(errors="backslashreplace")  # names of files need not be text
    sys.stdout = FaultTolerantStream(sys.stdout, 1, "standard output")
    sys.stderr = FaultTolerantStream(sys.stderr, 2)


class FaultTolerantStream:
    """Text stream that drops output once it cannot be written.

    Parameters
    ----------
    stream : file or None
        None: closed from the beginning.
    descriptor : int
    name : str, optional
        Name of the stream, for the report of its loss.
    """

    def __init__(self, stream, descriptor, name=""):
        self._stream = open(os.devnull, "w") if stream is None else stream
        self._descriptor, self._name = descriptor, name
        self.lost = None

    def __getattr__(self, name):
        return getattr(self._stream, name)

    def write(self, text):
        """Write like a file."""
        self._try(self._stream.write, text)
        return len(text)

    def flush(self):
        """Flush like a file."""
        self._try(self._stream.flush)

    def _try(self, action, *arguments):
        try:
            action(*arguments)
        except OSError as error:
            self._redirect(error)

    def _redirect(self, error):
        null = os.open(os.devnull, os.O_WRONLY)
        os.dup2(null, self._descriptor)  # also for the output of libraries
        os.close(null)
        with contextlib.suppress(OSError):
            self._stream.flush()
        if self.lost is None and self._name:
            print(
                f"ehlpetsc: {self._name} is lost ({error.strerror}); continuing without it", file=sys.stderr
            )
        self.lost = error
