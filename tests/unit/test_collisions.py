"""Collisions are found where they were put, matched by time and place, and judged by exact figures."""

import json

import numpy as np
import pytest
from matplotlib.figure import Figure
from support.made_results import TABLE_1, A

from ehlpetsc.analysis import collisions, entrapment, film_breakdown
from ehlpetsc.errors import OutputError
from ehlpetsc.plot import __main__ as plot
from ehlpetsc.plot.panels.over_time import space_time_map
from ehlpetsc.results import series_index as swept
from ehlpetsc.results.contacts import film_at_contact, in_contact
from ehlpetsc.results.hdf5.datasets import Layout
from ehlpetsc.results.reader import read_result
from ehlpetsc.results.writer import ResultWriter

X = np.linspace(-1.5, 1.5, 301)
SPEED = 5.0
FIELDS = ("pressure", "film_thickness", "in_contact")


def make(
    path,
    viscosity,
    dips,
    *,
    step=0.5e-6,
    steps=80,
    bumps=(),
    bound=0.0,
    fields=FIELDS,
    precision="float64",
):
    """A result whose film has moving dips (x/a, time, width [s], depth [um]) below 0.3 um."""
    attributes = {
        "title": "dips",
        "case": TABLE_1.format(viscosity=viscosity, speed=SPEED),
        "a": A,
        "p0": 1e9,
        "u1": SPEED,
        "u2": SPEED,
    }
    writer = ResultWriter(path, Layout(X * A, fields, precision=precision), attributes)
    for number in range(steps + 1):
        time = number * step
        film, pressure = np.full(len(X), 0.3), np.ones(len(X))
        for x, at, width, depth in dips:
            shape = np.maximum(1 - ((time - at) / width) ** 2, 0)
            film -= depth * shape * np.exp(-(((X - x - SPEED * (time - at) / A) / 0.02) ** 2))
        film = np.maximum(film, bound)
        pressure += 2.0 * (film == bound) * (0.01 / viscosity)
        for x, height in bumps:
            pressure += height * np.exp(-(((X - x - SPEED * time / A) / 0.01) ** 2))
        values = {"pressure": 1e9 * pressure, "film_thickness": 1e-6 * film}
        least = 1e-6 * film.min() if number else 1e-5 * viscosity  # smooth films at the start
        scalars = {"h_min": least, "contacts": (film == bound).sum(), "dt": step}
        writer.append(number, time, values, scalars, film == bound)
    writer.close("done")
    return read_result(path)


@pytest.fixture
def series(tmp_path):
    """Films 0.3 um less a dip that deepens by 0.05 um a member: contact from the third one on."""
    depths = {0.010: 0.2, 0.008: 0.25, 0.006: 0.3001, 0.004: 0.35}
    finer = {0.004: dict(step=0.25e-6, steps=160)}
    return [
        make(
            tmp_path / f"{v}.h5", v, [(-0.2, 20e-6, 6e-6, depth), (0.5, 10e-6, 3e-6, 0.4)], **finer.get(v, {})
        )
        for v, depth in depths.items()
    ]


def test_collisions_are_found_at_their_positions(series):
    early, late = collisions.find(series)
    assert early.touching == (True, True, True, True) and late.touching == (False, False, True, True)
    assert (late.x / A, late.time) == (pytest.approx(-0.2), pytest.approx(20e-6))
    np.testing.assert_allclose(late.film, [0.1e-6, 0.05e-6, 0, 0], atol=1e-12)
    np.testing.assert_allclose(late.pressure, [1e9, 1e9, 1e9 * (1 + 2 / 0.6), 6e9])
    assert early.begin < 10e-6 < early.end < 13e-6
    assert film_breakdown.contact_points([early, late]) == [late]
    assert film_breakdown.ranked([early, late]) == [1, 0]


def test_film_at_its_positive_bound_counts_as_contact(tmp_path):
    result = make(tmp_path / "b.h5", 0.01, [(-0.2, 20e-6, 6e-6, 0.35)], bound=1e-4)
    assert all(c.film == (0.0,) for c in collisions.find([result]))


@pytest.mark.parametrize("bound", [0.0, 1e-2])
@pytest.mark.parametrize("precision", ["float64", "float32"])
def test_contacts_from_flags_equal_contacts_from_the_bound(tmp_path, bound, precision):
    """Also in maps, and also at a bound [um] above zero, which is no number of single precision."""
    dips = [(-0.2, 20e-6, 6e-6, 0.35)]
    whole = make(tmp_path / "whole.h5", 0.01, dips, bound=bound)
    films = make(tmp_path / "film.h5", 0.01, dips, bound=bound, precision=precision, fields=FIELDS[:2])
    assert whole.in_contact.any() and not whole.in_contact.all()
    np.testing.assert_array_equal(in_contact(films, slice(0, len(films.time))), whole.in_contact)
    np.testing.assert_array_equal(in_contact(films, 40, slice(100, 200)), whole.in_contact[40, 100:200])
    np.testing.assert_array_equal(collisions.points_in_contact(films), np.nonzero(whole.in_contact))
    assert film_at_contact(films) == pytest.approx(1e-6 * bound, rel=1e-12)
    figure = Figure()
    space_time_map(figure.subplots(), films, (-1.4, 1.4), 3.0)
    marks = figure.axes[0].collections[1].get_array()
    shown = (films.x >= -1.4 * A) & (films.x <= 1.4 * A)
    np.testing.assert_array_equal(marks.filled(0).ravel(), whole.in_contact[:, shown].ravel())


def test_no_contact_without_a_film_at_its_bound(tmp_path):
    result = make(tmp_path / "open.h5", 0.01, [], fields=FIELDS[:2])
    assert film_at_contact(result) == -np.inf
    assert not in_contact(result, slice(0, len(result.time))).any()


def test_contact_points_are_spread_over_series_members():
    one, two, three = (collisions.Collision(0, 0, 0, 0, (), film, ()) for film in ((1, 0), (1, 0), (2, 1, 0)))
    assert film_breakdown.selected([one, two, three], 2) == [one, three]
    assert film_breakdown.selected([one, two, three], 9) == [one, three, two]


def test_collision_report_of_a_series(tmp_path, series, capsys):
    index = {"members": [{"file": result.path.name} for result in series] + [{"file": "missing.h5"}]}
    (tmp_path / "s.series.json").write_text(json.dumps(index))
    assert collisions.main([str(tmp_path / "s.series.json")]) == 0
    text = capsys.readouterr().out
    assert "2 collisions in 4 members, fluid.viscosity = 0.01, 0.008, 0.006, 0.004" in text
    assert "1 contact points" in text and "..xx" in text
    assert "extrapolate to: 1 of 1 (100 %)" in text
    assert "to the next: 1 of 1 (100 %)" in text


@pytest.mark.parametrize(
    "film, jumps",
    [
        ([4, 3, 2, 1, 0], [0, 0, 0]),  # a straight line
        ([3, 2, 1, 0.5, 0], [0, -0.5, 0]),  # shallower at the end
        ([4, 3, 2.5, 0, 0], [-0.5, 4]),  # half the slope, then all at a stroke
        ([3, 1, 0], [-0.5]),
    ],
)
def test_slope_jumps_at_contact(film, jumps):
    values = np.arange(len(film), 0, -1.0)
    np.testing.assert_allclose(film_breakdown.slope_jumps(values, film), jumps, atol=1e-12)
    np.testing.assert_allclose(film_breakdown.slope_jumps(3 * values, film), jumps, atol=1e-12)


def test_slope_jumps_need_films_and_contact():
    for film in ([3, 2, 1], [1, 0, 0], [0, 0, 0]):
        with pytest.raises(ValueError, match="two films"):
            film_breakdown.slope_jumps([3, 2, 1], film)


def test_pressure_changes_are_those_after_contact():
    np.testing.assert_allclose(film_breakdown.pressure_steps([2, 1, 0, 0, 0], [9, 5, 1, 2, 1]), [1.0, -0.5])
    assert len(film_breakdown.pressure_steps([2, 1, 1], [1, 2, 3])) == 0


def test_members_are_sorted_by_decreasing_film(series):
    ordered, values, key = swept.from_thick_to_thin(series[::-1])
    assert key == "fluid.viscosity" and values == [0.010, 0.008, 0.006, 0.004] and ordered == series
    with pytest.raises(OutputError, match="not a series"):
        swept.from_thick_to_thin([series[0], series[0]])


def test_entrapment_between_two_contacts_is_found(tmp_path):
    dips = [(-0.02, 20e-6, 6e-6, 0.3001), (0.02, 20e-6, 6e-6, 0.3001)]
    at = SPEED * 20e-6 / A
    result = make(tmp_path / "e.h5", 0.01, dips, bumps=[(-at, 6.0)])
    best = entrapment.find(result)[0]
    assert result.time[best.frame] == pytest.approx(20e-6)
    np.testing.assert_allclose(result.x[[best.left, best.peak, best.right]] / A, [-0.02, 0, 0.02], atol=1e-9)
    around = entrapment.instants(result, best, interval=4)
    np.testing.assert_allclose([result.time[f] for f, _ in around], [16e-6, 18e-6, 20e-6, 22e-6])
    np.testing.assert_allclose(np.diff([place for _, place in around]), SPEED * 2e-6)
    lower, upper = entrapment.surfaces(result, best.frame)
    np.testing.assert_allclose(upper - lower, result.frame("film_thickness", best.frame), atol=1e-20)


def test_pressure_peak_outside_contacts_is_no_entrapment(series):
    with pytest.raises(OutputError, match=r"0\.004\.h5: .* 0\.05 a apart"):
        entrapment.find(series[-1])


@pytest.fixture
def drawn(monkeypatch):
    """Figures that a command would have written to files."""
    figures = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, *_, **__: figures.append(figure))
    return figures


def markers(axis, shape):
    """Points that an axis shows with a marker: x and y of all of them."""
    lines = [line.get_xydata() for line in axis.lines if line.get_marker() == shape]
    return np.concatenate(lines) if lines else np.empty((0, 2))


def test_collision_picture_shows_every_member_at_the_collision_time(series, drawn):
    assert plot.main([*(str(result.path) for result in series), "--collision"]) == 0
    (figure,) = drawn
    upper, lower = np.array(figure.axes).reshape(2, -1)
    for column, collision in enumerate([collisions.find(series)[k] for k in (1, 0)]):  # the best first
        assert upper[column].get_title() == f"{1e6 * collision.time:.3f} µs"
        x, frames = (
            X[np.abs(X - collision.x / A) < 0.05],
            [r.nearest_frame(time=collision.time) for r in series],
        )
        for curves, name, unit in ((upper, "pressure", 1e-9), (lower, "film_thickness", 1e6)):
            shown = [
                line
                for line in curves[column].lines
                if line.get_marker() == "None" and len(line.get_xdata()) > 9
            ]
            for result, frame in zip(series, frames, strict=True):
                values = unit * np.interp(x * A, result.x, result.frame(name, frame))
                apart = [np.abs(np.interp(x, *line.get_data()) - values).max() for line in shown]
                assert min(apart) < 1e-9
        touching = [result.frame("in_contact", frame) for result, frame in zip(series, frames, strict=True)]
        inside = np.abs(X - collision.x / A) <= 0.06
        assert len(markers(upper[column], "v")) == sum((t.astype(bool) & inside).sum() for t in touching) > 0


def test_contact_point_picture_shows_film_and_pressure_against_viscosity(series, drawn):
    assert plot.main([*(str(result.path) for result in series), "--points"]) == 0
    (figure,) = drawn
    upper, lower = figure.axes
    (point,) = film_breakdown.contact_points(collisions.find(series))
    values = [0.010, 0.008, 0.006, 0.004]
    np.testing.assert_allclose(
        upper.lines[0].get_xydata(), np.column_stack([values, 1e6 * np.array(point.film)])
    )
    np.testing.assert_allclose(
        lower.lines[0].get_xydata(), np.column_stack([values, 1e-9 * np.array(point.pressure)])
    )
    np.testing.assert_allclose(np.sort(markers(lower, "v")[:, 0]), [0.004, 0.006])  # those without a film
    assert lower.get_xlabel() == "viscosity [Pa s]"


def test_entrapment_picture_shows_four_instants(tmp_path, capsys, drawn):
    dips = [(-0.02, 20e-6, 6e-6, 0.3001), (0.02, 20e-6, 6e-6, 0.3001)]
    make(tmp_path / "e.h5", 0.01, dips, bumps=[(-SPEED * 20e-6 / A, 6.0)]).close()
    assert plot.main([str(tmp_path / "e.h5"), "--entrapment"]) == 0
    (figure,) = drawn
    upper, lower = np.array(figure.axes).reshape(2, -1)
    with read_result(tmp_path / "e.h5") as result:
        instants = entrapment.instants(result, entrapment.find(result)[0])
        assert len(upper) == len(instants) == 4
        for above, below, (frame, place) in zip(upper, lower, instants, strict=True):
            assert above.get_title().endswith(f"{1e6 * result.time[frame]:.2f} µs")
            x, p = above.lines[0].get_data()
            np.testing.assert_allclose(p, 1e-9 * np.interp(x * A, result.x, result.frame("pressure", frame)))
            slow, fast = (line.get_ydata() for line in below.lines[:2])
            film = np.interp(x * A, result.x, result.frame("film_thickness", frame))
            np.testing.assert_allclose(fast - slow, 1e6 * film, atol=1e-9)
            assert x[0] * A < place < x[-1] * A
    assert plot.main([str(tmp_path / "e.h5"), "--collision"]) == 2
    assert "not a series" in capsys.readouterr().err


def test_foreign_json_is_no_series_index(tmp_path, capsys):
    (tmp_path / "x.series.json").write_text("[]")
    assert collisions.main([str(tmp_path / "x.series.json")]) == 2
    assert "x.series.json: not the index" in capsys.readouterr().err
    (tmp_path / "y.series.json").write_text('{"members": [{"file": "no.h5"}]}')
    assert collisions.main([str(tmp_path / "y.series.json")]) == 2
    assert "y.series.json: no member" in capsys.readouterr().err
