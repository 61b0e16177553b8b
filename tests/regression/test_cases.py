"""Every case of cases/ in its short form reproduces stored values; short_cases.py refreshes them."""

import json

import pytest
from short_cases import EXPECTED, NEWTON_SLACK, RTOL, SHORT, results
from support import ROOT

STORED = json.loads(EXPECTED.read_text())
LOAD_ERROR = 1e-8


def test_every_case_has_stored_values():
    assert set(SHORT) == set(STORED) == {path.stem for path in (ROOT / "cases").glob("*.toml")}


@pytest.mark.parametrize("name", SHORT)
def test_case_reproduces_stored_values(name, tmp_path):
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
