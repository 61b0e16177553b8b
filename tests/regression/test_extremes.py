"""Extreme conditions: the short form of the table of extremes, and every row of the whole one as a case."""

import math

import pytest
from benchmarks.extremes import extremes, table

from ehlpetsc.case.loading import load


@pytest.mark.slow
def test_short_table_of_extremes(tmp_path):
    rows = table(extremes(short=True), tmp_path / "extremes.csv")
    assert len(rows) > 25 and [row for row in rows if row["converged"] != "yes"] == []
    for row in rows:
        assert float(row["h_min_um"]) >= 0.0 and math.isfinite(float(row["p_max_GPa"]))
        assert float(row["load_error"]) < 1e-6
    assert len((tmp_path / "extremes.csv").read_text().splitlines()) == len(rows) + 1


@pytest.mark.parametrize("far, count", [(False, 105), (True, 40)])
@pytest.mark.parametrize("model", [None, "compliant"])
def test_every_row_of_the_whole_table_loads(far, count, model):
    whole = extremes(far=far, model=model)
    assert len({(line.axis, line.value) for line in whole}) == len(whole) == count
    for line in whole:
        case = load(line.base, line.overrides)
        own = any(word.startswith("contact.model") for word in line.overrides[2:])
        assert model is None or own or case.contact.asperity_height == 10e-9
