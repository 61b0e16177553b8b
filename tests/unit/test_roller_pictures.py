"""Pictures of a roller: maps over y in mm, load along the roller, profile with the deformed gap."""

import numpy as np
import pytest
from support.running import PYTHON, called

import ehlpetsc
from ehlpetsc.pictures.frames.choice import Choice
from ehlpetsc.pictures.style import hertz_at

CASE = {
    "title": "a roller",
    "contact": {"radius": 6e-3, "length": 12e-3, "load": 2400.0, "material": "100Cr6", "tilt": 0.3e-3},
    "mesh": {"inlet": -1.9, "outlet": 1.9, "points_per_half_width": [8, 20]},
}
CASE["contact"]["profile"] = {"kind": "iso", "diameter": 12e-3}


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    return ehlpetsc.solve(CASE, output=tmp_path_factory.mktemp("roller") / "roller.h5")


def test_picture_shows_maps_load_gap_and_sections(result):
    figure = Choice([result], [0], (-0.5, 0.5)).draw()  # all rows, whatever the limits along
    maps, loads, gap, pressure, film = (figure.axes[k] for k in (0, 2, 3, 4, 5))
    assert maps.get_ylabel() == "y [mm]" and maps.get_ylim() == pytest.approx((-6.0, 6.0))
    computed, lamina, mean = loads.lines
    np.testing.assert_allclose(computed.get_ydata(), 1e-3 * result.load_per_length())
    assert [line.get_label() for line in (computed, lamina, mean)] == ["computed", "lamina model", "mean"]
    assert lamina.get_ydata() == pytest.approx(1e-3 * result.roller().lamina)
    assert gap.lines[0].get_ydata()[0] > gap.lines[1].get_ydata()[20] >= 0.0
    middle, highest = (line.get_ydata() for line in pressure.lines)
    assert (highest >= middle).all() and highest.max() == pytest.approx(1e-9 * result.pressure.max())
    assert [line.get_label() for line in film.lines] == ["x = 0", "least of the row"]


def test_sections_and_movies_of_a_roller(result, tmp_path):
    a, p0 = hertz_at(result.section(5e-3), 0)
    assert (a, p0) == pytest.approx((result.attrs["a"], result.attrs["p0"]))
    words = ("plot", result.path, "--section", "20"), ("plot", result.path, "--movie", "-o", "roller.gif")
    for arguments in words:
        done = called([PYTHON, "-m", "ehlpetsc", *arguments], tmp_path)
        assert done.returncode == 0, done.stderr
