r"""Heat that the oil stores and carries along, and the temperatures of a solution with it.

The transport with the surfaces' mean speed u is implicit and of second order in space and time,

.. math:: \frac{m_o(T-T^{old})+e-e^{old}}{\Delta t}\Delta x+(um)_{i+1/2}(T_{i+1/2}-T_i)
   -(um)_{i-1/2}(T_{i-1/2}-T_i)=\frac{\Delta x}{\rho c}[\ldots],

:math:`m_o` the mass per area that the mass balance carries over. A face has the temperature of the node
upstream, extrapolated by half an interval, and e is the heat of the oil extrapolated by half a step:

.. math:: T_{i+1/2}=T_i+\varphi_i(T_i-T_{i-1}),\qquad e=m_o\psi(T-T^{old}),

:math:`\varphi` and :math:`\psi` half of van Leer's limiter (1974) of successive differences in space and in
time; with 1/2 for both it would be second-order upwind differences and BDF2, which overshoot behind
asperities. They are computed at the temperatures of the last evaluation in the solve, so that the temperature
of a node remains a monotone law. What leaves a cell enters the next one, and e is kept: the balance of heat
closes whatever they are. Where an extrapolated temperature would be below the coldest of bodies and oil, the
node has neither: upwind differences and backward Euler.

With the mass balance it is a balance of heat in which oil that the pressure turns back in the inlet leaves
with the temperature at which it turns.
"""

from typing import NamedTuple

import numpy as np

from ehlpetsc.base.compiled import compiled, inlined
from ehlpetsc.effects.heat.film_law import SLIDING, T_BASE, T_MEAN, T_SHAPE, G, film_temperature, fixed_at
from ehlpetsc.effects.heat.film_oil import FilmLaw
from ehlpetsc.effects.heat.record import in_rows, joined

SWEEPS = 50
P, THICKNESS, ON_LEFT, OLD, STORED, CHANGE, EXTRAPOLATED = range(7)  # rows: fields of a Film
IN_SPACE, IN_TIME = 0, 1  # rows of the limiters
SWEEP_TOLERANCE = 1e-11  # relative change of the temperatures that ends the sweeps


class Film(NamedTuple):
    """Film of a solution; arrays over the nodes.

    `pressure`, `thickness`: of the oil [Pa]; [m], 0 where the solids are in direct contact.
    `left`: fraction of the gap that is full of oil.
    `old`: temperature at the begin of the step [K].
    `stored`: heat capacity of the oil carried over, over the step [W/(m^2 K)]; 0: steady.
    `change`: by which the temperature would change in the step as fast as in the one before [K].
    `extrapolated`: e at the begin of the step, over the step [W/m^2].
    `couette`: heat capacity that the mean speed moves through the faces of each row, per cell [W/(m^2 K)],
        shape (rows (nx + 1),).
    `rubbing`: heat of the solids [W/m^2], which arises in the walls.
    """

    pressure: np.ndarray
    thickness: np.ndarray
    left: np.ndarray
    old: np.ndarray
    stored: np.ndarray
    change: np.ndarray
    extrapolated: np.ndarray
    couette: np.ndarray
    rubbing: np.ndarray


def explicit_transport(
    rows: int, stored: np.ndarray, flow: np.ndarray, t: np.ndarray, inlet: float
) -> tuple[np.ndarray, np.ndarray]:
    """Storage and upwind transport by temperatures t of the old level, of :func:`.film.film_temperature`.

    `rows`: of nodes along x.
    `stored`, `flow`: as `stored` and `couette` of :class:`Film`.
    `t`: [K], shape (nodes,).
    `inlet`: temperature of the oil that enters [K].
    """
    flow = flow.reshape(rows, -1)
    known = np.pad(t.reshape(rows, -1), ((0, 0), (1, 1)), constant_values=inlet)
    from_left, from_right = np.maximum(flow[:, :-1], 0.0).ravel(), np.maximum(-flow[:, 1:], 0.0).ravel()
    carried = stored * t + from_left * known[:, :-2].ravel() + from_right * known[:, 2:].ravel()
    return stored + from_left + from_right, carried


@compiled
def _limited(difference: float, next_one: float) -> float:
    """Half of van Leer's limiter: the fraction of a difference by which half an interval extrapolates."""
    return next_one / (difference + next_one) if difference * next_one > 0.0 else 0.0


def limited(difference: np.ndarray, following: np.ndarray) -> np.ndarray:
    """Differences by half an interval, limited: :func:`_limited` times the difference."""
    both = difference * following
    return np.divide(both, difference + following, out=np.zeros_like(both), where=both > 0.0)


@compiled
def _limiters(t: np.ndarray, film: np.ndarray, flow: np.ndarray, limiters: np.ndarray) -> None:
    """Fill in both limiters of every node at temperatures t; oil enters and leaves as at the end nodes."""
    last = len(t) - 1
    for i in range(last + 1):
        # t knows the neighbours of the old level and changes less than the solution: BDF2 at most
        limiters[IN_TIME, i] = min(_limited(t[i] - film[OLD, i], film[CHANGE, i]), 0.5)
        limiters[IN_SPACE, i] = 0.0
        if 0 < i < last:
            left, right = t[i] - t[i - 1], t[i + 1] - t[i]
            limiters[IN_SPACE, i] = _limited(left, right) if flow[i + 1] >= 0.0 else _limited(right, left)


@compiled
def transport(
    state: np.ndarray,
    film: np.ndarray,
    flow: np.ndarray,
    ambient: tuple[float, float],
    law: tuple,
    of_nodes: np.ndarray,
    out: np.ndarray,
) -> int:
    """Temperatures of the film and heat fluxes of a solution, by sweeps along the film; returns their number.

    `state`: of the film to start from, rows `BASE` to `MEAN`, at which the limiters are taken; becomes that
        of the solution, shape (3, nodes).
    `film`, `flow`: fields `pressure` to `extrapolated` of :class:`Film`, shape (7, nodes); its `couette`.
    `ambient`: temperature of the oil that enters, minimum of it and both bodies [K].
    `law`, `of_nodes`: as of :class:`.film.FilmHeat`, `law` as a tuple; rows `A` and `B` are not used.
    `out`: filled in: both heat fluxes, heat of shear, e at the end of the step over the step [W/m^2], shear
        stress [Pa], shape (5, nodes).

    Arrays of rows, as numba looks up the types of many arrays in a tuple, and of named tuples, anew in some
    calls, slowly.
    """
    nodes, law = len(flow) - 1, FilmLaw(*law)
    limiters = np.empty((2, nodes))
    _limiters(state[T_MEAN], film, flow, limiters)
    backward = flow[nodes // 2] < 0.0  # with the flow; the limiters need what is upstream
    for sweep in range(SWEEPS):
        largest, turned = 0.0, False
        for k in range(nodes):
            i = nodes - 1 - k if backward else k
            turned = turned or (flow[i] if backward else -flow[i + 1]) > 0.0
            before = state[T_MEAN, i]
            _solve_node(i, state, film, flow, limiters, ambient, law, of_nodes, out)
            largest = max(largest, abs(state[T_MEAN, i] - before))
        if not turned or largest < SWEEP_TOLERANCE * ambient[0]:
            return sweep + 1
        backward = not backward
    return SWEEPS


@inlined
def _solve_node(
    i: int,
    state: np.ndarray,
    film: np.ndarray,
    flow: np.ndarray,
    limiters: np.ndarray,
    ambient: tuple[float, float],
    law: FilmLaw,
    of_nodes: np.ndarray,
    out: np.ndarray,
) -> None:
    """Temperature and fluxes of node i, between neighbours whose temperatures are given."""
    (inlet, coldest), old = ambient, film[OLD, i]
    carried, before, after = _carried_in(i, state, film, flow, limiters, inlet)
    node = film[P, i], film[THICKNESS, i], film[ON_LEFT, i], of_nodes[SLIDING, i]
    last, walls = fixed_at(i, of_nodes)
    for _ in range(2):
        a, b, beyond = _balance(i, carried, before, after, film, flow, limiters)
        start, balance = (state[T_BASE, i], state[T_SHAPE, i]), (a, b, of_nodes[G, i])
        found, _ = film_temperature(start, node, balance, last, walls, law)
        state[T_BASE, i], state[T_SHAPE, i] = found.base, found.profile
        upstream = before if flow[i + 1] >= 0.0 else after
        drop = max(limiters[IN_SPACE, i] * (upstream - found.mean), limiters[IN_TIME, i] * (old - found.mean))
        if drop <= max(found.mean - coldest, 0.0):
            break
        limiters[IN_SPACE, i] = limiters[IN_TIME, i] = 0.0
    state[T_MEAN, i] = found.mean
    out[0, i], out[1, i], out[2, i] = found.q1, found.q2, found.shear_heat
    out[3, i], out[4, i] = beyond * (found.mean - old), found.stress


@inlined
def _carried_in(
    i: int, state: np.ndarray, film: np.ndarray, flow: np.ndarray, limiters: np.ndarray, inlet: float
) -> tuple[float, float, float]:
    """Heat of the old level and of the flow from both neighbours [W/m^2], and their temperatures [K]."""
    last, from_left, from_right = len(flow) - 2, max(flow[i], 0.0), max(-flow[i + 1], 0.0)
    before = state[T_MEAN, i - 1] if i > 0 else inlet
    after = state[T_MEAN, i + 1] if i < last else inlet
    carried = film[STORED, i] * film[OLD, i] + film[EXTRAPOLATED, i]
    if from_left > 0.0:
        drawn = limiters[IN_SPACE, i - 1] * (before - state[T_MEAN, i - 2]) if i > 1 else 0.0
        carried += from_left * (before + drawn)
    if from_right > 0.0:
        drawn = limiters[IN_SPACE, i + 1] * (after - state[T_MEAN, i + 2]) if i < last - 1 else 0.0
        carried += from_right * (after + drawn)
    return carried, before, after


@inlined
def _balance(
    i: int,
    carried: float,
    before: float,
    after: float,
    film: np.ndarray,
    flow: np.ndarray,
    limiters: np.ndarray,
) -> tuple[float, float, float]:
    """a and b of :mod:`.film_law` with both extrapolations, and the part of a by that in time."""
    stored, in_space = film[STORED, i], limiters[IN_SPACE, i]
    from_left, from_right = max(flow[i], 0.0), max(-flow[i + 1], 0.0)
    beyond = stored * limiters[IN_TIME, i]
    to_right, to_left = in_space * max(flow[i + 1], 0.0), in_space * max(-flow[i], 0.0)
    a = stored + from_left + from_right + beyond + to_right + to_left
    return a, carried + beyond * film[OLD, i] + to_right * before + to_left * after, beyond


@compiled
def heat_taken(
    old: np.ndarray,
    stored: np.ndarray,
    before_step: np.ndarray,
    flow: np.ndarray,
    inlet: float,
    t: np.ndarray,
    extrapolated: np.ndarray,
) -> float:
    """Heat that the oil stores and takes out of the contact, summed over the cells [W/m^2].

    `old`, `stored`, `before_step`, `flow`: `old`, `stored`, `extrapolated` and `couette` of :class:`Film`.
    `inlet`: temperature of the oil that enters [K].
    `t`, `extrapolated`: temperatures and e of the solution, as of :func:`transport`, shape (nodes,).
    """
    nodes = len(t)
    # oil that the pressure moves takes its heat along from where it turns: the Couette flow alone carries
    taken = max(flow[nodes], 0.0) * (t[nodes - 1] - inlet) + max(-flow[0], 0.0) * (t[0] - inlet)
    for i in range(nodes):
        taken += stored[i] * (t[i] - old[i]) + extrapolated[i] - before_step[i]
        taken -= (flow[i + 1] - flow[i]) * (t[i] - inlet)
    return taken


def transport_in_rows(
    rows: int,
    state: np.ndarray,
    film: np.ndarray,
    flow: np.ndarray,
    ambient: tuple[float, float],
    law: tuple,
    of_nodes: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """State and `out` of :func:`transport` of each row of nodes, over all nodes."""
    states, films, constants = (in_rows(values, rows) for values in (state.copy(), film, of_nodes))
    out = np.empty((rows, 5, films.shape[-1]))
    for k, row_flow in enumerate(np.split(flow, rows)):
        transport(states[k], films[k], row_flow, ambient, law, constants[k], out[k])
    return joined(states), joined(out)


def heat_taken_in_rows(rows: int, film: Film, inlet: float, t: np.ndarray, extrapolated: np.ndarray) -> float:
    """:func:`heat_taken` of all rows of nodes."""
    given = film.old, film.stored, film.extrapolated, film.couette, t, extrapolated
    parts = zip(*(np.split(values, rows) for values in given), strict=True)
    return sum(heat_taken(*part[:4], inlet, *part[4:]) for part in parts)
