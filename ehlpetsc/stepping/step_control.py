"""Size of the next time step."""

import numpy as np

from ehlpetsc.physics.operation import LEVEL

GROWTH = 2.0  # from one step to the next; BDF2 bears 2.4
NEARLY_NOMINAL = 1.5  # a step within this factor of the nominal one is followed by the nominal one


def on_level(steps, every=1):
    """Whether a number of nominal steps is a multiple of `every`, but for rounding."""
    return abs(steps - every * round(steps / every)) < LEVEL


def next_step(dt, retries, nominal, left):
    """Size of the step to try next [s]: a whole number of it ends on a multiple of the nominal step.

    So the run comes back after halved steps to the time levels that the members of a series share. After a
    step that had to be halved it does not grow at once: where steps have just failed, the next longer one
    mostly fails too.

    Parameters
    ----------
    dt : float or None
        Step that led there [s], None at the start.
    retries : int
        How often that step was halved.
    nominal : float
        Step that the operation proposes, courant dx / u_max [s].
    left : float
        Time to the next time level [s].
    """
    longest = nominal
    if dt is not None and NEARLY_NOMINAL * dt < nominal:
        longest = dt if retries else GROWTH * dt
    return left / np.ceil(left / longest - LEVEL)
