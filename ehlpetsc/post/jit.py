"""numba where it is installed; without it the same functions run as plain Python, slowly, to the same bit."""

import os

os.environ.setdefault("NUMBA_DISABLE_ERROR_MESSAGE_HIGHLIGHTING", "1")  # colour codes would end every output
try:
    from numba import njit

    COMPILED = True
except ImportError:
    COMPILED = False

    def njit(*args, **options):
        """Stand in for numba.njit: return the function as it is."""
        return args[0] if args else lambda function: function
