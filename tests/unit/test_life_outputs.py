"""Which mechanism wins a life; its line and picture."""

import numpy as np
import pytest

from ehlpetsc.life.body import LifeBody
from ehlpetsc.life.driver import line_of
from ehlpetsc.life.history import LifeHistory
from ehlpetsc.life.regimes import outcome, winner
from ehlpetsc.pictures import lives

EDGES = np.array([0.0, 1.0, 2.0, 4.0]) * 1e-7


def life(pits=0, ahead=0.5, rows=2):
    """A life of a body that is worn from row to row."""
    found = LifeHistory('contact = { material = ["100Cr6", "16MnCr5"] }', "title")
    for row in range(1, rows + 1):
        body = LifeBody.new(np.arange(8) * 1e-5, 1e-8 * np.arange(8), EDGES)
        body = body._replace(wear=np.full(8, 2e-8 * row), damage=np.full((3, 8), 0.1 * row))
        if pits:
            body = body._replace(failed=np.full((3, 8), 8e5))
        figures = {"passes": 10 * row, "jump": 10, "solved": 1, "friction": 0.1}
        for k in (1, 2):
            figures |= {f"pits_{k}": pits, f"pitted_share_{k}": 0.1 * pits, f"ra_{k}": body.ra}
            figures |= {f"damage_{k}": 0.1 * row, f"damage_ahead_{k}": ahead, f"wear_volume_{k}": 1e-12 * row}
        found.add(figures, (body._replace(failed=2.0 * body.failed), body), {})  # the first one fails later
    return found


@pytest.mark.parametrize("pits, ahead, wins", [(1, 0.5, "fatigue"), (0, 0.5, "wear"), (0, 1.5, "neither")])
def test_dominant_mechanism_follows_from_pits_and_expected_damage(pits, ahead, wins):
    assert winner(life(pits, ahead)) == wins
    found = outcome(life(pits, ahead))
    assert found["first_failure"] == (8e5 if pits else None) and found["solved"] == 2


def test_line_of_a_round_names_its_figures():
    figures = dict(entry.split("=") for entry in line_of(life(pits=2, rows=3), 3.4).split())
    assert figures.pop("friction") == "0.1000" and figures.pop("wall") == "3s"
    expected = {"solved": 3, "passes": 30, "D1": 0.3, "D2": 0.3, "pitted1": 0.2, "pitted2": 0.2}
    assert {name: float(value) for name, value in figures.items()} == expected | {
        "worn1": 3e-12,
        "worn2": 3e-12,
    }


def test_picture_names_the_steels_of_the_stored_case(tmp_path, monkeypatch):
    drawn = []
    monkeypatch.setattr(lives.style, "save", lambda figure, path: drawn.append(figure))
    lives.draw(life(), tmp_path / "a.png")
    assert drawn[0]._suptitle.get_text() == "title (100Cr6, 16MnCr5)"
    ra = next(axes for axes in drawn[0].axes if axes.get_ylabel() == "Ra [µm]")
    assert [line.get_linestyle() for line in ra.lines] == ["-", "--"], "surface 1 shows through"
