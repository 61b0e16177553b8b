"""Hertz scales, speeds and mesh against published and closed-form figures."""

import math

import numpy as np
import pytest
from support import CASES

from ehlpetsc.case import loading as case
from ehlpetsc.physics.scales import Scales, moes_groups, reduced_modulus


def scales(name, *overrides):
    return Scales.of(case.load(CASES / name, overrides))


def test_table_1_modulus_half_width_and_pressure():
    s = scales("table1_smooth.toml")
    assert s.E == pytest.approx(227.4725e9, rel=1e-6)
    assert s.a == pytest.approx(0.335682e-3, rel=2e-6)
    assert s.p0 == pytest.approx(0.999455e9, rel=1e-6)


def test_hertz_pressure_integrates_to_the_load():
    s = scales("table1_smooth.toml")
    assert math.pi / 2 * s.a * s.p0 == pytest.approx(s.load, rel=1e-14)


def test_rigid_solid_leaves_the_modulus_of_the_other():
    assert reduced_modulus((207e9, 1e30), (0.3, 0.3)) == pytest.approx(2 * 207e9 / 0.91, rel=1e-12)


def test_moes_case_has_the_groups_of_its_title():
    s = scales("moes.toml")
    assert (s.moes_m, s.moes_l) == pytest.approx((20, 10), rel=1e-9)
    s = scales("moes.toml", "contact.load=2.09915459e6", "fluid.viscosity=0.01014206817")
    assert (s.moes_m, s.moes_l) == pytest.approx((100, 11), rel=1e-9)
    s = scales("waviness.toml")
    assert (s.moes_m, s.moes_l) == pytest.approx((100, 11), rel=1e-9)


def test_moes_groups_fix_the_barus_exponent_at_the_hertz_pressure():
    # alpha p0 = L sqrt(M / 2 pi), whatever the modulus: the exponent depends on the two groups alone
    alpha, load, radius, modulus = 2e-8, 1e5, 0.01, 2e11
    m, oil = moes_groups(0.01, 1.0, alpha, load, radius, modulus)
    p0 = modulus * math.sqrt(load / (modulus * radius) / (2 * math.pi))
    assert oil * math.sqrt(m / (2 * math.pi)) == pytest.approx(alpha * p0, rel=1e-12)


@pytest.mark.parametrize(("xi", "u1", "u2"), [(0.25, 5.625, 4.375), (2, 10, 0), (-4, -5, 15), (0, 5, 5)])
def test_speeds_of_both_surfaces(xi, u1, u2):
    s = scales("table1_smooth.toml", f"motion.slide_roll_ratio={xi}")
    assert (s.u1, s.u2, s.u_max) == pytest.approx((u1, u2, max(abs(u1), abs(u2))))


def test_time_step_and_duration_follow_the_faster_surface():
    s = scales("table1_rough.toml")
    assert s.dt * s.u1 == pytest.approx(0.5 * s.a / 200)
    assert s.duration * s.u1 == pytest.approx(6 * s.a)
    backwards = scales("table1_rough.toml", "motion.slide_roll_ratio=-4")
    assert backwards.dt * abs(backwards.u2) == pytest.approx(0.5 * s.a / 200)


def test_nodes_run_from_inlet_to_outlet():
    s = scales("table1_rough.toml")
    assert s.nx == s.x.size == 801
    assert (s.x[0], s.x[-1]) == (-2.5, 1.5)
    assert np.ptp(np.diff(s.x)) < 1e-12
    assert s.dx == pytest.approx(s.a / 200)


def test_dry_case_has_no_lubricant_groups_and_steady_case_no_step():
    s = scales("dry_hertz.toml")
    assert (s.eta0, s.moes_m, s.moes_l, s.dt, s.duration) == (None,) * 5
    assert (s.u, s.u1, s.u2) == (0, 0, 0)
