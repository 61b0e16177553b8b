"""Stresses against closed forms and direct integration; loads between nodes, of ripples and steep peaks."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.interpolate import CubicHermiteSpline, CubicSpline

from ehlpetsc.post import stress, von_mises
from ehlpetsc.post.stresses import body_stress
from ehlpetsc.post.stresses.body_stress import BodyStress, hermite_spectra, limited_slopes, offset_weights
from ehlpetsc.post.stresses.half_plane import hat, padded_length, point_kernels


def hertz(per_width, traction=0.0, z=0.5):
    x = np.arange(-2 * per_width, 2 * per_width + 1) / per_width
    p = np.sqrt(np.clip(1 - x * x, 0, None))
    return x, stress(x, z, p, traction * p, 0.3)


def at(x, fields, place):
    return np.array([field[..., np.argmin(np.abs(x - place))] for field in fields])


def integral(x, p, q, place, z):
    """The three stresses by adaptive quadrature of the piecewise-linear load, element by element."""
    total = np.zeros(3)
    for k in range(x.size - 1):

        def value(s, part, k=k):
            a, b, c, e = point_kernels(place - s, z)
            ps, qs = np.interp(s, x[k : k + 2], p[k : k + 2]), np.interp(s, x[k : k + 2], q[k : k + 2])
            return -2 / np.pi * (c * ps + e * qs, a * ps + b * qs, b * ps + c * qs)[part]

        total += [
            quad(value, x[k], x[k + 1], args=(part,), epsabs=1e-14, epsrel=1e-13)[0] for part in range(3)
        ]
    return total


@pytest.mark.parametrize("z", [0.02, 0.1, 1.0, 5.0])
def test_equals_exact_integral_of_the_piecewise_linear_load(z):
    rng = np.random.default_rng(1)
    x = np.linspace(-1.0, 1.0, 41)
    p, q = rng.uniform(0, 1, 41), rng.normal(size=41)  # ends not at zero: jumps
    fields = stress(x, z, p, q, 0.3)
    for node in (0, 7, 20, 40):
        exact = integral(x, p, q, x[node], z)
        assert [field[node] for field in fields] == pytest.approx(exact, abs=1e-10)


def test_far_elements_keep_relative_accuracy():
    """Second differences of the closed form alone lose 1e-9 of a kernel 6,400 elements away."""
    u = np.array([6400.0])
    mean_distance = point_kernels(u, 3.0)[:, 0]
    assert hat(u, 3.0)[:, 0] == pytest.approx(mean_distance, rel=1e-6)

    def value(s):
        return (1 - abs(s)) * (u[0] - s) / ((u[0] - s) ** 2 + 9) ** 2

    exact = 9 * quad(value, -1, 1, points=[0], epsabs=0, epsrel=1e-13)[0]
    assert hat(u, 3.0)[1, 0] == pytest.approx(exact, rel=1e-11)


EXACT = np.array([-0.329715992, -0.841995437, -0.107116594])  # Hertz at (0.3, 0.5)


def orders(errors):
    """Observed orders over halved spacings."""
    return np.log2(np.array(errors[:-1]) / errors[1:])


def test_hertz_values_and_order_of_sampling_at_depth():
    """Order 1.5 at (0.3, 0.5): straight lines between samples cut a load of order h^1.5 off at the edges,
    where the pressure rises with infinite slope, and that is felt at depth.
    """
    dragged = np.array([-0.3405462, -0.8473513, -0.1236024])
    errors = []
    for per_width in (100, 200, 400):
        errors.append(np.abs(at(*hertz(per_width), 0.3) - EXACT).max())
        assert at(*hertz(per_width, 0.05), 0.3) == pytest.approx(dragged, abs=1.2 * errors[-1])
    assert errors[0] < 1.3e-4 and errors[2] < 1.6e-5
    assert orders(errors) == pytest.approx([1.5, 1.5], abs=0.03)
    z = np.array([0.5, 0.7042917, 0.7861514])
    x, (sx, sz, txz) = hertz(400, z=z)
    middle = np.argmin(np.abs(x))
    assert (sx - sz)[2, middle] / 2 == pytest.approx(0.3002831, abs=2e-5)
    assert von_mises(sx, sz, txz, 0.3)[1, middle] == pytest.approx(0.5575162, abs=5e-5)
    assert np.abs(txz[0]).max() == pytest.approx(0.25, abs=2e-5)
    assert abs(x[np.abs(txz[0]).argmax()]) == pytest.approx(np.sqrt(3) / 2, abs=0.0026)


def test_surface_is_the_limit_from_inside():
    x = np.linspace(-2, 2, 401)
    p = np.clip(1 - x * x, 0, None)
    for field in stress(x, [0.0, 1e-9], p, 0.1 * p, 0.3):
        assert field[0] == pytest.approx(field[1], abs=1e-7)
    sx, sz, txz = stress(x, 0.0, p, 0.1 * p, 0.3)
    assert sz == pytest.approx(-p, abs=1e-14) and txz == pytest.approx(-0.1 * p, abs=1e-14)
    only_pressed = stress(x, 0.0, p, None, 0.3)
    assert only_pressed[0] == pytest.approx(-p, abs=1e-14)


def test_no_wrap_around():
    x = np.linspace(0, 10, 256)
    p = np.zeros(256)
    p[1] = 1.0
    short = stress(x, 1.0, p, None, 0.3)
    assert short[1][-1] == pytest.approx(-2 / np.pi / 9.96**4 * (10 / 255), rel=0.05)
    assert (np.abs(short[1][-20:]) < 1e-5).all()
    x = np.linspace(-1, 1, 64)
    p = np.random.default_rng(0).uniform(size=(3, 2, 64))
    whole = stress(x, [0.1, 0.2], p, p, 0.3)
    assert whole[0].shape == (3, 2, 2, 64)
    single = stress(x, 0.2, p[1, 0], p[1, 0], 0.3)
    for many, one in zip(whole, single, strict=True):
        assert many[1, 0, 1] == pytest.approx(one, abs=1e-13)


NODES = np.arange(64.0)
BETWEEN = np.linspace(10, 54, 881)


def between(values):
    """The values between the nodes."""
    slopes = np.empty((1, NODES.size))
    limited_slopes(np.asarray(values, float)[None], slopes)
    return CubicHermiteSpline(NODES, values, slopes[0])(BETWEEN)


@pytest.mark.parametrize("length, error", [(20, 2.6e-5), (10, 4.3e-4), (8, 1.1e-3)])
def test_interpolated_ripples_keep_their_peaks(length, error):
    """Fourth order, wherever the peaks lie between the nodes."""
    worst = 0.0
    for shift in np.linspace(0, 1, 21):
        found = between(np.cos(2 * np.pi * (NODES - shift) / length))
        worst = max(worst, np.abs(found - np.cos(2 * np.pi * (BETWEEN - shift) / length)).max())
    assert worst < error


@pytest.mark.parametrize("peak", [[1], [1, 0.8], [0.4, 1, 0.4], [1, 1, 1], [0.1, 1, 0.9, 0.05]])
def test_steep_peaks_do_not_overshoot(peak):
    """By 1 % at most, where a spline swings to the other side by 2 to 14 %."""
    values = np.zeros(64)
    values[30 : 30 + len(peak)] = peak
    assert between(values).min() > -0.01
    assert CubicSpline(NODES, values)(BETWEEN).min() < -0.02


def test_single_node_and_step_do_not_overshoot():
    one, step = np.zeros(64), np.zeros(64)
    one[30], step[32:] = 1, 1
    for values in (one, step):
        assert (between(values).min(), between(values).max()) == (0, 1)
    assert CubicSpline(NODES, one)(BETWEEN).min() == pytest.approx(-0.136, abs=0.001)


@pytest.mark.parametrize("depth", [0.3, 2.0, 12.0])
def test_kernels_equal_direct_integration(depth):
    nx, offset = 80, 0.3
    kernels = np.fft.irfft(hermite_spectra(nx, depth, offset), padded_length(nx))
    shapes = (lambda t: (1 - abs(t)) ** 2 * (1 + 2 * abs(t)), lambda t: t * (1 - abs(t)) ** 2)
    for distance in (-60, -2, 0, 1, 23, 25, 70):
        for part in range(8):

            def value(t, part=part, distance=distance):
                return shapes[part // 4](t) * point_kernels(np.array(distance + offset - t), depth)[part % 4]

            exact = quad(value, -1, 1, points=[0], epsabs=1e-12, epsrel=1e-12)[0]
            assert -np.pi / 2 * kernels[part, distance] == pytest.approx(exact, abs=1.2e-4)


@pytest.mark.parametrize("depth, kept", [(12.0, 0.75), (20.0, 0.55), (200.0, 0.2)])
def test_ripples_omitted_at_depth_are_negligible(monkeypatch, depth, kept):
    x = np.linspace(-2.5, 1.5, 801)
    rough = 1 + 0.2 * np.random.default_rng(1).normal(size=(2, x.size))
    p = np.sqrt(np.clip(1 - x * x, 0, None)) * rough
    weights = offset_weights(np.array([0.0, 0.3]))
    monkeypatch.setattr(body_stress, "kernel_table", body_stress.kernel_table.__wrapped__)  # keeps nothing
    found = []
    for share in (body_stress.low_pass, lambda wave_number, depth: np.ones(wave_number.size)):
        monkeypatch.setattr(body_stress, "low_pass", share)
        body = BodyStress(x.size, np.array([depth]))
        found.append((body.tables[0].size, body(0, body.transform(p, 0.1 * p), weights)[..., : x.size]))
    assert found[0][0] < kept * found[1][0]
    assert np.abs(found[0][1] - found[1][1]).max() < 1e-9
