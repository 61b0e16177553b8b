"""A life that is killed at any moment and resumed is the one that was not, to 1e-9."""

import os
import signal
import subprocess
import sys
import time

import h5py
import numpy as np
import pytest
from support import COARSE_LIFE
from support.made_results import save_life

from ehlpetsc.case.loading import load
from ehlpetsc.life import read_life, run_life
from ehlpetsc.life.history import COMMIT_DATASET, LifeHistory

KEYS = {
    "time.travel": 3.6,
    "mesh.points_per_half_width": 8,
    "surface.1.scale": 1.0,
    "surface.2.scale": 1.0,
    "wear.coefficient": 1e-17,
    "contact.yield_pressure": 2e9,
    "life.max_solved": 4,
}
CASE = load(COARSE_LIFE, [f"{key}={value}" for key, value in KEYS.items()])


def command(path):
    settings = [part for key, value in KEYS.items() for part in ("--set", f"{key}={value}")]
    words = [COARSE_LIFE, "--unresolved", "-o", path, "--no-picture", *settings]
    return [sys.executable, "-m", "ehlpetsc", "life", *words]


def equal(life, other):
    assert life("passes").tolist() == other("passes").tolist()
    for name in life.rows[0]:
        assert life(name) == pytest.approx(other(name), rel=1e-9, nan_ok=True), name
    for both, others in zip(life.bodies, other.bodies, strict=True):
        for body, twin in zip(both, others, strict=True):
            assert body.profile == pytest.approx(twin.profile, rel=1e-9)
            assert body.damage == pytest.approx(twin.damage, rel=1e-9)


def cut(life, count):
    """The life up to a row."""
    return LifeHistory(life.case, life.title, life.rows[:count], life.bodies[:count], life.plastic[:count])


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    path = tmp_path_factory.mktemp("whole") / "a.life.h5"
    run_life(CASE, path, unresolved=True)
    return path


def test_a_life_killed_in_mid_pass_and_resumed_is_the_same(whole, tmp_path):
    path = tmp_path / "a.life.h5"
    run = subprocess.Popen(command(path), stdout=subprocess.PIPE, text=True)
    seen = 0
    for line in run.stdout:  # the second round is being solved once the first one has its line
        seen += line.startswith("solved=")
        if seen == 2:
            break
    time.sleep(0.05)
    run.send_signal(signal.SIGKILL)
    run.wait()
    assert 2 <= len(read_life(path).rows) < 4, "killed on its way, and the file has what was solved"
    equal(run_life(CASE, path, unresolved=True), read_life(whole))


@pytest.mark.parametrize("written", [0, 3, 12, 25])
def test_a_row_that_a_kill_cut_short_is_dropped(written, whole, tmp_path):
    """Datasets of a row that is not vouched for: as many as were written before the kill."""
    path, life = tmp_path / "a.life.h5", read_life(whole)
    first = cut(life, 2)
    save_life(first, path)
    with h5py.File(path, "r+") as file:
        growing = []

        def look(name, item):
            if isinstance(item, h5py.Dataset) and item.maxshape[0] is None:
                growing.append(name)

        file.visititems(look)
        growing.remove(f"figures/{COMMIT_DATASET}")
        for name in growing[:written]:
            file[name].resize(len(file[name]) + 1, axis=0)
    equal(read_life(path), first)


def test_a_life_restarts_at_any_of_its_rows(whole, tmp_path):
    path = tmp_path / "a.life.h5"
    save_life(cut(read_life(whole), 2), path)
    again = run_life(CASE, path, unresolved=True)
    equal(again, read_life(whole))
    assert len(again.rows) == 4 and os.path.exists(path)
    assert np.isfinite(again("friction")).all()
