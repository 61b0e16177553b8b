r"""Exchange of heat between the film and both walls.

The fluxes are those of a parabola, see :mod:`.film_law`, but for oil that enters cold between surfaces far
apart in temperature: a parabola would cool the colder surface by oil that is warmer than it. Where it does,
the sum of both fluxes stays and the colder surface has none; where the oil is colder than both surfaces, each
gives heat by its own difference, :math:`q_i=6(T_e-T_i)/r`, with the same sum. All three agree where they
meet. The sum is :math:`(T_e-\alpha)/\kappa`, for the parabola with

.. math:: \kappa=\frac r{12}+\frac14\Big[R_1+R_2-\frac{(R_1-R_2)^2}{r/X+R_1+R_2}\Big],\qquad
   \alpha=\frac{W_1+W_2}2-\frac{(R_1-R_2)(W_1-W_2)}{2(r/X+R_1+R_2)},

regular at r = 0.
"""

from __future__ import annotations

from typing import NamedTuple

from ehlpetsc.base.compiled import inlined

EXCHANGE_KINDS = PARABOLA, INSULATED, APART = 0, 1, 2  # in the order in which the oil gets colder
MAX_SPLIT = 30.0  # of d, walls thousands of kelvins apart: beyond, in first iterations, its sinh may overflow
NO_FLUX = 1e-9  # K: difference of temperature whose heat flux is rounding


class Exchange(NamedTuple):
    """Exchange of a film of thermal resistance r with both walls.

    `kind`: `PARABOLA`, `INSULATED` or `APART`.
    `r`: :math:`h/k_f` [m^2 K/W].
    `walls`: W1, W2 [K], R1, R2 [m^2 K/W], 1/X of :mod:`.film_law`.
    `conductance`: flux into both walls per temperature [W/(m^2 K)].
    `balanced`: temperature without flux [K].
    """

    kind: int
    r: float
    walls: tuple[float, float, float, float, float]
    conductance: float
    balanced: float


@inlined
def exchange_of(kind: int, r: float, walls: tuple) -> Exchange:
    """Exchange by one of the three laws."""
    w1, w2, r1, r2, between = walls
    if kind == PARABOLA:
        skew = (r1 - r2) / (r * between + r1 + r2)
        resistance = r * (1.0 / 12.0) + 0.25 * (r1 + r2 - (r1 - r2) * skew)
        return Exchange(kind, r, walls, 1.0 / resistance, 0.5 * (w1 + w2) - 0.5 * skew * (w1 - w2))
    if kind == INSULATED:
        conductance = 1.0 / (r * (1.0 / 12.0) + 0.5 * (r2 if w1 < w2 else r1))
        return Exchange(kind, r, walls, conductance, 0.5 * (w1 + w2))
    g1, g2 = 1.0 / (r / 6.0 + r1), 1.0 / (r / 6.0 + r2)
    return Exchange(kind, r, walls, g1 + g2, (g1 * w1 + g2 * w2) / (g1 + g2))


@inlined
def fluxes(t: float, exchange: Exchange) -> tuple[float, float, float]:
    """Heat fluxes into both surfaces from a film at t [K], and the derivative of their sum by r."""
    r, (w1, w2, r1, r2, between) = exchange.r, exchange.walls
    flow = (t - exchange.balanced) * exchange.conductance
    if exchange.kind == PARABOLA:
        over_total = 1.0 / (r * between + r1 + r2)
        skew = (r1 - r2) * over_total
        more = -2.0 * (w1 - w2) * over_total - skew * flow
        by_r = 0.5 * between * skew * (w1 - w2) * over_total
        by_r = -(by_r + flow * (1.0 / 12.0 + 0.25 * between * skew * skew)) * exchange.conductance
        return 0.5 * (flow + more), 0.5 * (flow - more), by_r
    if exchange.kind == INSULATED:
        first = 0.0 if w1 < w2 else flow
        return first, flow - first, -flow * exchange.conductance / 12.0
    g1, g2 = 1.0 / (r / 6.0 + r1), 1.0 / (r / 6.0 + r2)
    q1, q2 = g1 * (t - w1), g2 * (t - w2)
    return q1, q2, -(g1 * q1 + g2 * q2) / 6.0


@inlined
def split(t: float, beta: float, exchange: Exchange) -> float:
    """Half the difference of the walls' temperatures, times beta."""
    walls, (q1, q2, _) = exchange.walls, fluxes(t, exchange)
    d = 0.5 * beta * (walls[0] + walls[2] * q1 - walls[1] - walls[3] * q2)
    return min(max(d, -MAX_SPLIT), MAX_SPLIT)


@inlined
def holds(q1: float, q2: float, t: float, exchange: Exchange) -> bool:
    """Whether the law is that of the film: the next one is for oil that is colder still."""
    w1, w2 = exchange.walls[0], exchange.walls[1]
    if exchange.kind == PARABOLA:
        return (q1 if w1 < w2 else q2) >= -NO_FLUX * exchange.conductance
    return exchange.kind == APART or t >= min(w1, w2)
