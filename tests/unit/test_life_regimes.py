"""Regimes of lives: which mechanism wins, their index, its picture; rounds to come; the movie of a life."""

import json
from types import SimpleNamespace

import numpy as np
import pytest
from support import refused

from ehlpetsc.life.body import LifeBody
from ehlpetsc.life.command import main
from ehlpetsc.life.history import LifeHistory
from ehlpetsc.life.jumps import Jumps, Rates
from ehlpetsc.life.one_pass import OfBody
from ehlpetsc.life.regimes import outcome, winner
from ehlpetsc.surfaces.body_field import BodyField

EDGES = np.array([0.0, 1.0, 2.0, 4.0]) * 1e-7


def life(pits=0, ahead=0.5, rows=2):
    """A life of a body that is worn from row to row."""
    found = LifeHistory("text", "title")
    for row in range(1, rows + 1):
        body = LifeBody.new(np.arange(8) * 1e-5, 1e-8 * np.arange(8), EDGES)
        body = body._replace(wear=np.full(8, 2e-8 * row), damage=np.full((3, 8), 0.1 * row))
        if pits:
            body = body._replace(failed=np.full((3, 8), 8e5))
        figures = {"passes": 10 * row, "jump": 10, "solved": 1, "friction": 0.1}
        for k in (1, 2):
            figures |= {f"pits_{k}": pits, f"pitted_share_{k}": 0.1 * pits, f"ra_{k}": body.ra}
            figures |= {f"damage_{k}": 0.1 * row, f"damage_ahead_{k}": ahead, f"wear_volume_{k}": 1e-12 * row}
        found.add(figures, (body, body), {})
    return found


@pytest.mark.parametrize("pits, ahead, wins", [(1, 0.5, "fatigue"), (0, 0.5, "wear"), (0, 1.5, "neither")])
def test_dominant_mechanism_follows_from_pits_and_expected_damage(pits, ahead, wins):
    assert winner(life(pits, ahead)) == wins
    found = outcome(life(pits, ahead))
    assert found["worn_depth"] == pytest.approx(4e-8) and found["first_failure"] == (8e5 if pits else None)
    assert found["solved"] == 2 and found["ra_change"] == pytest.approx(0.0, abs=1e-12)


def test_regime_picture_is_drawn_from_the_index(tmp_path, capsys):
    rows = [
        {"value": [k, friction], "file": "", "state": "done"} | outcome(life(pits, ahead))
        for k, pits, ahead in ((1e-19, 2, 9.0), (1e-17, 0, 0.1))
        for friction in (0.1, 0.2)
    ]
    rows.append({"value": [1e-18, 0.1], "file": "", "state": "waiting"})
    path, keys = tmp_path / "a.life.series.json", ["wear.coefficient", "contact.boundary_friction"]
    path.write_text(json.dumps({"title": "t", "keys": keys, "members": rows, "case": ""}))
    assert main([str(path)]) == 0
    assert (tmp_path / "a.life.series.png").read_bytes().startswith(b"\x89PNG")
    path.write_text("{}")
    assert "a.life.series.json: not an index" in refused(capsys, main, path)


def test_movie_has_a_frame_per_round(tmp_path, capsys):
    from PIL import Image

    path = tmp_path / "a.life.h5"
    life(rows=3).save(path)
    assert main([str(path), "--movie", str(tmp_path / "a.gif")]) == 0
    with Image.open(tmp_path / "a.gif") as movie:
        assert movie.n_frames >= 3
    assert "--movie" in refused(capsys, main, path, "--movie", tmp_path / "a.txt")


def test_remaining_rounds_are_extrapolated():
    body = LifeBody.new(np.arange(8) * 1e-5, np.zeros(8), EDGES)
    none = BodyField(0.25e-5, 0, np.zeros(0))
    worn = none.add((np.arange(9) - 0.5) * 1e-5, np.full(8, 0.9999e-11))
    of = OfBody(body.s, np.array([0.0, 4e-7]), np.zeros((2, 8)), (none, worn))

    def rates(bodies):
        return tuple(Rates(*one.rates(of), of.volume) for one in bodies)

    one = SimpleNamespace(rates=rates, yielded=0.0, passes=[None])
    jumps = Jumps(SimpleNamespace(passes=1e5, wear_jump=0.05, damage_jump=0.1, break_out="above"), 2e-7)
    bodies, jump, _ = jumps.jump((body, body), one, 0)
    assert jump == 1000 and bodies[0].wear == pytest.approx(0.9999e-8)
    assert jumps.expected_rounds((body, body), one, 0) == (100, 100)
    assert jumps.expected_rounds((body, body), one, 99_500) == (1, 1)
    # more rounds than are looked at one by one
    assert Jumps(jumps.life, 2e-8).expected_rounds((body, body), one, 0) == (1000, 1000)
