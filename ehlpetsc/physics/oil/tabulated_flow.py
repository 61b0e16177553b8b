r"""Pressure flow of a sheared film by a table, for shear laws without a closed form, and the stress with it.

The flow of an isothermal film depends on its sliding speed and its pressure gradient alone: a table over both
is computed once for the constants of a law, of the flow along the sliding by :func:`flow_table`, across it by
:func:`cross_flow_table`.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from ehlpetsc.base.compiled import compiled, inlined, unsigned
from ehlpetsc.physics.oil.rheology import CARREAU, EYRING, MAX_SERIES_STRESS, NEWTON, FlowLaw, flow_stress

MIN_RATE = 1e-30  # shear rate and stress difference of a film at rest, over those of its law
NO_FLOW = 0.0, 0.0, 0.0, 0.0
TABLE_STEPS = 0.25, 0.1  # of ln(Gamma) and ln(s), over the width of the bend in Carreau's law
CROSS_STEPS = 0.5, 0.1  # the same of the flow across
RANGE = 14.0  # of both: exp(-14) is the error of the asymptotes beyond
NEWTONIAN = 1e-8  # accuracy to which it is below some Gamma and s
FLAT = (
    1e-5,
    1e-4,
)  # mean stress over the stress difference, and over the law's, below which the flow is linear
SHALLOW = 1e-4  # stress difference across the film over the law's stress, below which there is none
_Z, _WEIGHTS = (0.5 * half for half in np.polynomial.legendre.leggauss(20))
_Z += 0.5  # on either side of the lowest stress, squared: dense there


@inlined
def rate_of_stress(t: float, law: FlowLaw) -> tuple[float, float]:
    """Shear rate times viscosity by the stress, both over that of the law, and its derivative."""
    size = abs(t)
    if size < 1e-8:
        return t, 1.0
    if law.kind == EYRING:
        return np.sinh(t), np.cosh(t)
    n, a = law.n, law.a
    ln_t, power = np.log(size), (n - 1.0) / a
    x = ln_t if size < 1.0 or law.kind != CARREAU else ln_t / n
    slope = 1.0
    for _ in range(50):
        if law.kind == CARREAU:
            e = np.exp(-a * abs(x))
            thinned = e / (1.0 + e) if x < 0.0 else 1.0 / (1.0 + e)
            slope = 1.0 + (n - 1.0) * thinned
            change = (ln_t - x - power * (max(a * x, 0.0) + np.log(1.0 + e))) / slope
        else:
            tau, by_x, _ = flow_stress(x, law, np.inf)
            slope = by_x / tau
            change = (ln_t - np.log(tau)) / slope
        x += change
        if abs(change) < 1e-10:
            break
    rate = np.exp(x)
    return (rate if t > 0.0 else -rate), rate / (size * slope)


@compiled
def flow_across(gamma: float, drop: float, law: FlowLaw) -> tuple[float, float]:
    r"""Mobility and mean stress of a film, isothermal across it, by Gauss points.

    :math:`\Phi=12\eta M/h^3=(12/s)\int z\,\dot\gamma(t+zs)\,dz` and t by :math:`\int\dot\gamma\,dz=\Gamma`.

    Parameters
    ----------
    gamma, drop
        :math:`\Gamma=\eta|u_1-u_2|/(h\tau_s)` and :math:`s=hp_x/\tau_s`, not negative.
    law
        With a stress :math:`\tau_s` of 1.
    """
    steep = max(drop, SHALLOW)
    low, high = 0.0, gamma + 1e-300  # the mean stress is below the viscous one, and its rate convex
    t = min(gamma, gamma**law.n) if law.kind == CARREAU else flow_stress(np.log(high), law, np.inf)[0]
    moment = 0.0
    for _ in range(200):
        mean, slope, moment = 0.0, 0.0, 0.0
        lowest = max(-t / steep, -0.5)
        for length in (0.5 - lowest, -0.5 - lowest):
            for k in range(len(_Z)):
                z, weight = lowest + length * _Z[k] * _Z[k], 2.0 * abs(length) * _Z[k] * _WEIGHTS[k]
                rate, by_t = rate_of_stress(t + z * steep, law)
                mean += weight * rate
                slope += weight * by_t
                moment += weight * z * rate
        if t < min(FLAT[0] * steep, FLAT[1]):  # odd in t; of rates of both signs the sum has lost its digits
            mean = slope * t
        low, high = (t, high) if mean < gamma else (low, t)
        new = t + (gamma - mean) / slope
        if not low <= new <= high:
            new = 0.5 * (low + high)
        change, t = abs(new - t), new
        if change <= 1e-13 * (t + steep):
            break
    return 12.0 * moment / steep, t


@compiled
def flow_beside_sliding(gamma: float, drop: float, law: FlowLaw) -> float:
    r"""Mobility of the flow across the sliding of a film, isothermal, by Gauss points.

    The stress along the sliding, :math:`\tau`, is uniform, that of the cross flow :math:`zs`, and both rates
    are those of the magnitude of the stress: with :math:`r=\sqrt{\tau^2+z^2s^2}`,

    .. math:: \Phi=12\int\frac{\dot\gamma(r)}{r}z^2\,dz,\qquad \int\frac{\dot\gamma(r)}{r}\tau\,dz=\Gamma.

    Parameters
    ----------
    gamma, drop
        :math:`\Gamma=\eta|u_1-u_2|/(h\tau_s)` and :math:`s=hp_y/\tau_s`, not negative.
    law
        With a stress :math:`\tau_s` of 1.
    """
    low, high = 0.0, gamma  # the mean stress is below the viscous one
    t = flow_stress(np.log(gamma), law, np.inf)[0]
    phi = 0.0
    for _ in range(200):
        mean, slope, phi = 0.0, 0.0, 0.0
        for k in range(len(_Z)):
            z, weight = 0.5 * _Z[k], _WEIGHTS[k]
            r = np.hypot(t, z * drop)
            rate, by_r = rate_of_stress(r, law)
            mean += weight * rate / r * t
            slope += weight * (rate / r + (by_r - rate / r) * (t / r) ** 2)
            phi += weight * rate / r * z * z
        low, high = (t, high) if mean < gamma else (low, t)
        new = t + (gamma - mean) / slope
        if not low <= new <= high:
            new = 0.5 * (low + high)
        change, t = abs(new - t), new
        if change <= 1e-13 * t:
            break
    return 12.0 * phi


@compiled
def _fill_cross_table(law: FlowLaw, x: np.ndarray, ln_drop: np.ndarray, out: np.ndarray) -> None:
    for i in range(len(x)):
        for j in range(len(ln_drop)):
            out[i, j] = np.log(flow_beside_sliding(np.exp(x[i]), np.exp(ln_drop[j]), law))


@compiled
def _fill_table(law: FlowLaw, x: np.ndarray, ln_drop: np.ndarray, out: np.ndarray) -> None:
    for i in range(len(x)):
        for j in range(len(ln_drop)):
            phi, t = flow_across(np.exp(x[i]), np.exp(ln_drop[j]), law)
            if law.kind == CARREAU:
                out[0, i, j], out[1, i, j] = phi, np.log(t) - x[i]
            else:
                out[0, i, j], out[1, i, j] = np.log(phi), x[i] - np.log(rate_of_stress(t, law)[0])


@cache
def flow_table(kind: int, n: float, a: float) -> np.ndarray:
    r"""Table of the pressure flow of a shear law over x = ln(Gamma) and ln(s), empty where it is closed.

    The quantities are :math:`\Phi` and :math:`\ln(t/\Gamma)` of :func:`flow_across`. They do not depend on
    small Gamma and s; beyond large ones, where the law is a power, the logarithms of both at (x, ln s) are
    those at (x - e, ln s - n e) with :math:`\pm(1-n)e`. Cubic between the points, to 1e-4; a = 1: 8e-4.

    Of a user's law the quantities are :math:`\ln\Phi` and :func:`stress_spread`, which is equal at both
    places; n is the power at the end of the table.

    Returns
    -------
    ndarray, shape (2 * intervals of x + 1, intervals of ln s, 16)
        Coefficients of :math:`u^av^b` at 4 b + a in an interval, u and v from 0 to 1, of the first and then
        of the second quantity. The last row begins with n, the first x and ln s, one over both steps, the
        last x and ln s, a (0: of a user's law), and Gamma and s below which the film is Newtonian.
    """
    if kind <= EYRING:
        return np.zeros((0, 0, 16))
    law, sharpness = FlowLaw(kind, 1.0, n, a), a if kind == CARREAU else 1.0
    bend = max(sharpness, 2.0) / 2.0
    step_x, step = TABLE_STEPS[0] / bend, TABLE_STEPS[1] / bend
    if kind == CARREAU:
        last = RANGE / min(a, 2.0)
        x, ln_drop = np.arange(-last, last, step_x), np.arange(-last, n * last + 1.0, step)
    else:
        x = np.arange(-RANGE, 2.0 * RANGE, step_x)  # at its end the power of Eyring's law changes slowly
        tau, by_x, _ = flow_stress(x[-1], law, np.inf)
        ln_drop = np.arange(-0.5 * RANGE, min(np.log(tau), 0.5 * RANGE) + 1.0, step)
        n, a = by_x / tau, 0.0
    values = np.empty((2, len(x), len(ln_drop)))
    _fill_table(law, x, ln_drop, values)
    return _table(values, (x, ln_drop), n, a, NEWTONIAN ** (1.0 / sharpness))


def _table(
    values: np.ndarray, points: tuple[np.ndarray, np.ndarray], n: float, a: float, newtonian: float
) -> np.ndarray:
    """Table as of :func:`flow_table` of quantities, shape (quantities, x, ln s), at equidistant points."""
    from scipy.interpolate import CubicSpline

    u, v = (np.arange(len(along), dtype=float) for along in points)
    table = np.zeros((len(values) * (len(u) - 1) + 1, len(v) - 1, 16))
    for value, rows in zip(values, np.split(table[:-1], len(values)), strict=True):
        coefficients = CubicSpline(v, CubicSpline(u, value).c, axis=2).c  # falling powers of v, u
        rows[:] = coefficients[::-1, :, ::-1].transpose(3, 1, 0, 2).reshape(rows.shape)
    (x, ln_drop), steps = points, (along[1] - along[0] for along in points)
    ends = x[0], ln_drop[0], *(1.0 / step for step in steps), x[-1], ln_drop[-1]
    constants = n, *ends, a, newtonian
    table[-1, 0, : len(constants)] = constants
    return table


@cache
def cross_flow_table(kind: int, n: float, a: float) -> np.ndarray:
    r"""Table of the flow across the sliding, as :func:`flow_table` of a user's law; empty of Newton's.

    Its one quantity is :math:`\ln\Phi` of :func:`flow_beside_sliding`, to 1e-4 up to its last s; beyond it
    grows as the law does at its end.
    """
    if kind == NEWTON:
        return np.zeros((0, 0, 16))
    sharpness = a if kind == CARREAU else 2.0
    bend = max(sharpness, 2.0) / 2.0
    first, last = -RANGE / min(sharpness, 2.0), RANGE / min(a, 2.0) if kind == CARREAU else 2.0 * RANGE
    x = np.arange(first, last, CROSS_STEPS[0] / bend)
    law = FlowLaw(kind, 1.0, n, a)
    tau, by_x, _ = flow_stress(x[-1], law, np.inf)
    steepest = n * last + 1.0 if kind == CARREAU else min(np.log(tau), 0.5 * RANGE) + 1.0
    ln_drop = np.arange(first, steepest, CROSS_STEPS[1] / bend)
    values = np.empty((1, len(x), len(ln_drop)))
    _fill_cross_table(law, x, ln_drop, values[0])
    return _table(values, (x, ln_drop), by_x / tau, 0.0, NEWTONIAN ** (1.0 / sharpness))


@inlined
def _place(x: float, ln_drop: float, table: np.ndarray) -> tuple:
    """Interval of (x, ln s) in :func:`flow_table`, position in it, and the distance e beyond the table."""
    last = unsigned(table.shape[0] - 1)  # numbers, not views of the row, which would be counted
    n = table[last, 0, 0]
    beyond = max(max(x - table[last, 0, 5], (ln_drop - table[last, 0, 6]) / n), 0.0)
    u = max((x - beyond - table[last, 0, 1]) * table[last, 0, 3], 0.0)
    v = max((ln_drop - n * beyond - table[last, 0, 2]) * table[last, 0, 4], 0.0)
    i, j = (
        unsigned(min(u, (table[last, 0, 5] - table[last, 0, 1]) * table[last, 0, 3] - 0.5)),
        unsigned(min(v, table.shape[1] - 0.5)),
    )
    return i, j, u - i, v - j, beyond


@inlined
def _cubic_in_x(i: int, j: int, v: float, c: np.ndarray) -> tuple:
    """Coefficients of a cubic in u at one v, and their derivatives by v."""
    p0 = c[i, j, 0] + v * (c[i, j, 4] + v * (c[i, j, 8] + v * c[i, j, 12]))
    p1 = c[i, j, 1] + v * (c[i, j, 5] + v * (c[i, j, 9] + v * c[i, j, 13]))
    p2 = c[i, j, 2] + v * (c[i, j, 6] + v * (c[i, j, 10] + v * c[i, j, 14]))
    p3 = c[i, j, 3] + v * (c[i, j, 7] + v * (c[i, j, 11] + v * c[i, j, 15]))
    d0 = c[i, j, 4] + v * (2.0 * c[i, j, 8] + 3.0 * v * c[i, j, 12])
    d1 = c[i, j, 5] + v * (2.0 * c[i, j, 9] + 3.0 * v * c[i, j, 13])
    d2 = c[i, j, 6] + v * (2.0 * c[i, j, 10] + 3.0 * v * c[i, j, 14])
    d3 = c[i, j, 7] + v * (2.0 * c[i, j, 11] + 3.0 * v * c[i, j, 15])
    return (p0, p1, p2, p3), (d0, d1, d2, d3)


@inlined
def tabulated_mobilities(
    h: float,
    gradient: float,
    fluidity_l: float,
    fluidity_r: float,
    stress: float,
    slip: float,
    table: np.ndarray,
) -> tuple[tuple, tuple]:
    """Mobilities as of :func:`.rheology.mobilities`, for a law with a table by :func:`flow_table`."""
    if h <= 0.0:
        return NO_FLOW, NO_FLOW
    last, over_h, cube = unsigned(table.shape[0] - 1), 1.0 / h, h * h * h / 12.0
    drop, rate = h * abs(gradient) / stress, slip * over_h
    if max(drop, rate / min(fluidity_l, fluidity_r)) < table[last, 0, 8]:
        left, right = cube * fluidity_l, cube * fluidity_r
        return (left, 3.0 * left * over_h, 0.0, -left), (right, 3.0 * right * over_h, 0.0, -right)
    ln_drop = np.log(max(drop, MIN_RATE))
    at_l = _place(np.log(max(rate / fluidity_l, MIN_RATE)), ln_drop, table)
    at_r = _place(np.log(max(rate / fluidity_r, MIN_RATE)), ln_drop, table)
    cubic_l = _cubic_in_x(at_l[0], at_l[1], at_l[3], table)
    cubic_r = _cubic_in_x(at_r[0], at_r[1], at_r[3], table)
    over_gradient = 1.0 / gradient if gradient != 0.0 else 0.0
    steps = table[last, 0, 3], table[last, 0, 4]
    face = over_h, over_gradient, cube, table[last, 0, 0], *steps, table[last, 0, 7] == 0.0
    return (
        _tabulated_mobility(fluidity_l, at_l, cubic_l, face),
        _tabulated_mobility(fluidity_r, at_r, cubic_r, face),
    )


@inlined
def _tabulated_mobility(
    fluidity: float, at: tuple, cubic: tuple, face: tuple
) -> tuple[float, float, float, float]:
    """One of :func:`.rheology.mobilities`."""
    over_h, over_gradient, cube, n, per_x, per_v, is_logarithm = face
    u, beyond, (p, d) = at[2], at[4], cubic
    unit = cube * fluidity
    if beyond > 0.0:
        unit *= np.exp((1.0 - n) * beyond)
    value, by_u, by_v = _cubic(u, p), p[1] + u * (2.0 * p[2] + 3.0 * u * p[3]), _cubic(u, d)
    if is_logarithm:
        value = np.exp(value)
        by_u, by_v = value * by_u, value * by_v
    mobility, by_drop, by_x = unit * value, unit * per_v * by_v, unit * per_x * by_u
    return mobility, over_h * (3.0 * mobility - by_x + by_drop), by_drop * over_gradient, by_x - mobility


@inlined
def _cubic(u: float, p: tuple) -> float:
    return p[0] + u * (p[1] + u * (p[2] + u * p[3]))


@inlined
def stress_spread(sigma: float, x: float, table: np.ndarray) -> float:
    r"""Decrease of x = :math:`\ln(\eta\dot\gamma/\tau_s)` that gives the mean stress with a gradient.

    :math:`\Sigma=h|p_x|/(2\tau_s)`; :math:`\ln(\sinh\Sigma/\Sigma)` of Eyring's law, so that neither a huge
    viscosity nor a steep gradient overflows.
    """
    if len(table) > 0:
        i, j, u, v, beyond = _place(x, np.log(max(2.0 * sigma, MIN_RATE)), table)
        p, _ = _cubic_in_x(unsigned(table.shape[0] // 2) + i, j, v, table)
        n, a = table[-1, 0, 0], table[-1, 0, 7]
        if a == 0.0:
            return _cubic(u, p)
        lower = _cubic(u, p) - (1.0 - n) * beyond
        return x - np.log(rate_of_stress(np.exp(x + lower), FlowLaw(CARREAU, 1.0, n, a))[0])
    if sigma < MAX_SERIES_STRESS:
        square = sigma * sigma
        return square * (1 / 6 - square * (1 / 180 - square / 2835))
    return sigma + np.log(0.5 * (1.0 - np.exp(-2.0 * sigma)) / sigma)
