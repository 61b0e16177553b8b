"""Data of a solve without its initial guess: previous masses of the film, gap, conditions."""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ehlpetsc.discretisation.contact.model import ContactModel
from ehlpetsc.discretisation.finite_volumes import extrapolated
from ehlpetsc.physics.operation import Conditions

if TYPE_CHECKING:
    from ehlpetsc.discretisation.oil import Oil

Watch = Callable[[], object] | None  # called in every iteration; an exception that it raises ends the solve


class FilmHistory:
    r"""Masses per area of the film at the previous time levels, for BDF2.

    `m`, `m_older`: :math:`\rho h(1-\theta)` one and two steps ago, shape (nx,).
    `dt`, `dt_older`: current and previous time step, in units of a/u; `dt_older` None starts with backward
        Euler.

    `k`: factor of the extrapolation from the two levels of the current step.
    `extrapolated`: extrapolation from the two older levels, shape (nx,).
    """

    def __init__(self, m: np.ndarray, m_older: np.ndarray, dt: float, dt_older: float | None = None):
        self.m, self.m_older, self.dt, self.dt_older = m, m_older, dt, dt_older
        self.k = 0.0 if dt_older is None else dt / (dt + dt_older)
        self.extrapolated = m if dt_older is None else extrapolated(m, m_older, self.k * dt / dt_older)


@dataclass(frozen=True)
class StepInputs:
    """Data of a solve, without its initial guess.

    `phi`: contribution of the roughness to the gap, in a^2/R, shape (nx,).
    `history`: previous time levels; None: steady.
    `oil`: None: dry.
    `inlet_film`: oil film at the inlet in a^2/R; None: flooded.
    `conditions`: at the end of the step.
    `load_share`: applied fraction of the load of `conditions`.
    `dt`: length of the step [s]; None: steady.
    `contact`: contact model of the solve; None: that of the problem.
    `boundary_friction`: coefficient of friction between the solids.
    """

    phi: np.ndarray
    history: FilmHistory | None
    oil: Oil | None
    inlet_film: float | None
    conditions: Conditions
    load_share: float = 1.0
    dt: float | None = None
    contact: ContactModel | None = None
    boundary_friction: float | np.ndarray = 0.0

    @property
    def fluid(self) -> Any:
        """Table `[fluid]` of the case; None: dry."""
        return self.oil and self.oil.fluid

    def begin(self) -> StepInputs:
        """Inputs of one solve, see :meth:`.oil.Oil.begin`."""
        return replace(self, oil=self.oil and self.oil.begin())


def mirrored(value: Any) -> Any:
    """Arrays, last axis, and records of arrays with the nodes in reverse order; speeds change their sign.

    The discrete equations have their inlet at the first node: a step with a negative entrainment speed is
    solved mirrored. Tuples that are no records are not over nodes.
    """
    if isinstance(value, np.ndarray):
        return np.ascontiguousarray(value[..., ::-1])
    if isinstance(value, Conditions):
        return value._replace(u1=-value.u1, u2=-value.u2)
    if hasattr(value, "_make"):
        return value._make(map(mirrored, value))
    if isinstance(value, StepInputs | FilmHistory):
        turned = copy(value)
        vars(turned).update({name: mirrored(entry) for name, entry in vars(value).items()})
        return turned
    return value
