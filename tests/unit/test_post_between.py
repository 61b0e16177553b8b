"""The load between nodes against smooth ripples, steep peaks, and its kernels by direct integration."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.interpolate import CubicHermiteSpline, CubicSpline

from ehlpetsc.post.stresses import body_stress
from ehlpetsc.post.stresses.body_stress import BodyStress, hermite_spectra, limited_slopes, offset_weights
from ehlpetsc.post.stresses.half_plane import padded_length, point_kernels

NODES = np.arange(64.0)
BETWEEN = np.linspace(10, 54, 881)


def load(values):
    """The values between the nodes."""
    slopes = np.empty((1, NODES.size))
    limited_slopes(np.asarray(values, float)[None], slopes)
    return CubicHermiteSpline(NODES, values, slopes[0])(BETWEEN)


@pytest.mark.parametrize("length, error", [(20, 2.6e-5), (10, 4.3e-4), (8, 1.1e-3)])
def test_interpolated_ripples_keep_their_peaks(length, error):
    """Fourth order, wherever the peaks lie between the nodes."""
    worst = 0.0
    for shift in np.linspace(0, 1, 21):
        found = load(np.cos(2 * np.pi * (NODES - shift) / length))
        worst = max(worst, np.abs(found - np.cos(2 * np.pi * (BETWEEN - shift) / length)).max())
    assert worst < error


@pytest.mark.parametrize("peak", [[1], [1, 0.8], [0.4, 1, 0.4], [1, 1, 1], [0.1, 1, 0.9, 0.05]])
def test_steep_peaks_do_not_overshoot(peak):
    """By 1 % at most, where a spline swings to the other side by 2 to 14 %."""
    values = np.zeros(64)
    values[30 : 30 + len(peak)] = peak
    assert load(values).min() > -0.01
    assert CubicSpline(NODES, values)(BETWEEN).min() < -0.02


def test_single_node_and_step_do_not_overshoot():
    one, step = np.zeros(64), np.zeros(64)
    one[30], step[32:] = 1, 1
    for values in (one, step):
        assert (load(values).min(), load(values).max()) == (0, 1)
    assert CubicSpline(NODES, one)(BETWEEN).min() == pytest.approx(-0.136, abs=0.001)


@pytest.mark.parametrize("depth", [0.3, 2.0, 12.0])
def test_kernels_equal_direct_integration(depth):
    """Values and slopes, near and far, seen from between the nodes."""
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
    """Under a load with ripples of all lengths."""
    x = np.linspace(-2.5, 1.5, 801)
    rough = 1 + 0.2 * np.random.default_rng(1).normal(size=(2, x.size))
    p = np.sqrt(np.clip(1 - x * x, 0, None)) * rough
    weights = offset_weights(np.array([0.0, 0.3]))
    monkeypatch.setattr(body_stress, "kernel_table", body_stress.kernel_table.__wrapped__)  # keeps nothing
    found = []
    for share in (body_stress.low_pass, lambda nx, depth: np.ones(padded_length(nx) // 2 + 1)):
        monkeypatch.setattr(body_stress, "low_pass", share)
        body = BodyStress(x.size, np.array([depth]))
        found.append((body.tables[0].size, body(0, body.transform(p, 0.1 * p), weights)[..., : x.size]))
    assert found[0][0] < kept * found[1][0]
    assert np.abs(found[0][1] - found[1][1]).max() < 1e-9
