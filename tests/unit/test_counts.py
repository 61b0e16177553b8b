"""Counts, lengths and loads of contact against the same taken from the made-up fields directly."""

import numpy as np
import pytest
from support.made_results import A, make_result

from ehlpetsc.analysis import contact_statistics as counts
from ehlpetsc.results.reader import read_result


@pytest.fixture
def result(tmp_path):
    with read_result(make_result(tmp_path / "one.h5")) as opened:
        yield opened


def test_contact_rates_are_means_over_a_window(result):
    x, counted = result.x / A, result.contact_count
    part = (x >= -1) & (x <= -0.5)
    assert counts.mean_rate(result, -1.0, -0.5) == pytest.approx(counted[part].sum() / part.sum() / 0.041)
    assert counts.mean_rate(result) > 0


def test_contact_length_is_a_mean_over_time(result):
    dx = result.x[1] - result.x[0]
    assert counts.contact_length(result) == pytest.approx(result["in_contact"][1:].sum() * dx / 40)


def test_solids_load_fraction(result):
    dx = result.x[1] - result.x[0]
    carried = (result["pressure"][:] * result["in_contact"][:]).sum(axis=1).mean() * dx
    assert counts.load_share(result) == pytest.approx(carried / 527e3) and carried > 0


def test_contact_table_of_a_series(tmp_path, capsys):
    files = [make_result(tmp_path / f"{v}.h5", viscosity=v) for v in (0.002, 0.005)]
    assert counts.main([*map(str, files)]) == 0
    head, one, two = capsys.readouterr().out.splitlines()
    assert head.split()[0] == "fluid.viscosity" and "exit half" in head
    rates = [float(line.split()[1]) for line in (one, two)]
    assert float(two.split()[4]) == pytest.approx(rates[1] / rates[0], abs=0.006)
    assert np.isfinite([float(word) for word in one.split()]).all()


def test_steady_results_have_no_contact_counts(tmp_path, capsys):
    assert counts.main([str(make_result(tmp_path / "s.h5", steps=1))]) == 2
    assert "s.h5: a steady" in capsys.readouterr().err
