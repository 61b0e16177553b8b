r"""Fixed points :math:`x=g(x)` of a steady start by Anderson's acceleration (Walker & Ni 2011).

Of the heat fluxes of a film and both walls for a given flow, and of all that a solve of the film takes from
the temperatures of the last one: alone they would oscillate where fast, warm films heat by their own flow.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ehlpetsc.effects.heat.record import HeatRecord

DEPTH = 6  # changes of x and g that are combined
MIXING_ITERATIONS = 200
MIXING_ACCURACY = 1e-11  # of the maximum
MIN_SINGULAR_VALUE = 1e-12  # of the maximum, in the least squares of fluxes
MIN_SINGULAR_VALUE_OF_RECORDS = 1e-8
FAR = 0.3  # of the maximum rise of temperature: after a larger change a record is taken as it is
LAGGED = (
    *("film", "base", "profile", "pressure", "source", "rubbing", "spread", "flow"),
    *("wall_1", "wall_2", "flux_1", "flux_2"),
)


def mixing(
    function: Callable[[np.ndarray], np.ndarray], start: np.ndarray, of_change: float = 0.0
) -> np.ndarray:
    """Fixed point of a function; the last argument that the function had.

    `of_change`: fraction of the first change that is accurate.
    """
    x: np.ndarray = start
    steps: list[np.ndarray] = []
    residuals: list[np.ndarray] = []
    least = 0.0
    for _ in range(MIXING_ITERATIONS):
        new = function(x)
        f = new - x
        change = np.abs(f).max()
        least = least or of_change * change
        if change <= max(MIXING_ACCURACY * max(np.abs(new).max(), 1e-300), least):
            return x
        steps, residuals = [*steps, x][-DEPTH:], [*residuals, f][-DEPTH:]
        x = combined(steps, residuals, 1.0, MIN_SINGULAR_VALUE)
    return x


def combined(
    steps: Sequence[np.ndarray],
    residuals: Sequence[np.ndarray],
    weights: np.ndarray | float,
    min_singular_value: float,
) -> np.ndarray:
    """Next x from those so far and g(x) - x, whose combination is least in the norm with the weights."""
    f, new = residuals[-1], steps[-1] + residuals[-1]
    if len(steps) == 1:
        return new
    differences, moved = np.diff(np.array(residuals), axis=0), np.diff(np.array(steps), axis=0)
    gamma = np.linalg.lstsq((differences * weights).T, f * weights, rcond=min_singular_value)[0]
    return new - gamma @ (moved + differences)


def mixed_record(pairs: Sequence[tuple[HeatRecord, HeatRecord]], cold: float) -> HeatRecord:
    """Record for the next solve, from those before and after the last ones; `cold` is unheated oil [K]."""
    after = pairs[-1][1]
    near = [pair for pair in pairs if pair[0].levels and _change(*pair) < FAR * _rise(pair[1], cold)]
    if not near or near[-1] is not pairs[-1]:
        return after
    before, found = (np.array([_lagged(pair[k]) for pair in near[-DEPTH:]]) for k in (0, 1))
    scales = [np.full(getattr(after, name).size, np.abs(getattr(after, name)).max()) for name in LAGGED]
    weights = 1.0 / np.maximum(np.concatenate(scales), 1e-300)
    x = combined(list(before), list(found - before), weights, MIN_SINGULAR_VALUE_OF_RECORDS)
    ends = np.cumsum([getattr(after, name).size for name in LAGGED])
    fields: dict[str, Any] = dict(zip(LAGGED, np.split(x, ends[:-1]), strict=True))
    return after._replace(**fields)


def _lagged(record: HeatRecord) -> np.ndarray:
    return np.concatenate([getattr(record, name) for name in LAGGED])


def _change(before: HeatRecord, after: HeatRecord) -> float:
    return np.abs(after.film - before.film).max()


def _rise(record: HeatRecord, cold: float) -> float:
    return np.abs(record.film - cold).max()
