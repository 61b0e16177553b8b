"""Smooth roller around a window: its steady solution, from which the window begins and beside which it is held.

Its pressures, linear along x and constant across a row as the kernel has them, are the same function on the
rows of the window; those beside the window deflect it by the kernel of the window on the whole length. Without
roughness on the same rows the window is then the smooth roller to rounding.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple, cast

import numpy as np

from ehlpetsc.discretisation.ehl_problem import EHLProblem
from ehlpetsc.discretisation.plane.deflection import Convolution, Transposition
from ehlpetsc.discretisation.unknowns import Unknowns
from ehlpetsc.elasticity.bodies import Bodies
from ehlpetsc.elasticity.kernel import Mesh
from ehlpetsc.elasticity.kernels import kernel_of
from ehlpetsc.physics.contact.grid import Grid, Surroundings
from ehlpetsc.physics.contact.window import smooth_mesh
from ehlpetsc.stepping.steady_start import guess_of

if TYPE_CHECKING:
    from ehlpetsc.base.case import Case
    from ehlpetsc.physics.contact.window import WindowGrid
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
    simulation = solve(smooth_roller(case))
    state, problem = simulation.dimensionless, simulation.stepper.problem
    grid = cast("WindowGrid", scales.grid)
    film = problem.model.state(state.q, state.w).film
    rows = _beyond(problem.grid, grid, state.q), _beyond(problem.grid, grid, film)
    sides = [
        None if not count else np.stack([field[side] for field in rows])
        for count, side in zip(grid.to_ends, (0, -1), strict=True)
    ]
    gap, load = _far_pressure(case, scales, grid, state.p)
    around = Surroundings(gap, load, (sides[0], sides[1]))
    return Solved(
        replace(scales, grid=replace(grid, surroundings=around)),
        lambda window: guess_of(state, problem, window),
    )


def _beyond(whole: Grid, grid: WindowGrid, field: np.ndarray) -> np.ndarray:
    """A flat field of the roller on the rows of the window and on one more at either side."""
    step, y = grid.increments[0], grid.y
    wider = replace(grid, axes=(np.concatenate([[y[0] - step], y, [y[-1] + step]]), grid.x))
    return wider.rows(whole.interpolated(field, wider))


def _far_pressure(
    case: Case, scales: Scales, grid: WindowGrid, pressure: np.ndarray
) -> tuple[np.ndarray, float]:
    """Gap of the window by the pressures of the roller beside it in a^2/R, flat, and their load."""
    whole, finer = grid.whole, case.mesh.window.coarsening[1]
    first, behind = grid.to_ends[0] // finer, len(whole.y) - grid.to_ends[1] // finer
    beside = whole.rows(pressure).copy()
    beside[first:behind] = 0.0
    along = np.array([np.interp(grid.x, whole.x, row) for row in beside])
    fine = np.repeat(along, finer, axis=0)
    mesh = Mesh(fine.shape, grid.increments, False, scales.a)
    kernel = kernel_of(Bodies.of(case.contact), mesh)
    mirrored = None if kernel.mirrored is None else scales.stiffness * kernel.mirrored
    product = Convolution(scales.stiffness * kernel.direct, False, Transposition(), mirrored)
    gap = product(fine.ravel()).reshape(fine.shape)[first * finer : behind * finer]
    return gap.ravel(), float(whole.cell * beside.sum())
