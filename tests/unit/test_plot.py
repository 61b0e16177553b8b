"""Pictures of results and cases: drawn arrays, the chosen instant, formats and options, refusals."""

from types import SimpleNamespace
from xml.etree import ElementTree

import h5py
import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from PIL import Image as image
from support import CASES, is_line_with
from support.made_results import A, change_case, make_result, with_solids

from ehlpetsc.base.errors import OutputError
from ehlpetsc.case.loading import load
from ehlpetsc.commands import plot
from ehlpetsc.elasticity.bodies import reduced_modulus
from ehlpetsc.physics.contact.hertz import hertz_line
from ehlpetsc.physics.scales import Scales
from ehlpetsc.pictures import style
from ehlpetsc.pictures.case_surfaces import draw_case, passing
from ehlpetsc.pictures.frames import choice as drawing
from ehlpetsc.pictures.frames import line
from ehlpetsc.pictures.frames.data import Frame, common
from ehlpetsc.results.means import both_fill
from ehlpetsc.results.reader import read_result
from ehlpetsc.surfaces.motion.roughness import Roughness

FRAME = ["pressure [GPa]", "film thickness [µm]"]
LATER = ["--time", 1e-5, "--window", 0.05, 0.55]
MAP = ["time [µs]", "pressure [GPa]"]  # of the panel and of its colours
COURSES = ["film [µm]", "maximum\npressure [GPa]", "friction\ncoefficient"]
OPTIONS = plot.arguments().parse_args(["x"])


@pytest.fixture
def result(tmp_path):
    return make_result(tmp_path / "one.h5")


@pytest.fixture
def series(tmp_path):
    return [make_result(tmp_path / f"{v}.h5", viscosity=v, nodes=81, steps=21) for v in (0.010, 0.002, 0.005)]


def draw(*arguments):
    return plot.main([str(a) for a in arguments])


def reversing(path, load=None):
    """A result of 41 steps whose speeds reverse: no net displacement after a period of 40 us.

    Its share on the solids is largest at step 0, where `load` [N/m] may be small.
    """
    with_solids(make_result(path), share=0.5, scatter=0.5)
    with h5py.File(path, "r+", libver="latest") as file:
        steps, time = file["steps"], file["steps/time"][:]
        phase = 2.0 * np.pi * time / time[-1]
        u = 0.2 * np.cos(phase)
        load = np.full(time.size, 527e3) if load is None else load
        values = {"load_given": load, "radius": np.full(time.size, 0.0191), "speed_1": u, "speed_2": u}
        values |= {f"displacement_{side}": 0.2 * np.sin(phase) * time[-1] / (2.0 * np.pi) for side in "12"}
        for name, column in values.items():
            steps.create_dataset(name, data=column, maxshape=(None,))
        steps["load"][:] = load
    return path


@pytest.mark.parametrize(
    "options, name, title, window, panels",
    [
        ([], "one.png", "made up: step 0, 0 µs, travel 0.00 a", (-1.6, 1.4), FRAME),
        (LATER, "one.png", "made up: step 10, 10 µs, travel 0.17 a", (0.05, 0.55), FRAME),
        (["--over-time"], "one.over_time.png", "made up", (0.0, 0.04), COURSES),
        (["--map", "--window", -0.5, 0.5], "one.map.png", "made up", (-0.5, 0.5), MAP),
    ],
)
def test_picture_of_one_result(tmp_path, result, drawn, capsys, options, name, title, window, panels):
    assert draw(result, *options) == 0
    assert capsys.readouterr().out == f"{tmp_path / name}\n"
    (figure,) = drawn
    conditions = "u = 5 m/s, slide/roll ratio 0.24, a = 0.336 mm, p0 = 1 GPa, oil 5 mPa s"
    assert figure._suptitle.get_text() == f"{title}\n{conditions}"
    assert figure.axes[0].get_xlim() == pytest.approx(window)
    assert [axes.get_ylabel() for axes in figure.axes] == panels


def test_any_scalar_is_drawn_over_time_of_several_results(tmp_path, capsys):
    one, two = (make_result(tmp_path / f"{v}.h5", viscosity=v, steps=5) for v in (0.005, 0.01))
    assert plot.main([str(one), str(two), "--steps", "p_max"]) == 0
    assert capsys.readouterr().out.strip().endswith(".p_max.png")
    options = SimpleNamespace(steps="p_max")
    with read_result(one) as first, read_result(two) as second:
        (axes,) = line.draw_scalar([first, second], options).axes
        assert axes.get_ylabel() == "maximum pressure [Pa]"
        for curve, result, words in zip(axes.lines, (first, second), ("0.005", "0.01"), strict=True):
            np.testing.assert_array_equal(curve.get_ydata(), result.steps("p_max"))
            np.testing.assert_allclose(curve.get_xdata(), 1e3 * result.steps("time"))
            assert curve.get_label() == f"viscosity = {words}"
    assert plot.main([str(one), "--steps", "p_maximum"]) == 2
    assert f"{one}: --steps p_maximum: not stored; allowed: " in capsys.readouterr().err
    assert plot.main([str(make_result(tmp_path / "steady.h5", steps=1)), "--steps", "p_max"]) == 2
    assert "is steady; allowed: --steps of runs over time" in capsys.readouterr().err


def test_steps_of_a_cycle_are_drawn_over_time(tmp_path):
    with read_result(reversing(tmp_path / "c.h5")) as r:
        panels = {axes.get_ylabel(): axes for axes in line.draw_courses([r], None).axes}
        speeds = panels["speed [m/s]"].lines
        np.testing.assert_allclose(speeds[1].get_xydata(), np.c_[1e3 * r.steps("time"), r.steps("speed_2")])
        assert [to_hex(line.get_color()) for line in speeds] == list(style.SURFACES.values())
        load = panels["load [N/mm]"].lines[0].get_ydata()
        np.testing.assert_allclose(load, 1e-3 * r.steps("load_given"))
    assert {"friction\ncoefficient", "share of the load\non the solids"} <= set(panels)


@pytest.mark.parametrize("words", [["step", 30], ["time", 30e-6], []])
def test_frame_of_a_reversing_contact_is_found(tmp_path, drawn, words):
    """Its displacement returns to zero: by displacement frames after the first ones were out of reach."""
    path = reversing(tmp_path / "needle.h5")
    assert draw(path, *(f"--{words[0]}", words[1]) if words else ()) == 0
    with read_result(path) as r:
        shown = drawing.choose_frames([r], **dict([words] if words else []))
        expected = 30 if words else int(np.argmax(r.steps("contact_share")))
        assert shown == [expected]
        x, film = drawn[0].axes[1].lines[0].get_data()
        part = np.isin(r.x / A, x)
        assert np.count_nonzero(part) > 100
        np.testing.assert_allclose(film, 1e6 * r.frame("film_thickness", expected)[part])


def test_hertz_contact_and_flow_are_those_of_the_instant(tmp_path, drawn):
    """Load and speed of step 20: a tenth of the greatest load, and to the left."""
    load = np.linspace(527e3, 52.7e3, 41)
    path = reversing(tmp_path / "v.h5", load)
    assert draw(path, "--step", 20) == 0
    (figure,) = drawn
    upper = figure.axes[0]
    a, p0 = hertz_line(load[20], 0.0191, reduced_modulus((207e9, 207e9), (0.3, 0.3)))
    x, pressure = next(line for line in upper.lines if line.get_linestyle() == ":").get_data()
    assert pressure.max() == pytest.approx(1e-9 * p0, rel=1e-3)
    assert np.abs(x[pressure > 0.0]).max() == pytest.approx(a / A, abs=0.01)
    named = f"u = -0.2 m/s, slide/roll ratio 0, a = {1e3 * A:.3g} mm, half-width {a / A:.3g} a, p0 = "
    assert named in figure._suptitle.get_text()  # a is the unit of x/a
    assert [text.get_text() for text in upper.texts] == ["← flow"]
    assert upper.get_ylim()[1] >= pressure.max()


def test_film_axis_ends_above_the_film_in_the_contact_of_the_instant(tmp_path, drawn):
    """Under a ninetieth of the load the contact is a tenth as wide, the film beside it much thicker."""
    path = reversing(tmp_path / "v.h5", np.linspace(527e3, 6e3, 41))
    assert draw(path, "--step", 40) == 0
    with read_result(path) as r:
        inside = np.abs(r.x) <= (6 / 527) ** 0.5 * A
        thickest = 1e6 * r.frame("film_thickness", 40)[inside].max()
        limits = common(Frame.of(r, k, (-1.6, 1.4)).limits for k in (39, 40))
        assert limits.high >= Frame.of(r, 40, (-1.6, 1.4)).limits.high == pytest.approx(1.15 * thickest)
    assert drawn[0].axes[1].get_ylim()[1] == pytest.approx(1.15 * thickest)


def test_picture_options_and_formats(tmp_path, result, drawn, monkeypatch):
    words = ["--dpi", 50, "--size", 4, 3, "--no-title"]
    assert draw(result, *words) == 0
    (figure,) = drawn
    assert tuple(figure.get_size_inches()) == (4.0, 3.0) and figure._suptitle.get_text() == ""
    monkeypatch.undo()
    assert draw(result, *words, "-o", tmp_path / "out.png") == 0
    with image.open(tmp_path / "out.png") as picture:
        assert picture.size == (200, 150)
        assert len(picture.convert("RGB").getcolors(30_000)) > 30
    assert draw(result, "-o", tmp_path / "out.svg") == 0
    root = ElementTree.parse(tmp_path / "out.svg").getroot()
    lines = [path.get("d", "") for path in root.iter("{http://www.w3.org/2000/svg}path")]
    assert sum(line.count("L") > 50 for line in lines) >= 3  # curves over the nodes in view


def test_series_is_overlaid_in_order_of_its_key(series, drawn):
    assert draw(*series) == 0
    (figure,) = drawn
    assert [axes.get_ylabel() for axes in figure.axes] == FRAME
    assert [len(axes.lines) for axes in figure.axes] == [4, 3]  # one a member, and Hertz' pressure
    legend = next(axes.get_legend() for axes in figure.axes if axes.get_legend())
    assert [text.get_text() for text in legend.texts][:3] == ["0.002", "0.005", "0.01"]
    brightness = [sum(line.get_color()[:3]) for line in figure.axes[1].lines]
    assert brightness == sorted(brightness)
    figure.draw_without_rendering()
    for axes in figure.axes:
        if axes.get_legend():
            assert axes.get_legend().get_window_extent().x0 >= axes.get_window_extent().x1


def test_contact_is_outlined_in_a_map_without_hiding_the_pressure(result):
    with h5py.File(result, "r+", libver="latest") as file:
        file["in_contact"][:] = (np.abs(file["x"][:]) < 0.5 * A)[None, :]
    with read_result(result) as r:
        axes = line.draw_map([r], OPTIONS).axes[0]
    marks = axes.collections
    assert len(axes.images) == 1 and not any(mark.get_facecolor().size for mark in marks)
    outline = np.concatenate([path.vertices for mark in marks for path in mark.get_paths()])
    np.testing.assert_allclose(np.abs(outline[:, 0]), 0.5, atol=0.03)


def test_movie_has_every_frame_on_fixed_axes(tmp_path, monkeypatch):
    seen = []

    class Writer(drawing.PillowWriter):
        def grab_frame(self, **keys):
            bounds = [(*axes.get_position().bounds, *axes.get_ylim()) for axes in self.fig.axes]
            seen.append((bounds, self.fig._suptitle.get_text()))
            super().grab_frame(**keys)

    monkeypatch.setattr(drawing, "PillowWriter", Writer)
    monkeypatch.setattr(drawing, "MOVIE_FRAMES", 4)
    monkeypatch.setattr(drawing, "MOVIE_DPI", 40)
    assert draw(reversing(tmp_path / "one.h5"), "--movie") == 0
    with image.open(tmp_path / "one.gif") as shown:
        assert shown.n_frames == 4
    assert all(bounds == seen[0][0] for bounds, _ in seen)
    steps = [title.partition("step ")[2].partition(",")[0] for _, title in seen]
    assert steps == ["0", "13", "27", "40"]


def test_default_instant_has_the_maximum_load_on_the_solids_or_pressure(tmp_path, result):
    """Not the maximum share, which is at the ends of a gear's path under next to no load."""
    with read_result(reversing(tmp_path / "g.h5", np.linspace(1e3, 527e3, 41))) as r:
        carried = r.steps("contact_share") * r.steps("load")
        assert drawing.frame_to_show(r) == np.argmax(carried) != np.argmax(r.steps("contact_share"))
    with read_result(result) as r:
        assert r.steps("p_max")[drawing.frame_to_show(r)] == r.steps("p_max").max()
    for share, name in ((0.3, "contact_share"), (1e-4, "p_max")):
        with read_result(with_solids(make_result(tmp_path / f"{share}.h5"), share)) as r:
            assert r.steps(name)[drawing.frame_to_show(r)] == r.steps(name).max()
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


def test_rough_result_shows_both_deformed_surfaces_in_their_colours(tmp_path, drawn):
    path = make_result(tmp_path / "r.h5", speed=50.0, rough=True)
    assert draw(path, "--step", 30) == 0
    (figure,) = drawn
    assert [axes.get_ylabel() for axes in figure.axes] == [*FRAME, "surfaces [µm]"]
    first, second = figure.axes[2].lines
    with read_result(path) as r:
        film = 1e6 * r.frame("film_thickness", 30)
    np.testing.assert_allclose(first.get_ydata() - second.get_ydata(), film, atol=1e-9)
    assert [to_hex(line.get_color()) for line in (first, second)] == [style.SURFACES[side] for side in "12"]


def test_dry_contact_shows_gap_and_no_flow(tmp_path, drawn):
    path = make_result(tmp_path / "dry.h5")
    change_case(path, {"fluid": None})
    assert draw(path, "--step", 30) == 0
    upper, lower = drawn[0].axes
    assert lower.get_ylabel() == "gap [µm]" and not list(upper.texts)
    assert "gap" in [text.get_text() for text in lower.get_legend().texts]


@pytest.mark.parametrize("share", [0.8, 0.0])
def test_pressure_of_the_solids_is_drawn_under_the_total(tmp_path, share):
    path = with_solids(make_result(tmp_path / "mixed.h5", viscosity=0.002))
    with h5py.File(path, "r+", libver="latest") as file:
        file["contact_pressure"][:] *= share
    with read_result(path) as r:
        axes = Figure().subplots(2)
        line.fill(axes, drawing.Choice([r], [12], (-1.2, 1.2)))
        highest = 1e-9 * r.frame("contact_pressure", 12).max()
    drawn = [solids.get_paths()[0].get_extents().ymax for solids in axes[0].collections]
    assert drawn == ([pytest.approx(highest)] if share else [])
    names = {text.get_text() for text in axes[0].get_legend().texts}
    assert names == {"pressure", "Hertz"} | ({"of the solids"} if share else set())


@pytest.mark.parametrize(
    "options, parts",
    [
        (["--window", 39.75, 40.25], [" 39.75 a to 40.25 a"]),
        (["--step", 99999], ["99999; allowed: 0 to 40"]),
        (["--time", 1], ["at 1; allowed: 0 to 4e-05"]),
        (["--movie", "-o", "movie.avi"], ["movie.avi: ", " .gif"]),
        (["--report", "-o", "page.csv"], ["page.csv: ", " .html, .htm"]),
        (["--stribeck"], [" motion.entrainment_speed"]),
        (["-o", "picture.xyz"], ["picture.xyz: "]),
    ],
)
def test_plot_faults_are_reported(result, options, parts, capsys):
    assert draw(result, *options) == 2
    fault = capsys.readouterr().err
    assert fault.startswith("ehlpetsc plot: ") and is_line_with(fault, *parts)


def test_case_picture_shows_parameters_and_passing_length(tmp_path, capsys):
    case = load(CASES / "fig1.toml")
    scales = Scales.of(case)
    profile = Roughness.of(case, scales).surface_1
    begin, end = passing(profile, case, scales)
    assert begin == profile.X[0]
    assert end - begin == pytest.approx((case.time.travel - 1.5 - 2.0) * scales.a, rel=1e-9)
    short = load(CASES / "fig1.toml", ["time.travel=3"])
    scales = Scales.of(short)
    assert np.ptp(passing(Roughness.of(short, scales).surface_1, short, scales)) == 0.0
    out = tmp_path / "c.png"
    assert draw(CASES / "table1_rough.toml", "-o", out) == 0
    assert capsys.readouterr().out == f"{out}\n"
    with image.open(out) as picture:
        assert len(picture.convert("RGB").getcolors(picture.width * picture.height)) > 100
    figure = draw_case(CASES / "table1_rough.toml", ["time.travel=5"])
    title = figure.axes[0].get_title(loc="left")
    assert title.startswith("Ra 0.079 µm") and "Rsk 0.08" in title and "travel 1.50 a of 5 a" in title
    title = draw_case(CASES / "fzg.toml")._suptitle.get_text()
    assert "slide/roll" not in title and "of the widest contact; conditions over time" in title


@pytest.mark.parametrize(
    "words, message",
    [
        (["--size", "0", "3"], "--size: 0: allowed: a number >= 0.1 and <= 100"),
        (["--dpi", "nan"], "--dpi: nan: allowed: a number >= 1 and <= 10000"),
        (["--window", "3", "1"], "--window 3 1: allowed: LOW below HIGH"),
    ],
)
def test_option_out_of_range_is_named_and_draws_nothing(tmp_path, capsys, words, message):
    result = make_result(tmp_path / "one.h5", steps=3)
    try:
        status = plot.main([str(result), *words])
    except SystemExit as end:
        status = end.code
    assert status == 2 and is_line_with(capsys.readouterr().err, message)
    assert list(tmp_path.iterdir()) == [result]
