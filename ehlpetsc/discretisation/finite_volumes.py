r"""Finite volumes of the Reynolds equation: mass fluxes, mass balance of the cells, derivatives (compiled).

The Couette flux and the storage are second-order upwind (BDF2 in time), both by
:func:`positive_extrapolation`: second order where the film is resolved, and never
a negative outflow, so that no node is emptied by the scheme itself.

The pressure flow through a face is the exact one between its nodes of a film that is linear between them,
:func:`face_film`, and of a fluidity :math:`\rho/\eta` (and S) that is exponential in the pressure,
:func:`face_mean`. A closed node then lets nothing through, and the flow is a difference of reduced pressures,
monotone in both: with the viscosity at the mean pressure, the flow out of a node would fall again when its
pressure exceeds its neighbour's by more than about 2/alpha, a fold at which Newton's method cycles.
The paper's direct contact needs faces that leak, with the means of both films and of both fluidities: it
closes a node by draining it.

An oil may be thinned by other than its pressure: both nodes then have the fluidities at the mean of both
nodes' thinning. With its own, a node can be the more fluid one although its pressure is higher, which is the
same fold.
"""

import numpy as np

from ehlpetsc.base.compiled import compiled, inlined, unsigned
from ehlpetsc.discretisation.contact.node_state import AMBIENT_TOLERANCE
from ehlpetsc.physics.contact.asperities import flow_factor
from ehlpetsc.physics.oil.laws import relative_density
from ehlpetsc.physics.oil.rheology import mobilities
from ehlpetsc.physics.oil.tabulated_flow import tabulated_mobilities

ONE = unsigned(1)
# Coefficients of a row, of q and h of each node: i-2, i-1, i, i+1 along x; in the plane i below and above.
ALONG, STENCIL = 4, 6  # nodes
Q_OWN, Q_BELOW, Q_ABOVE = 4, 8, 10  # index of q of the node i and of the neighbours across, followed by h
# Nodal properties, rows of one array (a tuple of arrays costs ten times the loop):
P, DP = 0, 1  # pressure in p0, dp/dq
H = 2  # film [m]
M, M_Q, M_H = 3, 4, 5  # mass per area rho h (1 - theta) in a^2/R, and its derivatives by q and h
RHO, RHO_P = 6, 7  # density over u a^2/R, and its derivative by p
FLUIDITY, LN_ETA_P = 8, 9  # 1/eta [1/(Pa s)], d ln(eta)/dp
PROPERTIES = 10
THIRD = 1.0 / 3.0
LEAST_SHARE = 1e-100  # of both fluidities of a face that the smaller one counts as at least
SERIES_LIMIT = 0.02  # difference over sum of both, below which the logarithmic mean is a series
# Of an oil that is thinned by other than its pressure, FLUIDITY and LN_ETA_P hold without that. THINNING is
# the square root of the fluidity over that one, LN_THINNING_* the derivatives of its logarithm by p and h.
THINNING, LN_THINNING_P, LN_THINNING_H = 10, 11, 12
THINNED_PROPERTIES = 13


@compiled
def positive_extrapolation(m: float, behind: float, k: float) -> tuple[float, float, float]:
    r"""Extrapolate m from the values at `behind` and here, kept positive for m > 0.

    :math:`\max[m+k(m-m_b),\ m/2]`. Plain extrapolation of a film that goes to zero is negative, which empties
    the next cell and starts a cascade of false contacts. At m = 0 the slope is a half and not zero: a node
    that is to leave contact must feel its film, or Newton's method stalls there at any time step.
    """
    value = m + k * (m - behind)
    if value < 0.5 * m:
        return 0.5 * m, 0.5, 0.0
    return value, 1.0 + k, -k


@compiled
def extrapolated(m: np.ndarray, behind: np.ndarray, k: float) -> np.ndarray:
    """Values of :func:`positive_extrapolation` for arrays m and behind."""
    out = np.empty_like(m)
    for i in range(len(m)):
        out[i] = positive_extrapolation(m[i], behind[i], k)[0]
    return out


@inlined
def fill_mass(
    i: int, q: float, h: float, density: tuple, p0: float, film: float, unit: float, at: np.ndarray
) -> float:
    """Fill in the properties of node i except its viscosity, as :func:`.step_inputs.nodal`; return p [Pa]."""
    p, oil_fraction, full = max(q, 0.0), 1.0 + min(q, 0.0), q > -AMBIENT_TOLERANCE
    rho, rho_p = relative_density(density, p0 * p)
    at[P, i], at[DP, i], at[H, i] = p, 1.0 if full else 0.0, film * h
    at[M, i], at[M_H, i] = rho * oil_fraction * h, rho * oil_fraction
    at[M_Q, i] = (rho_p * p0 if full else 1.0) * h
    at[RHO, i], at[RHO_P, i] = unit * rho, unit * p0 * rho_p
    return p0 * p


@compiled
def fluidities(at: np.ndarray, left: int, right: int) -> tuple:
    """1/eta [1/(Pa s)] of two neighbours at the mean of their thinning."""
    if at.shape[0] == PROPERTIES:
        return at[FLUIDITY, left], at[FLUIDITY, right]
    thinning = at[THINNING, left] * at[THINNING, right]
    return thinning * at[FLUIDITY, left], thinning * at[FLUIDITY, right]


@compiled
def face_mobilities(
    at: np.ndarray, left: int, right: int, table: np.ndarray, gap: tuple
) -> tuple[tuple, tuple]:
    """Mobilities of both nodes of a face and their derivatives, with the factor of the layer.

    `gap` are film, pressure gradient, stress of the shear law, sliding speed and rms height of the layer.
    """
    film, gradient, stress, sliding, layer = gap
    state = film, gradient, *fluidities(at, left, right), stress, sliding / stress
    mobility_l, mobility_r = tabulated_mobilities(*state, table) if len(table) > 0 else mobilities(*state)
    if layer == 0.0:
        return mobility_l, mobility_r
    factor, by_film = flow_factor(film, layer)
    return scaled(mobility_l, factor, by_film), scaled(mobility_r, factor, by_film)


@compiled
def scaled(mobility: tuple, factor: float, by_film: float) -> tuple:
    """A mobility and its derivatives times a factor of the film."""
    value, by_h, by_gradient, by_ln_eta = mobility
    return factor * value, factor * by_h + by_film * value, factor * by_gradient, factor * by_ln_eta


@inlined
def face_film(left: float, right: float, leaks: bool) -> tuple[float, float, float]:
    r"""Film of a face between nodes with the films `left` and `right`, and its derivatives by both.

    Of a film that is linear between the nodes a constant flow meets the resistance
    :math:`\int h^{-3}dx`: :math:`h^3=2h_l^2h_r^2/(h_l+h_r)`. Of a face that leaks the mean.
    """
    if leaks:
        return 0.5 * (left + right), 0.5, 0.5
    if left <= 0.0 or right <= 0.0:
        return 0.0, 0.0, 0.0
    total = left + right
    film = (2.0 * (left * right) ** 2 / total) ** THIRD  # half the time of a cube root
    third = THIRD * film
    return film, third * (2.0 / left - 1.0 / total), third * (2.0 / right - 1.0 / total)


@inlined
def face_mean(left: float, right: float, leaks: bool) -> tuple[float, float, float]:
    r"""Mean of positive fluidities of both nodes of a face, and twice its derivatives by both.

    The logarithmic mean :math:`(f_l-f_r)/\ln(f_l/f_r)` is the mean over the pressure of a fluidity that is
    exponential in it, as in exponentially fitted schemes (Scharfetter & Gummel 1969): the flow of Barus' law
    is exact. Of a face that leaks the arithmetic mean.
    """
    total = left + right
    if leaks or total <= 0.0:
        return 0.5 * total, 1.0, 1.0
    least = LEAST_SHARE * total
    a, b = max(left, least), max(right, least)
    difference = (a - b) / total
    if abs(difference) < SERIES_LIMIT:  # of the logarithm, to 1e-13
        d2 = difference * difference
        over = 1.0 / (1.0 + d2 * (1.0 / 3.0 + d2 * (1.0 / 5.0 + d2 / 7.0)))
        slope = -difference * (2.0 / 3.0 + d2 * (4.0 / 5.0 + d2 * 6.0 / 7.0)) * over * over
        by = slope * 2.0 / total
        return 0.5 * total * over, over + by * b, over - by * a
    ln_ratio = np.log(a / b)
    mean = (a - b) / ln_ratio
    by_left = 2.0 * (a - mean) / (a * ln_ratio) if left > least else 0.0
    by_right = 2.0 * (mean - b) / (b * ln_ratio) if right > least else 0.0
    return mean, by_left, by_right


@inlined
def drawn(at: np.ndarray, behind: int, left: int) -> tuple[float, float, float]:
    """Mass per area that the mean speed moves through a face, and derivatives by that of both nodes."""
    return positive_extrapolation(at[M, left], at[M, behind], 0.5 if behind != left else 0.0)


@inlined
def face(at: np.ndarray, left: int, right: int, table: np.ndarray, law: tuple) -> tuple:
    """State of the face between two nodes; parameters as of :func:`flux_through`.

    Returns film [m] and its derivatives by those of both nodes; pressure gradient [Pa/m]; stress of the shear
    law [Pa]; mobilities of both nodes.
    """
    per_length, _, stress, stress_rise, sliding, _, layer, leaks = law
    gradient = per_length * (at[P, right] - at[P, left])
    films = face_film(at[H, left], at[H, right], leaks)
    if stress_rise != 0.0:
        stress += 0.5 * stress_rise * (at[P, left] + at[P, right])
    gap = films[0], gradient, stress, sliding, layer
    return films, gradient, stress, face_mobilities(at, left, right, table, gap)


@compiled
def flux_through(at: np.ndarray, behind: int, left: int, right: int, table: np.ndarray, law: tuple) -> tuple:
    """Mass flux through the face between the nodes `left` and `right`, and its derivatives.

    Derivatives are with respect to (q, h) of the nodes `behind`, `left` and `right`.

    Parameters
    ----------
    at : shape (10 or 13, nodes)
    behind
        Node upstream of `left`; `left` itself where there is none.
    table
        Of :func:`ehlpetsc.physics.oil.tabulated_flow.flow_table`.
    law
        p0 over the spacing [Pa/m]; a^2/R [m]; stress of the shear law without pressure, infinite: Newtonian,
        its rise over p0 [Pa]; |u1 - u2| [m/s]; entrainment speed over that of the scales; rms height of the
        compliant layer [m], 0 without one; whether the face leaks.
    """
    per_length, per_film, _, stress_rise, _, entrainment, _, leaks = law
    couette, by_left, by_behind = 0.0, 0.0, 0.0
    if entrainment != 0.0:
        couette, by_left, by_behind = drawn(at, behind, left)
        couette, by_left, by_behind = entrainment * couette, entrainment * by_left, entrainment * by_behind
    of_behind = by_behind * at[M_Q, behind], by_behind * at[M_H, behind]
    of_left = by_left * at[M_Q, left], by_left * at[M_H, left]
    if at[DP, left] == 0.0 and at[DP, right] == 0.0:  # no pressure in a cavity
        return couette, *of_behind, *of_left, 0.0, 0.0
    films, gradient, stress, (mobility_l, mobility_r) = face(at, left, right, table, law)
    half, flows = 0.5 * gradient, (at[RHO, left] * mobility_l[0], at[RHO, right] * mobility_r[0])
    mean, weight_l, weight_r = face_mean(*flows, leaks)
    rho_l, rho_r = weight_l * at[RHO, left], weight_r * at[RHO, right]
    by_film = half * per_film * (rho_l * mobility_l[1] + rho_r * mobility_r[1])
    by_difference = (mean + half * (rho_l * mobility_l[2] + rho_r * mobility_r[2])) * per_length
    by_state_l = weight_l * at[RHO_P, left] * mobility_l[0] + at[LN_ETA_P, left] * rho_l * mobility_l[3]
    by_state_r = weight_r * at[RHO_P, right] * mobility_r[0] + at[LN_ETA_P, right] * rho_r * mobility_r[3]
    by_p_l, by_p_r = half * by_state_l - by_difference, half * by_state_r + by_difference
    if stress_rise != 0.0:
        by_stress = rho_l * (mobility_l[0] + mobility_l[3] + gradient * mobility_l[2])
        by_stress += rho_r * (mobility_r[0] + mobility_r[3] + gradient * mobility_r[2])
        by_stress *= -0.5 * half * stress_rise / stress
        by_p_l, by_p_r = by_p_l + by_stress, by_p_r + by_stress
    by_film_l, by_film_r = by_film * films[1], by_film * films[2]
    if at.shape[0] > PROPERTIES:
        by_thinning = -half * (rho_l * mobility_l[3] + rho_r * mobility_r[3])
        by_p_l, by_p_r = (
            by_p_l + by_thinning * at[LN_THINNING_P, left],
            by_p_r + by_thinning * at[LN_THINNING_P, right],
        )
        by_film_l += by_thinning * at[LN_THINNING_H, left]
        by_film_r += by_thinning * at[LN_THINNING_H, right]
    return (
        couette - mean * gradient,
        *of_behind,
        of_left[0] - by_p_l * at[DP, left],
        of_left[1] - by_film_l,
        -by_p_r * at[DP, right],
        -by_film_r,
    )


@inlined
def law_of_row(law: tuple, speeds: np.ndarray, row: int) -> tuple:
    """Law of the faces of a row; `law` as of :func:`flux_through`, `speeds` as of :func:`balance`."""
    per_length, per_film, stress, rise, _, _, layer, leaks = law
    return per_length, per_film, stress, rise, speeds[row, 0], speeds[row, 1], layer, leaks


@compiled
def balance(
    at: np.ndarray,
    layout: tuple,
    law: tuple,
    speeds: np.ndarray,
    table: np.ndarray,
    storage: tuple,
    breadth: float,
    rows: tuple,
) -> None:
    """Fill in the mass balance of cells in rows along x, outflow - inflow + storage, and its derivatives.

    Parameters
    ----------
    at : shape (10 or 13, nodes)
        Nodal properties, with one node at least before and behind the cells of a row.
    layout
        Number of rows; cells of a row; index in `at` of the first cell, and its distance to that of the next
        row; the same among the filled rows; whether there are two nodes before the cells.
    law, table
        As of :func:`flux_through`.
    speeds : shape (rows, 2)
        As of :func:`.step_inputs.row_speeds`, in place of those of `law`.
    storage
        `m`, `extrapolated`, at the filled rows, and `k` of :class:`.step_inputs.FilmHistory`; cell over time
        step, 0: steady.
    breadth
        Weight of the fluxes.
    rows
        Filled in: residual, shape (rows,); derivatives with respect to q and h of the `ALONG` nodes, (rows, 8
        or more).
    """
    (m_old, extrapolated, k, rate), (residual, by) = storage, rows
    n_rows, cells, first, stride, filled, filled_stride, has_behind = layout
    for line in range(unsigned(n_rows)):  # numba takes longer over indices that may be negative
        begin = unsigned(first) + line * unsigned(stride)
        place = unsigned(filled) + line * unsigned(filled_stride)
        left, here_law = begin - ONE, law_of_row(law, speeds, line)
        behind = left - ONE if has_behind else left
        inflow = flux_through(at, behind, left, begin, table, here_law)
        for i in range(unsigned(cells)):
            node, here = begin + i, place + i
            outflow = flux_through(at, node - ONE, node, node + ONE, table, here_law)
            stored, by_m, _ = positive_extrapolation(at[M, node], m_old[here], k)
            residual[here] = breadth * (outflow[0] - inflow[0]) + (stored - extrapolated[here]) * rate
            by[here, 0], by[here, 1] = -breadth * inflow[1], -breadth * inflow[2]
            by[here, 2], by[here, 3] = breadth * (outflow[1] - inflow[3]), breadth * (outflow[2] - inflow[4])
            by[here, 4] = breadth * (outflow[3] - inflow[5]) + by_m * at[M_Q, node] * rate
            by[here, 5] = breadth * (outflow[4] - inflow[6]) + by_m * at[M_H, node] * rate
            by[here, 6], by[here, 7] = breadth * outflow[5], breadth * outflow[6]
            inflow = outflow


@compiled
def reynolds_product(by: np.ndarray, v: np.ndarray, n_x: int, first: int, out: np.ndarray) -> None:
    """Fill in the derivatives of the Reynolds rows times a vector.

    Parameters
    ----------
    by : shape (rows, 8 or 12)
        Derivatives with respect to q and h of the `ALONG` nodes and of those across; zero where there is no
        such node.
    v : shape (window, 2)
        Changes of q and h.
    n_x
        Nodes along x.
    first
        Index in the window of the node of the first row.
    out : shape (rows,)
    """
    first, last, stride = unsigned(first), unsigned(len(v) - 1), unsigned(n_x)
    for row in range(unsigned(len(by))):  # a view by[row] would take as long as its product
        here = first + row
        left, right = max(here, ONE) - ONE, min(here + ONE, last)
        behind = max(left, ONE) - ONE
        total = by[row, 0] * v[behind, 0] + by[row, 1] * v[behind, 1]
        total = total + by[row, 2] * v[left, 0] + by[row, 3] * v[left, 1]
        total = total + by[row, 4] * v[here, 0] + by[row, 5] * v[here, 1]
        total = total + by[row, 6] * v[right, 0] + by[row, 7] * v[right, 1]
        if by.shape[1] > Q_BELOW:
            below, above = max(here, stride) - stride, min(here + stride, last)
            total += by[row, Q_BELOW] * v[below, 0] + by[row, Q_BELOW + 1] * v[below, 1]
            total += by[row, Q_ABOVE] * v[above, 0] + by[row, Q_ABOVE + 1] * v[above, 1]
        out[row] = total
