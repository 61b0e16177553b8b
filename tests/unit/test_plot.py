"""Pictures: every kind is drawn, the default instant is chosen, and faults are reported."""

from types import SimpleNamespace
from xml.etree import ElementTree

import h5py
import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image as image
from support import is_line_with
from support.made_results import A, change_case, make_result, with_solids

from ehlpetsc.errors import OutputError
from ehlpetsc.pictures import command as plot
from ehlpetsc.pictures import figures, movies, over_time, stribeck
from ehlpetsc.pictures import frames as drawing
from ehlpetsc.pictures.operating_points import time_statistics
from ehlpetsc.results.means import both_fill
from ehlpetsc.results.reader import read_result


@pytest.fixture
def result(tmp_path):
    return make_result(tmp_path / "one.h5")


@pytest.fixture
def series(tmp_path):
    return [make_result(tmp_path / f"{v}.h5", viscosity=v, nodes=81, steps=21) for v in (0.010, 0.002, 0.005)]


def draw(*arguments):
    return plot.main([str(a) for a in arguments])


def colours_in(path):
    """Number of different colours: a picture in which nothing was drawn has few."""
    with image.open(path) as picture:
        return len(picture.convert("RGB").getcolors(picture.width * picture.height))


@pytest.fixture
def drawn(monkeypatch):
    """Figures that the command would have written to files."""
    figures = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, *_, **__: figures.append(figure))
    return figures


FRAME = ["pressure [GPa]", "film thickness [µm]"]
MAP = ["time [µs]", "pressure [GPa]"]  # of the panel and of its colours


@pytest.mark.parametrize(
    "options, name, title, window, panels",
    [
        ([], "one.png", "made up: step 0, 0.000 µs, travel 0.00 a", (-1.6, 1.4), FRAME),
        (["--step", 12], "one.png", "made up: step 12, 12.000 µs, travel 0.20 a", (-1.6, 1.4), FRAME),
        (
            ["--time", 1e-5, "--around", 0.3],
            "one.png",
            "made up: step 10, 10.000 µs, travel 0.17 a",
            (0.05, 0.55),
            FRAME,
        ),
        (["--map"], "one.map.png", "made up", (-1.6, 1.375), MAP),
        (["--map", "--around", 0, "--width", 1], "one.map.png", "made up", (-0.5, 0.5), MAP),
    ],
)
def test_picture_of_one_result(tmp_path, result, drawn, capsys, options, name, title, window, panels):
    assert draw(result, *options) == 0
    assert capsys.readouterr().out == f"{tmp_path / name}\n"
    (figure,) = drawn
    upper = figure.axes[0]
    conditions = "u = 5 m/s, slide/roll ratio 0, a = 0.336 mm, p0 = 1 GPa, oil 5 mPa s"
    assert upper.get_title() == (title if panels == MAP else f"{title}\n{conditions}")
    if panels == FRAME:
        (mm,) = upper.child_axes
        assert mm.get_xlabel() == "x [mm]" and "flow" in [text.get_text() for text in upper.texts]
    if panels == MAP:
        assert figure._suptitle.get_text() == conditions
    assert upper.get_xlim() == pytest.approx(window)
    assert [axes.get_ylabel() for axes in figure.axes] == panels


def test_picture_format_follows_its_name(tmp_path, result, monkeypatch):
    monkeypatch.setattr(plot, "DPI", 80)
    assert draw(result, "-o", tmp_path / "out.png") == 0
    assert colours_in(tmp_path / "out.png") > 30
    with image.open(tmp_path / "out.png") as picture:
        assert picture.size == pytest.approx([80 * inches for inches in figures.SIZE], abs=1)
    assert draw(result, "-o", tmp_path / "out.svg") == 0
    root = ElementTree.parse(tmp_path / "out.svg").getroot()
    lines = [path.get("d", "") for path in root.iter("{http://www.w3.org/2000/svg}path")]
    assert root.tag == "{http://www.w3.org/2000/svg}svg"
    assert sum(line.count("L") > 50 for line in lines) >= 3  # curves over the nodes in view


def test_series_is_overlaid(series, drawn):
    assert draw(*series) == 0
    (figure,) = drawn
    assert [axes.get_ylabel() for axes in figure.axes] == FRAME
    assert [len(axes.lines) for axes in figure.axes] == [4, 3]  # one a member, and Hertz' pressure
    legend = next(axes.get_legend() for axes in figure.axes if axes.get_legend())
    assert [text.get_text().split(":")[0] for text in legend.texts][:3] == ["0.002", "0.005", "0.01"]
    film = figure.axes[1]
    assert len({line.get_color() for line in film.lines}) == 3


def test_movie_has_every_frame(tmp_path, monkeypatch):
    monkeypatch.setattr(movies, "MAX_FRAMES", 4)
    monkeypatch.setattr(movies, "DPI", 40)
    assert draw(make_result(tmp_path / "one.h5", nodes=41, steps=9), "--movie") == 0
    with image.open(tmp_path / "one.gif") as movie:
        assert movie.n_frames == 4


def test_steady_result_without_contacts_is_drawn(tmp_path, drawn):
    fields = ("pressure", "film_thickness")
    path = make_result(tmp_path / "one.h5", steps=1, fields=fields)
    assert draw(path) == 0
    (figure,) = drawn
    with read_result(path) as steady:
        for axes, name, unit in zip(figure.axes, fields, (1e9, 1e-6), strict=True):
            (line,) = [line for line in axes.lines if len(line.get_xdata()) == len(steady.x)]  # not Hertz's
            np.testing.assert_allclose(line.get_ydata(), steady[name][0] / unit)


def test_default_instant_has_largest_solid_load_or_pressure(tmp_path, result):
    with read_result(result) as r:
        chosen = drawing.frame_to_show(r)
        assert r.steps("p_max")[chosen] == r.steps("p_max").max()
        assert drawing.choose_frames([r], step=12) == [12]
        assert drawing.choose_frames([r], time=10.2e-6) == [10]
    for share, name in ((0.3, "contact_share"), (1e-4, "p_max")):
        with read_result(with_solids(make_result(tmp_path / f"{share}.h5"), share)) as r:
            chosen = drawing.frame_to_show(r)
            assert r.steps(name)[chosen] == r.steps(name).max()


def test_default_instant_excludes_the_entering_profile_edge(tmp_path):
    with read_result(make_result(tmp_path / "r.h5", speed=50.0, rough=True)) as r:
        filled = both_fill(r, r.time)
        assert 0 < filled.sum() < 41
        chosen = drawing.frame_to_show(r)
        assert filled[chosen] and r.steps("p_max")[chosen] == r.steps("p_max")[filled].max()


def test_members_at_different_speeds_are_shown_at_equal_travel(tmp_path):
    """At 5 and 20 m/s, over the same 40 us: the faster one is shown after a quarter of the time."""
    slow, fast = (read_result(make_result(tmp_path / f"{u}.h5", speed=u)) for u in (5.0, 20.0))
    assert drawing.choose_frames([slow, fast], step=40) == [40, 10]
    frames = drawing.choose_frames([fast, slow])
    assert drawing.travel_of(slow)[frames[1]] == pytest.approx(drawing.travel_of(fast)[frames[0]])
    assert drawing.instant([slow, fast], [40, 10]) == "travel 0.67 a"
    with pytest.raises(OutputError, match=r"5\.0\.h5: .* 0\.6673 a, .* 2\.669 a$"):
        drawing.choose_frames([fast, slow], step=40)


def test_rough_result_shows_both_deformed_surfaces(tmp_path, drawn):
    path = make_result(tmp_path / "r.h5", speed=50.0, rough=True)
    assert draw(path, "--step", 30) == 0
    (figure,) = drawn
    assert [axes.get_ylabel() for axes in figure.axes] == [*FRAME, "surfaces [µm]"]
    upper, lower = (line.get_ydata() for line in figure.axes[2].lines)
    with read_result(path) as r:
        film = 1e6 * r.frame("film_thickness", 30)
    np.testing.assert_allclose(upper - lower, film, atol=1e-9)


def test_dry_contact_shows_gap_and_no_flow(tmp_path, drawn):
    path = make_result(tmp_path / "dry.h5")
    change_case(path, {"fluid": None})
    assert draw(path, "--step", 30) == 0
    upper, lower = drawn[0].axes
    assert lower.get_ylabel() == "gap [µm]" and not list(upper.texts)
    assert lower.get_legend().texts[0].get_text() == "gap"


def test_gap_beside_a_closed_contact_is_in_view(tmp_path):
    path = make_result(tmp_path / "closed.h5")
    with h5py.File(path, "r+", libver="latest") as file:
        inside = np.abs(file["x"][:]) <= A
        file["film_thickness"][:, inside] = 0.0
    figure = Figure()
    with read_result(path) as closed:
        beside = 1e6 * closed.frame("film_thickness", 0)[np.abs(closed.x) <= 1.2 * A].max()
        drawing.pressure_and_film(figure.subplots(2), [closed], [0], ["k"], (-1.2, 1.2))
    assert beside > 0.0 and figure.axes[1].get_ylim() == pytest.approx((0.0, 1.15 * beside))


def test_map_includes_contacts_of_skipped_frames(result):
    with read_result(result) as r:
        touching = over_time._contacts(r, slice(0, len(r.x)), 7)
        assert touching.shape == (6, len(r.x))
        np.testing.assert_array_equal(touching.any(axis=0), r.contact_count > 0)


@pytest.mark.parametrize(
    "options, parts",
    [
        (["--around", 40], [" 39.75 a to 40.25 a"]),
        (["--step", 99999], ["--step 99999; allowed: 0 to 40"]),
        (["--step", -1], ["--step -1; allowed: 0 to 40"]),
        (["--time", 1], ["--time 1; allowed: 0 to 4e-05 s"]),
        (["--movie", "-o", "movie.avi"], ["movie.avi: ", " .gif, .mp4, .webm"]),
        (["--report", "-o", "page.csv"], ["page.csv: ", " .html, .htm"]),
        (["--stribeck"], [" motion.entrainment_speed"]),
        (["-o", "/no/where.png"], ["/no/where.png: ", "No such file or directory"]),
        (["-o", "picture.xyz"], ["picture.xyz: "]),
    ],
)
def test_plot_faults_are_reported(result, options, parts, capsys):
    assert draw(result, *options) == 2
    fault = capsys.readouterr().err
    assert fault.startswith("ehlpetsc plot: ") and is_line_with(fault, *parts)


@pytest.mark.parametrize(
    "name, kind", [("one.png", []), ("one.html", ["--report"]), ("one.gif", ["--movie"])]
)
def test_picture_never_overwrites_its_input(tmp_path, result, name, kind, capsys):
    path = result.rename(tmp_path / name)
    before = path.read_bytes()
    (tmp_path / "link.gif").symlink_to(path)
    for place in (path, tmp_path / "link.gif") if kind == ["--movie"] else (path,):
        assert draw(path, *kind, "-o", place) == 2
        assert (
            is_line_with(capsys.readouterr().err, f"{place}: ", f"({path})") and path.read_bytes() == before
        )


def test_undrawable_result_is_reported(tmp_path, capsys):
    steady = make_result(tmp_path / "one.h5", steps=1)
    assert draw(steady, "--map") == 2
    assert is_line_with(capsys.readouterr().err, "one.h5: ", "map", "frame")
    assert draw(make_result(tmp_path / "two.h5", fields=("pressure",))) == 2
    assert is_line_with(capsys.readouterr().err, "two.h5: ", " film_thickness")


def test_contact_pressure_is_drawn_under_the_total(tmp_path):
    path = with_solids(make_result(tmp_path / "mixed.h5", viscosity=0.002))
    assert draw(path, "--step", 12) == 0
    with read_result(path) as r:
        _, axes = figures.two_panels()
        drawing.pressure_and_film(axes, [r], [12], ["k"], (-1.2, 1.2))
        drawing.frame_legend(axes, r, 12, "k")
        (solids,) = axes[0].collections
        drawn = solids.get_paths()[0].get_extents()
        assert drawn.ymax == pytest.approx(1e-9 * r.frame("contact_pressure", 12).max())
        assert [t.get_text() for t in axes[0].get_legend().texts] == [
            "total pressure",
            "of the solids",
            "Hertz",
        ]


SPEEDS = (0.001, 0.02, 0.5, 5.0, 20.0)


@pytest.fixture
def stribeck_series(tmp_path):
    """Share on the solids 1/(1 + u), friction between 0.12 of the solids and 0.03."""
    paths = []
    for speed in SPEEDS:
        share = 1.0 / (1.0 + 5.0 * speed)
        path = make_result(tmp_path / f"u{speed}.h5", speed=speed, nodes=41, steps=81)
        paths.append(with_solids(path, share, 0.03 + 0.09 * share))
    return paths


@pytest.mark.slow
def test_stribeck_curve_has_means_and_scatter(tmp_path, stribeck_series):
    results = [read_result(path) for path in stribeck_series]
    points, short = stribeck.stribeck_points(results)
    assert [p.speed for p in points] == list(SPEEDS) and short == []
    for point in points:
        share = 1.0 / (1.0 + 5.0 * point.speed)
        friction = point.scalars["friction_coefficient"]
        assert friction.mean == pytest.approx(0.03 + 0.09 * share, rel=0.02)
        assert point.scalars["contact_share"].mean == pytest.approx(share, rel=0.02)
        # of a cosine of amplitude 0.2 5 and 95 % lie at 0.2 cos(0.05 pi)
        assert friction.high / friction.mean == pytest.approx(1 + 0.2 * np.cos(0.05 * np.pi), abs=0.02)
        assert friction.low / friction.mean == pytest.approx(1 - 0.2 * np.cos(0.05 * np.pi), abs=0.02)
        assert point.boundary == 0.12
    assert draw(*stribeck_series, "--stribeck", "-o", tmp_path / "s.png") == 0
    assert colours_in(tmp_path / "s.png") > 100


@pytest.mark.parametrize("share", [0.0, 1e-3])
def test_stribeck_axes_are_hersey_number_and_logarithmic_fraction(tmp_path, share):
    paths = [make_result(tmp_path / f"u{u:g}.h5", speed=u, nodes=41, steps=81) for u in (1.0, 10.0)]
    for path in paths:
        change_case(with_solids(path, share, 0.05), {"contact.load": 5e5})
    figure = stribeck.draw_stribeck([read_result(path) for path in paths], None)
    (above,) = figure.axes[0].child_axes
    figure.draw_without_rendering()
    ratio = np.array(above.get_xlim()) / figure.axes[0].get_xlim()
    assert "Hersey" in above.get_xlabel() and ratio == pytest.approx(0.005 / 5e5)  # viscosity over load
    assert figure.axes[1].get_yscale() == ("log" if share else "linear")


def test_stribeck_means_start_when_the_contact_is_filled(tmp_path, capsys):
    paths = [make_result(tmp_path / f"{u}.h5", speed=u, nodes=41, steps=41, rough=True) for u in (5.0, 40.0)]
    slow, fast = (read_result(path) for path in paths)
    # the slower surface, 0.88 u, from -2.5 a to a, and the ramp
    points, short = stribeck.stribeck_points([slow, fast])
    assert ([p.speed for p in points], short) == ([40.0], ["5.0.h5"])  # 40 us are too short for 5 m/s
    assert np.isnan(points[0].scalars["contact_share"].mean)
    with pytest.raises(OutputError, match=r"one result .* motion\.entrainment_speed$"):
        stribeck.stribeck_points([slow])
    unfinished = [read_result(make_result(tmp_path / f"u{u}.h5", speed=u, status="running")) for u in (1, 2)]
    with pytest.raises(OutputError, match="no member .*two or more"):
        stribeck.stribeck_points(unfinished)
    with pytest.raises(OutputError, match=r"no member .* time\.travel "):
        stribeck.stribeck_points([slow, read_result(make_result(tmp_path / "4.h5", speed=4.0, rough=True))])


def test_time_means_are_weighted_by_step_length():
    values = np.array([1.0, 2.0, np.nan, 9.0])
    result = SimpleNamespace(scalars=["load"], steps=lambda name: values)
    found = time_statistics(result, "load", np.array([1.0, 3.0, 1.0, 0.0]))
    assert found.mean == pytest.approx(1.75)
    assert 1.0 <= found.low < found.high <= 2.0
