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

from ehlpetsc.base.compiled import compiled
from ehlpetsc.effects.heat.film_law import FilmLaw, film_temperature, fixed_at

SWEEPS = 50
SWEEP_TOLERANCE = 1e-11  # relative change of the temperatures that ends the sweeps


class Film(NamedTuple):
    """Film of a solution; arrays of shape (nx,).

    `pressure`, `thickness`: of the oil [Pa]; [m], 0 where the solids are in direct contact.
    `left`: fraction of the gap that is full of oil.
    `old`: temperature at the begin of the step [K].
    `stored`: heat capacity of the oil carried over, over the step [W/(m^2 K)]; 0: steady.
    `change`: by which the temperature would change in the step as fast as in the one before [K].
    `extrapolated`: e at the begin of the step, over the step [W/m^2].
    `couette`: heat capacity that the mean speed moves through the faces, per cell [W/(m^2 K)], shape (nx +
        1,).
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


@compiled
def explicit_transport(
    stored: np.ndarray, flow: np.ndarray, t: np.ndarray, inlet: float
) -> tuple[np.ndarray, np.ndarray]:
    """Storage and upwind transport by temperatures t of the old level, of :func:`.film.film_temperature`.

    `stored`, `flow`: as `stored` and `couette` of :class:`Film`.
    `t`: [K], shape (nodes,).
    `inlet`: temperature of the oil that enters [K].
    """
    nodes = len(t)
    a, b = np.empty(nodes), np.empty(nodes)
    for i in range(nodes):
        from_left, from_right = max(flow[i], 0.0), max(-flow[i + 1], 0.0)
        before, after = t[i - 1] if i > 0 else inlet, t[i + 1] if i < nodes - 1 else inlet
        a[i] = stored[i] + from_left + from_right
        b[i] = stored[i] * t[i] + from_left * before + from_right * after
    return a, b


@compiled
def _limited(difference: float, next_one: float) -> float:
    """Half of van Leer's limiter: the fraction of a difference by which half an interval extrapolates."""
    return next_one / (difference + next_one) if difference * next_one > 0.0 else 0.0


@compiled
def _limiters(
    t: np.ndarray,
    old: np.ndarray,
    change: np.ndarray,
    couette: np.ndarray,
    in_space: np.ndarray,
    in_time: np.ndarray,
) -> None:
    """Fill in both limiters of every node at temperatures t; oil enters and leaves as at the end nodes."""
    last = len(t) - 1
    for i in range(last + 1):
        # t knows the neighbours of the old level and changes less than the solution: BDF2 at most
        in_time[i] = min(_limited(t[i] - old[i], change[i]), 0.5)
        in_space[i] = 0.0
        if 0 < i < last:
            left, right = t[i] - t[i - 1], t[i + 1] - t[i]
            in_space[i] = _limited(left, right) if couette[i + 1] >= 0.0 else _limited(right, left)


@compiled
def transport(
    base: np.ndarray,
    profile: np.ndarray,
    t: np.ndarray,
    pressure: np.ndarray,
    thickness: np.ndarray,
    left: np.ndarray,
    old: np.ndarray,
    stored: np.ndarray,
    change: np.ndarray,
    before_step: np.ndarray,
    flow: np.ndarray,
    inlet: float,
    coldest: float,
    law: tuple,
    of_nodes: np.ndarray,
    t_new: np.ndarray,
    q1: np.ndarray,
    q2: np.ndarray,
    shear_heat: np.ndarray,
    extrapolated: np.ndarray,
    shear: np.ndarray,
) -> int:
    """Temperatures of the film and heat fluxes of a solution, by sweeps along the film; returns their number.

    `base`, `profile`, `t`: state of the film to start from; the limiters are taken at the mean temperatures t
        [K]. `base` and `profile` become those of the solution.
    `pressure`, `thickness`, `left`, `old`, `stored`, `change`, `before_step`, `flow`: as `pressure` to
        `couette` of :class:`Film`. One by one, as numba looks up the types of many arrays in a tuple, and of
        named tuples, anew in some calls, slowly.
    `inlet`, `coldest`: temperature of the oil that enters, minimum of it and both bodies [K].
    `law`, `of_nodes`: as of :class:`.film.FilmHeat`, `law` as a tuple; rows `A` and `B` are not used.
    `t_new`, `q1`, `q2`, `shear_heat`, `extrapolated`, `shear`: filled in; `extrapolated` is e at the end of
        the step, over the step [W/m^2], `shear` the shear stress [Pa].
    """
    nodes, law = len(t), FilmLaw(*law)
    in_space, in_time = np.empty(nodes), np.empty(nodes)
    _limiters(t, old, change, flow, in_space, in_time)
    t_new[:] = t
    backward = flow[nodes // 2] < 0.0  # with the flow; the limiters need what is upstream
    for sweep in range(SWEEPS):
        largest, turned = 0.0, False
        for k in range(nodes):
            i = nodes - 1 - k if backward else k
            from_left, from_right = max(flow[i], 0.0), max(-flow[i + 1], 0.0)
            turned = turned or (from_left if backward else from_right) > 0.0
            before, after = t_new[i - 1] if i > 0 else inlet, t_new[i + 1] if i < nodes - 1 else inlet
            first_order = stored[i] * old[i] + before_step[i]
            if from_left > 0.0:
                drawn = in_space[i - 1] * (before - t_new[i - 2]) if i > 1 else 0.0
                first_order += from_left * (before + drawn)
            if from_right > 0.0:
                drawn = in_space[i + 1] * (after - t_new[i + 2]) if i < nodes - 2 else 0.0
                first_order += from_right * (after + drawn)
            fixed = fixed_at(i, of_nodes, law)
            for _ in range(2):
                beyond = stored[i] * in_time[i]
                to_right, to_left = in_space[i] * max(flow[i + 1], 0.0), in_space[i] * max(-flow[i], 0.0)
                a = stored[i] + from_left + from_right + beyond + to_right + to_left
                b = first_order + beyond * old[i] + to_right * before + to_left * after
                found = film_temperature(
                    base[i], profile[i], pressure[i], thickness[i], left[i], a, b, *fixed
                )
                value, _, _, q1[i], q2[i], shear_heat[i], _, base[i], profile[i], shear[i] = found
                upstream = before if flow[i + 1] >= 0.0 else after
                drop = max(in_space[i] * (upstream - value), in_time[i] * (old[i] - value))
                if drop <= max(value - coldest, 0.0):
                    break
                in_space[i] = in_time[i] = 0.0
            largest = max(largest, abs(value - t_new[i]))
            t_new[i], extrapolated[i] = value, beyond * (value - old[i])
        if not turned or largest < SWEEP_TOLERANCE * inlet:
            return sweep + 1
        backward = not backward
    return SWEEPS


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

    `old`, `stored`, `before_step`, `flow`, `inlet`: as of :func:`transport`.
    `t`, `extrapolated`: as it fills them in, shape (nodes,).
    """
    nodes = len(t)
    # oil that the pressure moves takes its heat along from where it turns: the Couette flow alone carries
    taken = max(flow[nodes], 0.0) * (t[nodes - 1] - inlet) + max(-flow[0], 0.0) * (t[0] - inlet)
    for i in range(nodes):
        taken += stored[i] * (t[i] - old[i]) + extrapolated[i] - before_step[i]
        taken -= (flow[i + 1] - flow[i]) * (t[i] - inlet)
    return taken
