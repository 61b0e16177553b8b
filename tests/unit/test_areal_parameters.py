"""Roughness parameters of areal surfaces against those of waves."""

import numpy as np
import pytest

from ehlpetsc.surfaces.areal_parameters import ArealParameters, autocorrelation, correlation_lengths

AMPLITUDE, WAVE = 1e-7, 40e-6
STEP = WAVE / 32
X = STEP * np.arange(1024)


def waves(across=WAVE):
    return AMPLITUDE * np.cos(2 * np.pi * X / WAVE) * np.cos(2 * np.pi * X / across)[:, np.newaxis]


def test_heights_of_a_product_of_cosines():
    found = ArealParameters.of(waves(), STEP, STEP)
    assert found.sa == pytest.approx(AMPLITUDE * (2 / np.pi) ** 2, rel=1e-2)
    assert found.sq == pytest.approx(AMPLITUDE / 2, rel=1e-12)
    assert found.ssk == pytest.approx(0.0, abs=1e-12)
    assert found.sku == pytest.approx(9 / 4, rel=1e-12)


def test_gradient_of_a_product_of_cosines():
    found = ArealParameters.of(waves(2 * WAVE), STEP, STEP)
    assert found.sdq == pytest.approx(AMPLITUDE * np.pi / WAVE * np.hypot(1.0, 0.5), rel=6e-3)


def test_texture_of_a_product_of_cosines():
    # the autocorrelation is cos(k tx) cos(k ty): 0.2 along x, and along the diagonal
    found = ArealParameters.of(waves(), STEP, STEP)
    k = 2 * np.pi / WAVE
    assert found.sal == pytest.approx(np.arccos(0.2) / k, rel=5e-3)
    assert found.str == pytest.approx(np.arccos(0.2) / np.sqrt(2) / np.arccos(np.sqrt(0.2)), rel=1e-2)


def test_spacings_of_the_columns_and_rows_may_differ():
    every_other = ArealParameters.of(waves()[::2], STEP, 2 * STEP)
    whole = ArealParameters.of(waves(), STEP, STEP)
    np.testing.assert_allclose(every_other, whole, rtol=1e-2, atol=1e-12)


def test_autocorrelation_is_that_of_all_pairs():
    z = np.random.default_rng(1).standard_normal((7, 9))
    z -= z.mean()
    found = autocorrelation(z)
    assert found.shape == (7, 9) and found[3, 4] == pytest.approx(1.0)
    pairs = np.mean(z[2:, :-3] * z[:-2, 3:])
    assert found[3 + 2, 4 - 3] == pytest.approx(pairs / np.mean(z**2))


def test_texture_longer_than_half_the_map_has_no_aspect_ratio():
    ridges = np.broadcast_to(np.cos(2 * np.pi * X / WAVE), (64, len(X)))
    found = ArealParameters.of(ridges, STEP, STEP)
    assert found.sal == pytest.approx(np.arccos(0.2) * WAVE / (2 * np.pi), rel=5e-3)
    assert np.isnan(found.str)


def test_a_plane_has_no_shape():
    found = ArealParameters.of(np.zeros((8, 8)), STEP, STEP)
    assert (found.sa, found.sq, found.sdq) == (0.0, 0.0, 0.0)
    assert np.isnan([found.ssk, found.sku, found.sal, found.str]).all()


def test_a_map_shorter_than_its_texture_has_no_correlation_length():
    assert np.isnan(correlation_lengths(np.ones((8, 8)) + 1e-3 * np.eye(8), STEP, STEP)).all()
