"""Tables of operating conditions: what they may hold, and their interpolation, integrals and time levels."""

import re
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from support import one_fault

from ehlpetsc.base.errors import CaseError
from ehlpetsc.case.loading import load, stored_case
from ehlpetsc.physics import operation_of
from ehlpetsc.physics.contact.geometry import line_half_width
from ehlpetsc.physics.scales import Scales
from ehlpetsc.physics.variable_operation import ConditionsTable, VariableOperation

CASE = Path(__file__).parents[2] / "cases" / "table1_smooth.toml"
TABLE = """time [s], load [N/m], radius [m], speed 1, speed 2 [m/s]
0,    400e3, 0.019, 5.0, 4.0
1e-4, 527e3, 0.020, 5.5, 3.0   # heaviest
3e-4, 300e3, 0.018, 4.0, 4.5
"""


@pytest.fixture
def with_table(tmp_path):
    def write(text, **more):
        (tmp_path / "mesh.csv").write_text(text)
        text = CASE.read_text().partition("[time]")[0]
        path = tmp_path / "case.toml"
        extra = "".join(f"{key} = {value}\n" for key, value in more.items())
        path.write_text(text + '\n[operation]\nfile = "mesh.csv"\n' + extra)
        return path

    return write


def test_table_sets_conditions_and_reference_state_in_units_of_its_heading(with_table):
    case = load(with_table(TABLE, repeat=2))
    assert (case.contact.load, case.contact.radius) == (527e3, 0.020)
    assert case.motion.entrainment_speed == pytest.approx(4.5)
    scales = Scales.of(case)
    operation = operation_of(case, scales)
    assert operation.duration == pytest.approx(6e-4)
    assert operation.at(1e-4) == pytest.approx((527e3, 0.020, 5.5, 3.0))
    assert operation.at(4e-4) == pytest.approx((527e3, 0.020, 5.5, 3.0))
    assert 300e3 < operation.at(2e-4).load < 527e3
    plain = load(with_table(TABLE)).conditions
    text = "time [us], load (N/mm), radius [mm], speed 1 [mm/s], speed 2 [m/s]\n"
    case = load(with_table(text + "0,400,19,5000,4\n100,527,20,5500,3\n300,300,18,4000,4.5\n"))
    for one, other in zip(case.conditions[:5], plain[:5], strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-15)


@pytest.mark.parametrize("head", ["t,w,r,u1,u2", "time;load;radius;speed_1;speed_2"])
def test_table_columns_by_alias_and_separator(with_table, head):
    lines = TABLE.replace("   # heaviest", "").splitlines()[1:]
    text = "\n".join([head, *lines]) + "\n"
    case = load(with_table(text.replace(",", ";") if ";" in head else text))
    np.testing.assert_array_equal(case.conditions.load, [400e3, 527e3, 300e3])
    np.testing.assert_array_equal(case.conditions.u2, [4.0, 3.0, 4.5])


def test_omitted_column_is_constant_and_a_table_begins_at_its_first_time(with_table):
    case = load(with_table("time, load\n0, 527e3\n1e-4, 600e3\n"))
    assert set(case.conditions.radius) == {0.0191}
    u1, u2 = case.conditions.u1[0], case.conditions.u2[0]
    assert (0.5 * (u1 + u2), u1 - u2) == pytest.approx((5.0, 1.25))
    later = load(with_table("time [ms], load\n5, 527e3\n7, 600e3\n")).conditions
    np.testing.assert_allclose(later.time, [0.0, 2e-3], atol=1e-18)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (TABLE.replace("3e-4", "0.5e-4"), "row 3: time = 5e-05 s: "),
        (TABLE.replace("300e3", "-300e3"), "row 3: load = -300000 N/m: "),
        (TABLE.replace("0.018", "-1"), "row 3: radius = -1 m: "),
        ("time, speed 1, speed 2\n0, 0, 0\n1e-3, 0, 0\n", "both speeds"),
        (TABLE.replace("4.0, 4.5", "4.0"), "line 2: 5 numbers"),
        (TABLE.replace("527e3", "nan"), "row 2: load = nan N/m: "),
        (TABLE.replace("527e3", "lots"), 'line 3: "lots" is not a number; '),
        (TABLE.replace("speed 1", "velocity"), "column 'velocity'"),
        (TABLE.replace("radius [m]", "load"), "column 'load': allowed: one each"),
        (TABLE.replace("radius [m]", "radius [s]"), r"column 'radius \[s\]': .* a unit of m$"),
        ("time, load\n0, 1e5\n", "two times"),
        ("time\n0\n1\n", ": load, radius, speed 1, speed 2,"),
        ("load\n1e5\n1e5\n", "no column time;"),
        ("", "0 points"),
        ("0, 1e5, 0.02\n1, 2e5, 0.02\n", "0 column names, 3 columns"),
    ],
)
def test_bad_table_is_refused_with_its_line(with_table, text, sentence):
    assert re.search(f'"mesh.csv": .*{sentence}', one_fault(load, with_table(text)))


def test_case_text_contains_its_table_and_columns_may_be_arrays(with_table, tmp_path):
    path = with_table(TABLE, repeat=2)
    case = load(path, ["fluid.viscosity=0.004"])
    assert case.operation.file == "mesh.csv"
    (tmp_path / "mesh.csv").unlink()
    alone = stored_case(case.text)
    assert alone.operation.file is None and alone.conditions.repeat == 2
    for one, other in zip(alone.conditions, case.conditions, strict=True):
        np.testing.assert_array_equal(one, other)
    assert alone.fluid.viscosity == 0.004 and alone.contact.load == case.contact.load
    tables = {"operation": {"time": np.array([0.0, 1e-4]), "load": [5e5, 6e5]}}
    overrides = {f"operation.{key}": value for key, value in tables["operation"].items()}
    case = load(CASE, overrides)
    np.testing.assert_array_equal(case.conditions.load, [5e5, 6e5])
    with pytest.raises(CaseError, match="row 2: time"):
        load(CASE, overrides | {"operation.time": [0.0, 0.0]})


@pytest.mark.parametrize("time", [1e-4, "0.1 ms"])
def test_a_number_in_place_of_a_column_is_refused(time):
    fault = one_fault(load, CASE, {"operation": {"time": time, "load": [5e5, 6e5]}})
    assert "operation.time = 0.0001: allowed: a list of numbers" in fault


def test_reversing_entrainment_needs_a_symmetric_domain(with_table):
    text = "time, speed 1, speed 2\n0, 1, 1\n1e-3, -1, -1\n"
    with pytest.raises(CaseError, match=r"mesh\.outlet = 1\.5: .* allowed: 4, "):
        load(with_table(text))
    case = load(with_table(text), {"mesh.outlet": 4.0})
    assert operation_of(case, Scales.of(case)).is_reversing
    odd = {"mesh.points_per_half_width": 40, "mesh.inlet": -2.53}  # 202.4 cells
    fault = one_fault(load, with_table(text), odd | {"mesh.outlet": 2.53})
    assert "mesh.outlet = 2.53: " in fault
    outlet, inlet = re.search(r"allowed: (\S+) with mesh\.inlet = ([^,]+),", fault).groups()
    load(with_table(text), odd | {"mesh.inlet": float(inlet), "mesh.outlet": float(outlet)})


def make(repeat=1, courant=0.5, **columns):
    time = np.array([0.0, 1e-3, 1.5e-3, 3e-3])
    values = {"load": 1e5, "radius": 0.01, "u1": 1.0, "u2": 1.0} | columns
    values = {name: np.broadcast_to(np.asarray(v, float), time.shape) for name, v in values.items()}
    table = ConditionsTable(time, *values.values(), repeat=repeat)
    half_width = partial(line_half_width, modulus=227e9, extent=1.0)
    return VariableOperation(table, courant, 1e-6, half_width, 1.0)


@pytest.mark.parametrize("last", [0.0, 1.2])
def test_speeds_that_are_rounding_of_rest_or_rolling_are_zero(last):
    """Else the friction of solids, mu p with the sign of u1 - u2, is that of a rounding error."""
    fast = [2.384353324024164, 1.192176662012082, 0.7, last]
    operation = make(u1=fast, u2=np.array(fast) / 3.0 * [1.0, 1.0, 1.0, 3.0] * (1.0 + 2e-16))
    assert operation.at(3e-3).sliding == 0.0
    assert operation.at(3e-3).u1 == pytest.approx(last, rel=1e-14, abs=0.0)
    assert operation.at(2.9e-3).sliding > 1e-3


def test_distances_are_integrals_of_speeds_and_interpolation_does_not_overshoot():
    operation = make(load=[1e5, 5e5, 5e5, 1e5])
    loads = [operation.at(t).load for t in np.linspace(0.0, 3e-3, 999)]
    assert min(loads) == 1e5 and max(loads) == 5e5
    operation = make(repeat=3, u1=[0.0, 2.0, 1.0, 0.0], u2=[-1.0, 1.0, 0.5, -1.0])
    for begin, end in ((0.0, 1.2e-3), (2.5e-3, 3.7e-3), (0.3e-3, 8.9e-3)):
        count = 10_000
        times = begin + (np.arange(count) + 0.5) / count * (end - begin)
        mean = np.mean([operation.at(t)[2:] for t in times], axis=0)
        way = operation.displacement(begin, end - begin)
        np.testing.assert_allclose(way, mean * (end - begin), atol=2e-9)
    parts = [operation.displacement(k * 1e-3, 1e-3) for k in range(9)]
    np.testing.assert_allclose(np.sum(parts, axis=0), operation.travelled(9e-3), rtol=1e-12)
    places = np.array([operation.travelled(t) for t in np.linspace(0.0, 9e-3, 3001)])
    ends = np.stack([places.min(0), places.max(0)], axis=1)
    np.testing.assert_allclose(operation.extent(), ends, atol=1e-8)


def test_time_levels_end_with_the_run_and_follow_the_film():
    operation = make(repeat=2, u1=[0.0, 2.0, 1.0, 0.0], u2=[-1.0, 1.0, 0.5, -1.0])
    time, steps = 0.0, 0
    while operation.remaining(time, (0.0, 0.0)) > 0.0:
        dt = operation.time_left(time, None)
        moved = operation.at(time + 0.5 * dt).step_speed * dt
        assert moved <= 0.5e-6 * 1.01
        time, steps = time + dt, steps + 1
    assert time == pytest.approx(6e-3, rel=1e-12)
    assert steps == operation.step_count(None)
    # a step cut in two comes back to the same level
    level = operation.level(1.1e-3, None)
    left = operation.time_left(1.1e-3, None)
    assert operation.level(1.1e-3 + left, None) == pytest.approx(np.floor(level) + 1.0, abs=1e-6)


@pytest.mark.parametrize("column", [{"load": [1e5, 5e5, 5e5, 1e5]}, {"radius": [0.01, 0.05, 0.05, 0.01]}])
def test_contact_edge_motion_is_limited_by_the_courant_number(column):
    operation = make(**column, u1=1e-4, u2=0.0)
    time, widest = 0.0, 0.0
    while operation.remaining(time, (0.0, 0.0)) > 0.0:
        dt = operation.time_left(time, None)
        now, then = operation.at(time), operation.at(time + dt)
        a = [np.sqrt(8.0 * at.load * at.radius / (np.pi * 227e9)) for at in (now, then)]
        widest, time = max(widest, abs(a[1] - a[0])), time + dt
    assert 0.45e-6 < widest <= 0.5e-6 * 1.01
