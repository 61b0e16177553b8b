r"""Heat fluxes from the film into both surfaces, by the film's mean temperature T.

A parabola across the film gives

.. math:: q_{1,2}=\frac{k_f}{h}\Big[6(T-T_w)\pm(T_2-T_1)\Big],\qquad T_w=(T_1+T_2)/2.

Oil that enters cold between surfaces far apart in temperature has no parabola: the law would cool the colder
surface by oil that is warmer than it. Where it does, the sum of both fluxes stays and the colder surface has
none; where the oil is colder than both surfaces, each gives heat by its own difference,
:math:`q_i=6(k_f/h)(T-T_i)`, with the same sum. All three agree where they meet.

With the responses :math:`T_i=W_i+R_iq_i` and :math:`r=h/k_f` the sum is :math:`(T-\alpha)/\kappa`, for the
parabola with

.. math:: \kappa=\frac r{12}+\frac14\Big[R_1+R_2-\frac{(R_1-R_2)^2}{r+R_1+R_2}\Big],\qquad
   \alpha=\frac{W_1+W_2}2-\frac{(R_1-R_2)(W_1-W_2)}{2(r+R_1+R_2)},

regular at r = 0.
"""

from ehlpetsc.compiled import inlined

PARABOLA, INSULATED, APART = 0, 1, 2  # the three cases, in the order in which the oil gets colder
NO_FLUX = 1e-9  # K: difference of temperature whose heat flux is rounding


@inlined
def exchange_law(kind, r, walls):
    """Flux into both surfaces per temperature [W/(m^2 K)], and the temperature without flux [K]."""
    w1, w2, r1, r2 = walls
    if kind == PARABOLA:
        skew = (r1 - r2) / (r + r1 + r2)
        resistance = r * (1.0 / 12.0) + 0.25 * (r1 + r2 - (r1 - r2) * skew)
        return 1.0 / resistance, 0.5 * (w1 + w2) - 0.5 * skew * (w1 - w2)
    if kind == INSULATED:
        return 1.0 / (r * (1.0 / 12.0) + 0.5 * (r2 if w1 < w2 else r1)), 0.5 * (w1 + w2)
    g1, g2 = 1.0 / (r / 6.0 + r1), 1.0 / (r / 6.0 + r2)
    return g1 + g2, (g1 * w1 + g2 * w2) / (g1 + g2)


@inlined
def fluxes(kind, t, r, walls, exchange, alpha):
    """Heat fluxes into both surfaces, and the derivative of their sum with respect to r."""
    w1, w2, r1, r2 = walls
    flow = (t - alpha) * exchange
    if kind == PARABOLA:
        over_total = 1.0 / (r + r1 + r2)
        skew = (r1 - r2) * over_total
        between = -2.0 * (w1 - w2) * over_total - skew * flow
        by_r = -(0.5 * skew * (w1 - w2) * over_total + flow * (1.0 / 12.0 + 0.25 * skew * skew)) * exchange
        return 0.5 * (flow + between), 0.5 * (flow - between), by_r
    if kind == INSULATED:
        first = 0.0 if w1 < w2 else flow
        return first, flow - first, -flow * exchange / 12.0
    g1, g2 = 1.0 / (r / 6.0 + r1), 1.0 / (r / 6.0 + r2)
    q1, q2 = g1 * (t - w1), g2 * (t - w2)
    return q1, q2, -(g1 * q1 + g2 * q2) / 6.0
