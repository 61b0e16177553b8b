"""Smooth roller of a window: its steady solution, with which the window begins and beside which it is held.

Rows next to the window have its pressure and film, interpolated between its rows.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple, cast

import numpy as np

from ehlpetsc.discretisation.ehl_problem import EHLProblem
from ehlpetsc.discretisation.plane.beside import gap_and_load_beside
from ehlpetsc.discretisation.unknowns import Unknowns
from ehlpetsc.physics.contact.grid import Grid, Surroundings
from ehlpetsc.physics.contact.window import WindowGrid, smooth_mesh
from ehlpetsc.stepping.steady_start import guess_of

if TYPE_CHECKING:
    from ehlpetsc.base.case import Case
    from ehlpetsc.physics.scales import Scales
    from ehlpetsc.run.simulation import Simulation


class Solved(NamedTuple):
    """Scales of a window with its surroundings, and a guess of its steady solution by a problem."""

    scales: Scales
    guess: Callable[[EHLProblem], Unknowns]


def smooth_roller(case: Case) -> Case:
    """The steady smooth roller of a window."""
    smooth = case.surface.copy({"body_1": None, "body_2": None})
    whole = {"mesh": smooth_mesh(case.mesh), "surface": smooth, "time": None, "wear": None, "_kind": "roller"}
    return case.copy(whole)


def of_roller(case: Case, scales: Scales, solve: Callable[[Case], Simulation]) -> Solved:
    """Surroundings of a window of a roller; `solve`: simulation of a steady case, solved."""
    simulation, grid = solve(smooth_roller(case)), cast(WindowGrid, scales.grid)
    state, problem = simulation.dimensionless, simulation.stepper.problem
    film = problem.model.film(state.q, state.w)
    rows = next_to(grid, problem.grid, state.q), next_to(grid, problem.grid, film)
    below, above = (
        np.stack([field[side] for field in rows]) if to_end else None
        for side, to_end in zip((0, -1), grid.to_ends, strict=True)
    )
    gap, load = gap_and_load_beside(case.contact, scales, grid, state.p)
    around = replace(grid, surroundings=Surroundings(gap, load, (below, above)))
    return Solved(replace(scales, grid=around), lambda window: guess_of(state, problem, window))


def next_to(grid: WindowGrid, whole: Grid, field: np.ndarray) -> np.ndarray:
    """A flat field of the roller on the row below a window and on that above it, shape (2, nx)."""
    step, y = grid.increments[0], grid.y
    rows = replace(grid, axes=(np.array([y[0] - step, y[-1] + step]), grid.x))
    return rows.rows(whole.interpolated(field, rows))
