r"""Finite volumes of the Reynolds equation in the plane: balance of the cells (compiled).

Along x the fluxes are those of a line contact (:mod:`ehlpetsc.discretisation.finite_volumes`). Across there
is no entrainment; the pressure flow between two rows is central, with the film of the face and both nodes'
fluidities, as along x.

Flow across a sliding non-Newtonian film: the stress of sliding, :math:`\tau_m`, is along x and of the order
of the Eyring stress, the one of the cross flow is small beside it. It then flows with the viscosity
:math:`\eta_e=\tau_m/\dot\gamma_m` of the film that slides (the secant, whereas flow along x sees the
tangent), as Ehret, Dowson and Taylor (1998) and Greenwood (2000) have it,

.. math:: M_y=\frac{h^3}{12\eta}\Big[S_0^2+\Big(\frac{\eta}{\eta_e}\Big)^2-1\Big]^{1/2},\qquad
   \frac{\eta}{\eta_e}=\frac{\eta|u_1-u_2|}{h\,\tau(\eta|u_1-u_2|/h)},

for Eyring's law :math:`\zeta/\operatorname{asinh}\zeta`, :math:`\zeta=\eta(u_1-u_2)/(\tau_0h)`. :math:`S_0`
is the factor of the cross flow without sliding: the limits of a Newtonian oil, of pure rolling and of slow
cross flow are exact.
"""

import numpy as np

from ehlpetsc.base.compiled import compiled, unsigned
from ehlpetsc.discretisation.finite_volumes import (
    DP,
    LN_ETA_P,
    LN_THINNING_H,
    LN_THINNING_P,
    M_H,
    M_Q,
    PROPERTIES,
    RHO,
    RHO_P,
    H,
    M,
    P,
    face_film,
    face_mean,
    fluidities,
    flux_through,
    positive_extrapolation,
)
from ehlpetsc.physics.asperities import flow_factor
from ehlpetsc.physics.rheology import NEWTON, FlowLaw, flow_stress, mobilities
from ehlpetsc.physics.tabulated_flow import tabulated_mobilities

STENCIL = 6  # nodes i-2, i-1, i, i+1 along x, then i in the row below and in the row above
OWN = 4  # index of q_i among the coefficients of a row, followed by h_i
BELOW, ABOVE = 8, 10  # of q of the neighbours across
ONE = unsigned(1)


@compiled
def cross_mobility(
    film: float, resting: tuple, fluidity: float, sliding: float, law: FlowLaw
) -> tuple[float, float, float, float, float]:
    """Mobility of the flow across of one node of a face, and its derivatives.

    With respect to film, gradient, ln(eta) and ln of the stress of the shear law.

    `resting`: mobility without sliding and its derivatives by film, gradient and ln(eta).
    """
    value, by_h, by_gradient, by_ln_eta = resting
    if sliding == 0.0 or law.kind == NEWTON or value == 0.0:
        return value, by_h, by_gradient, by_ln_eta, 0.0
    x = np.log(sliding / (fluidity * film * law.stress))
    tau, by_x, _ = flow_stress(x, law, np.inf)
    ratio, slope = law.stress * np.exp(x) / tau, 1.0 - by_x / tau  # eta over eta_e; d ln(ratio)/dx
    newton = film**3 * fluidity / 12.0
    excess = newton * np.sqrt(max(ratio * ratio - 1.0, 0.0))
    total = np.sqrt(value * value + excess * excess)
    rests, newton_2, slides_2 = value / total, newton * newton / total, (newton * ratio) ** 2 / total
    by_excess = slides_2 - newton_2  # derivative by ln(newton); by ln(ratio) it is slides_2
    return (
        total,
        rests * by_h + (3.0 * by_excess - slides_2 * slope) / film,
        rests * by_gradient,
        rests * by_ln_eta - by_excess + slides_2 * slope,
        -slides_2 * slope,
    )


@compiled
def flux_across(at: np.ndarray, left: int, right: int, table: np.ndarray, law: tuple, flow: FlowLaw) -> tuple:
    """Mass flux from the node `left` to its neighbour `right` across, and its derivatives.

    Derivatives are with respect to (q, h) of both nodes.

    `at`, `table`: as of `finite_volumes.flux_through`, and `law` with the spacing across; its stress and
        rise.
    `flow`: shear law, its stress at zero pressure.
    """
    per_length, per_film, stress, rise, sliding, _, layer, leaks = law
    gradient = per_length * (at[P, right] - at[P, left])
    film, film_l, film_r = face_film(at[H, left], at[H, right], leaks)
    if rise != 0.0:
        stress += 0.5 * rise * (at[P, left] + at[P, right])
    fluidity_l, fluidity_r = fluidities(at, left, right)
    state = film, gradient, fluidity_l, fluidity_r, stress, 0.0
    at_rest_l, at_rest_r = tabulated_mobilities(*state, table) if len(table) > 0 else mobilities(*state)
    now = FlowLaw(flow.kind, stress if flow.kind != NEWTON else 1.0, flow.n, flow.a)
    factor, factor_h = flow_factor(film, layer) if layer != 0.0 else (1.0, 0.0)
    half = 0.5 * gradient
    m_l, h_l, g_l, eta_l, s_l = cross_mobility(film, at_rest_l, fluidity_l, sliding, now)
    m_r, h_r, g_r, eta_r, s_r = cross_mobility(film, at_rest_r, fluidity_r, sliding, now)
    mean, weight_l, weight_r = face_mean(at[RHO, left] * m_l, at[RHO, right] * m_r, leaks)
    rho_l, rho_r = weight_l * at[RHO, left], weight_r * at[RHO, right]
    by_film = half * per_film * (factor * (rho_l * h_l + rho_r * h_r) + 2.0 * factor_h * mean)
    by_difference = factor * (mean + half * (rho_l * g_l + rho_r * g_r)) * per_length
    by_state_l = weight_l * at[RHO_P, left] * m_l + at[LN_ETA_P, left] * rho_l * eta_l
    by_state_r = weight_r * at[RHO_P, right] * m_r + at[LN_ETA_P, right] * rho_r * eta_r
    by_p_l, by_p_r = half * factor * by_state_l - by_difference, half * factor * by_state_r + by_difference
    if rise != 0.0:  # the mobility at rest is a function of gradient over stress
        at_rest = 0.0
        if at_rest_l[0] > 0.0 and m_l > 0.0:
            at_rest -= gradient * (rho_l * g_l + rho_r * g_r)
        by_stress = factor * half * (at_rest + rho_l * s_l + rho_r * s_r) * 0.5 * rise / stress
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
def balance(
    at: np.ndarray,
    shape: tuple,
    laws: tuple,
    flow: FlowLaw,
    table: np.ndarray,
    storage: tuple,
    weights: tuple,
    rows: tuple,
) -> None:
    """Fill in the mass balance of the cells, outflow - inflow + rate of storage, and its derivatives.

    The first node of each row, the inlet, is left out.

    Parameters
    ----------
    at : shape (10 or 13, (n_y + 2) (n_x + 1))
        Nodal properties of the local rows, of one more on either side and of a node beyond the outlet in
        each.
    shape
        n_y, n_x: local rows, nodes along x.
    laws
        Constants of the flux along x and across, see `flux_through`.
    storage
        `m`, `extrapolated`, shape (n_y n_x,), and `k` of :class:`.step_inputs.FilmHistory`; cell over time
            step, 0:
        steady.
    weights
        Of the fluxes along x and across.
    rows
        Filled in: residual, shape (n_y n_x,); derivatives with respect to q and h of the `STENCIL`, (n_y
        n_x, 12).
    """
    (n_y, n_x), (along, across), (m_old, extrapolated, k, rate) = shape, laws, storage
    (weight_x, weight_y), (residual, derivatives) = weights, rows
    stride = unsigned(n_x + 1)
    for row in range(unsigned(n_y)):
        first = (row + ONE) * stride
        inflow = flux_through(at, first, first, first + ONE, table, along)
        for i in range(ONE, unsigned(n_x)):
            here, node = first + i, row * unsigned(n_x) + i
            outflow = flux_through(at, here - ONE, here, here + ONE, table, along)
            stored, by_m, _ = positive_extrapolation(at[M, here], m_old[node], k)
            residual[node] = weight_x * (outflow[0] - inflow[0]) + (stored - extrapolated[node]) * rate
            by = derivatives[node]
            by[0], by[1] = -weight_x * inflow[1], -weight_x * inflow[2]
            by[2] = weight_x * (outflow[1] - inflow[3])
            by[3] = weight_x * (outflow[2] - inflow[4])
            by[4] = weight_x * (outflow[3] - inflow[5]) + by_m * at[M_Q, here] * rate
            by[5] = weight_x * (outflow[4] - inflow[6]) + by_m * at[M_H, here] * rate
            by[6], by[7] = weight_x * outflow[5], weight_x * outflow[6]
            inflow = outflow
    for row in range(unsigned(n_y + 1)):
        for i in range(ONE, unsigned(n_x)):
            below = row * stride + i
            flux = flux_across(at, below, below + stride, table, across, flow)
            if row > 0:
                node = (row - ONE) * unsigned(n_x) + i
                residual[node] += weight_y * flux[0]
                by = derivatives[node]
                by[OWN] += weight_y * flux[1]
                by[OWN + 1] += weight_y * flux[2]
                by[ABOVE], by[ABOVE + 1] = weight_y * flux[3], weight_y * flux[4]
            if row < n_y:
                node = row * unsigned(n_x) + i
                residual[node] -= weight_y * flux[0]
                by = derivatives[node]
                by[OWN] -= weight_y * flux[3]
                by[OWN + 1] -= weight_y * flux[4]
                by[BELOW], by[BELOW + 1] = -weight_y * flux[1], -weight_y * flux[2]


@compiled
def product(
    derivatives: np.ndarray, v_q: np.ndarray, v_h: np.ndarray, n_x: int, first: int, out: np.ndarray
) -> None:
    """Fill in the derivatives of the Reynolds rows times a vector.

    Parameters
    ----------
    derivatives : shape (rows, 12)
        Zero where there is no such node.
    v_q, v_h : shape (window,)
    n_x
        Nodes along x.
    first
        Index in the window of the first local node.
    out : shape (rows,)
    """
    last = len(v_q) - 1
    for row in range(len(derivatives)):
        here, by, total = first + row, derivatives[row], 0.0
        for k in range(STENCIL):
            node = here + (k - 2 if k < 4 else -n_x if k == 4 else n_x)
            node = min(max(node, 0), last)
            total += by[2 * k] * v_q[node] + by[2 * k + 1] * v_h[node]
        out[row] = total
