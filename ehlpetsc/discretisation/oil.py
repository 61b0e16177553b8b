"""Oil of a solve: the properties of the nodes for their faces, in the rows of :mod:`.finite_volumes`.

By default they are laws of the pressure alone; an effect may put another oil in its place.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol

import numpy as np

from ehlpetsc.base.compiled import compiled
from ehlpetsc.discretisation.finite_volumes import FLUIDITY, LN_ETA_P, PROPERTIES, fill_mass
from ehlpetsc.physics.laws import density_law, ln_viscosity, viscosity_law
from ehlpetsc.physics.scales import Scales


class Oil(Protocol):
    """Interface of an oil.

    `fluid`: table `[fluid]` of the case.
    `scales`: of pressure, film and speed.
    `rows`: number of nodal properties.
    """

    @property
    def fluid(self) -> Any: ...
    @property
    def scales(self) -> Scales: ...
    @property
    def rows(self) -> int: ...

    def begin(self) -> Oil:
        """Oil of one solve, which may keep a state from one evaluation to start the next one from."""
        ...

    def fill(self, q: np.ndarray, h: np.ndarray, nodes: slice | np.ndarray, at: np.ndarray) -> None:
        """Fill in the properties of `nodes` of the mesh at their q and h.

        `at`: shape (rows, columns): one for each node, and one for each row of nodes along x that `nodes`
            holds up to the outlet: a node beyond the outlet, with the film of the last one and no pressure.
        """
        ...


@dataclass(frozen=True)
class IsothermalOil:
    """Oil whose viscosity and density are laws of the pressure; interface of :class:`Oil`."""

    fluid: Any
    scales: Scales
    rows = PROPERTIES

    @cached_property
    def viscosity(self) -> tuple:
        """Law of the viscosity, as compiled loops take it."""
        return tuple(viscosity_law(self.fluid))

    @cached_property
    def density(self) -> tuple:
        """Law of the density, as compiled loops take it."""
        return tuple(density_law(self.fluid))

    @cached_property
    def units(self) -> tuple[float, float, float]:
        """Scales of pressure p0 [Pa] and film [m]; 1/(u film) [s/m^2]."""
        s = self.scales
        return s.p0, s.h, 1.0 / (s.u * s.h)

    def begin(self) -> IsothermalOil:
        """The oil itself, which has no state."""
        return self

    def fill(self, q: np.ndarray, h: np.ndarray, nodes: slice | np.ndarray, at: np.ndarray) -> None:
        """As :meth:`Oil.fill`."""
        nodal(q, h, self.viscosity, self.density, (*self.units, 1.0 / self.fluid.viscosity), at)


@compiled
def nodal(
    q: np.ndarray, h: np.ndarray, viscosity: tuple, density: tuple, units: tuple, at: np.ndarray
) -> None:
    """Fill in the nodal properties, see :mod:`.finite_volumes`.

    Parameters
    ----------
    q, h : shape (nodes,)
    viscosity, density
        :class:`ehlpetsc.physics.laws.OilLaw` of both, as tuples, which numba looks up faster.
    units
        Scales of pressure p0 [Pa] and film [m]; 1/(u film) [s/m^2]; 1/eta0 [1/(Pa s)].
    at : shape (10, columns)
        As of :meth:`Oil.fill`.
    """
    nodes, (p0, film, unit, fluidity) = len(q), units
    for i in range(at.shape[1]):
        here, gap = (q[i], h[i]) if i < nodes else (0.0, h[last_before(i, nodes, at)])
        p = fill_mass(i, here, gap, density, p0, film, unit, at)
        ln_eta, ln_eta_p, _ = ln_viscosity(viscosity, p, viscosity[2])
        at[FLUIDITY, i], at[LN_ETA_P, i] = np.exp(-ln_eta) * fluidity, p0 * ln_eta_p


@compiled
def last_before(beyond: int, nodes: int, at: np.ndarray) -> int:
    """Last node of the row along x that ends at the node `beyond` the outlet; all rows have one length."""
    return (beyond - nodes + 1) * (nodes // (at.shape[1] - nodes)) - 1
