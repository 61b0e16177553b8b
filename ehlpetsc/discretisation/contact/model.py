"""Interface of the contact models: everything in which one law of contact differs from another.

A model maps the unknowns (q, w) of a node to pressures, film and separation. Solver, time stepping and
outputs call the methods below and depend on no single model; a new law of contact is one module with one
subclass, and a line in :func:`ehlpetsc.discretisation.contact.contact_model`.

Lengths in x are in half-widths, films in a^2/R, pressures in p0.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ehlpetsc.discretisation.contact.node_state import NodeState, SurfaceLoads


class ContactModel:
    """Elastic solids that carry load with the oil; the defaults hold for every model with p_c of its own.

    `minimum_film`: smallest film that the model aims at, in a^2/R.
    `touching_film`: film below which solids carry beside oil, in a^2/R; 0: only where the film closes.
    `lower_bound`: bound of w that the nonlinear solver enforces (SNESVI); None: no bound.
    `starts_unconstrained`: whether a bounded system is solved without its bound first, where the guess is
        clear of it.
    `bound_tolerance`: tolerance of the active set: films this close to the bound count as on it, as SNES has
        it.
    `yield_pressure`, `compliance`: in p0, inf for elastic solids; depth over the excess in a^2/R per p0.
    """

    minimum_film = 0.0
    touching_film = 0.0
    lower_bound: float | None = None
    starts_unconstrained = False
    bound_tolerance = 0.0
    yield_pressure = np.inf
    compliance = 0.0

    # --- unknowns -----------------------------------------------------------------------------------------

    def state(self, q: np.ndarray, w: np.ndarray) -> NodeState:
        """:class:`.node_state.NodeState` at the unknowns q, w, shape (nodes,)."""
        raise NotImplementedError

    def film(self, q: np.ndarray, w: np.ndarray) -> np.ndarray:
        """Film in a^2/R at the unknowns, that of :meth:`state`."""
        return self.state(q, w).film

    def pressure(self, q: np.ndarray, w: np.ndarray) -> np.ndarray:
        """Total pressure in p0, at most the yield pressure."""
        return np.minimum(np.maximum(q, 0.0) + self.contact_pressure(w), self.yield_pressure)

    def contact_pressure(self, w: np.ndarray) -> np.ndarray:
        """Pressure of the solids in p0."""
        raise NotImplementedError

    def contact_mask(self, w: np.ndarray, reynolds_residual: np.ndarray) -> np.ndarray:
        """Nodes in contact, of a solution."""
        raise NotImplementedError

    def w_from_film(self, h: np.ndarray) -> np.ndarray:
        """Second unknown of an open gap of the film h."""
        raise NotImplementedError

    def w_from_state(self, h: np.ndarray, contact_pressure: np.ndarray) -> np.ndarray:
        """Second unknown of a film and of the pressure of the solids in p0."""
        raise NotImplementedError

    # --- first guesses ------------------------------------------------------------------------------------

    def dry_start(self, pressure: np.ndarray, gap: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Unknowns q, w of a dry contact with a pressure where solids touch and a gap elsewhere."""
        return np.zeros_like(pressure), self.w_from_state(gap, pressure)

    def start_film(self, film: float) -> float:
        """Film of a first guess under oil, from the expected one."""
        return film

    def oil_start(self, pressure: np.ndarray, h: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Oil pressure and second unknown of a first guess with a total pressure and a film."""
        return pressure, self.w_from_film(h)

    def advected(self, interpolated: np.ndarray, shifted: np.ndarray) -> np.ndarray:
        """Second unknown of a new time level.

        `interpolated`: of the film of the last level, moved along by interpolation, shape (nodes,).
        `shifted`: w of the last level, moved by the nearest whole number of nodes, shape (nodes,).
        """
        raise NotImplementedError

    # --- nonlinear solver ---------------------------------------------------------------------------------

    def linearised(self, state: NodeState, owned: slice, ranks_sum: Callable) -> NodeState:
        """State with the derivatives that the Newton step takes.

        `owned`: nodes of this rank.
        `ranks_sum`: sum of a tuple of numbers over all ranks.
        """
        return state

    def pressure_change(self, now: np.ndarray, step: np.ndarray) -> float:
        """Largest change of pressure of a Newton step, in p0; pairs (q, w), shape (nodes, 2)."""
        raise NotImplementedError

    def clip_step(self, now: np.ndarray, step: np.ndarray, film_after_release: float) -> None:
        """Limit single entries of a Newton step in place; the new values are ``now - step``.

        Parameters
        ----------
        now, step : shape (nodes, 2)
        film_after_release
            Largest film that a node gets in the iteration in which its solids separate, in a^2/R.
        """
        raise NotImplementedError

    def follow_pressure(self, now: np.ndarray, step: np.ndarray) -> None:
        """Change entries of a Newton step near a solution in place, where a law of the solids is not linear.

        `now`, `step`: as of :meth:`clip_step`, which limits the changed step.
        """

    def check(
        self, w: np.ndarray, reynolds_residual: np.ndarray, tolerance: float
    ) -> tuple[str | None, np.ndarray]:
        """Violation of the contact conditions by a solution.

        Returns the violation, None without one, and the Reynolds rows that must vanish.
        """
        return None, reynolds_residual

    # --- yielding -----------------------------------------------------------------------------------------

    def elastic(self) -> ContactModel | None:
        """The same model for solids that do not yield; None where they never do."""
        return None

    def reset_yielding(self, q: np.ndarray, w: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Unknowns of the same pressures and film without plastic deformation, for the next step."""
        return q, w

    # --- outputs ------------------------------------------------------------------------------------------

    def surface_loads(
        self, q: np.ndarray, w: np.ndarray, h: np.ndarray, reynolds_residual: np.ndarray
    ) -> SurfaceLoads:
        """:class:`.node_state.SurfaceLoads` of a solution; h its film."""
        raise NotImplementedError

    def real_area_fraction(self, loads: SurfaceLoads) -> np.ndarray:
        """Share of each cell on which solids touch."""
        return loads.contact_mask
