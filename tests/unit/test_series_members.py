"""Members of a series: names, order, sums; time levels that members share."""

import numpy as np
import pytest
from made_results import make_result

from ehlpetsc.case.loading import load, members
from ehlpetsc.results.reader import read_result
from ehlpetsc.results.totals import Totals
from ehlpetsc.run.series.member import Member
from ehlpetsc.run.series.series import Named
from ehlpetsc.stepping.step_control import next_step, on_level


def series(tmp_path, *overrides):
    case = load("cases/fig4.toml", overrides)
    return [
        Member(n, case.series.key, value, member, tmp_path / "out.h5")
        for n, (value, member) in enumerate(members(case))
    ]


def test_files_are_named_after_output_and_value(tmp_path):
    first, *_, last = series(tmp_path)
    assert first.name == "viscosity=0.01"
    assert first.output == tmp_path / "out_viscosity_0.01.h5"
    assert last.restart == tmp_path / "out_viscosity_0.001.restart.h5"


def test_values_that_make_no_name_are_numbered(tmp_path):
    key = "series.key='surface.slow.synthetic'"
    one, two = (f"{{kind='sine',amplitude={z},wavelength=1e-4}}" for z in ("1e-7", "2e-7"))
    values = f"series.values=[{one},{two}]"
    names = [m.output.name for m in series(tmp_path, f"surface.slow={{synthetic={one}}}", key, values)]
    assert names == ["out_synthetic_1.h5", "out_synthetic_2.h5"]


def test_the_longest_runs_come_first(tmp_path):
    thin, thick = (next(m for m in series(tmp_path) if m.value == value) for value in (0.001, 0.01))
    assert thin.weight() > thick.weight()
    fine = series(tmp_path, "series.key='mesh.points_per_half_width'", "series.values=[100,200]")
    assert fine[1].weight()[0] == pytest.approx(4 * fine[0].weight()[0], rel=0.01)


def test_a_whole_file_of_the_same_case_is_done(tmp_path, monkeypatch):
    member = series(tmp_path)[0]
    assert member.state_of_files() == "waiting" and member.totals().values == {}
    make_result(member.output)
    assert member.state_of_files() == "waiting" and member.is_foreign()  # of another case
    with read_result(member.output) as result:
        member.case._text = str(result.attrs["case"])
    assert not member.is_foreign()
    assert member.state_of_files() == "done"
    raw = bytearray(member.output.read_bytes())
    with read_result(member.output) as result:
        place = raw.index(result["pressure"][20].tobytes())
    raw[place] ^= 1
    member.output.write_bytes(raw)
    assert member.state_of_files() == "waiting"  # damaged: computed again
    make_result(member.output, status="stopped")
    assert member.state_of_files() == "waiting"  # and no restart file to go on with


def test_sums_and_extremes_of_the_whole():
    one = dict(step=3, newton=10, h_min=1e-7, p_max=1e9, contacts=2, load_error=1e-9, mass_error=0.1)
    two = dict(step=4, newton=20, h_min=0.0, p_max=2e9, contacts=5, load_error=1e-8, mass_error=0.0)
    whole = Totals.of_series([Totals(one), Totals(), Totals(two)])
    assert whole.values == dict(
        step=7, newton=30, h_min=0.0, p_max=2e9, contacts=7, load_error=1e-8, mass_error=0.1
    )
    assert str(Totals.of_series([Totals()])).startswith("steps=0 newton=0 ")


def test_totals_of_steps_are_those_of_their_file(tmp_path):
    totals = Totals()
    with read_result(make_result(tmp_path / "r.h5")) as result:
        for row in range(len(result.steps("step"))):
            totals.add({name: result.steps(name)[row].item() for name in result.figures})
        stored = Totals.of_result(result)
    assert str(totals) == str(stored)
    assert stored.values["step"] == 40 and stored.values["newton"] == 41 * 5


def test_lines_are_named(capsys):
    import sys

    stream = Named("xi=1", sys.stdout)
    print("one\ntwo", 3, file=stream)
    assert capsys.readouterr().out == "[xi=1] one\n[xi=1] two 3\n"


@pytest.mark.parametrize("halvings", [1, 2, 5, 9])
def test_halved_steps_come_back_to_the_levels_of_the_nominal_step(halvings):
    nominal = 0.37e-6
    time, dt, retries = 7 * nominal, nominal, 0
    levels, steps = [], 0
    for _ in range(60):
        longest, dt = 2.0 * dt, next_step(time, dt, retries, nominal)
        if steps == 0:
            dt *= 0.5**halvings
        assert dt <= nominal * (1 + 1e-9) and dt <= longest * (1 + 1e-9)
        time, retries = time + dt, halvings if steps == 0 else 0
        steps += 1
        if on_level(time, nominal):
            levels.append(round(time / nominal))
    np.testing.assert_array_equal(levels, np.arange(8, 8 + len(levels)))
    assert dt == pytest.approx(nominal)
    assert steps - len(levels) <= 2.5 * halvings
