"""Standard output and error that are closed, full or nobody's any more: a run is worth more than they."""

import contextlib
import os
import sys


def harden_std_streams():
    """Let a run outlive its standard output and error.

    What cannot be written is dropped from then on, by this process and by the libraries in it; of standard
    output that is said once on standard error. Descriptors 0 to 2 that are closed become /dev/null: the next
    file opened would get their number, and what is printed.
    """
    for descriptor in range(3):
        try:
            os.fstat(descriptor)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # gets the lowest number that is free
    if hasattr(sys.stdout, "reconfigure"):
        sys.stdout.reconfigure(errors="backslashreplace")  # names of files need not be text
    sys.stdout = FaultTolerantStream(sys.stdout, 1, "standard output")
    sys.stderr = FaultTolerantStream(sys.stderr, 2)


class FaultTolerantStream:
    """A text stream that is quiet once it cannot be written.

    Parameters
    ----------
    stream : file or None
        None: closed from the start.
    descriptor : int
    name : str, optional
        Of the stream, if its end is to be told.
    """

    def __init__(self, stream, descriptor, name=""):
        self._stream = open(os.devnull, "w") if stream is None else stream
        self._descriptor, self._name = descriptor, name
        self.lost = None

    def __getattr__(self, name):
        return getattr(self._stream, name)

    def write(self, text):
        """As of a file."""
        self._try(self._stream.write, text)
        return len(text)

    def flush(self):
        """As of a file."""
        self._try(self._stream.flush)

    def _try(self, action, *arguments):
        try:
            action(*arguments)
        except OSError as error:
            self._give_up(error)

    def _give_up(self, error):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, self._descriptor)  # what the libraries print goes there too
        os.close(nowhere)
        with contextlib.suppress(OSError):
            self._stream.flush()
        if self.lost is None and self._name:
            print(f"ehlpetsc: {self._name} is lost ({error.strerror}); going on without it", file=sys.stderr)
        self.lost = error
