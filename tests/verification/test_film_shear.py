"""Shear stress with the temperature resolved: against a boundary value problem across the film."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import pytest
from support.film_stress import FilmStress, film_stress

from ehlpetsc.effects.heat import film_shear
from ehlpetsc.physics.oil.rheology import CARREAU, EYRING, NEWTON, FlowLaw

N = 80
BETA, CONDUCTIVITY, FILM = 0.04, 0.14, 0.3e-6
LAWS = {"newton": FlowLaw(NEWTON), "eyring": FlowLaw(EYRING, 5e6)}
LAWS["carreau"] = FlowLaw(CARREAU, 6e6, 0.45, 2.0)


def chebyshev() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points from 1 to -1, matrix of differentiation and weights of the mean (Trefethen 2000)."""
    angle = np.pi * np.arange(N + 1) / N
    x = np.cos(angle)
    c = (-1.0) ** np.arange(N + 1)
    c[[0, -1]] *= 2.0
    D = np.outer(c, 1.0 / c) / (x[:, None] - x[None, :] + np.eye(N + 1))
    D -= np.diag(D.sum(axis=1))
    modes = np.cos(np.outer(np.arange(N + 1), angle))
    moments = np.array([0.0 if k % 2 else 1.0 / (1.0 - k * k) for k in range(N + 1)])
    return x, D, np.linalg.solve(modes, moments)


X, D, MEAN = chebyshev()


class Across(NamedTuple):
    stress: float
    q1: float
    q2: float
    mean: float
    middle: float


def solved_across(
    stress_of: Callable,
    ln_eta: Callable,
    sliding: float,
    walls: tuple[float, float],
    start: tuple[float, np.ndarray],
) -> Across:
    """Newton's method for T(z) and the stress of k T'' = -tau (shear rate), sliding given.

    `stress_of` is the logarithm of the shear rate times viscosity by stress, with its derivative.
    """
    scale = 4.0 * CONDUCTIVITY / FILM**2
    ln_tau, T = np.log(start[0]), start[1].copy()
    for _ in range(200):
        tau = np.exp(ln_tau)
        viscous, by_tau = stress_of(tau)
        value, slope = ln_eta(T)
        rate = viscous * np.exp(-value)
        moved = (MEAN @ rate) * FILM / sliding
        residual = np.append(scale * (D @ (D @ T)) + tau * rate, np.log(moved))
        J = np.zeros((N + 2, N + 2))
        J[:-1, :-1] = scale * (D @ D) - np.diag(tau * rate * slope)
        J[:-1, -1] = tau * (rate + tau * by_tau * np.exp(-value))
        J[-1, :-1] = -MEAN * rate * slope * FILM / (sliding * moved)
        J[-1, -1] = (MEAN @ (by_tau * np.exp(-value))) * tau * FILM / (sliding * moved)
        for row, node, wall in ((0, 0, walls[0]), (N, N, walls[1])):
            J[row], residual[row] = 0.0, T[node] - wall
            J[row, node] = 1.0
        step = np.linalg.solve(J, -residual)
        damping = min(1.0, 10.0 / np.abs(step[:-1]).max(), 0.5 / abs(step[-1]))
        T += damping * step[:-1]
        ln_tau += damping * step[-1]
        if damping == 1.0 and abs(step[-1]) < 1e-10:
            slope = -2.0 * CONDUCTIVITY / FILM * (D @ T)
            return Across(np.exp(ln_tau), slope[0], -slope[-1], MEAN @ T, T[N // 2])
    raise AssertionError("no convergence across the film")


def viscous_stress(flow: FlowLaw, limit: float = np.inf) -> Callable:
    """eta times shear rate by stress, the law inverted by bisection, with its derivative."""

    def inverse(tau: float) -> tuple[float, float]:
        low, high = -60.0, 60.0
        for _ in range(80):
            x = 0.5 * (low + high)
            low, high = (low, x) if film_shear.flow_stress(x, flow, limit)[0] > tau else (x, high)
        viscous = flow.stress * np.exp(x)
        return viscous, viscous / film_shear.flow_stress(x, flow, limit)[1]

    return inverse


def exponential(T: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return -BETA * T, np.full(T.shape, -BETA)


def start_of(
    closed: FilmStress, walls: tuple[float, float] = (0.0, 0.0), beta: float = BETA
) -> tuple[float, np.ndarray]:
    y, tilt = float(closed.y), 0.25 * beta * (walls[0] - walls[1])
    shape = np.exp(-tilt) * np.sinh(0.5 * y * (1.0 + X)) + np.exp(tilt) * np.sinh(0.5 * y * (1.0 - X))
    return 0.9999 * float(closed.stress), -2.0 / beta * np.log(shape / np.sinh(y))


@pytest.mark.parametrize("y", [0.05, 0.099, 0.5, 4.0])
def test_derivatives_of_shear_rate_and_heating(y):
    """Against the complex step, on both sides of the border of the series."""
    across, d = getattr(film_shear.across, "py_func", film_shear.across), 0.5 * y
    _, by_y, _, heating_by_y, heating_by_d = across(y, d)
    stepped = [np.imag(across(*at)) / 1e-30 for at in ((y + 1e-30j, d), (y, d + 1e-30j))]
    found = stepped[0][0], stepped[0][2], stepped[1][2]
    assert found == pytest.approx((by_y, heating_by_y, heating_by_d), rel=1e-11)


@pytest.mark.parametrize("difference", [0.0, -50.0])
@pytest.mark.parametrize("limited", [False, True])
@pytest.mark.parametrize("name", LAWS)
def test_closed_form_is_the_solution_across_the_film(name, limited, difference):
    flow, walls = LAWS[name], (0.5 * difference, -0.5 * difference)
    for eta, sliding in ((0.5, 1.0), (0.5, 25.0), (50.0, 5.0)):
        given = FILM, eta, BETA, *walls, CONDUCTIVITY, sliding, flow
        limit = 1.3 * float(film_stress(*given).stress) if limited else np.inf
        closed = film_stress(*given, limit)

        def ln_eta(T, eta=eta):
            value, slope = exponential(T)
            return value + np.log(eta), slope

        exact = solved_across(viscous_stress(flow, limit), ln_eta, sliding, walls, start_of(closed, walls))
        assert float(closed.stress) == pytest.approx(exact.stress, rel=1e-8)
        assert float(closed.q1) == pytest.approx(exact.q1, rel=1e-7)
        assert float(closed.q2) == pytest.approx(exact.q2, rel=1e-7)
        assert float(closed.middle) == pytest.approx(exact.middle, rel=1e-7)
        assert float(closed.mean) == pytest.approx(exact.mean, rel=3e-3 if difference else 1e-7)


def test_sum_of_fluxes_is_the_heat_of_shear():
    sliding = np.geomspace(1e-3, 100.0, 30)
    closed = film_stress(FILM, 5.0, BETA, 340.0, 300.0, CONDUCTIVITY, sliding, LAWS["eyring"], 20e6)
    rounding = 1e-14 * CONDUCTIVITY * 40.0 / FILM
    np.testing.assert_allclose(closed.q1 + closed.q2, closed.stress * sliding, rtol=1e-13, atol=rounding)


@pytest.mark.parametrize("limit", [np.inf, 9e6])
@pytest.mark.parametrize("name", LAWS)
def test_derivatives_by_complex_step(name, limit, uncompiled):
    step = 1e-30
    for eta, sliding, t1 in ((0.5, 1.0, 0.0), (5.0, 10.0, 15.0), (500.0, 5.0, -40.0)):
        given = {"h": FILM, "eta": eta, "beta": BETA, "t1": t1, "t2": 0.0}

        def stress(changes, given=given, sliding=sliding):
            arguments = {**given, **changes}
            return film_stress(
                **arguments, conductivity=CONDUCTIVITY, sliding=sliding, flow=LAWS[name], limit=limit
            )

        closed = stress({})
        size = 1j * step
        expected = {
            "by_ln_eta": {"eta": eta * (1.0 + size)},
            "by_ln_h": {"h": FILM * (1.0 + size)},
            "by_beta": {"beta": BETA + size},
            "by_t1": {"t1": t1 + size, "eta": eta * (1.0 - 0.5 * BETA * size)},
            "by_t2": {"t2": size, "eta": eta * (1.0 - 0.5 * BETA * size)},
        }
        for key, changes in expected.items():
            moved = stress(changes)
            slope = float(moved.stress.imag) / step
            assert float(getattr(closed, key)) == pytest.approx(slope, rel=1e-9), key
            assert float(moved.stress.real) == pytest.approx(float(closed.stress), rel=1e-12)


@pytest.mark.parametrize("name", LAWS)
def test_solution_over_24_orders_of_magnitude(name):
    """The equation holds, and the stress grows with the viscosity, whatever the heating."""
    flow = LAWS[name]._replace(stress=1.0)
    exponents = np.linspace(-12.0, 12.0, 49)
    for heating in 10.0 ** exponents[::4]:
        for d in (0.0, 2.0):
            stresses = []
            for x in exponents * np.log(10.0):
                y, tau, by_x, *_ = film_shear.resolved_stress(0.0, x, heating, d, flow, np.inf)
                assert 0.0 < by_x <= tau * (1.0 + 1e-12)
                value, by_y = film_shear.across(y, d)[2:4]
                assert abs(value - heating * tau) <= 1e-10 * (value + y * by_y)
                stresses.append(tau)
            assert np.all(np.diff(stresses) > 0.0)


@pytest.mark.parametrize("flow, error", [(LAWS["eyring"], 0.01), (LAWS["newton"], 0.03)])
def test_secant_of_roelands_law_to_the_middle_of_the_film(flow, error):
    wall, reference = 333.0, 333.0
    for pressure in (0.5e9, 1e9):
        power = (np.log(0.03) + 9.67) * (1.0 + pressure / 1.96e8) ** (20e-9 * 1.96e8 / (np.log(0.03) + 9.67))

        def ln_eta(T, power=power):
            theta = ((T + wall - 138.0) / (reference - 138.0)) ** -1.1
            return power * theta - 9.67, -1.1 * power * theta / (T + wall - 138.0)

        for sliding in (0.5, 2.0, 10.0):
            at_wall, slope = (float(value) for value in ln_eta(np.float64(0.0)))
            secant = -slope
            for _ in range(100):
                closed = film_stress(FILM, np.exp(at_wall), secant, 0.0, 0.0, CONDUCTIVITY, sliding, flow)
                middle = float(closed.middle)
                secant = 0.5 * (secant + (at_wall - float(ln_eta(middle)[0])) / middle)
            start = start_of(closed, beta=secant)
            exact = solved_across(viscous_stress(flow), ln_eta, sliding, (0.0, 0.0), start)
            assert float(closed.stress) == pytest.approx(exact.stress, rel=error)
            tangent = film_stress(FILM, np.exp(at_wall), -slope, 0.0, 0.0, CONDUCTIVITY, sliding, flow)
            if middle > 60.0:
                assert float(tangent.stress) < 0.88 * exact.stress
