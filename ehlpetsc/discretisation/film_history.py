r"""Film of the previous time levels in the balance of a time step, for steps of any length.

A step in which the film moves by at most one node follows the oil along its path, see :mod:`.transport`: the
surfaces' mean speed then has no flux of its own. Where the film is steady, its balance along the path has
the differences of a mesh as coarse as the distance moved. At one node these are the differences of the
steady equations; in steps of C nodes the film would tend to the steady film of a mesh C times coarser.

Longer steps of smooth surfaces therefore leave the history at its nodes, and the mean speed drives a Couette
flux at the new level, as in the steady equations. A steady film satisfies these in steps of any length, and
conditions that vary are second order in time.

This flux damps waves that pass with the film in few steps. Roughness causes such waves, and under constant
conditions the smooth steady film is known: its deviation from that follows the path, while the smooth film
has the steady differences. The difference of both balances of the smooth film is a sum of fluxes through the
faces, so that no mass is lost. A flux is reduced where the film is thinner than the smooth one, in their
ratio: next to solids it would otherwise take more than is there. Where it would do so even then, it leaves a
tenth. Roughness under conditions that vary follows the path as a whole, and a warning states its error.

Rows of different speeds (:mod:`ehlpetsc.physics.speeds_across`) have the history at the nodes in steps of any
length, and each its own flux.

`tests/verification/test_time_steps.py` holds the steady state, the mass and the waves.
"""

from __future__ import annotations

import itertools
from typing import NamedTuple

import numpy as np

from ehlpetsc.discretisation.finite_volumes import extrapolated
from ehlpetsc.discretisation.transport import carried

ONE_NODE = 1.02  # nodes of a step of one node where speeds change in it
ROUNDING = 1e-9  # of the mass, by which that of the smooth film itself may differ from its own
LEFT = 0.1  # of the mass of a cell from which more would flow than is there
SWEEPS = 20  # over the cells, before what enters them is left out


class FilmHistory:
    r"""Masses per area of the film at the previous time levels, in the form of the balance, for BDF2.

    `m`, `m_older`: :math:`\rho h(1-\theta)` one and two steps ago, at the nodes or where the film that is
        now at each node was then, shape (nodes,).
    `dt`, `dt_older`: current and previous time step, in units of a/u; `dt_older` None starts with backward
        Euler.
    `moved`: distance of the film in the step, in nodes. `before`: mass one step ago at the nodes themselves.

    `k`: factor of the extrapolation from the two levels of the current step.
    `extrapolated`: extrapolation from the two older levels, shape (nodes,).
    `follows_path`: whether the masses are carried with the film; otherwise the mean speed drives a flux.
    """

    def __init__(
        self,
        m: np.ndarray,
        m_older: np.ndarray,
        dt: float,
        dt_older: float | None = None,
        moved: float = 0.0,
        before: np.ndarray | None = None,
        follows_path: bool = True,
    ):
        self.m, self.m_older, self.dt, self.dt_older = m, m_older, dt, dt_older
        self.moved, self.before, self.follows_path = moved, m if before is None else before, follows_path
        self.k = 0.0 if dt_older is None else dt / (dt + dt_older)
        self.extrapolated = m if dt_older is None else extrapolated(m, m_older, self.k * dt / dt_older)

    @property
    def nodes_carried(self) -> float:
        """Distance in nodes by which fields of the previous level are carried to this one."""
        return self.moved if self.follows_path else 0.0


class FilmLevels(NamedTuple):
    """Films of the previous two time levels, at their nodes.

    Attributes
    ----------
    m, m_older : shape (rows, nx)
        Masses per area; `m_older` None: there is one level.
    dt, dt_older
        Current and previous time step, in units of a/u.
    moved, moved_older
        Distances of the film in both steps, in nodes, signed.
    """

    m: np.ndarray
    m_older: np.ndarray | None
    dt: float
    dt_older: float
    moved: float
    moved_older: float

    @property
    def is_long(self) -> bool:
        """Whether the film moves by more than a node in either step."""
        return max(abs(self.moved), abs(self.moved_older)) > ONE_NODE


def film_history(
    levels: FilmLevels,
    is_rough: bool = False,
    smooth: np.ndarray | None = None,
    has_one_speed: bool = True,
) -> FilmHistory:
    """History of the film for one step.

    `is_rough`: whether roughness moves with the surfaces.
    `smooth`: mass per area of the smooth steady film under constant conditions, shape (rows, nx); None:
        conditions vary.
    `has_one_speed`: whether all rows move at one speed; otherwise each row has its own Couette flux.
    """
    if not has_one_speed or (levels.is_long and not is_rough):
        return levels_at_nodes(levels)
    return levels_along_path(levels, smooth if levels.is_long else None)


def levels_at_nodes(levels: FilmLevels) -> FilmHistory:
    """History at the nodes, beside a Couette flux at the new level."""
    m, of_step = levels.m.ravel(), (levels.moved, None, False)
    if levels.m_older is None:
        return FilmHistory(m, None, levels.dt, None, *of_step)
    return FilmHistory(m, levels.m_older.ravel(), levels.dt, levels.dt_older, *of_step)


def levels_along_path(levels: FilmLevels, smooth: np.ndarray | None = None) -> FilmHistory:
    """History carried along the path of the film; `smooth`: for the deviation from this steady film alone."""
    before, moved = levels.m.ravel(), levels.moved
    m = carried(levels.m, moved).ravel()
    if levels.m_older is None:
        history = FilmHistory(m, None, levels.dt, None, moved, before)
    else:
        older = carried(levels.m_older, moved + levels.moved_older).ravel()
        history = FilmHistory(m, older, levels.dt, levels.dt_older, moved, before)
    if smooth is not None:
        history.extrapolated = history.extrapolated - _of_smooth_film(smooth, levels, history)
    return history


def _of_smooth_film(smooth: np.ndarray, levels: FilmLevels, history: FilmHistory) -> np.ndarray:
    """Steady balance of the smooth film less its balance along the path, both over a step."""
    rows, turned = smooth.shape, slice(None, None, -1 if levels.moved < 0.0 else 1)
    distance, of_both = abs(levels.moved), abs(levels.moved + levels.moved_older)
    m, extrapolated_film = smooth[:, turned], history.extrapolated.reshape(rows)[:, turned]
    m_1, m_2 = carried(m, distance), carried(m, of_both)
    k = history.k
    ratio = 0.0 if history.dt_older is None else k * history.dt / history.dt_older
    from_history = extrapolated(m_1.ravel(), m_2.ravel(), ratio)
    along_path = extrapolated(m.ravel(), m_1.ravel(), k) - from_history
    behind = np.concatenate((m[:, :1], m[:, :-1]), axis=1)
    outflow = distance * extrapolated(m.ravel(), behind.ravel(), 0.5).reshape(rows)
    fluxes = outflow - outflow[:, :1] - np.cumsum(along_path.reshape(rows), axis=1)
    of_smooth = from_history.reshape(rows)
    left = of_smooth - np.diff(fluxes, axis=1, prepend=0.0) - ROUNDING * of_smooth
    least = np.minimum(left, LEFT * extrapolated_film)
    share = np.minimum(extrapolated_film / from_history.reshape(rows), 1.0)
    fluxes *= np.minimum(share, np.concatenate((share[:, 1:], share[:, -1:]), axis=1))
    fluxes = _limited(fluxes, extrapolated_film, least)
    return np.diff(fluxes, axis=1, prepend=0.0)[:, turned].ravel()


def _limited(fluxes: np.ndarray, m: np.ndarray, least: np.ndarray) -> np.ndarray:
    """Fluxes that leave in each cell at least `least` of its mass `m`.

    `fluxes`: through the faces behind the cells in the direction of the motion, shape (rows, nx). Those out
    of a cell are reduced together, so that what enters a cell can only fall: neighbours are checked again,
    and after some sweeps as if nothing entered, which ends.
    """
    part, out = np.ones_like(m), np.maximum(fluxes, 0.0)
    out[:, 1:] += np.maximum(-fluxes[:, :-1], 0.0)
    for sweep in itertools.count():
        of_next = np.concatenate((part[:, 1:], part[:, -1:]), axis=1)
        reduced = fluxes * np.where(fluxes > 0.0, part, of_next)
        into = np.maximum(-reduced, 0.0)
        into[:, 1:] += np.maximum(reduced[:, :-1], 0.0)
        short = m + into - part * out < least - ROUNDING * m
        if not short.any():
            return reduced
        entering = into[short] if sweep < SWEEPS else 0.0
        part[short] = np.maximum(m[short] + entering - least[short], 0.0) / out[short]
