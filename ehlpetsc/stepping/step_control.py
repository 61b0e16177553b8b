r"""Length of time steps by an error estimate of the film, under conditions that vary.

The time levels of the operation are as far apart as the shortest step; a step spans a whole number of them.
Its error is the local error of BDF2 at fixed nodes,

.. math:: e=\frac{\Delta t^2(\Delta t+\Delta t_1)}{1+k}\,h[t_0,t_1,t_2,t_3],\qquad
   k=\frac{\Delta t}{\Delta t+\Delta t_1},

with the divided difference of the films at the new level and the three before it: :math:`h'''/6` of a cubic
through them, times the interpolation error of the derivative (Hairer, Norsett & Wanner 1993, section III.5).
The estimate is the root mean square of e over that of the film, both weighted by the pressure: inlet and
outlet, where films are thick and move with the edges of the contact, do not count.

Steps that grow at most by a factor of two keep BDF2 stable. No step passes a line of the table of conditions,
so that no line is missed.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ehlpetsc.base.counts import whole_down
from ehlpetsc.base.declarations import Values

if TYPE_CHECKING:
    from ehlpetsc.physics.variable_operation import VariableOperation

SAFETY = 0.9  # of the step that the estimate allows
MAX_GROWTH = 2.0  # of successive steps; BDF2 is stable up to 2.4
MIN_SHRINKAGE = 0.2  # of a step that is repeated
REPEATED = 2.0  # tolerances: a larger error has the step repeated


def divided_difference(values: Sequence[np.ndarray], times: Sequence[float]) -> np.ndarray:
    """Divided difference of all values, of as many orders as there are values but one."""
    if len(values) == 1:
        return values[0]
    higher = divided_difference(values[:-1], times[:-1]) - divided_difference(values[1:], times[1:])
    return higher / (times[0] - times[-1])


def film_error(films: Sequence[np.ndarray], times: Sequence[float], pressure: np.ndarray) -> float | None:
    """Relative error of the film in a step; None: fewer than four levels.

    Parameters
    ----------
    films, times
        At the new level and those before it, latest first, shape (nodes,) each.
    pressure : shape (nodes,)
        At the new level, in any unit.
    """
    if len(films) < 4 or not pressure.any():
        return None
    dt, dt_older = times[0] - times[1], times[1] - times[2]
    factor = dt * dt * (dt + dt_older) / (1.0 + dt / (dt + dt_older))
    error = factor * divided_difference(films[:4], times[:4])
    weight = np.maximum(pressure, 0.0)
    return float(np.sqrt(weight @ error**2 / (weight @ films[0] ** 2)))


class StepControl:
    """Control of the error of a step.

    `time`: table of the case, with a tolerance.
    `operation`: conditions that vary.
    """

    def __init__(self, time: Values, operation: VariableOperation) -> None:
        self.tolerance, self.operation = time.tolerance, operation
        self.span = max(whole_down(time.courant / time.shortest), 1)  # time levels of the longest step

    error = staticmethod(film_error)

    def levels(self, dt: float | None, error: float | None, nominal: float, may_grow: bool = True) -> int:
        """Levels of the next step after one of `dt` [s] with an error, `nominal` [s] apart."""
        if dt is None or error is None:
            return 1
        growth = SAFETY * (self.tolerance / max(error, 1e-300)) ** (1.0 / 3.0)
        growth = min(max(growth, MIN_SHRINKAGE), MAX_GROWTH if may_grow else 1.0)
        return min(max(whole_down(growth * dt / nominal), 1), self.span)

    def is_repeated(self, error: float | None, levels: int) -> bool:
        """Whether a step over some levels has to be repeated in a shorter one."""
        return levels > 1 and error is not None and error > REPEATED * self.tolerance
