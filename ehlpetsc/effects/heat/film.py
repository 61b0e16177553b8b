r"""Heat in the film: its temperature in the Reynolds equation, and the dissipation of a solution.

In Newton's method the temperature is a nodal law, :mod:`.film_law`, whose derivatives are part of
those of the viscosity. Transport along the film: :mod:`.transport`.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from ehlpetsc.base.compiled import compiled, inlined
from ehlpetsc.discretisation.finite_volumes import (
    FLUIDITY,
    LN_ETA_P,
    LN_THERMAL_H,
    LN_THERMAL_P,
    THERMAL,
    H,
    M,
    P,
    face_mobilities,
    fill_mass,
    fluidities,
    positive_extrapolation,
)
from ehlpetsc.effects.heat.film_law import MIN_SLOPE, REFERENCE, A, B, FilmLaw, film_temperature, fixed_at
from ehlpetsc.effects.heat.film_shear import wall_exchange
from ehlpetsc.effects.heat.half_spaces import BodyStep
from ehlpetsc.physics.laws import ln_viscosities, ln_viscosity
from ehlpetsc.physics.tabulated_flow import MIN_RATE, stress_spread

TINY = 1e-6  # y whose sinh(y)/y is 1


class FilmHeat(NamedTuple):
    """Coefficients of the film's temperature that are fixed in a solve.

    `law`: constants of the oil.
    `of_nodes`: rows `A` to `REFERENCE`, as of :func:`.film_law.film_temperature`, shape (10, nx): one array,
        as numba looks up the types of many in a tuple anew in some calls, slowly.
    `guess`: state of the film to start from, rows `BASE` to `MEAN`, shape (3, nx).
    `walls`: temperatures without the flux of the step [K], shape (2, nx).
    `stored`: heat capacity of the oil carried over, over the step [W/(m^2 K)], shape (nx,).
    `bodies`: both bodies at the end of the step; None: steady.
    """

    law: FilmLaw
    of_nodes: np.ndarray
    guess: np.ndarray
    walls: np.ndarray
    stored: np.ndarray
    bodies: tuple[BodyStep, ...] | None = None

    def with_rows(self, rows: Iterable[int], values: Iterable[np.ndarray]) -> FilmHeat:
        """Coefficients with other values in some rows of `of_nodes`."""
        of_nodes = self.of_nodes.copy()
        for row, row_values in zip(rows, values, strict=True):
            of_nodes[row] = row_values
        return self._replace(of_nodes=of_nodes)

    def fill_properties(
        self,
        q: np.ndarray,
        h: np.ndarray,
        density: tuple,
        units: tuple[float, float, float],
        nodes: slice,
        temperatures: np.ndarray | None,
        at: np.ndarray,
    ) -> None:
        """Fill in the properties of `nodes`, see :func:`heated_nodal`.

        `temperatures` of the whole mesh to start from become those of the nodes; None: start from `guess`.
        """
        states = (self.guess if temperatures is None else temperatures)[:, nodes]
        rows = [np.ascontiguousarray(row) for row in states]
        of_nodes = np.ascontiguousarray(self.of_nodes[:, nodes])
        heated_nodal(q, h, density, *units, tuple(self.law), of_nodes, *rows, at)
        if temperatures is not None:
            states[:] = rows


@compiled
def heated_nodal(
    q: np.ndarray,
    h: np.ndarray,
    density: tuple,
    p0: float,
    film: float,
    unit: float,
    law: tuple,
    of_nodes: np.ndarray,
    base: np.ndarray,
    profile: np.ndarray,
    mean: np.ndarray,
    at: np.ndarray,
) -> None:
    """Fill in the properties of nodes for their faces, viscosity at the film's temperature with derivatives.

    q, h, density, p0, film, unit and `at` as of :func:`.reynolds.nodal`; the node beyond the outlet has the
    temperature of the last one. `base`, `profile` and `mean` are the state of the film to start from,
    and become that of the nodes. `law` is a tuple: numba looks up the type of a named one anew in some calls.
    """
    nodes, law = len(q), FilmLaw(*law)
    for i in range(nodes):
        p = fill_mass(i, q[i], h[i], density, p0, film, unit, at)
        of_node = of_nodes[A, i], of_nodes[B, i], *fixed_at(i, of_nodes, law)
        left = 1.0 + min(q[i], 0.0)
        t, t_p, t_h, _, _, _, line, base[i], profile[i], _ = film_temperature(
            base[i], profile[i], p, at[H, i], left, *of_node
        )
        zero = law.viscosity[2]
        if law.is_linear:  # in T: no second power of the pressure
            (ln_eta, beta, by_p), start = line, of_nodes[REFERENCE, i]
            viscosity = ln_eta - beta * (t - start), by_p, -beta
            at_zero = ln_eta - beta * (zero - start), by_p, -beta
        else:
            viscosity, at_zero = ln_viscosities(law.viscosity, p, t, zero)
        _fill_fluidity(i, viscosity, at_zero, t_p, t_h, law, p0, film, at)
        mean[i] = t
    if at.shape[1] > nodes:
        p = fill_mass(nodes, 0.0, h[nodes - 1], density, p0, film, unit, at)
        viscosities = ln_viscosities(law.viscosity, p, mean[nodes - 1], law.viscosity[2])
        _fill_fluidity(nodes, *viscosities, 0.0, 0.0, law, p0, film, at)


@inlined
def _fill_fluidity(
    i: int,
    viscosity: tuple[float, float, float],
    at_reference: tuple[float, float, float],
    t_p: float,
    t_h: float,
    law: FilmLaw,
    p0: float,
    film: float,
    at: np.ndarray,
) -> None:
    """Fill in the fluidity of node i at the reference temperature, and the factor on it by the film's."""
    (ln_eta, by_p, by_t), (ln_eta_0, by_p_0, _) = viscosity, at_reference
    at[FLUIDITY, i], at[LN_ETA_P, i] = np.exp(-ln_eta_0) / law.eta0, p0 * by_p_0
    at[THERMAL, i] = np.exp(0.5 * (ln_eta_0 - ln_eta))
    at[LN_THERMAL_P, i] = 0.5 * p0 * (by_p_0 - by_p - by_t * t_p)
    at[LN_THERMAL_H, i] = -0.5 * film * by_t * t_h


@compiled
def last_profile(
    profile: np.ndarray,
    pressure: np.ndarray,
    walls_apart: np.ndarray,
    law: tuple,
    between: np.ndarray,
    middle: np.ndarray,
) -> None:
    r"""Fill in 1/X of :mod:`.film_law`, and the temperature in the middle of the film [K], at the last level.

    There :math:`\ln\eta` is lower by 2 ln(cosh(y/2)). `middle` is the base temperature before, and remains so
    with a law that is linear in temperature. `walls_apart`: difference of the walls' temperatures [K].
    """
    law = FilmLaw(*law)
    for i in range(len(profile)):
        y, at = profile[i], middle[i]
        value, _, slope = ln_viscosity(law.viscosity, pressure[i], at)
        slope = min(slope, -MIN_SLOPE)
        between[i] = 1.0 / wall_exchange(max(y, TINY), min(-0.5 * slope * walls_apart[i], y))
        if not law.is_linear:
            bottom = value - 2.0 * np.log(np.cosh(0.5 * y))
            at += (bottom - value) / slope
            value, _, slope = ln_viscosity(law.viscosity, pressure[i], at)
            middle[i] = at + (bottom - value) / min(slope, -MIN_SLOPE)


@compiled
def faces(
    at: np.ndarray,
    law: tuple,
    table: np.ndarray,
    oil: np.ndarray,
    max_flow: tuple[float, float],
    couette: np.ndarray,
    pressure_heat: np.ndarray,
    spread: np.ndarray,
    gradient: np.ndarray,
) -> None:
    r"""Couette flow, heat of the pressure flow and stress gradients of a solution on the whole mesh.

    `law`, `table`: of :func:`.finite_volumes.balance`.
    `oil`: nodes where the Reynolds equation holds: flow through faces of others has no meaning, shape
        (nodes,).
    `max_flow`: maximum pressure flow of the heat: speed [m/s] times the film of a face, flow of any face
        [m^2/s].
    `couette`: filled in: mass flow of the mean speed through the faces i-1/2, in u a^2/R, shape (nodes + 1,).
    `pressure_heat`: filled in: :math:`M(dp/dx)^2` [W/m^2], half of each face's to either node, shape
        (nodes,).
    `spread`: filled in: :func:`.tabulated_flow.stress_spread` of the nodes, shape (nodes,).
    `gradient`: filled in: central :math:`dp/dx` [Pa/m], shape (nodes,).
    """
    nodes = at.shape[1] - 1
    per_length, _, no_pressure, stress_rise, sliding, entrainment, layer = law
    pressure_heat[:] = 0.0
    slope = 0.0
    for i in range(nodes):
        behind = max(i - 1, 0)
        drawn = positive_extrapolation(at[M, i], at[M, behind], 0.5 if i > 0 else 0.0)[0]
        before, slope = slope, per_length * (at[P, i + 1] - at[P, i])
        film = 0.5 * (at[H, i] + at[H, i + 1])
        stress = no_pressure
        if stress_rise != 0.0:
            stress += 0.5 * stress_rise * (at[P, i] + at[P, i + 1])
        left, right = face_mobilities(at, i, i + 1, table, (film, slope, stress, sliding, layer))
        couette[i + 1] = entrainment * drawn
        if i == nodes - 1:  # the node beyond the outlet is a mirror of it
            slope = 0.0
        between_oil_nodes = oil[i] and oil[min(i + 1, nodes - 1)]
        pressure_flow = 0.5 * (left[0] + right[0]) * abs(slope) if between_oil_nodes else 0.0
        pressure_flow = min(pressure_flow, max(max_flow[0] * film, max_flow[1]))
        heat = 0.5 * pressure_flow * abs(slope)
        pressure_heat[i] += heat
        if i < nodes - 1:
            pressure_heat[i + 1] += heat
        gradient[i] = 0.5 * (before + slope)
        spread[i] = 0.0
        if no_pressure < np.inf and at[H, i] > 0.0:
            stress = no_pressure
            if stress_rise != 0.0:
                stress += stress_rise * at[P, i]
            rate = max(sliding / (stress * at[H, i] * fluidities(at, i, i)[0]), MIN_RATE)
            spread[i] = stress_spread(0.5 * at[H, i] * abs(gradient[i]) / stress, np.log(rate), table)
    couette[0] = couette[1]
