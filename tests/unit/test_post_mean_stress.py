"""Corrections for the mean stress against their equations, and half cycles in the sum of damage."""

import numpy as np
import pytest

from ehlpetsc.base.materials import MEAN_STRESSES
from ehlpetsc.case.tables.outputs import POST_KEYS
from ehlpetsc.post import Material, cycles_to_failure, damage
from ehlpetsc.post.fatigue.accumulate import CORRECTIONS, reversed_range
from ehlpetsc.post.fatigue.cycles import RESIDUALS

STEEL = Material(tensile_strength=1.5e9, walker_exponent=0.6)
ROOT = np.sqrt(1 - 0.3 + 0.09)  # equivalent range of a range of sz in plane strain


def swing(low, high):
    """Histories of sz alone between two stresses."""
    sz = np.array([low, high, low, high, low])
    return np.zeros(5), sz, np.zeros(5)


@pytest.mark.parametrize(
    "name, expected",
    [
        ("goodman", lambda a, m: a / (1 - m / 1.5e9)),
        ("gerber", lambda a, m: a / (1 - (m / 1.5e9) ** 2)),
        ("swt", lambda a, m: np.sqrt(a * (a + m))),
        ("walker", lambda a, m: (a + m) ** 0.4 * a**0.6),
    ],
)
def test_equations(name, expected):
    """Range 800 MPa of sz about a mean of 300 MPa: the mean is that of the sum of the normal stresses."""
    found = damage(*swing(-1e8, 7e8), STEEL, mean_stress=name)
    amplitude, mean = 4e8 * ROOT, 1.3 * 3e8
    life = cycles_to_failure(2 * expected(amplitude, mean), STEEL, strain="neuber")
    assert found.damage == pytest.approx(found.cycles / life, rel=1e-8)


@pytest.mark.parametrize("name", CORRECTIONS)
def test_no_mean_no_correction(name):
    plain = damage(*swing(-5e8, 5e8), STEEL)
    assert damage(*swing(-5e8, 5e8), STEEL, mean_stress=name).damage == pytest.approx(plain.damage, rel=1e-9)


def test_order_under_tension_and_under_compression():
    tension = [
        damage(*swing(0, 8e8), STEEL, mean_stress=name).damage for name in ("none", "gerber", "goodman")
    ]
    assert tension == sorted(tension) and tension[0] < tension[2] / 2
    pressed = {name: damage(*swing(-9e8, -1e8), STEEL, mean_stress=name).damage for name in MEAN_STRESSES}
    assert pressed["swt"] == pressed["walker"] == 0  # never in tension
    assert pressed["gerber"] == pressed["none"] > pressed["goodman"] > 0


def test_mean_beyond_the_tensile_strength_fails_at_once():
    assert damage(*swing(1.6e9, 1.7e9), STEEL, mean_stress="goodman").damage > 1e300
    assert reversed_range(3, 1e8, 2e9, 1.5e9, 0.6) == np.inf


def test_estimates_of_a_steel():
    """42CrMo4 of 295 HB: 3.45 HB in MPa, Dowling's exponent."""
    strength, exponent = Material(fatigue_strength=4.25e6 * 295 + 225e6).mean_stress_constants()
    assert strength == pytest.approx(1018e6, abs=1e6)
    assert exponent == pytest.approx(0.678, abs=1e-3)


def test_keys_list_what_is_computed():
    assert ("none", "morrow", *CORRECTIONS) == MEAN_STRESSES
    assert POST_KEYS["residual"].choices == RESIDUALS


def test_half_cycles_have_half_the_damage():
    once = np.zeros(5), np.array([0.0, 1.5e9, 0.0, 0.0, 0.0]), np.zeros(5)
    whole, half = (damage(*once, STEEL, residual=name) for name in RESIDUALS)
    assert whole.cycles == half.cycles == 1  # up and down: two halves
    up = tuple(part[:2] for part in once)
    assert damage(*up, STEEL, residual="half").damage == pytest.approx(whole.damage / 2)
