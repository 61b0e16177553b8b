"""Members of a series: names, order, sums; time levels that members share."""

import tomllib

import numpy as np
import pytest
from support.made_results import make_result, with_solids

from ehlpetsc.base.errors import CaseError
from ehlpetsc.base.toml_file import settings_of
from ehlpetsc.case.loading import load, members
from ehlpetsc.physics.operation import Conditions, ConstantOperation
from ehlpetsc.results.means import Totals, filled_from
from ehlpetsc.results.reader import is_done, read_result
from ehlpetsc.run.series import Member, named
from ehlpetsc.stepping.time_stepping import next_step


def series(tmp_path, *overrides):
    return made(load("cases/fig4.toml", overrides), tmp_path)


def made(case, tmp_path):
    names = named(settings_of(tomllib.loads(case.text)["series"]))
    named_members = zip(names, members(case), strict=True)
    return [Member(name, value, one, tmp_path / "out.h5") for name, (value, one) in named_members]


def test_files_are_named_after_output_and_value_and_longest_members_run_first(tmp_path):
    first, *_, last = series(tmp_path)
    assert first.name == "viscosity=0.01"
    assert first.output == tmp_path / "out_viscosity_0.01.h5"
    assert last.output == tmp_path / "out_viscosity_0.001.h5"
    thin, thick = (next(m for m in series(tmp_path) if m.value == value) for value in (0.001, 0.01))
    assert thin.weight() > thick.weight()
    fine = series(tmp_path, "series.key='mesh.points_per_half_width'", "series.values=[100,200]")
    assert fine[1].weight()[0] == pytest.approx(4 * fine[0].weight()[0], rel=0.01)


STEP = {"series.combine": "step"}
SEVERAL = {"series.key": None, "series.keys": ["fluid.viscosity", "motion.entrainment_speed"]}


def several(tmp_path, values, combine=None):
    keys = SEVERAL | {"series.values": values, "series.combine": combine}
    return made(load("cases/fig4.toml", keys), tmp_path)


def test_several_keys_make_a_grid_or_vary_together(tmp_path):
    found = several(tmp_path, [[0.01, 0.002], [5.0, 1.0, 0.2]])
    assert [m.value for m in found] == [(e, u) for e in (0.01, 0.002) for u in (5.0, 1.0, 0.2)]
    for member in found:
        assert (member.case.fluid.viscosity, member.case.motion.entrainment_speed) == member.value
        assert member.case.series is None and "series" not in tomllib.loads(member.case.text)
    assert found[1].name == "viscosity=0.01,entrainment_speed=1.0"
    assert found[1].output.name == "out_viscosity_0.01_entrainment_speed_1.0.h5"
    assert len({m.output for m in found}) == 6
    found = several(tmp_path, [[0.01, 0.002, 0.002], [5.0, 5.0, 5.0]], "step")
    assert [m.value for m in found] == [(0.01, 5.0), (0.002, 5.0), (0.002, 5.0)]
    # only viscosity differs, and that makes one name twice
    assert [m.name for m in found] == ["member=1", "member=2", "member=3"]
    found = several(tmp_path, [[0.01, 0.002], [5.0, 5.0]], "step")
    assert [m.name for m in found] == ["viscosity=0.01", "viscosity=0.002"]


@pytest.mark.parametrize(
    "changed, words",
    [
        ({"series.keys": ["fluid.viscosity", "fluid.viscosity"]}, "series: keys: .*twice"),
        ({"series.values": [[0.01]]}, "series: values: .* 2 lists"),
        ({"series.values": [0.01, 5.0]}, "series: values: .* 2 lists"),
        (STEP | {"series.values": [[0.01, 0.02], [5.0]]}, 'series: values: .* 2, 1; .*combine = "step"'),
        ({"series.key": "fluid.viscosity"}, "series: .*key or keys"),
        ({"series.values": [[0.01] * 200, [5.0] * 200]}, "series: 40000 members; .* 10000"),
        ({"series.values": [[0.01, -1.0], [5.0]]}, "fluid.viscosity = -1.0"),
        ({"series.combine": "all"}, 'series.combine = "all": .*"grid", "step"'),
    ],
)
def test_faulty_series_of_several_keys_are_refused(changed, words):
    good = SEVERAL | {"series.values": [[0.01, 0.002], [5.0, 1.0]]}
    with pytest.raises(CaseError, match=words):
        load("cases/fig4.toml", good | changed)


def test_complete_result_of_the_same_case_is_done(tmp_path):
    path, member = tmp_path / "r.h5", series(tmp_path)[0]
    assert not is_done(path, "") and member.totals().values == {}
    make_result(path)
    with read_result(path) as result:
        text = str(result.attrs["case"])
    assert is_done(path, text) and not is_done(path, member.case.text)
    make_result(path, status="stopped")
    assert not is_done(path, text)


def test_sums_and_extremes_of_series_and_steps(tmp_path):
    one = dict(step=3, newton=10, h_min=1e-7, p_max=1e9, contacts=2, load_error=1e-9, mass_error=0.1)
    two = dict(step=4, newton=20, h_min=0.0, p_max=2e9, contacts=5, load_error=1e-8, mass_error=0.0)
    whole = Totals.of_series([Totals(one), Totals(), Totals(two)])
    summed = dict(step=7, newton=30, contacts=7)
    assert whole.values == summed | dict(h_min=0.0, p_max=2e9, load_error=1e-8, mass_error=0.1)
    assert str(Totals.of_series([Totals()])).startswith("steps=0 newton=0 ")
    totals = Totals()
    with read_result(make_result(tmp_path / "r.h5")) as result:
        for row in range(len(result.steps("step"))):
            totals.add({name: result.steps(name)[row].item() for name in result.scalars})
        stored = Totals.of_result(result)
    assert str(Totals(totals.values, stored.means)) == str(stored)
    assert stored.values["step"] == 40 and stored.values["newton"] == 41 * 5


def test_means_are_over_the_time_in_which_both_surfaces_fill_the_contact(tmp_path):
    with read_result(with_solids(make_result(tmp_path / "r.h5", speed=50.0, rough=True))) as result:
        filled = result.steps("time") >= filled_from(result)
        assert 5 < filled.sum() < 41
        found = Totals.of_result(result)
        for name in ("contact_share", "friction_coefficient"):
            assert found.means[name] == pytest.approx(result.steps(name)[filled].mean(), rel=1e-12)
        line = str(found)
        assert f" contact_share={found.means['contact_share']:.4g}" in line
        assert f" contact_share_max={result.steps('contact_share').max():.4g}" in line
    with read_result(with_solids(make_result(tmp_path / "s.h5", speed=1.0, rough=True))) as result:
        assert Totals.of_result(result).means == {}  # ends before
    with read_result(with_solids(make_result(tmp_path / "t.h5", steps=1))) as result:
        steady = Totals.of_result(result).means
        assert steady["contact_share"] == result.steps("contact_share")[0]


@pytest.mark.parametrize("halvings", [1, 2, 5, 9])
def test_halved_steps_return_to_nominal_levels(halvings):
    nominal = 0.37e-6
    operation = ConstantOperation(Conditions(1.0, 1.0, 1.0, 1.0), 1.0)
    time, dt, retries = 7 * nominal, nominal, 0
    levels, steps = [], 0
    for _ in range(60):
        left = operation.time_left(time, nominal)
        longest, dt = 2.0 * dt, next_step(dt, retries, nominal, left)
        if steps == 0:
            dt *= 0.5**halvings
        assert dt <= nominal * (1 + 1e-9) and dt <= longest * (1 + 1e-9)
        time, retries = time + dt, halvings if steps == 0 else 0
        steps += 1
        if abs(time / nominal - round(time / nominal)) < 1e-6:
            levels.append(round(time / nominal))
    np.testing.assert_array_equal(levels, np.arange(8, 8 + len(levels)))
    assert dt == pytest.approx(nominal)
    assert steps - len(levels) <= 2.5 * halvings
