"""numba where it is installed; without it the same functions run as plain Python, slowly, to the same bit."""

import os

os.environ.setdefault("NUMBA_DISABLE_ERROR_MESSAGE_HIGHLIGHTING", "1")  # colour codes would end every output
try:
    import numba

    COMPILED = True
except ImportError:
    COMPILED = False


def njit(**options):
    """numba.njit, or what returns the function as it is; compiled in every run where nothing can be kept."""

    def decorate(function):
        if not COMPILED:
            return function
        try:
            return numba.njit(**options)(function)
        except RuntimeError:  # neither the package's directory nor the user's can be written to
            return numba.njit(**(options | {"cache": False}))(function)

    return decorate
