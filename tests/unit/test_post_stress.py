"""Stresses of lines and planes against closed forms and integration; loads between nodes and steep."""

from itertools import product

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.interpolate import CubicHermiteSpline, CubicSpline
from scipy.special import erfc

from ehlpetsc.post import stress, stress_plane, von_mises
from ehlpetsc.post.stresses import body_stress
from ehlpetsc.post.stresses.body_stress import BodyStress, hermite_spectra, limited_slopes, offset_weights
from ehlpetsc.post.stresses.half_plane import hat, padded_length, point_kernels
from ehlpetsc.post.stresses.half_space import hat_kernels


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


def test_hertz_values_extremes_and_order_of_sampling_at_depth():
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


def test_shapes_and_no_wrap_around_of_lines():
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


NU = 0.3


def point_loads(x, y, z):
    """Stresses (2, 6, ...) of unit point loads along z and along x (Johnson (3.19), (3.76))."""
    r, free = np.sqrt(x * x + y * y + z * z), 1 - 2 * NU
    plane, s = x * x + y * y, r + z

    def bent(u, v):
        return free / plane * ((1 - z / r) * (u * u - v * v) / plane + z * v * v / r**3)

    def pulled(u, constant):
        return free * (
            x / r**3 - constant * x / (r * s * s) + x * u * u * (1 / (r**3 * s * s) + 2 / (r * r * s**3))
        )

    twisted = free * y * (-1 / (r * s * s) + x * x * (1 / (r**3 * s * s) + 2 / (r * r * s**3)))
    shear = free / plane * (2 * (1 - z / r) * x * y / plane - x * y * z / r**3)
    five = -3 / r**5
    pressed = [
        bent(x, y) + five * z * x * x,
        bent(y, x) + five * z * y * y,
        five * z**3,
        shear + five * x * y * z,
        five * y * z * z,
        five * x * z * z,
    ]
    dragged = [
        pulled(x, 3) + five * x**3,
        pulled(y, 1) + five * x * y * y,
        five * x * z * z,
        twisted + five * x * x * y,
        five * x * y * z,
        five * x * x * z,
    ]
    return np.array([pressed, dragged]) / (2 * np.pi)


@pytest.mark.parametrize(
    "x, y, z", [(0.0, 0.0, 1.0), (1.0, 3.0, 0.7), (-3.0, 1.5, 2.0), (5.0, -6.0, 0.3), (60.0, -90.0, 4.0)]
)
def test_kernels_equal_the_integral_of_point_loads(x, y, z):
    width, (nodes, weights) = 1.5, np.polynomial.legendre.leggauss(30)
    exact = 0
    for along, across in product((-1, 0), repeat=2):
        s, t = (nodes + 1) / 2 + along, (nodes + 1) / 2 + across
        u, v = np.meshgrid(x - s, y - width * t)
        exact += point_loads(u, v, z) @ (weights / 2 * (1 - abs(s))) @ (weights * width / 2 * (1 - abs(t)))
    found = hat_kernels(x + np.arange(-1.0, 2.0), y + width * np.arange(-1.0, 2.0), z, NU)[:, :, 1, 1]
    assert found == pytest.approx(exact, abs=1e-11)


def sphere(per_radius, extent=1.5):
    x = np.arange(-extent * per_radius, extent * per_radius + 0.5) / per_radius
    return x, np.sqrt(np.clip(1 - x * x - x[:, None] ** 2, 0, None))


def test_stresses_on_the_axis_of_a_pressed_and_of_a_sliding_sphere():
    """Johnson (3.45): 1e-3 of p0 asked for, 3e-4 found with 40 nodes a radius."""
    x, p = sphere(40)
    z = np.array([0.0, 0.05, 0.2, 0.48, 1.0, 2.0])
    fields = stress_plane(x, x, z, p, None, NU)
    middle = x.size // 2
    along = -(1 + NU) * (1 - z * np.arctan2(1, z)) + 0.5 / (1 + z * z)
    for field, exact in ((fields.sx, along), (fields.sy, along), (fields.sz, -1 / (1 + z * z))):
        assert field[:, middle, middle] == pytest.approx(exact, abs=3e-4)
    x, p = sphere(40)
    z = np.array([0.0, 0.05, 0.3, 1.0])
    fields = stress_plane(x, x, z, np.zeros_like(p), p, NU)
    middle = x.size // 2
    exact = -1 + 1.5 * z * np.arctan2(1, z) - z * z / (2 * (1 + z * z))
    assert fields.txz[:, middle, middle] == pytest.approx(exact, abs=3e-4)


def test_stresses_at_the_surface_of_a_pressed_and_of_a_sliding_sphere():
    """Radial tension (1 - 2 nu)/3 p0 at the surface, equal compression around (Johnson (3.44))."""
    x, p = sphere(120, extent=1.05)
    fields = stress_plane(x, x, 0.0, p, None, NU)
    middle, edge = x.size // 2, np.argmin(np.abs(x - 1))
    assert fields.sx[middle, edge] == pytest.approx((1 - 2 * NU) / 3, abs=1e-3)
    assert fields.sy[middle, edge] == pytest.approx(-(1 - 2 * NU) / 3, abs=1e-3)
    assert fields.sy[edge, middle] == pytest.approx((1 - 2 * NU) / 3, abs=1e-3)
    x, p = sphere(120, extent=1.05)
    fields = stress_plane(x, x, 0.0, np.zeros_like(p), p, NU)
    inner = np.hypot(x, x[:, None]) < 0.9
    across = np.broadcast_to(x[:, None], p.shape)
    exact = {
        "sx": -np.pi / 8 * (4 + NU) * np.broadcast_to(x, p.shape),
        "sy": -np.pi / 8 * 3 * NU * np.broadcast_to(x, p.shape),
        "txy": -np.pi / 8 * (2 - NU) * across,
        "txz": -p,
    }
    for name, values in exact.items():
        assert getattr(fields, name)[inner] == pytest.approx(values[inner], abs=1e-3), name


def test_load_constant_across_a_period_is_the_line():
    rng = np.random.default_rng(1)
    x, y, z = np.linspace(-1, 1, 65), np.arange(6) / 20, np.array([0.0, 0.02, 0.3, 2.0])
    p, q = rng.uniform(size=65), rng.normal(size=65)
    p[[0, -1]] = q[[0, -1]] = 0.0
    fields = stress_plane(x, y, z, np.tile(p, (6, 1)), np.tile(q, (6, 1)), NU, periodic=True)
    sx, sz, txz = stress(x, z, p, q, NU)
    for name, line in {"sx": sx, "sy": NU * (sx + sz), "sz": sz, "txz": txz}.items():
        assert getattr(fields, name) == pytest.approx(np.tile(line[:, None], (1, 6, 1)), abs=1e-12), name
    assert np.abs([fields.txy, fields.tyz]).max() < 1e-12


@pytest.mark.parametrize("ratio", [1e3, 1e5])
def test_long_ellipse_is_the_line(ratio):
    """In the middle; the surface of an ellipse is less compressed along x by (1 - 2 nu) a/(a + b) p0."""
    x, z = np.arange(-40, 41) / 20, [0.0, 0.5, 1.0]
    y = ratio / 200 * np.arange(-201, 202)
    p = np.sqrt(np.clip(1 - x * x - (y[:, None] / ratio) ** 2, 0, None))
    fields = stress_plane(x, y, z, p, 0.1 * p, NU)
    sx, sz, txz = stress(x, z, p[201], 0.1 * p[201], NU)
    shorter = (1 - 2 * NU) / (1 + ratio)
    assert fields.sx[0, 201] - sx[0] == pytest.approx(np.full(x.size, shorter), rel=0.06, abs=1e-7)
    for field, line in ((fields.sx, sx), (fields.sz, sz), (fields.txz, txz)):
        assert field[:, 201] == pytest.approx(line, abs=1.1 * shorter + 1e-7)


def test_period_equals_many_copies():
    """61 copies of 12 cells, whose load fades out so that the ends are not felt."""
    x, y, z = np.arange(24) / 10, np.arange(12) / 10, [0.0, 0.3]
    one = np.random.default_rng(2).normal(size=(12, 24))
    one -= one.mean(axis=0)
    fields = stress_plane(x, y, z, one, one[::-1], NU, periodic=True)
    cells = np.arange(12 * 61)
    faded = erfc((np.abs(cells + 0.5 - cells.size / 2) / 12 - 20) / 3)[:, None] / 2
    copies = [np.tile(load, (61, 1)) * faded for load in (one, one[::-1])]
    free = stress_plane(x, cells / 10, z, *copies, NU)
    for field, expected in zip(fields, free, strict=True):
        assert field == pytest.approx(expected[:, 360:372], abs=1e-6)


def test_shapes_and_no_wrap_around_of_planes():
    x = np.arange(64.0)
    p = np.zeros((64, 64))
    p[1, 1] = 1.0
    fields = stress_plane(x, x, 2.0, p, None, NU)
    exact = point_loads(np.array([61.0]), np.array([61.0]), 2.0)[0, :, 0]
    assert [field[62, 62] for field in fields] == pytest.approx(exact, rel=1e-3)
    x, y = np.linspace(-1, 1, 16), np.linspace(0, 1, 8)
    p = np.random.default_rng(0).uniform(size=(3, 2, 8, 16))
    whole = stress_plane(x, y, [0.1, 0.2], p, p, NU)
    assert whole.sx.shape == (3, 2, 2, 8, 16)
    single = stress_plane(x, y, 0.2, p[1, 0], p[1, 0], NU)
    for many, one in zip(whole, single, strict=True):
        assert many[1, 0, 1] == pytest.approx(one, abs=1e-13)
    x = np.linspace(-1, 1, 16)
    with pytest.raises(ValueError, match="one value a node"):
        stress_plane(x, x[:8], 0.1, np.zeros((16, 8)), None, NU)
