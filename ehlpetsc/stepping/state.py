"""State of the contact at one time level, and the guess of the next one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from ehlpetsc.base.compiled import compiled
from ehlpetsc.discretisation.contact.node_state import PRESSURE_AFTER_REFILL
from ehlpetsc.discretisation.ehl_problem import EHLProblem, Solution
from ehlpetsc.discretisation.unknowns import Unknowns


class TimeLevel(NamedTuple):
    """Unknowns of an earlier time level, the distance travelled by the film [m], and its time [s]."""

    travelled: float
    q: np.ndarray
    w: np.ndarray
    time: float = 0.0


@dataclass(frozen=True)
class State:
    """One time level with the history needed by the next step; arrays of shape (nodes,), dimensionless.

    Attributes
    ----------
    unknowns
        Without the plastic deformation of the last step, which is in the record of the effect.
    solution
        Solution of the step; None after a restart.
    m, m_older
        Masses per area of the film at this level and the previous one (None: no such level; before a steady
        start the same).
    time, dt
        [s]; `dt` is the step to this level (None at the start).
    step
        Number of the time step.
    travelled
        Distances travelled by surfaces 1 and 2 since time 0 [m], signed.
    earlier
        Up to two previous levels, latest first.
    error
        Relative error of the film in the step, see :mod:`.step_control`; None: not estimated.
    newton, retries
        Iterations of the step, failed attempts included; number of times that it was halved.
    records
        Records of the effects by their names, see :mod:`ehlpetsc.effects`.
    """

    unknowns: Unknowns
    solution: Solution | None = field(default=None, repr=False)
    m: np.ndarray | None = None
    m_older: np.ndarray | None = None
    time: float = 0.0
    dt: float | None = None
    step: int = 0
    travelled: tuple[float, float] = (0.0, 0.0)
    earlier: tuple[TimeLevel, ...] = ()
    error: float | None = None
    newton: int = 0
    retries: int = 0
    records: dict = field(default_factory=dict, repr=False)

    @property
    def q(self) -> np.ndarray:
        """First unknown of each node."""
        return self.unknowns.q

    @property
    def w(self) -> np.ndarray:
        """Second unknown of each node."""
        return self.unknowns.w

    @property
    def p(self) -> np.ndarray:
        """Pressure in p0."""
        return self.solution.nodes.pressure

    @property
    def h(self) -> np.ndarray:
        """Film in a^2/R."""
        return self.solution.nodes.film

    @property
    def reynolds_residual(self) -> np.ndarray:
        """F of the Reynolds equation at the solution."""
        return self.solution.residual

    @property
    def level(self) -> TimeLevel:
        """Time level for the predictor of later steps."""
        return TimeLevel(0.5 * sum(self.travelled), self.q, self.w, self.time)


MIN_FILM_DIVISOR = 1e-3  # of the expected film: on a coarse mesh the smooth solution may be in contact too
SMALL_PRESSURE = 0.01  # of the smooth solution: less oil pressure does not rise with it from node to node
LEVEL_AGE_NODES = 0.03  # distance from a whole number of nodes that counts as much as one step of age


ALL = slice(None)


def advected(rows: np.ndarray, nodes: float, columns: slice = ALL) -> np.ndarray:
    """Rows along x advected by `nodes` nodes, at some columns.

    Cubic interpolation, limited to the range of the two neighbouring values: next to the pressure spikes of
    asperities, two or three nodes wide, a cubic undershoots, and the resulting cavity costs Newton's method
    iterations.
    """
    begin, end, _ = columns.indices(rows.shape[1])
    return _advected(rows, nodes, begin, end)


@compiled
def _advected(rows: np.ndarray, nodes: float, begin: int, end: int) -> np.ndarray:
    shift, last, moved = int(np.floor(nodes)), rows.shape[1] - 1, np.empty((len(rows), end - begin))
    t = 1.0 - (nodes - shift)
    for row in range(len(rows)):
        values = rows[row]
        for i in range(begin, end):
            k = i - shift - 1
            a, b = values[min(max(k - 1, 0), last)], values[min(max(k, 0), last)]
            c, d = values[min(max(k + 1, 0), last)], values[min(max(k + 2, 0), last)]
            value = (
                -t * (t - 1.0) * (t - 2.0) / 6.0 * a
                + (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0 * b
                - (t + 1.0) * t * (t - 2.0) / 2.0 * c
                + (t + 1.0) * t * (t - 1.0) / 6.0 * d
            )
            moved[row, i - begin] = min(max(value, min(b, c)), max(b, c))
    return moved


def neighbours(v: np.ndarray, nodes: float, columns: slice = ALL) -> tuple[np.ndarray, np.ndarray]:
    """Values of the two nodes upstream of each point moved by `nodes` nodes, at some columns."""
    source = np.arange(*columns.indices(v.shape[-1])) - int(np.floor(nodes))
    return v.take(source, axis=-1, mode="clip"), v.take(source - 1, axis=-1, mode="clip")


def whole_nodes(v: np.ndarray, nodes: float, columns: slice = ALL) -> np.ndarray:
    """Values moved by the nearest whole number of nodes, at some columns."""
    return v.take(np.arange(*columns.indices(v.shape[-1])) - int(np.rint(nodes)), axis=-1, mode="clip")


def predict(
    problem: EHLProblem,
    baseline: TimeLevel,
    levels: Sequence[TimeLevel],
    nodes: Sequence[float],
    columns: slice = ALL,
) -> tuple[np.ndarray, np.ndarray]:
    """Guess of q and w: the difference from the baseline, which roughness causes, advected.

    The difference (of films the ratio, which keeps them positive) is advected with the entrainment speed from
    one of the last three time levels, the one whose distance to the new level is nearest to a whole number of
    nodes. Asperity pressures are two or three nodes wide, and interpolation between the nodes is the largest
    error of a predictor: on the measured surfaces the last level alone costs 6.0 Newton iterations a step,
    the best of three 4.6 (over a travel of 5 a). Extrapolation in time does not reduce this number.

    `baseline`: smooth steady solution. `levels`: earlier time levels, latest first. `nodes`: distance of
    each level to the new time, with the entrainment speed, in nodes. `columns`: of the guess.
    """
    best = min(range(len(levels)), key=lambda k: abs(nodes[k] - round(nodes[k])) + LEVEL_AGE_NODES * k)
    level, distance, model, grid = levels[best], nodes[best], problem.model, problem.grid
    rows, old = grid.rows, model.film(level.q, level.w)
    q0, q_before = (grid.at_columns(q, columns) for q in (baseline.q, level.q))
    h0 = np.maximum(model.film(baseline.q, baseline.w), MIN_FILM_DIVISOR * problem.film_scale)
    q = q0 + advected(rows(level.q - baseline.q), distance, columns).ravel()
    # no cavity in the guess where there was oil: a cavity fills a few nodes an iteration, but opens at once
    pair = neighbours(rows(level.q), distance, columns)
    smallest, largest = np.minimum(*pair).ravel(), np.maximum(*pair).ravel()
    # no oil pressure in the guess where there was next to none: through an open gap it would drive a flood
    q = np.where(largest < SMALL_PRESSURE * q0, np.minimum(q, np.maximum(largest, PRESSURE_AFTER_REFILL)), q)
    in_cavity = np.minimum(np.minimum(smallest, q_before), PRESSURE_AFTER_REFILL)  # of the baseline
    full = np.where(q0 > 0.0, 0.5 * np.minimum(q0, smallest), in_cavity)
    q = np.maximum(q, np.where(full > 0.0, full, -1.0 + 1e-3))
    ratio = advected(rows(old / h0), distance, columns).ravel()
    interpolated = model.w_from_film(grid.at_columns(h0, columns) * ratio)
    shifted = whole_nodes(rows(level.w), distance, columns).ravel()
    return model.reset_yielding(q, model.advected(interpolated, shifted))
