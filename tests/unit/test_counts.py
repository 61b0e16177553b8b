"""Counts of steps and nodes, which must not depend on the last digit of the quotient behind them."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from support import CASES

from ehlpetsc.base.counts import whole_down, whole_near, whole_up
from ehlpetsc.case.loading import load
from ehlpetsc.physics.contact.geometry import Dry
from ehlpetsc.physics.contact.roller import rows_across
from ehlpetsc.physics.operation import Conditions, ConstantOperation
from ehlpetsc.physics.scales import Scales
from ehlpetsc.stepping.step_control import StepControl
from ehlpetsc.stepping.time_stepping import next_step, ramp_time


@pytest.mark.parametrize("rounding", [0.0, 1e-15, -1e-15, 1e-8, -1e-8])
@pytest.mark.parametrize("number", [1, 7, 100, 32_772, 4_000_000])
def test_a_rounded_whole_number_counts_as_itself(number, rounding):
    rounded = number * (1.0 + min(abs(rounding), 1e-7 / number) * math.copysign(1.0, rounding))
    assert whole_up(rounded) == whole_down(rounded) == whole_near(rounded) == number
    assert whole_near(rounded - 0.5) == number  # halves go up, whichever way they are rounded
    assert (whole_up(number + 1e-5), whole_down(number - 1e-5)) == (number + 1, number - 1)


def test_ramp_of_a_rough_start_has_the_same_steps_at_any_load_radius_and_speed():
    random, counts = np.random.default_rng(1), set()
    for _ in range(100):
        load_given, radius, speed = (10.0 ** random.uniform((4.0, -3.0, -1.0), (6.0, -1.0, 1.0))).tolist()
        given = f"contact.load={load_given!r}", f"contact.radius={radius!r}"
        motion = f"motion.entrainment_speed={speed!r}", "motion.slide_roll_ratio=0", "time.courant=1"
        s = Scales.of(load(CASES / "table1_rough.toml", [*given, *motion, "mesh.points_per_half_width=50"]))
        counts.add(round(ramp_time(s, s.dt) / s.dt))
    assert counts == {50}


def test_steps_of_a_run_of_a_whole_number_of_them_do_not_depend_on_rounding():
    random = np.random.default_rng(2)
    for speed, nominal in 10.0 ** random.uniform((-2.0, -8.0), (2.0, -4.0), (200, 2)):
        operation = ConstantOperation(Conditions(1.0, 1.0, speed, 0.5 * speed), 5e5 * nominal * speed)
        assert operation.step_count(nominal) == 500_000
        assert next_step(nominal, 0, nominal, 3 * nominal) == pytest.approx(nominal, rel=1e-12)


@pytest.mark.parametrize("width, beyond", [(2.2, 2), (2.4, 4), (2.6, 6), (2.8, 8), (2.81, 9)])
def test_rows_beyond_the_ends_of_a_roller_do_not_depend_on_rounding(width, beyond):
    """Half of the length has 20: of width/2 - 1 the last digit is lost."""
    mesh = SimpleNamespace(points_across=20, points_per_half_width=20, width=width)
    contact = SimpleNamespace(end_radius=1e-4)
    assert rows_across(contact, mesh, Dry(1e-4, 5e-3, 1e9)) == (20, beyond)


@pytest.mark.parametrize("inlet", [-2.5, -2.45, -2.05, -2.85])
def test_nodes_of_a_mesh_of_half_a_spacing_more_do_not_depend_on_where_it_begins(inlet):
    outlet = round(inlet + 4.05, 2)  # 40.5 spacings, in binary a little more or less
    case = load(
        CASES / "moes.toml", [f"mesh.inlet={inlet}", f"mesh.outlet={outlet}", "mesh.points_per_half_width=10"]
    )
    assert case.mesh.nodes == 42


def test_levels_of_a_step_follow_the_error_of_the_one_before_within_bounds():
    """By a factor of 0.9 times the cube root of what the tolerance allows, 0.2 to 2, to the longest step."""
    control = StepControl(SimpleNamespace(tolerance=1e-3, courant=40.0, shortest=1.0), None)
    for factor, levels in ((1.5, 15), (10.0, 20), (0.5, 5), (0.05, 2)):
        error = control.tolerance * (0.9 / factor) ** 3
        assert control.levels(10.0, error, 1.0) == levels
        assert control.levels(10.0, error, 1.0, may_grow=False) == min(levels, 10)
        assert control.levels(30.0, error, 1.0) == min(3 * levels, 40)
        assert control.levels(1.0, error, 1.0) == max(levels // 10, 1)
    assert control.levels(None, None, 1.0) == 1
