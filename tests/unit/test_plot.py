"""Pictures: each kind is drawn, the right instant is chosen, and faults are told."""

import numpy as np
import pytest
from made_results import A, make_result
from PIL import Image as image

from ehlpetsc.plot import __main__ as plot
from ehlpetsc.plot import frames as drawing
from ehlpetsc.results import series_index as swept
from ehlpetsc.results.reader import read_result
from ehlpetsc.results.writer import ResultWriter


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
        return len(np.unique(np.asarray(picture.convert("RGB")).reshape(-1, 3), axis=0))


@pytest.mark.parametrize(
    "options, name",
    [
        ([], "one.png"),
        (["--step", 12], "one.png"),
        (["--time", 1e-5, "--around", 0.3], "one.png"),
        (["--map"], "one.map.png"),
        (["--map", "--around", 0, "--width", 1], "one.map.png"),
        (["--contacts"], "one.contacts.png"),
    ],
)
def test_picture_is_drawn_beside_the_result(tmp_path, result, options, name, capsys):
    assert draw(result, *options) == 0
    assert capsys.readouterr().out == f"{tmp_path / name}\n"
    with image.open(tmp_path / name) as picture:
        assert min(picture.size) > 600
    assert colours_in(tmp_path / name) > 30


def test_svg_holds_text_and_lines(tmp_path, result):
    assert draw(result, "-o", tmp_path / "out.svg") == 0
    assert "<svg" in (tmp_path / "out.svg").read_text()


@pytest.mark.parametrize("kind", [[], ["--contacts"], ["--map"]])
def test_series_is_overlaid(tmp_path, series, kind):
    assert draw(*series, *kind, "-o", tmp_path / "out.png") == 0
    assert colours_in(tmp_path / "out.png") > 100


def test_movie_has_a_picture_each_frame(tmp_path, monkeypatch):
    monkeypatch.setattr(plot, "MOVIE_FRAMES", 4)
    monkeypatch.setattr(plot, "MOVIE_DPI", 40)
    assert draw(make_result(tmp_path / "one.h5", nodes=41, steps=9), "--movie") == 0
    with image.open(tmp_path / "one.gif") as movie:
        assert movie.n_frames == 4


def test_steady_and_dry_results_are_drawn(tmp_path):
    fields = ["pressure", "film_thickness"]
    assert draw(make_result(tmp_path / "one.h5", steps=1, fields=fields)) == 0


def test_instant_is_the_one_with_most_contacts(result):
    with read_result(result) as r:
        chosen = drawing.frame_with_most_contacts(r)
        assert r["in_contact"][chosen].sum() == r["in_contact"][:].sum(axis=1).max()
        assert plot.choose_frames([r], step=12) == [12]
        assert plot.choose_frames([r], time=10.2e-6) == [10]


def test_instant_is_that_of_the_highest_pressure_if_nothing_touches(tmp_path):
    x = np.linspace(-1, 1, 11)
    writer = ResultWriter(
        tmp_path / "r.h5",
        case_text="",
        title="",
        x=x * A,
        fields=["pressure", "film_thickness"],
        every=2,
        scalars_attrs={"a": A, "p0": 1e9},
        precision="float64",
        profiles={},
    )
    for step, highest in enumerate([1.0, 9.0, 3.0, 8.0, 2.0]):  # the odd steps are not stored
        values = {"pressure": np.full(11, highest), "film_thickness": np.ones(11)}
        writer.append(step, step * 1e-6, values, {"p_max": highest, "contacts": 0}, np.zeros(11, bool))
    writer.close("done")
    with read_result(tmp_path / "r.h5") as r:
        assert r.step[drawing.frame_with_most_contacts(r)] == 2


def test_members_of_a_series_are_shown_at_the_same_time(tmp_path):
    coarse = make_result(tmp_path / "a.h5", steps=11)
    fine = make_result(tmp_path / "b.h5", steps=41)
    with read_result(coarse) as a, read_result(fine) as b:
        assert plot.choose_frames([a, b], step=5) == [5, 20]


def test_series_is_sorted_and_labelled_by_its_swept_value(series):
    results = [read_result(path) for path in series]
    ordered = swept.in_order(results)
    colours, labels, key = drawing.series_colours(ordered)
    assert (key, labels) == ("fluid.viscosity", ["0.002", "0.005", "0.01"])
    brightness = [sum(colour[:3]) for colour in colours]
    assert brightness == sorted(brightness)
    same = [results[0], results[0]]
    assert drawing.series_colours(same)[1:] == (["0.01", "0.01"], None)


def test_polynomial_and_mean_follow_the_counts(tmp_path, result):
    figure, axes = plot.plt.subplots(2)
    with read_result(result) as r:
        (mean,) = drawing.contact_rates(axes, [r], ["k"])
        inside = np.abs(r.x) <= A
        assert mean == pytest.approx(r.contact_rate()[inside].mean())
        fit = axes[1].lines[0].get_ydata()
        assert np.mean(fit) == pytest.approx(mean, rel=0.02)
    plot.plt.close(figure)


def test_map_keeps_contacts_of_frames_it_does_not_draw(result):
    with read_result(result) as r:
        touching = drawing._contacts(r, slice(0, len(r.x)), 7)
        assert touching.shape == (6, len(r.x))
        np.testing.assert_array_equal(touching.any(axis=0), r.contact_count > 0)


@pytest.mark.parametrize(
    "options, message",
    [
        (["--around", 40], "fewer than two nodes from 39.75 a to 40.25 a"),
        (["-o", "/no/where.png"], "No such file or directory"),
        (["-o", "picture.xyz"], "xyz"),
    ],
)
def test_faults_are_told_in_words(result, options, message, capsys):
    assert draw(result, *options) == 2
    fault = capsys.readouterr().err
    assert fault.startswith("ehlpetsc.plot: ") and message in fault


def test_what_cannot_be_drawn_is_told(tmp_path, capsys):
    steady = make_result(tmp_path / "one.h5", steps=1)
    assert draw(steady, "--map") == 2
    assert "more than one stored frame" in capsys.readouterr().err
    assert draw(steady, "--contacts") == 2
    assert "no contacts per millisecond" in capsys.readouterr().err
    assert draw(make_result(tmp_path / "two.h5", fields=["pressure"])) == 2
    assert "does not store film_thickness" in capsys.readouterr().err
