r"""Heat in the film: its temperature in the Reynolds equation, and the dissipation of a solution.

In Newton's method the temperature is a nodal law, :mod:`.film_law`, whose derivatives are part of
those of the viscosity. Transport along the film: :mod:`.transport`.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from ehlpetsc.base.case import Fluid
from ehlpetsc.base.compiled import compiled, inlined, unsigned
from ehlpetsc.discretisation.finite_volumes import (
    FLUIDITY,
    LN_ETA_P,
    LN_THINNING_H,
    LN_THINNING_P,
    RHO,
    THINNED_PROPERTIES,
    THINNING,
    H,
    P,
    drawn,
    face,
    face_film,
    face_mean,
    fill_mass,
    fluidities,
    law_of_row,
)
from ehlpetsc.discretisation.plane.cross_flow import flux_across
from ehlpetsc.discretisation.step_inputs import IsothermalOil, last_before
from ehlpetsc.effects.heat.film_law import (
    SLIDING,
    T_BASE,
    T_MEAN,
    T_SHAPE,
    A,
    B,
    G,
    film_temperature,
    fixed_at,
)
from ehlpetsc.effects.heat.film_oil import MIN_VISCOSITY_SLOPE, FilmLaw
from ehlpetsc.effects.heat.film_shear import wall_exchange
from ehlpetsc.effects.heat.half_spaces import BodyStep
from ehlpetsc.effects.heat.record import in_rows
from ehlpetsc.physics.oil.laws import ln_viscosities, ln_viscosity
from ehlpetsc.physics.oil.rheology import FlowLaw
from ehlpetsc.physics.oil.tabulated_flow import MIN_RATE, stress_spread
from ehlpetsc.physics.scales import Scales

LINEAR_Y = 1e-6  # y whose sinh(y)/y is 1


class FilmHeat(NamedTuple):
    """Oil whose viscosity depends on the film's temperature; interface of :class:`.step_inputs.Oil`.

    `isothermal`: oil without heat; None: dry.
    `law`: constants of the oil.
    `of_nodes`: rows `A` to `SLIDING`, of :mod:`.film_law`, shape (12, n): one array,
        as numba looks up the types of many in a tuple anew in some calls, slowly.
    `guess`: state of the film to start from, rows `BASE` to `MEAN`, shape (3, n).
    `walls`: temperatures without the flux of the step [K], shape (2, n).
    `stored`: heat capacity of the oil carried over, over the step [W/(m^2 K)], shape (n,).
    `bodies`: both bodies at the end of the step; None: steady.
    """

    isothermal: IsothermalOil | None
    law: FilmLaw
    of_nodes: np.ndarray
    guess: np.ndarray
    walls: np.ndarray
    stored: np.ndarray
    bodies: tuple[BodyStep, ...] | None = None

    @property
    def rows(self) -> int:
        """Number of nodal properties."""
        return THINNED_PROPERTIES

    @property
    def fluid(self) -> Fluid:
        """Table `[fluid]` of the case."""
        return self.isothermal.fluid

    @property
    def scales(self) -> Scales:
        """Scales of the contact."""
        return self.isothermal.scales

    def begin(self) -> FilmHeat:
        """Oil of one solve, which starts an evaluation from the state of the film in the last one."""
        return SolvedFilm(*self._replace(guess=self.guess.copy()))

    def fill(self, q: np.ndarray, h: np.ndarray, nodes: slice | np.ndarray, at: np.ndarray) -> None:
        """Fill the arrays as :meth:`.step_inputs.Oil.fill` does, from `guess`."""
        self.begin().fill(q, h, nodes, at)

    def with_rows(self, rows: Iterable[int], values: Iterable[np.ndarray]) -> FilmHeat:
        """Coefficients with other values in some rows of `of_nodes`."""
        of_nodes = self.of_nodes.copy()
        for row, row_values in zip(rows, values, strict=True):
            of_nodes[row] = row_values
        return self._replace(of_nodes=of_nodes)


class SolvedFilm(FilmHeat):
    """Oil of one solve: its `guess` becomes the state of the film at the nodes last filled in."""

    def fill(self, q: np.ndarray, h: np.ndarray, nodes: slice | np.ndarray, at: np.ndarray) -> None:
        """Fill the arrays as :meth:`.step_inputs.Oil.fill` does; changes `guess`."""
        state, of_nodes = (np.ascontiguousarray(rows[:, nodes]) for rows in (self.guess, self.of_nodes))
        oil = self.isothermal
        heated_nodal(q, h, oil.density, oil.units, tuple(self.law), of_nodes, state, at)
        self.guess[:, nodes] = state


@compiled
def heated_nodal(
    q: np.ndarray,
    h: np.ndarray,
    density: tuple,
    units: tuple[float, float, float],
    law: tuple,
    of_nodes: np.ndarray,
    state: np.ndarray,
    at: np.ndarray,
) -> None:
    """Fill in the properties of nodes for their faces, viscosity at the film's temperature with derivatives.

    q, h, density, units and `at` as of :func:`.step_inputs.nodal`; a node beyond the outlet has the
    temperature of the last one. `state` of the film to start from becomes that of the nodes. `law` is a
    tuple: numba looks up the type of a named one anew in some calls.
    """
    nodes, law, (p0, film, unit) = len(q), FilmLaw(*law), units
    zero = law.viscosity[2]
    for i in range(nodes):
        p = fill_mass(i, q[i], h[i], density, p0, film, unit, at)
        start = state[T_BASE, i], state[T_SHAPE, i]
        node = p, at[H, i], 1.0 + min(q[i], 0.0), of_nodes[SLIDING, i]
        balance, (last, walls) = (of_nodes[A, i], of_nodes[B, i], of_nodes[G, i]), fixed_at(i, of_nodes)
        found, oil = film_temperature(start, node, balance, last, walls, law)
        t = found.mean
        if law.is_linear:  # in T: no second power of the pressure
            viscosity = oil.ln_eta - oil.beta * (t - oil.reference), oil.eta_p, -oil.beta
            at_zero = oil.ln_eta - oil.beta * (zero - oil.reference), oil.eta_p, -oil.beta
        else:
            viscosity, at_zero = ln_viscosities(law.viscosity, p, t, zero)
        _fill_fluidity(i, viscosity, at_zero, found.by_p, found.by_h, law, p0, film, at)
        state[T_BASE, i], state[T_SHAPE, i], state[T_MEAN, i] = found.base, found.profile, t
    for i in range(nodes, at.shape[1]):
        end = last_before(i, nodes, at)
        p = fill_mass(i, 0.0, h[end], density, p0, film, unit, at)
        viscosities = ln_viscosities(law.viscosity, p, state[T_MEAN, end], zero)
        _fill_fluidity(i, *viscosities, 0.0, 0.0, law, p0, film, at)


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
    at[THINNING, i] = np.exp(0.5 * (ln_eta_0 - ln_eta))
    at[LN_THINNING_P, i] = 0.5 * p0 * (by_p_0 - by_p - by_t * t_p)
    at[LN_THINNING_H, i] = -0.5 * film * by_t * t_h


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
        slope = min(slope, -MIN_VISCOSITY_SLOPE)
        between[i] = 1.0 / wall_exchange(max(y, LINEAR_Y), min(-0.5 * slope * walls_apart[i], y))
        if not law.is_linear:
            bottom = value - 2.0 * np.log(np.cosh(0.5 * y))
            at += (bottom - value) / slope
            value, _, slope = ln_viscosity(law.viscosity, pressure[i], at)
            middle[i] = at + (bottom - value) / min(slope, -MIN_VISCOSITY_SLOPE)


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
    _, _, no_pressure, stress_rise, sliding, entrainment, _, leaks = law
    pressure_heat[:] = 0.0
    slope = 0.0
    for i in range(nodes):
        before = slope
        here = unsigned(i)  # or numba would compile the fluxes of the Reynolds equation again
        films, slope, stress, (left, right) = face(at, here, unsigned(i + 1), table, law)
        couette[i + 1] = entrainment * drawn(at, unsigned(max(i - 1, 0)), here)[0]
        if i == nodes - 1:  # the node beyond the outlet is a mirror of it
            slope = 0.0
        between_oil_nodes = oil[i] and oil[min(i + 1, nodes - 1)]
        mobility, _, _ = face_mean(left[0], right[0], leaks)
        pressure_flow = mobility * abs(slope) if between_oil_nodes else 0.0
        pressure_flow = min(pressure_flow, max(max_flow[0] * films[0], max_flow[1]))
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
            rate = max(sliding / (stress * at[H, i] * fluidities(at, here, here)[0]), MIN_RATE)
            spread[i] = stress_spread(0.5 * at[H, i] * abs(gradient[i]) / stress, np.log(rate), table)
    couette[0] = couette[1]


def faces_in_rows(
    speeds: np.ndarray,
    at: np.ndarray,
    law: tuple,
    table: np.ndarray,
    oil: np.ndarray,
    max_flow: tuple[float, float],
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Results of :func:`faces` of each row of nodes, flat: Couette flow, heat, spread, gradient.

    `speeds`: of each row, in place of those of `law`, as of :func:`.finite_volumes.balance`.
    `at`: nodes of all rows, then the nodes beyond their outlets, as of :meth:`.step_inputs.Oil.fill`.
    """
    n, rows = len(oil), len(speeds)
    nodes, beyond = in_rows(at[:, :n], rows), in_rows(at[:, n:], rows)
    couette, of_nodes = np.zeros((rows, n // rows + 1)), np.empty((3, rows, n // rows))
    for k, row_oil in enumerate(np.split(oil, rows)):
        row_at = np.concatenate([nodes[k], beyond[k]], axis=1)
        row_law = *law[:4], *map(float, speeds[k]), *law[6:]
        faces(row_at, row_law, table, row_oil, max_flow, couette[k], *of_nodes[:, k])
    return couette.ravel(), *of_nodes.reshape(3, n)


@compiled
def cross_flow_heat(
    at: np.ndarray,
    shape: tuple[int, int],
    is_periodic: bool,
    laws: tuple[tuple, np.ndarray, FlowLaw, np.ndarray],
    oil: np.ndarray,
    max_flow: tuple[float, float],
) -> np.ndarray:
    r"""Heat of the flow between rows, :math:`M_y(dp/dy)^2` [W/m^2], half of each face's to either node.

    `at`, `oil`, `max_flow`: as of :func:`faces_in_rows`. `shape`: rows, nodes along x.
    `is_periodic`: whether the last row is next to the first one.
    `laws`: law, speeds, flow and table of :func:`.plane.cross_flow.add_across`.
    """
    (rows, n), (law, speeds, flow, table) = shape, laws
    heat = np.zeros(rows * n)
    for left in range((rows if is_periodic else rows - 1) * n):
        right = (left + n) % (rows * n)
        if not (oil[left] and oil[right]):
            continue
        here_law = law_of_row(law, speeds, unsigned(left // n + 1))
        mass = flux_across(at, unsigned(left), unsigned(right), table, here_law, flow)[0]
        pressure_flow = 2.0 * abs(mass) / (at[RHO, left] + at[RHO, right])
        film, _, _ = face_film(at[H, left], at[H, right], law[-1])
        pressure_flow = min(pressure_flow, max(max_flow[0] * film, max_flow[1]))
        half = 0.5 * pressure_flow * law[0] * abs(at[P, right] - at[P, left])
        heat[left] += half
        heat[right] += half
    return heat
