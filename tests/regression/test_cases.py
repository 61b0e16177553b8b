"""Every case of cases/ in its short form gives the figures stored; see short_cases.py for refreshing them."""

import json

import pytest
from short_cases import EXPECTED, NEWTON_SLACK, RTOL, SHORT, results
from support import ROOT

STORED = json.loads(EXPECTED.read_text())
LOAD_ERROR = 1e-8


def test_no_case_is_left_out():
    assert set(SHORT) == set(STORED) == {path.stem for path in (ROOT / "cases").glob("*.toml")}


@pytest.mark.parametrize("name", SHORT)
def test_case_gives_the_stored_figures(name, tmp_path):
    found, stored = results(name, tmp_path), STORED[name]
    assert found.keys() == stored.keys()
    for file, expected in stored.items():
        figures = found[file]
        for figure in ("steps", "contacts", "retries"):
            assert figures[figure] == expected[figure], (file, figure)
        for figure in ("h_min", "h_central", "p_max", "friction", "approach"):
            assert figures[figure] == pytest.approx(expected[figure], rel=RTOL, abs=0), (file, figure)
        # between dry contacts the pressure is next to nothing
        scale = RTOL * expected["p_max"]
        assert figures["p_central"] == pytest.approx(expected["p_central"], rel=0, abs=scale), file
        factor, more = NEWTON_SLACK
        assert figures["newton"] <= factor * expected["newton"] + more, file
        assert figures["load_error"] < LOAD_ERROR, file
