"""Profiles of many more points than a mesh can tell apart: they are thinned first."""

import os
import subprocess
import sys

import numpy as np
import pytest
from support import ROOT

from ehlpetsc.surfaces import filters
from ehlpetsc.surfaces.filters import MAX_POINTS_PER_CELL, MIN_THINNED_POINTS, thinned
from ehlpetsc.surfaces.profile import Profile
from ehlpetsc.surfaces.samples import Samples

# a small process between: a child's largest memory begins with that of the process that started it
MEASURED = """
import resource, subprocess, sys
status = subprocess.run(sys.argv[1:]).returncode
used = resource.getrusage(resource.RUSAGE_CHILDREN)
print(status, used.ru_maxrss, used.ru_utime, file=sys.stderr)
"""
COARSE = {"mesh.points_per_half_width": 20, "mesh.inlet": -1.5, "mesh.outlet": 1.3, "time.travel": 0.5}


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


def dense(folder, n, step):
    X = step * np.arange(n)
    z = 3e-7 * np.sin(2 * np.pi * X / 1e-4) + 2e-9 * np.random.default_rng(0).normal(size=n)
    with open(folder / "dense.csv", "w") as file:
        for begin in range(0, n, 100_000):
            part = zip(X[begin : begin + 100_000], z[begin : begin + 100_000], strict=True)
            file.writelines(f"{x:.9e},{height:.6e}\n" for x, height in part)
    text = (ROOT / "cases" / "table1_rough.toml").read_text()
    path = folder / "dense.toml"
    path.write_text(text.replace("profiles/alicona_meander_profile.csv", "dense.csv"))
    return path


@pytest.mark.slow
def test_profile_of_half_a_million_points_runs(tmp_path):
    """Ten million take 17 s and 1.8 GB. A running median of points times window took 9 GB for one million."""
    case = dense(tmp_path, 500_000, 2e-9)
    keys = [f"{key}={value}" for key, value in COARSE.items()]
    keys += ["surface.1.level=true", "surface.1.cutoff=1e-4", "surface.1.short_cutoff=1e-8"]
    words = [word for key in keys for word in ("--set", key)]
    command = [sys.executable, "-m", "ehlpetsc", str(case), *words, "--output", str(tmp_path / "r.h5")]
    path = f"{ROOT}:{os.environ.get('PYTHONPATH', '')}"
    done = subprocess.run(
        [sys.executable, "-c", MEASURED, *command],
        env=os.environ | {"PYTHONPATH": path},
        capture_output=True,
        text=True,
    )
    status, peak, user = (float(word) for word in done.stderr.splitlines()[-1].split())
    assert status == 0, done.stdout + done.stderr
    assert " 500000 points, thinned" in done.stdout
    assert peak < 600_000  # kB
    assert user < 30.0  # s
