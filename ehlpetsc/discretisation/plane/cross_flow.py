r"""Finite volumes of the Reynolds equation: flow across, in strips and points (compiled).

Across the direction of motion there is no entrainment; the pressure flow between two rows is central, with
the film of the face and both nodes' fluidities, as along x.

Flow across a sliding non-Newtonian film: the magnitude of both stresses, along the sliding :math:`\tau` and
across it :math:`zp_y`, sets the viscosity of both (see
:func:`ehlpetsc.physics.oil.tabulated_flow.flow_beside_sliding`),

.. math:: M_y=\int\frac{\dot\gamma(r)}{r}z^2\,dz,\qquad r=\sqrt{\tau^2+z^2p_y^2},\qquad
   \int\frac{\dot\gamma(r)}{r}\tau\,dz=|u_1-u_2|.

It is a table over the sliding speed and the gradient. In the limit of a slow cross flow the oil flows with
the viscosity of the sliding film, the secant of the shear law (Ehret, Dowson & Taylor 1998; Greenwood 2000),
whereas flow along x sees the tangent. The gradient along x is left out.
"""

import numpy as np

from ehlpetsc.base.compiled import compiled, unsigned
from ehlpetsc.discretisation.finite_volumes import (
    DP,
    LN_ETA_P,
    LN_THINNING_H,
    LN_THINNING_P,
    ONE,
    PROPERTIES,
    Q_ABOVE,
    Q_BELOW,
    Q_OWN,
    RHO,
    RHO_P,
    H,
    P,
    face_film,
    face_mean,
    fluidities,
    law_of_row,
)
from ehlpetsc.physics.contact.asperities import flow_factor
from ehlpetsc.physics.oil.rheology import EYRING, FlowLaw, mobilities
from ehlpetsc.physics.oil.tabulated_flow import tabulated_mobilities


@compiled
def flux_across(at: np.ndarray, left: int, right: int, table: np.ndarray, law: tuple, flow: FlowLaw) -> tuple:
    """Mass flux from the node `left` to its neighbour `right` across, and its derivatives.

    Derivatives are with respect to (q, h) of both nodes.

    `at`: as of `finite_volumes.flux_through`, and `law` with the spacing across.
    `table`: of :func:`ehlpetsc.physics.oil.tabulated_flow.cross_flow_table`.
    `flow`: shear law.
    """
    if at[DP, left] == 0.0 and at[DP, right] == 0.0:  # no pressure in a cavity
        return 0.0, 0.0, 0.0, 0.0, 0.0
    per_length, per_film, stress, rise, sliding, _, layer, leaks = law
    gradient = per_length * (at[P, right] - at[P, left])
    film, film_l, film_r = face_film(at[H, left], at[H, right], leaks)
    if rise != 0.0:
        stress += 0.5 * rise * (at[P, left] + at[P, right])
    fluidity_l, fluidity_r = fluidities(at, left, right)
    state = film, gradient, fluidity_l, fluidity_r, stress
    if len(table) > 0 and (sliding != 0.0 or flow.kind != EYRING):
        now_l, now_r = tabulated_mobilities(*state, sliding / stress, table)
    else:
        now_l, now_r = mobilities(*state, 0.0)
    (m_l, h_l, g_l, eta_l), (m_r, h_r, g_r, eta_r) = now_l, now_r
    factor, factor_h = flow_factor(film, layer) if layer != 0.0 else (1.0, 0.0)
    half = 0.5 * gradient
    mean, weight_l, weight_r = face_mean(at[RHO, left] * m_l, at[RHO, right] * m_r, leaks)
    rho_l, rho_r = weight_l * at[RHO, left], weight_r * at[RHO, right]
    by_film = half * per_film * (factor * (rho_l * h_l + rho_r * h_r) + 2.0 * factor_h * mean)
    by_difference = factor * (mean + half * (rho_l * g_l + rho_r * g_r)) * per_length
    by_state_l = weight_l * at[RHO_P, left] * m_l + at[LN_ETA_P, left] * rho_l * eta_l
    by_state_r = weight_r * at[RHO_P, right] * m_r + at[LN_ETA_P, right] * rho_r * eta_r
    by_p_l, by_p_r = half * factor * by_state_l - by_difference, half * factor * by_state_r + by_difference
    if rise != 0.0:  # the mobility over the fluidity is a function of sliding and gradient over the stress
        s_l, s_r = (-m_l - eta_l - gradient * g_l), (-m_r - eta_r - gradient * g_r)
        by_stress = factor * half * (rho_l * s_l + rho_r * s_r) * 0.5 * rise / stress
        by_p_l, by_p_r = by_p_l + by_stress, by_p_r + by_stress
    by_film_l, by_film_r = by_film * film_l, by_film * film_r
    if at.shape[0] > PROPERTIES:
        by_thermal = -half * factor * (rho_l * eta_l + rho_r * eta_r)
        by_p_l += by_thermal * at[LN_THINNING_P, left]
        by_p_r += by_thermal * at[LN_THINNING_P, right]
        by_film_l += by_thermal * at[LN_THINNING_H, left]
        by_film_r += by_thermal * at[LN_THINNING_H, right]
    return (
        -factor * mean * gradient,
        -by_p_l * at[DP, left],
        -by_film_l,
        -by_p_r * at[DP, right],
        -by_film_r,
    )


@compiled
def add_across(
    at: np.ndarray,
    shape: tuple,
    law: tuple,
    speeds: np.ndarray,
    flow: FlowLaw,
    table: np.ndarray,
    breadth: float,
    rows: tuple,
) -> None:
    """Add the flow across to the mass balance of the cells and to its derivatives.

    Parameters
    ----------
    at : shape (10 or 13, (n_y + 2) (n_x + 1))
        Nodal properties of the local rows, of one more on either side and of a node beyond the outlet in
        each.
    shape
        n_y, n_x: local rows, nodes along x. The first node of each, the inlet, is left out.
    law, flow, table
        As of :func:`flux_across`.
    speeds : shape (n_y + 1, 2)
        As of :func:`ehlpetsc.discretisation.step_inputs.face_speeds`, in place of those of `law`.
    breadth
        Weight of the fluxes.
    rows
        Residual, shape (n_y n_x,); derivatives with respect to q and h of the `STENCIL`, (n_y n_x, 12).
    """
    (n_y, n_x), (residual, by) = shape, rows
    stride = unsigned(n_x + 1)
    for row in range(unsigned(n_y + 1)):
        here_law = law_of_row(law, speeds, row)
        for i in range(ONE, unsigned(n_x)):
            below = row * stride + i
            flux = flux_across(at, below, below + stride, table, here_law, flow)
            if row > 0:
                node = (row - ONE) * unsigned(n_x) + i
                residual[node] += breadth * flux[0]
                by[node, Q_OWN] += breadth * flux[1]
                by[node, Q_OWN + 1] += breadth * flux[2]
                by[node, Q_ABOVE], by[node, Q_ABOVE + 1] = breadth * flux[3], breadth * flux[4]
            if row < n_y:
                node = row * unsigned(n_x) + i
                residual[node] -= breadth * flux[0]
                by[node, Q_OWN] -= breadth * flux[3]
                by[node, Q_OWN + 1] -= breadth * flux[4]
                by[node, Q_BELOW], by[node, Q_BELOW + 1] = -breadth * flux[1], -breadth * flux[2]
