"""Extreme conditions: short form of the table of extremes, and random cases."""

import math
import os

import pytest
from support.running import MAIN, PREPARED

from ehlpetsc.case.loading import load
from ehlpetsc.study import runs
from ehlpetsc.study.extremes import cases, table
from ehlpetsc.study.random_cases import run_all


@pytest.fixture(autouse=True)
def quick_start(monkeypatch):
    """Run in the prepared process."""

    def run_command(words, stream, limit):
        (_, _, module), rest = words[:3], words[3:]
        assert module == "ehlpetsc"
        return PREPARED.run([MAIN, *rest], os.getcwd(), {}, stream.name, stream.name)

    monkeypatch.setattr(runs, "_wait", run_command)


@pytest.mark.slow
def test_short_table_of_extremes(tmp_path):
    rows = table(tmp_path / "extremes.csv", short=True, limit=120, say=lambda text: None)
    assert len(rows) == len(cases(short=True)) > 25
    failed = [row for row in rows if row["converged"] != "yes"]
    assert failed == []
    for row in rows:
        assert float(row["h_min_um"]) >= 0.0
        assert math.isfinite(float(row["p_max_GPa"])) and float(row["viscosity_Pa_s"]) > 0.0
        assert float(row["load_error"]) < 1e-6
    assert len((tmp_path / "extremes.csv").read_text().splitlines()) == len(rows) + 1


@pytest.mark.slow
def test_random_cases_end_with_status_0_or_3_and_complete_files(tmp_path):
    message = []
    count = int(os.environ.get("EHL_DRAWS", "3"))
    assert run_all(count, 1, tmp_path / "random.csv", 120, message.append) == 0, message


def test_every_row_of_the_full_table_loads(tmp_path):
    whole = cases()
    assert len({(line.axis, line.value) for line in whole}) == len(whole) > 100
    for line in whole:
        path = tmp_path / "case.toml"
        path.write_text(line.text)
        case = load(path, line.overrides)
        assert case.title == "extreme"
