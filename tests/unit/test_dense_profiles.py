"""Profiles of many more points than a mesh can tell apart: they are thinned first."""

import numpy as np
import pytest
from support import CASES

from ehlpetsc.case.loading import load
from ehlpetsc.surfaces import filters
from ehlpetsc.surfaces.filters import MAX_POINTS_PER_CELL, MIN_THINNED_POINTS, thinned
from ehlpetsc.surfaces.profile import Profile
from ehlpetsc.surfaces.samples import Samples, samples


def waves(n, length, wavelengths, amplitude=1e-7):
    X = np.linspace(0.0, length, n)
    return X, amplitude * sum(np.cos(2 * np.pi * X / w + w / 1e-5) for w in wavelengths)


@pytest.mark.parametrize("even", [True, False])
@pytest.mark.parametrize("cells, error", [(2.0, 3e-5), (4.0, 2e-5), (20.0, 5e-6)])
def test_thinning_keeps_cell_means(even, cells, error):
    cell = 1.5e-6
    X, z = waves(400_001, 1e-3, [cells * cell])
    if not even:
        X = X + 1e-6 * np.sin(2 * np.pi * X / 1e-3) * np.sin(2 * np.pi * X / 7e-5) ** 2
        z = 1e-7 * np.cos(2 * np.pi * X / (cells * cell))
    X_thin, z_thin = thinned(X, z, cell)
    assert X_thin.size == int(MAX_POINTS_PER_CELL * (X[-1] - X[0]) / cell) + 1 < X.size / 30
    assert X_thin[0] == X[0] and X_thin[-1] == X[-1]
    faces = np.arange(X[0], X[-1], 0.37 * cell)
    means = []
    for one, other in ((X, z), (X_thin, z_thin)):
        profile = Profile(Samples(one, other, True, True), 0.0, False, 0.0, X[-1], 1.0, 1.0)
        means.append(profile.mean_height(faces)[3:-3])
    np.testing.assert_allclose(means[1], means[0], rtol=0.0, atol=error * 1e-7)


def test_coarse_profile_is_not_thinned():
    for n, cell in ((MIN_THINNED_POINTS - 1, 1e-3), (2 * MIN_THINNED_POINTS, 1e-3 / 12_500)):
        X, z = waves(n, 1e-3, [1e-5])
        assert thinned(X, z, cell)[1] is z


def test_levelling_of_a_dense_profile_removes_a_line_only():
    X, z = waves(10_001, 4e-3, [1e-4])
    np.testing.assert_allclose(filters.levelled(X, z + 3e-3 * X - 7e-6), filters.levelled(X, z), atol=1e-18)
    fit = np.polynomial.Polynomial.fit(X, z, 1)(X)
    np.testing.assert_allclose(filters.levelled(X, z), z - fit, atol=1e-20)


def test_profile_of_half_a_million_points_is_thinned_and_filtered(tmp_path):
    X = 2e-9 * np.arange(500_000)
    z = 3e-7 * np.sin(2 * np.pi * X / 1e-4) + 2e-9 * np.random.default_rng(0).normal(size=X.size)
    np.savetxt(tmp_path / "dense.csv", np.column_stack([X, z]), delimiter=",")
    keys = {"file": str(tmp_path / "dense.csv"), "level": True, "cutoff": 1e-4, "short_cutoff": 1e-8}
    found = samples(tmp_path, load(CASES / "table1_smooth.toml", {"surface.1": keys}).surface.side("1"), 1e-5)
    assert any(note.startswith("500000 points, thinned to ") for note in found.notes)
    passed = 0.5 * 3e-7  # of the wave at the cut-off
    middle = slice(found.z.size // 4, -found.z.size // 4)
    assert np.abs(found.z[middle]).max() == pytest.approx(passed, rel=0.05)
