"""Runs of a compliant layer through restart, passes, a series, post-processing and explain."""

import json
import re

import numpy as np
import pytest
from support import ROOT
from support.running import run, settings, whole_and_restarted

from ehlpetsc.case.loading import load
from ehlpetsc.results.reader import read_result
from ehlpetsc.run.simulation import Simulation

QUICK = ("mesh.inlet=-1.4", "mesh.points_per_half_width=50", "time.travel=0.6", "output.every=1")


@pytest.fixture(scope="module")
def case(tmp_path_factory):
    """A case of one speed: the file of the Stribeck curve without its series."""
    given = load(ROOT / "cases" / "stribeck.toml", {"series": None, "motion.entrainment_speed": 0.05})
    text = given.text.replace('"profiles/', f'"{ROOT}/cases/profiles/')
    path = tmp_path_factory.mktemp("case") / "layer.toml"
    path.write_text(text)
    return path


def test_restart_gives_the_same_run(case, tmp_path):
    whole, parts = whole_and_restarted([case, *settings(*QUICK)], "layer", 15, tmp_path)
    with read_result(whole) as one, read_result(parts) as other:
        assert len(one.time) == len(other.time) > 20
        for name in ("pressure", "contact_pressure", "film_thickness"):
            largest = np.abs(one[name][:]).max()
            np.testing.assert_allclose(one[name][:], other[name][:], rtol=0, atol=1e-9 * largest)
        share = one.steps("contact_share")
        np.testing.assert_allclose(other.steps("contact_share"), share, rtol=1e-9)
        assert share.max() > 0.1
        stored = np.asarray(one["in_contact"][:], dtype=bool)
        np.testing.assert_array_equal(stored, one["contact_pressure"][:] > 10e6)


def test_passes_add_plastic_deformation(case, tmp_path):
    words = settings(*QUICK[:3], "time.travel=1.2", "time.passes=2", "contact.yield_pressure=0.98e9")
    done = run(case, *words, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    rows = json.loads((tmp_path / "layer.passes.json").read_text())["passes"]
    assert len(rows) == 2 and rows[0]["added"] > rows[1]["added"] >= 0.0


def test_explain_names_no_fault(case, tmp_path):
    done = run("explain", case, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "Refused" not in done.stdout
    # 132 nm/6 times ln(1 + (beta E*/p)^3), beta E* = 2 pi 132 nm/80 um of 113.7 GPa
    assert re.search(r" 10 MPa .* 315 nm .* p0 .* 21\.5 nm", done.stdout)
    assert "combined Rq 0.134 um" in done.stdout  # the waves on the mesh and the layer


def test_oil_locked_in_below_a_thin_layer_is_solved_at_any_speed():
    """Rounding of enclosed oil limits a residual that is scaled by the far thinner film of the inlet."""
    profile = {"file": f"{ROOT}/cases/profiles/alicona_meander_profile.csv", "short_cutoff": 25e-6}
    locked = {
        "series": None,
        "contact.asperity_height": 10e-9,
        "motion.entrainment_speed": 1e-6,
        "surface": {"1": profile, "2": profile},
        "mesh": {"inlet": -1.5, "outlet": 1.3, "points_per_half_width": 50},
        "time": {"travel": 0.86},
    }
    simulation = Simulation(load(ROOT / "cases" / "stribeck.toml", locked))
    *_, end = simulation
    assert simulation.finished and end.mass_error < 1e-6
    smooth = 1e-6 * simulation.scales.h  # no film is expected to be thinner, m
    assert end.film_thickness[simulation.scales.grid.inside(1.0)].mean() > 1000.0 * smooth
