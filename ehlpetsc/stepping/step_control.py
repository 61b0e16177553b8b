"""The size of the next time step, in one place."""

import numpy as np

LEVEL = 1e-6  # of a step: times nearer than this are the same
GROWTH = 2.0  # from one step to the next; BDF2 bears 2.4
NEARLY_NOMINAL = 1.5  # a step within this factor of the nominal one is followed by the nominal one


def on_level(time, step, every=1):
    """Whether a time is a multiple of `every` nominal steps, but for rounding."""
    steps = time / step
    return abs(steps - every * round(steps / every)) < LEVEL


def next_step(time, dt, retries, nominal):
    """Size of the step to try next [s]: a whole number of it ends on a multiple of the nominal step.

    So the run comes back after halved steps to the time levels that the members of a series share. After a
    step that had to be halved it does not grow at once: where steps have just failed, the next longer one
    mostly fails too.

    Parameters
    ----------
    time : float
        Of the last level [s].
    dt : float or None
        Step that led there [s], None at the start.
    retries : int
        How often that step was halved.
    nominal : float
        The case's step, courant dx / u_max [s].
    """
    longest = nominal
    if dt is not None and NEARLY_NOMINAL * dt < nominal:
        longest = dt if retries else GROWTH * dt
    left = nominal - time % nominal
    if left < LEVEL * nominal:
        left += nominal
    return left / np.ceil(left / longest - LEVEL)
