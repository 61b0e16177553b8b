"""numba's compiler as the package uses it: loops over nodes and samples, kept on disk between runs.

The solver needs numba. Post-processing does without it: the same functions then run as plain Python, slowly,
to the same bit.
"""

import os

import numpy as np

os.environ.setdefault("NUMBA_DISABLE_ERROR_MESSAGE_HIGHLIGHTING", "1")  # colour codes would end every output
try:
    import numba

    COMPILED = True
except ImportError:
    COMPILED = False
# what indices are that cannot be negative, over which numba takes half the time
unsigned = np.uint64 if COMPILED and not numba.config.DISABLE_JIT else int
ZERO = np.int64(0)  # to hand to compiled functions, which numba would compile once more for a literal 0


def compiled(function=None, **options):
    """Compile `function` at its first call, once for all runs where the outcome can be kept.

    Division by zero gives infinity as in numpy; ``error_model="python"`` makes it an error as in Python.
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
