"""Size of the next time step."""

import numpy as np

from ehlpetsc.physics.operation import LEVEL_TOLERANCE

MAX_STEP_RATIO = 2.0  # of successive steps; BDF2 is stable up to 2.4
NEARLY_NOMINAL = 1.5  # a step within this factor of the nominal step is followed by the nominal step


def on_level(steps, every=1):
    """Whether a number of nominal steps is a multiple of `every`, except for rounding."""
    return abs(steps - every * round(steps / every)) < LEVEL_TOLERANCE


def next_step(dt, retries, nominal, left):
    """Size of the next time step [s], of which a whole number ends on the next time level.

    After halved steps the run thus returns to the time levels that the members of a series have in common.
    The size does not increase directly after a halved step, because a longer step would mostly fail too.

    Parameters
    ----------
    dt : float or None
        Last step [s]; None at the start.
    retries : int
        Number of times that the last step was halved.
    nominal : float
        Nominal step, courant dx / u_max [s].
    left : float
        Time to the next time level [s].
    """
    longest = nominal
    if dt is not None and NEARLY_NOMINAL * dt < nominal:
        longest = dt if retries else MAX_STEP_RATIO * dt
    return left / np.ceil(left / longest - LEVEL_TOLERANCE)
