"""Pictures of cases before they run, and the roughness parameters in them."""

import numpy as np
import pytest
from PIL import Image as image
from support import CASES

from ehlpetsc.case.loading import load
from ehlpetsc.physics.scales import Scales
from ehlpetsc.pictures import command as plot
from ehlpetsc.pictures.case_profiles import draw_case, passing
from ehlpetsc.surfaces.parameters import core, roughness_parameters
from ehlpetsc.surfaces.roughness import Roughness


def test_roughness_parameters_of_a_cosine():
    X = np.linspace(0.0, 1e-3, 20001)
    found = roughness_parameters(X, 2e-7 * np.cos(2 * np.pi * X / 1e-4))
    assert found["ra"] == pytest.approx(2 / np.pi * 2e-7, rel=1e-3)
    assert found["rq"] == pytest.approx(2e-7 / np.sqrt(2), rel=1e-3)
    assert found["rz"] == pytest.approx(4e-7, rel=1e-6)
    assert abs(found["rsk"]) < 1e-3


def test_peaks_and_valleys_of_a_plateau_profile():
    """A core of slope 1 over the whole ratio with peaks on 10 % and valleys on 20 % of the length."""
    ratio = np.linspace(0.0, 1.0, 4001)
    height = 1.0 - ratio + 5.0 * np.maximum(0.1 - ratio, 0.0) - 10.0 * np.maximum(ratio - 0.8, 0.0)
    about = core(ratio, height)
    assert (about["rk"], about["mr1"], about["mr2"]) == pytest.approx((1.0, 0.5 / 6, 9 / 11), abs=2e-3)
    assert about["rpk"] == pytest.approx(5.0 * 0.1, rel=0.02)  # as high as its triangle
    assert about["rvk"] == pytest.approx(10.0 * 0.2, rel=0.02)


def test_passing_profile_length_follows_from_travel():
    case = load(CASES / "fig1.toml")
    scales = Scales.of(case)
    profile = Roughness.of(case, scales).surface_1
    begin, end = passing(profile, case, scales)
    assert begin == profile.X[0]
    assert end - begin == pytest.approx((case.time.travel - 1.5 - 2.0) * scales.a, rel=1e-9)
    short = load(CASES / "fig1.toml", ["time.travel=3"])
    scales = Scales.of(short)
    assert np.ptp(passing(Roughness.of(short, scales).surface_1, short, scales)) == 0.0


def test_case_picture_shows_parameters_and_passing_length(tmp_path, capsys):
    out = tmp_path / "c.png"
    assert plot.main([str(CASES / "table1_rough.toml"), "-o", str(out)]) == 0
    assert capsys.readouterr().out == f"{out}\n"
    with image.open(out) as picture:
        assert len(picture.convert("RGB").getcolors(picture.width * picture.height)) > 100
    figure = draw_case(CASES / "table1_rough.toml", ["time.travel=5"])
    texts = [text.get_text() for axes in figure.axes for text in axes.texts]
    assert any("Ra 0.079 µm" in text and "Rpk" in text and "Rsk 0.08" in text for text in texts)
    titles = [axes.get_title(loc="left") for axes in figure.axes]
    assert "travel 1.50 a of 5 a" in titles[0]
