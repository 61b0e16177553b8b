"""Compilation of loops over nodes and samples by numba, cached on disk between runs.

The solver requires numba. Post-processing works without numba: the functions then run as Python code, slowly,
with bitwise equal results.
"""

import contextlib
import hashlib
import os
from pathlib import Path

import numpy as np

os.environ.setdefault(
    "NUMBA_DISABLE_ERROR_MESSAGE_HIGHLIGHTING", "1"
)  # no colour codes at the end of the output
try:
    import numba
    from llvmlite import ir
    from numba.extending import intrinsic

    COMPILED = True
except ImportError:
    COMPILED = False
# type of indices that are not negative, with which loops take half the time
unsigned = np.uint64 if COMPILED and not numba.config.DISABLE_JIT else int
ZERO = np.int64(0)  # argument of compiled functions, which numba would compile again for a literal 0


def drop_stale_code(package):
    """Remove numba's cached code of other versions of a package.

    numba notices a change of the file of a function, not of the files of functions that it calls, nor that a
    module has moved.

    Parameters
    ----------
    package : Path
    """
    stamp = package / "__pycache__" / "compiled.stamp"
    sources = sorted((str(path.relative_to(package)), path.stat()) for path in package.rglob("*.py"))
    text = repr([(name, status.st_size, status.st_mtime_ns) for name, status in sources])
    digest = hashlib.sha256(text.encode()).hexdigest()
    with contextlib.suppress(OSError):  # read-only: numba then has its cache elsewhere
        if stamp.exists() and stamp.read_text() == digest:
            return
        for path in package.rglob("__pycache__/*.nb[ic]"):
            path.unlink(missing_ok=True)
        temporary = stamp.with_suffix(f".{os.getpid()}")
        temporary.parent.mkdir(exist_ok=True)
        temporary.write_text(digest)
        temporary.replace(stamp)


if COMPILED:
    with contextlib.suppress(OSError):  # a module is removed at the same time
        drop_stale_code(Path(__file__).parent)


def compiled(function=None, **options):
    """Compile `function` at its first call, once for all runs if the code can be cached.

    Division by zero is infinity as in numpy; with ``error_model="python"`` it is an error as in Python.
    Other options are numba's.
    """
    if function is None:
        return lambda function: compiled(function, **options)
    if not COMPILED:
        return function
    options = {"cache": True, "error_model": "numpy"} | options
    try:
        return numba.njit(**options)(function)
    except RuntimeError:  # neither the package's directory nor the user's can be written to
        return numba.njit(**(options | {"cache": False}))(function)


def inlined(function):
    """Compile a small function of a law into its callers.

    A call from compiled code hands over the law's constants one by one, which takes as long as the law.
    """
    return compiled(function, forceinline=True)


if COMPILED:

    @intrinsic
    def call_allgather(typing, function, send, number, received, count, communicator):
        """``function(send, count, number, received, count, number, communicator)`` of C in compiled loops."""

        def code(context, builder, signature, arguments):
            function, send, number, received, count, communicator = arguments
            word, integer = ir.IntType(64), ir.IntType(32)
            kind = ir.FunctionType(integer, [word, integer, word, word, integer, word, word])
            call, count = builder.inttoptr(function, kind.as_pointer()), builder.trunc(count, integer)
            return builder.call(call, [send, count, number, received, count, number, communicator])

        return numba.types.int32(*[numba.types.int64] * 6), code
