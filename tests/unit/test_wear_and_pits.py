"""Wear against micropits: failures at every rate of wear from one life; waves that ensembles leave out."""

import sys
from pathlib import Path

import numpy as np
import pytest
from support import CASES

sys.path.append(str(CASES / "paper"))
import short_waves
import wear_and_pits

from ehlpetsc.case.loading import load, members
from ehlpetsc.life import ensemble
from ehlpetsc.life.body import LifeBody
from ehlpetsc.life.history import LifeHistory
from ehlpetsc.life.positions import Positions, with_shift
from ehlpetsc.physics.scales import Scales

K, PASSES = 1e-15, np.array([100.0, 200.0, 400.0])
DAMAGE = np.array([0.01, 0.03, 0.04])  # of the worst cell
WORN = 0.6  # of the columns, in the last row


def life():
    """A rough body and a smooth one, which fails first; the worst cell of the rough one is worn off last."""
    made = LifeHistory(f"[wear]\ncoefficient = {K:g}\n", "title")
    one = LifeBody.new(np.arange(4.0), np.array([0.0, 1e-7, 0.0, 0.0]), np.array([0.0, 0.5, 1.0]))
    for row, (passes, damage) in enumerate(zip(PASSES, DAMAGE, strict=True)):
        cells = np.zeros((2, 4))
        cells[0, 1], cells[1] = 0.5 * damage, 0.1 * damage
        rough = one._replace(damage=cells, wear=np.where(row == 2, WORN, 0.0) * (one.height > 0.0))
        smooth = one._replace(damage=2.0 * cells)
        figures = {"passes": passes, "solved": 3, "smooth_life_2": 1e8, "smooth_pressure": 1.2e9}
        figures |= {f"damage_{k}": of.largest_damage for k, of in ((1, rough), (2, smooth))}
        made.add(figures, (rough, smooth), {})
    return made


def test_one_life_has_the_failures_of_every_rate_of_wear():
    curve = wear_and_pits.Curve.of(life())
    assert curve.worn == pytest.approx(K * np.append(0.0, PASSES))
    even = 0.25 * K * DAMAGE  # of first cells, one column of four has all damage
    assert curve.damage[1:, 1:] == pytest.approx(np.array([K * DAMAGE, even]))
    assert curve.damage[0, -1] == 0.5 * K * DAMAGE[1], (
        "a cell that is worn off fails no more, nor did it heal"
    )
    assert curve.limits[1] == pytest.approx(K * 0.04) and curve.rise[1] == pytest.approx(0.25)
    for rate, worn in ((0.02 * K, 150 * K), (0.04 * K, 400 * K)):  # D(N; k) = F(kN)/k = 1
        assert curve.passes(rate)[1] == pytest.approx(worn / rate)
    assert curve.passes(1.001 * curve.limits[1])[1] == np.inf


def test_lines_and_picture_of_all_films(monkeypatch, tmp_path, capsys):
    lives = {"0.3": [life(), life()], "1": [life()]}
    monkeypatch.setattr(wear_and_pits, "compute", lambda *_: lives)
    wear_and_pits.main([str(tmp_path / "lives"), "--seeds", "1,2", "-o", str(tmp_path / "a.png")])
    printed = capsys.readouterr().out.splitlines()
    assert printed[0].startswith("lambda 0.3, life 1, 9 passes to kN = 4e-13 m^2/N: Sq 43 ->")
    assert "no failure from k = 4e-17 m^2/N on (last round +25.0%); first failure at" in printed[2]
    assert printed[-2] == "smooth contact: 1e+08 passes at 1.2e+09 Pa"
    assert (tmp_path / "a.png").stat().st_size > 10_000


@pytest.mark.parametrize("is_strip", [False, True])
def test_points_pass_under_every_film(is_strip, monkeypatch, tmp_path):
    made = []
    monkeypatch.setattr(ensemble, "run_lives", lambda case, *_, **__: made.append(case))
    monkeypatch.setattr(wear_and_pits, "read_lives", lambda index: {"": []})
    films = wear_and_pits.compute(Path(tmp_path), is_strip)
    assert [*films] == [*(wear_and_pits.STRIP if is_strip else wear_and_pits.LINE)] and len(made) == len(
        films
    )
    for case in made:
        (_, member), *others = members(case)
        assert len(others) == 2 and member.life.break_out == "none"
        case = with_shift(member)
        Positions(case, Scales.of(case)).check_travel()


def test_waves_that_are_left_out_are_the_short_ones_alone():
    x, heights = short_waves.profiles(1)
    waves = np.fft.rfftfreq(x.size, x[1] - x[0])
    both, long = (np.abs(np.fft.rfft(heights[name])) for name in ("all", "long"))
    is_long = waves <= 1.0 / short_waves.LONGEST
    assert heights["long"].std() == pytest.approx(short_waves.SQ)
    assert both[is_long] == pytest.approx(long[is_long], abs=1e-9 * both.max())
    assert long[~is_long].max() < 1e-9 * both.max()
    added = np.sqrt(heights["all"].var() - heights["long"].var())
    # spectra 1 to q0, then q^-2.6: (1 + (1 - 9^-1.6)/1.6)/(1 + (1 - 3^-1.6)/1.6) - 1
    assert added == pytest.approx(0.242 * short_waves.SQ, rel=0.05)


def test_a_pass_of_short_waves_is_a_case_and_its_first_failures_are_printed(tmp_path, monkeypatch, capsys):
    made = life()
    cells = np.zeros((2, 4))
    cells[1, 2] = 1e-6
    made.rows[0]["p_max"] = 3e9
    made.bodies[0] = tuple(body._replace(damage_rate=cells) for body in made.bodies[0])
    monkeypatch.setattr(short_waves, "run_life", lambda case, path, **_: made)
    short_waves.main([str(tmp_path), "2"])
    printed = capsys.readouterr().out.splitlines()
    assert len(printed) == len(short_waves.RUNS)
    first = "first failures after 1e+06 and 1e+06 passes, 750000.0 and 750000.0 um deep"
    assert printed[0] == f"seed 2, all waves, a/96: 3.00 GPa, {first}"
    case = with_shift(load(short_waves.CASE, short_waves.settings(tmp_path / "all_2.csv", 32)))
    Positions(case, Scales.of(case)).check_travel()
