"""Pictures of cases before they run."""

import numpy as np
import pytest
from PIL import Image as image
from support import CASES

from ehlpetsc.case.loading import load
from ehlpetsc.physics.scales import Scales
from ehlpetsc.pictures import command as plot
from ehlpetsc.pictures.case_profiles import draw_case, passing
from ehlpetsc.surfaces.roughness import Roughness


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
    title = figure.axes[0].get_title(loc="left")
    assert title.startswith("Ra 0.079 µm") and "Rsk 0.08" in title and "travel 1.50 a of 5 a" in title
