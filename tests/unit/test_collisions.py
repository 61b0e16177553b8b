"""Programs of the paper's figures and pages: collisions, entrapment, shares of micropits."""

import sys

import numpy as np
import pytest
from support import ROOT
from support.made_results import TABLE_1, A

from ehlpetsc.base.errors import OutputError
from ehlpetsc.results.reader import read_result
from ehlpetsc.results.writer import Layout, ResultWriter

sys.path.append(str(ROOT / "cases" / "paper"))
import collisions
import entrapment
import micropits

from ehlpetsc.life.history import read_life

X = np.linspace(-1.5, 1.5, 301)
SPEED = 5.0
FIELDS = ("pressure", "film_thickness", "in_contact")


def make(
    path, viscosity, dips, *, step=0.5e-6, steps=80, bumps=(), bound=0.0, fields=FIELDS, precision="float64"
):
    """A result whose film has moving dips (x/a, time, width [s], depth [um]) below 0.3 um."""
    case = TABLE_1.format(viscosity=viscosity, speed=SPEED)
    attributes = {"title": "dips", "case": case, "a": A, "p0": 1e9, "u1": SPEED, "u2": SPEED}
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
    assert late.dry == (False, False, True, True)
    np.testing.assert_allclose(late.film, [0.1e-6, 0.05e-6, 0, 0], atol=1e-12)
    np.testing.assert_allclose(late.pressure, [1e9, 1e9, 1e9 * (1 + 2 / 0.6), 6e9])
    assert collisions.breakdowns([early, late]) == [late]
    assert entrapment.find(series[-1]) == []


def test_contacts_and_printed_films_are_those_of_the_frame(tmp_path):
    whole = make(tmp_path / "whole.h5", 0.01, [(-0.2, 20e-6, 6e-6, 0.35)])
    assert whole.in_contact.any() and not whole.in_contact.all()
    np.testing.assert_array_equal(whole.contacts_at(40, slice(100, 200)), whole.in_contact[40, 100:200])
    films = make(tmp_path / "film.h5", 0.01, [], fields=FIELDS[:2])
    with pytest.raises(OutputError, match="film.h5: does not store in_contact"):
        films.contacts_at(40)
    result = make(tmp_path / "b.h5", 0.01, [(-0.2, 20e-6, 6e-6, 0.35)], bound=0.0221)
    (found,) = collisions.find([result])
    assert found.film == pytest.approx((0.0221e-6,)) and found.dry == (True,)
    assert " 0.0221,3.00" in collisions.report([found], [0.01], "fluid.viscosity", A)[2]


def test_entrapment_between_two_contacts_is_found_and_drawn(tmp_path):
    dips = [(-0.02, 20e-6, 6e-6, 0.3001), (0.02, 20e-6, 6e-6, 0.3001)]
    at = SPEED * 20e-6 / A
    result = make(tmp_path / "e.h5", 0.01, dips, bumps=[(-at, 6.0)])
    best = entrapment.find(result)[0]
    assert result.time[best.frame] == pytest.approx(20e-6)
    np.testing.assert_allclose(result.x[[best.left, best.peak, best.right]] / A, [-0.02, 0, 0.02], atol=1e-9)
    around = entrapment.instants(result, best, interval=4)
    np.testing.assert_allclose([result.time[f] for f, _ in around], [16e-6, 18e-6, 20e-6, 22e-6])
    np.testing.assert_allclose(np.diff([place for _, place in around]), SPEED * 2e-6)
    upper, lower = np.array(entrapment.draw(result, best).axes).reshape(2, -1)
    for pressure, surfaces, (frame, _) in zip(upper, lower, entrapment.instants(result, best), strict=True):
        x, p = pressure.lines[0].get_data()
        np.testing.assert_allclose(p, 1e-9 * np.interp(x * A, result.x, result.frame("pressure", frame)))
        above, below = (line.get_ydata() for line in surfaces.lines[:2])
        np.testing.assert_allclose(above - below, 1e6 * result.frame("film_thickness", frame), atol=1e-9)


def test_short_form_computes_once_prints_shares_and_draws(tmp_path, capsys, monkeypatch):
    words = [str(tmp_path / "lives"), "first", "--short", "-o", str(tmp_path / "signs.png")]
    micropits.main(words)
    first = capsys.readouterr().out
    files = sorted((tmp_path / "lives").glob("*.life.h5"))
    stamps = [file.stat().st_mtime_ns for file in files]
    monkeypatch.setattr(micropits.style, "save", lambda *_: None)  # drawn by now
    micropits.main(words)
    assert capsys.readouterr().out == first and "first, three seeds, 2 seeds: surface 1: " in first
    assert [file.stat().st_mtime_ns for file in files] == stamps and len(files) == 2
    assert (tmp_path / "signs.png").stat().st_size > 10_000
    lives = [read_life(file) for file in files]
    early, late = (micropits.shares(lives, passes) for passes in (0.3 * micropits.PASSES, micropits.PASSES))
    assert (late >= early).all() and late.sum() > early.sum() > 0.0
    with pytest.raises(SystemExit):
        micropits.main([str(tmp_path), "frist"])
    assert "scene frist; allowed: first, second" in capsys.readouterr().err
