"""numba's compiler as the solver uses it: loops over nodes, kept on disk between runs.

(ehlpetsc.post has its own: it stands alone, and does without numba.)
"""

import os

os.environ.setdefault("NUMBA_DISABLE_ERROR_MESSAGE_HIGHLIGHTING", "1")  # colour codes would end every output
from numba import njit


def compiled(function=None, **options):
    """Compile `function` at its first call, once for all runs where the outcome can be kept.

    Division by zero gives infinity as in numpy. Other options are numba's.
    """
    if function is None:
        return lambda function: compiled(function, **options)
    try:
        return njit(cache=True, error_model="numpy", **options)(function)
    except RuntimeError:  # neither the package's directory nor the user's can be written to
        return njit(error_model="numpy", **options)(function)
