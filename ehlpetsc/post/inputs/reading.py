"""Reading from HDF5 with every fault in plain words, and each read announced to whoever watches.

HDF5 hands the faults of a damaged file on as exceptions of many kinds; some damage makes it crash or never
return. Who runs this in a process of its own (:mod:`ehlpetsc.post.supervised`) learns from the announcements
what was being read.
"""

from contextlib import contextmanager

from ehlpetsc.errors import OutputError, PostError

LONGEST_REASON = 200  # characters

_listeners = []


@contextmanager
def announced_to(listener):
    """Call listener(what) before each read, and listener("") after it."""
    _listeners.append(listener)
    try:
        yield
    finally:
        _listeners.remove(listener)


def _announce(what):
    for listener in _listeners:
        listener(what)


@contextmanager
def reading(what):
    """Around calls of HDF5 alone: whatever they raise becomes a PostError that names `what` was read."""
    _announce(what)
    try:
        yield
    except (PostError, OutputError):
        raise
    except PermissionError:
        raise PostError(f"{what}: permission denied") from None
    except Exception as fault:  # h5py has no class of its own for what HDF5 reports
        raise PostError(f"{what}: cannot be read, the file is damaged ({in_words(fault)})") from None
    finally:
        _announce("")


def in_words(fault):
    """One printable line of an exception."""
    words = str(fault).strip() or type(fault).__name__
    line = "".join(c if c.isprintable() else "?" for c in words.splitlines()[0])
    return line[:LONGEST_REASON]


def text(value, what):
    """A string attribute or dataset as str."""
    if isinstance(value, bytes):
        try:
            return value.decode()
        except UnicodeDecodeError:
            raise PostError(f"{what}: not a text in UTF-8") from None
    if not isinstance(value, str):
        raise PostError(f"{what}: not a text")
    return value
