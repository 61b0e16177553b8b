"""Pictures of point contacts and strips: maps, sections, fringes, contacts, movie, page, maps of a case."""

import base64
import json
import re
import subprocess
import sys
from pathlib import Path

import h5py
import matplotlib
import numpy as np
import pytest
from matplotlib.colors import to_rgb
from PIL import Image as image
from support import is_line_with
from support.browser import BROWSER, visited
from support.made_results import P0, A, change_case, make_plane, make_result

from ehlpetsc import read_result
from ehlpetsc.commands import plot
from ehlpetsc.pictures import report, style
from ehlpetsc.pictures.frames import choice as frames
from ehlpetsc.pictures.frames import line, plane

OPTIONS = plot.arguments().parse_args(["x"])
CASE = """title = "rough ball"
contact = { radius = [0.0125, 0.0125], load = 20.0, youngs_modulus = 207e9, poisson_ratio = 0.3 }
fluid = { viscosity = 0.04, law = "roelands", pressure_viscosity = 22e-9, density = "dowson-higginson" }
motion = { entrainment_speed = 0.3 }
mesh = { inlet = -2.0, outlet = 1.5, points_per_half_width = 16, width = 3.0 }
time = { travel = 7.0 }
[surface.1]
synthetic = { kind = "self-affine", sq = 1e-7, hurst = 0.8, roll_off = 6e-5, short_cutoff = 2e-5, seed = 1 }
"""


@pytest.fixture
def point(tmp_path):
    return make_plane(tmp_path / "point.h5")


def draw(*arguments):
    return plot.main([str(a) for a in arguments])


@pytest.mark.parametrize(
    "words, name, panels",
    [
        ([], "point.png", ["y/a", "y/a", *2 * ["pressure [GPa]", "film thickness [µm]"]]),
        (["--fringes"], "point.fringes.png", ["y/a", "y/a"]),
        (["--contacts"], "point.contacts.png", ["y/a"]),
        (["--section", 0], "point.section.png", ["pressure [GPa]", "film thickness [µm]"]),
        (["--map"], "point.map.png", ["time [µs]", "pressure [GPa]"]),
    ],
)
def test_pictures_of_a_point_contact(point, drawn, capsys, words, name, panels):
    assert draw(point, *words) == 0
    assert capsys.readouterr().out == f"{point.parent / name}\n"
    assert [axes.get_ylabel() for axes in drawn[0].axes if axes.get_ylabel()] == panels
    assert ", a = 0.336 mm, b = 0.671 mm, p0 = 1 GPa" in drawn[0]._suptitle.get_text().replace("\n", ", ")


def test_maps_and_sections_show_fields_contacts_and_the_ellipse(point):
    with read_result(point) as r:
        figure = r.plot(step=2)
        pressure, film = figure.axes[:2]
        x, y = r.x / A, r.y / A
        part = np.ix_(np.abs(y) <= 3.0, (x >= -1.6) & (x <= 1.4))
        np.testing.assert_allclose(pressure.images[0].get_array(), 1e-9 * r.frame("pressure", 2)[part])
        np.testing.assert_allclose(film.images[0].get_array(), 1e6 * r.frame("film_thickness", 2)[part])
        touching = film.images[1]
        np.testing.assert_array_equal(touching.get_array(), r["in_contact"][2][part])
        opaque, clear = map(touching.get_cmap(), (1.0, 0.0))
        assert opaque == (*to_rgb(style.CONTACTS), 1.0) and clear[3] == 0.0
        assert [text.get_text() for text in film.get_legend().texts] == ["dry contact", "in contact"]
        assert [axes.get_xlabel() for axes in (pressure, film)] == 2 * ["x/a, flow →"]
        np.testing.assert_allclose(np.hypot(*(film.lines[0].get_xydata() / (1.0, 2.0)).T), 1.0)
    with read_result(point) as r:
        along, across = r.plot(step=2).axes[2:6:2]
        total = 1e-9 * r.frame("pressure", 2)
        (found, *_), (other, hertz, *_) = along.lines, across.lines
        x, y = r.x / A, r.y / A
        np.testing.assert_allclose(found.get_ydata(), total[20, (x >= -1.6) & (x <= 1.4)])
        np.testing.assert_allclose(other.get_ydata(), total[np.abs(y) <= 3.0, np.argmin(np.abs(x))])
        expected = 1e-9 * P0 * np.sqrt(np.maximum(1.0 - (hertz.get_xdata() / 2.0) ** 2, 0.0))
        np.testing.assert_allclose(hertz.get_ydata(), expected, atol=1e-12)


def test_hertz_pressure_of_sections_is_that_at_their_place(point, drawn):
    assert draw(point, "--section", 1.2) == 0
    hertz = next(line for line in drawn[-1].axes[0].lines if line.get_linestyle() == ":")
    assert hertz.get_ydata().max() == pytest.approx(1e-9 * P0 * 0.8, rel=1e-3)  # y/b = 0.6
    assert drawn[-1]._suptitle.get_text().replace("\n", " ").endswith(", section at y = 1.2 a")
    assert draw(point, "--window", 0.6, 1.6) == 0
    axes = drawn[-1].axes[4]
    assert axes.get_xlabel() == "y/a along x = 0.64 a"
    hertz = next(line for line in axes.lines if line.get_linestyle() == ":")
    assert hertz.get_ydata().max() == pytest.approx(1e-9 * P0 * (1.0 - 0.6429**2) ** 0.5, rel=1e-3)


def test_strip_and_line_are_compared_along_one_section(tmp_path, drawn):
    strip, line = make_plane(tmp_path / "strip.h5", kind="strip"), make_result(tmp_path / "line.h5")
    assert draw(strip, line, "--time", 2e-5) == 0
    first, second = drawn[0].axes[0].lines[:2]
    at = np.interp(first.get_xdata(), *second.get_data())
    np.testing.assert_allclose(first.get_ydata(), at, atol=0.05)


def test_red_of_a_layer_is_as_opaque_as_the_share_of_the_solids(point):
    """Over 10 MPa on the solids was painted red, a large area in which they carry 2 %."""
    change_case(point, {"contact.model": "mixed", "contact.asperity_height": 2e-8})
    with h5py.File(point, "r+", libver="latest") as file:
        file["contact_pressure"][:] = 0.02 * file["pressure"][:]
        file["in_contact"][:] = file["contact_pressure"][:] > 10e6
    with read_result(point) as r:
        figure = r.plot(step=2)
        share = figure.axes[1].images[1].get_array()
        assert share.max() == pytest.approx(0.02) and 0.2 < (share > 0.0).mean()
        assert figure.axes[1].get_legend().texts[1].get_text() == "solids 10 %"
        assert not [line for axes in figure.axes for line in axes.lines if line.get_marker() == "v"]
        assert len(line.draw_map([r.section()], OPTIONS).axes[0].collections) == 0


@pytest.mark.parametrize("kind", ["line", "strip", "point"])
def test_any_field_is_drawn_by_its_unit_and_name(tmp_path, kind, drawn, capsys):
    path = tmp_path / "r.h5"
    make_result(path) if kind == "line" else make_plane(path, kind=kind)
    words = ["--field", "shear_stress_2"]
    assert draw(path, *words, "--time", 2e-5) == draw(path, *words, "--map") == 0
    names = [f"{tmp_path}/{name}.shear_stress_2.png" for name in ("r", "r.map")]
    assert capsys.readouterr().out.split() == names
    instant, over = drawn
    shown = [axes.get_ylabel().replace("\n", " ") for axes in (*instant.axes, *over.axes)]
    assert shown.count("shear stress on surface 2 [GPa]") == (2 if kind == "line" else 3)
    with read_result(path) as r:
        section = r if kind == "line" else r.section()
        k = r.nearest_frame(time=2e-5)
        panel = instant.axes[1] if kind == "line" else instant.axes[3]
        x, values = panel.lines[0].get_data()
        at = np.interp(x, r.x / A, 1e-9 * section.frame("shear_stress_2", k))
        np.testing.assert_allclose(values, at, atol=1e-12)


def test_field_in_movie_and_page(point, monkeypatch):
    monkeypatch.setattr(frames, "MOVIE_DPI", 40)
    assert draw(point, "--field", "void_fraction", "--movie") == 0
    assert draw(point, "--field", "void_fraction", "--report") == 0
    page = point.with_name("point.void_fraction.html").read_text(encoding="utf-8")
    data = json.loads(re.search(r'id="data">(.*?)</script>', page, re.S)[1])
    assert data["frames"]["label"] == "void fraction of the film" and not data["frames"]["is_film"]
    maps = data["maps"]["values"]
    highest = np.frombuffer(base64.b64decode(maps["levels"]), "<u2").max() * maps["unit"] + maps["low"]
    assert highest == pytest.approx(0.3)


def test_fringes_resolve_the_film_and_contacts_are_shares_of_all_steps(point):
    with read_result(point) as r:
        figure = plane.draw_fringes([r], OPTIONS)
    titles = [axes.get_title() for axes in figure.axes[:2]]
    assert titles == ["wavelength 530 nm", "wavelengths 630, 530, 460 nm"]
    assert max(figure.axes[0].images[0].get_array().shape) == plane.PIXELS
    assert figure.axes[1].images[0].get_array().shape[2] == 3
    film = np.arange(5) * plane.WAVELENGTHS["green"] / (4.0 * plane.OIL_INDEX)
    np.testing.assert_allclose(plane.monochromatic(film, plane.OIL_INDEX), [1, 0, 1, 0, 1], atol=1e-12)
    far = 50 * film[-1]
    np.testing.assert_allclose(plane.coloured(np.array([0.0, far]), 1.5), [[1.0] * 3, [0.5] * 3], atol=1e-3)
    with read_result(point) as r:
        shown = plane.draw_contacts([r], OPTIONS).axes[0].images[0].get_array()
        assert shown.max() == 100.0 * r.contact_count.max() / 5 > 0.0


def test_movie_has_every_frame_with_common_colours(point, monkeypatch):
    seen = []

    class Writer(frames.PillowWriter):
        def grab_frame(self, **keys):
            images = [image for axes in self.fig.axes[:2] for image in axes.images]
            seen.append(([image.get_clim() for image in images], images[0].get_array().copy()))
            super().grab_frame(**keys)

    monkeypatch.setattr(frames, "PillowWriter", Writer)
    monkeypatch.setattr(frames, "MOVIE_DPI", 40)
    assert draw(point, "--movie") == 0
    with image.open(point.with_suffix(".gif")) as shown:
        assert shown.n_frames == 5
    assert all(limits == seen[0][0] for limits, _ in seen)
    assert not np.array_equal(seen[0][1], seen[1][1])


def test_page_holds_maps_of_every_frame(point, monkeypatch):
    monkeypatch.setattr(report, "MAX_MAP_NODES", 21)
    assert draw(point, "--report") == 0
    text = point.with_suffix(".html").read_text(encoding="utf-8")
    maps = json.loads(re.search(r'id="data">(.*?)</script>', text, re.S)[1])["maps"]
    levels = np.frombuffer(base64.b64decode(maps["pressure"]["levels"]), "<u2").reshape(5, -1)
    with read_result(point) as r:
        for shown, found in zip(levels, r.pressure, strict=True):  # thinned without losing its maximum
            assert maps["pressure"]["unit"] * shown.max() == pytest.approx(1e-9 * found.max(), rel=1e-4)
    assert maps["aspect"] == 2.0
    assert len(np.frombuffer(base64.b64decode(maps["y"]), "<f4")) <= 21


VISITOR = (Path(__file__).parents[1] / "data" / "plane_visitor.js").read_text(encoding="utf-8")


@pytest.mark.slow
@pytest.mark.skipif(BROWSER is None, reason="no browser is installed; the other tests read text and data")
def test_slider_of_the_page_changes_the_maps(point):
    assert draw(point, "--report") == 0
    found = visited(point.with_suffix(".html"), VISITOR)
    with read_result(point) as r:
        columns = (r.x / A >= -1.6) & (r.x / A <= 1.4)
        expected = 1e-9 * r.frame("pressure", 2)[np.abs(r.y / A) <= 3.0][:, columns]
    np.testing.assert_allclose(found["pressure"], expected, atol=1e-4)
    assert found["edge"] == pytest.approx(2.0)


def test_case_picture_shows_rows_of_the_mesh(tmp_path, capsys, drawn):
    path = tmp_path / "ball.toml"
    path.write_text(CASE, encoding="utf-8")
    assert draw(path, "-o", tmp_path / "ball.png") == 0
    assert capsys.readouterr().out == f"{tmp_path / 'ball.png'}\n"
    axes = drawn[0].axes[0]
    heights = axes.images[0].get_array()
    assert heights.shape[0] == 49 and heights.std() == pytest.approx(0.1, rel=0.2)
    assert "travel 1.00 a of 7 a; pale: does not pass the whole contact" in axes.get_title(loc="left")


@pytest.mark.parametrize(
    "made, words, parts",
    [
        (make_result, ["--fringes"], ["a line contact; allowed: --fringes of a point contact or strip"]),
        (make_result, ["--section", 0], ["a line contact; allowed: --section of a point contact or strip"]),
        (make_plane, ["--section", 0, "--over-time"], ["--section: of pictures over x, not of --over-time"]),
        (make_plane, ["--window", 3, 4], ["fewer than two nodes from 3 a to 4 a"]),
        (make_plane, ["--window", 0, 0.1, "--fringes"], ["fewer than two nodes from 0 a to 0.1 a"]),
        (make_plane, ["--section", 9], ["section: y = ", "; allowed: on the mesh"]),
        (make_plane, ["--field", "heat"], ["--field heat: not stored; allowed: contact_pressure, "]),
        (make_plane, ["--field", "pressure", "--fringes"], ["--field: of pictures of", "not of --fringes"]),
    ],
)
def test_faults_are_reported(tmp_path, made, words, parts, capsys):
    assert draw(made(tmp_path / "r.h5"), *words) == 2
    assert is_line_with(capsys.readouterr().err, *parts)


def test_contacts_of_a_run_without_any_are_refused(point, capsys):
    with h5py.File(point, "r+", libver="latest") as file:
        file["contact_count"][...] = 0
    assert draw(point, "--contacts") == 2
    assert is_line_with(capsys.readouterr().err, "no node is in contact in any step")


def test_lines_load_no_module_of_planes(tmp_path):
    make_result(tmp_path / "line.h5")
    code = "import sys; from ehlpetsc.commands.plot import main; main(sys.argv[1:]); print(*sys.modules)"
    words = [sys.executable, "-c", code, str(tmp_path / "line.h5")]
    loaded = subprocess.run(words, capture_output=True, text=True, check=True).stdout.split()
    assert "ehlpetsc.pictures.frames.choice" in loaded
    assert not [name for name in loaded if re.search(r"pictures\.plane", name)]


def test_text_of_a_narrow_picture_fits(point, tmp_path):
    out = tmp_path / "column.png"
    assert draw(point, "--size", 3.4, 5.0, "-o", out) == 0
    with image.open(out) as picture:
        edge = np.asarray(picture.convert("L"))[:, [0, 1, -2, -1]]
    assert edge.min() == 255  # nothing runs out of the picture
    assert matplotlib.rcParams["font.size"] == 10.0  # of later pictures
