"""Life and damage against the restored equations: elastic-plastic rules, mean stress, closed loops."""

from functools import partial

import numpy as np
import pytest
from support import ROOT
from support.made_loads import Scene, write
from support.running import PYTHON, called

from ehlpetsc import post
from ehlpetsc.base.materials import MEAN_STRESSES
from ehlpetsc.case.tables.outputs import POST_KEYS
from ehlpetsc.commands.post import main
from ehlpetsc.post import Material, cycles_to_failure
from ehlpetsc.post.fatigue.accumulate import CORRECTIONS, reversed_range
from ehlpetsc.post.fatigue.cycles import RESIDUALS, loop_of
from ehlpetsc.post.fatigue.strain_life import STRAINS, life_table, log_local_range, look_up
from ehlpetsc.results.post_result import PostResult

STEEL = Material()
damage = partial(post.damage, strain="direct")
RANGES = np.array([1e9, 1.5e9, 2e9, 3e9, 4e9])


def life_curve(n, material):
    """Strain range that N cycles stand: Holmes et al. 2005, eq. (14)."""
    elastic = material.fatigue_strength / material.youngs_modulus * (2 * n) ** material.b
    return 2 * (elastic + material.fatigue_ductility * (2 * n) ** material.c)


def strain_range(stress, material):
    """Cyclic stress-strain curve: Holmes et al. 2005, eq. (13)."""
    plastic = (stress / (2 * material.hardening_coefficient)) ** (1 / material.cyclic_hardening)
    return stress / material.youngs_modulus + 2 * plastic


def pulse(size, samples=41):
    """One loading of sz alone in plane strain, from 0 to -size and back."""
    sz = -size * np.sin(np.linspace(0, np.pi, samples)) ** 2
    return np.zeros(samples), sz, np.zeros(samples)


def test_restored_values_and_extremes():
    assert STEEL.hardening_coefficient == pytest.approx(2232.77e6, rel=1e-6)
    strains = [4.92393e-3, 8.634665e-3, 1.911124e-2, 0.1555341, 0.9793237]
    assert strain_range(RANGES, STEEL) == pytest.approx(strains, rel=1e-6)
    lives = [2.106877e6, 2.565758e4, 1093.558, 12.21644, 0.5]
    assert cycles_to_failure(RANGES, STEEL) == pytest.approx(lives, rel=1e-6)
    with np.errstate(all="raise"):
        lives = cycles_to_failure(np.array([0.0, 1e-300, 1e-30, 1e30, np.inf]), STEEL)
    assert lives[0] == lives[1] == np.inf and lives[2] > 1e300 and lives[3] < 1e-30 and lives[4] == 0


def test_inversion_to_1e10_over_23_decades():
    lives = np.logspace(-3, 20, 47)
    wanted = life_curve(lives, STEEL)
    low, high = np.full_like(lives, 1.0), np.full_like(lives, 1e13)
    for _ in range(200):
        middle = np.sqrt(low * high)
        above = strain_range(middle, STEEL) > wanted
        low, high = np.where(above, low, middle), np.where(above, middle, high)
    lives_back = cycles_to_failure(np.sqrt(low * high), STEEL)
    # a rounding error of the stress range itself moves N by 1/(0.091) of it
    assert lives_back == pytest.approx(lives, rel=1e-10)
    assert life_curve(lives_back, STEEL) == pytest.approx(wanted, rel=1e-12)


def test_one_pulse_is_one_cycle_and_no_stress_no_damage():
    size = 2e9
    result = damage(*pulse(size), STEEL)
    dsv = size * np.sqrt(1 - 0.3 + 0.09)  # sx = 0, sy = nu sz
    assert result.peak_range == pytest.approx(dsv, rel=1e-12)
    assert result.cycles == 1
    assert result.damage == pytest.approx(1 / cycles_to_failure(dsv, STEEL), rel=1e-9)
    result = damage(np.zeros((2, 9)), np.zeros((2, 9)), np.zeros((2, 9)), STEEL)
    assert (result.damage == 0).all() and (result.cycles == 0).all() and (result.peak_range == 0).all()
    t = np.linspace(0, 2 * np.pi, 81)
    parts = np.zeros(81), np.zeros(81), 5e8 * np.sin(t)
    assert damage(*parts, STEEL).peak_range == pytest.approx(np.sqrt(3) * 1e9, rel=1e-6)


@pytest.mark.parametrize("first", [True, False])
def test_component_of_most_damage_counts_not_that_of_the_largest_range(first):
    many = np.append(1.5e9 * np.sin(np.linspace(0, 20 * np.pi, 401)) ** 2, np.zeros(41))
    one = np.append(np.zeros(401), 1.6e9 * np.sin(np.linspace(0, np.pi, 41)) ** 2)
    both = damage(*((many, one) if first else (one, many)), 0 * one, STEEL)
    assert both.cycles == 20 and both.damage == pytest.approx(20 * float(damage(*pulse(1.5e9), STEEL).damage))
    assert both.peak_range == pytest.approx(1.5e9 * np.sqrt(0.79))


def test_rounding_errors_of_a_component_without_stress_change_nothing():
    """Neither of one that is zero nor of one that rests while another changes, and time may run backwards."""
    errors = 1e-3 * np.random.default_rng(1).standard_normal((2, 81))
    wave, part = 8e8 * np.sin(np.linspace(0, 6 * np.pi, 81)), slice(20, 50)
    rests = np.where(np.arange(81) < 40, 0.0, -1e9 * np.sin(np.linspace(0, 2 * np.pi, 81)) ** 2)
    moves = 9e8 * np.sin(np.linspace(0, 3 * np.pi, 81) + 0.5)
    exact, rounded = (damage(wave, 0 * wave, error, STEEL) for error in (0 * wave, errors[0]))
    assert rounded.damage == pytest.approx(exact.damage, rel=1e-9, abs=0) and rounded.cycles == exact.cycles
    parts = moves[part], rests[part], 0 * moves[part]
    exact = damage(*parts, STEEL).damage
    assert damage(parts[0], parts[1] + errors[1][part], parts[2], STEEL).damage == pytest.approx(
        exact, rel=1e-9
    )
    assert damage(*(row[::-1] for row in parts), STEEL).damage == pytest.approx(exact, rel=1e-12)


def test_morrow_lengthens_life_under_compression_to_a_floor_and_residual_stress_enters():
    result = damage(*pulse(1e9), STEEL, mean_stress="morrow")
    dsv = 1e9 * np.sqrt(0.79)
    assert 1.3 * -0.5e9 < -dsv / 2  # the trace asks for more than the floor gives
    assert result.damage == pytest.approx(1 / cycles_to_failure(dsv, STEEL, -dsv / 2), rel=1e-9)
    assert result.damage < damage(*pulse(1e9), STEEL).damage
    tension = damage(*pulse(-1e9), STEEL, mean_stress="morrow")
    assert tension.damage == pytest.approx(1 / cycles_to_failure(dsv, STEEL, 1.3 * 0.5e9), rel=1e-9)
    beyond = cycles_to_failure(1e9, STEEL, 3e9)  # mean above the strength: the plastic term alone
    assert np.isfinite(beyond) and 0 < beyond < cycles_to_failure(1e9, STEEL)
    dsv = 1e9 * np.sqrt(0.79)
    tension, residual = pulse(-1e9), -2e8
    result = damage(*tension, STEEL, mean_stress="morrow", residual_stress=residual)
    mean = 1.3 * 0.5e9 + 2 * residual  # the same in x and y
    assert result.damage == pytest.approx(1 / cycles_to_failure(dsv, STEEL, mean), rel=1e-9)
    assert damage(*tension, STEEL, residual_stress=residual).damage == damage(*tension, STEEL).damage
    with pytest.raises(ValueError, match="residual_stress"):
        damage(*tension, STEEL, residual_stress=np.nan)
    sx, sz, txz = pulse(1e9)
    lives = [damage(sx - p, sz - p, txz, STEEL, mean_stress="morrow").damage for p in (2e9, 2e10)]
    assert lives[0] == pytest.approx(lives[1], rel=1e-6)


SCRIPT = """
import sys
{block}
import numpy as np
from ehlpetsc.post import Material, damage, rainflow
from ehlpetsc.base.compiled import COMPILED
assert COMPILED is {compiled}
parts = np.cumsum(np.random.default_rng(5).normal(scale=2e8, size=(3, 20, 300)), axis=-1)
neuber = dict(mean_stress="morrow", strain="neuber")
for choice in ({{}}, neuber):
    for row in damage(*parts, Material(), **choice):
        print(row.tobytes().hex())
print(rainflow(parts[0, 0]).tobytes().hex())
"""


def test_results_without_numba_are_bitwise_equal():
    import numba  # noqa: F401 - without it there would be nothing to compare

    scripts = [SCRIPT.format(block="", compiled=True)]
    scripts += [SCRIPT.format(block="sys.modules['numba'] = None", compiled=False)]
    outputs = [called([PYTHON, "-c", script], ROOT).stdout for script in scripts]
    assert outputs[0] == outputs[1] and len(outputs[0]) > 1000


ELASTIC = np.logspace(7, 10.5, 30)


def local_range(rule):
    curve = STEEL.constants()[:3]
    return np.exp([log_local_range(value, *curve, STRAINS.index(rule))[0] for value in np.log(ELASTIC)])


def test_neuber_rule_conserves_the_product_and_glinkas_the_strain_energy():
    local = local_range("neuber")
    assert local * strain_range(local, STEEL) == pytest.approx(ELASTIC**2 / STEEL.youngs_modulus, rel=1e-12)
    for elastic, local in zip(ELASTIC, local_range("glinka"), strict=True):
        share = np.linspace(0, 1, 20001) ** 0.25  # fine where the curve bends
        stress = local * share
        strain = strain_range(stress, STEEL)
        energy = np.sum((stress[1:] + stress[:-1]) / 4 * np.diff(strain))
        # a strain of half the range on the plain curve is half of that on the doubled one
        assert energy / 2 == pytest.approx((elastic / 2) ** 2 / (2 * STEEL.youngs_modulus), rel=1e-6)


@pytest.mark.parametrize("rule", STRAINS)
def test_table_error_is_below_1e9(rule):
    low, high = (1e2, 1e12) if rule == "direct" else (2e3, 2e11)
    table = life_table(STEEL, rule)
    ranges = np.exp(np.random.default_rng(0).uniform(np.log(low), np.log(high), 2000))
    exact = 1 / cycles_to_failure(ranges, STEEL, strain=rule)
    found = np.array([look_up(value * value, table) for value in ranges])
    assert found == pytest.approx(exact, rel=1e-9)


def test_strain_rules_apply_with_and_without_morrow_and_lower_the_damage():
    sz = -2e9 * np.sin(np.linspace(0, np.pi, 41)) ** 2
    parts, dsv = (0 * sz, sz, 0 * sz), 2e9 * np.sqrt(0.79)
    for rule in ("neuber", "glinka"):
        plain = post.damage(*parts, STEEL, strain=rule)
        assert plain.damage == pytest.approx(1 / cycles_to_failure(dsv, STEEL, strain=rule), rel=1e-9)
        morrow = post.damage(*parts, STEEL, strain=rule, mean_stress="morrow")
        expected = 1 / cycles_to_failure(dsv, STEEL, -dsv / 2, strain=rule)
        assert morrow.damage == pytest.approx(expected, rel=1e-9)
    ranges = np.array([1.0, 1.5, 2.0, 3.0]) * 1e9
    direct = cycles_to_failure(ranges, STEEL)
    neuber, glinka = (cycles_to_failure(ranges, STEEL, strain=rule) / direct for rule in ("neuber", "glinka"))
    assert neuber == pytest.approx([1.104, 1.983, 6.048, 66.98], rel=1e-3)
    assert glinka == pytest.approx([1.180, 2.685, 9.969, 129.6], rel=1e-3)


def test_loop_of_an_inner_cycle_of_equal_ends_and_of_the_whole():
    series = np.array([0.0, 10, 2, 6, 1, 12, 0])
    assert loop_of(series, 7, 2, 3) == (2, 2)  # beyond 2 and 6 the next samples leave the range
    series = np.array([0.0, 10, 5, 2, 4, 6, 3, 1, 12, 0])
    assert loop_of(series, 10, 3, 5) == (2, 5)  # 5, 2, 4, 6, 3
    assert loop_of(series, 10, 8, 0)[1] == 10
    assert loop_of(series, 10, 9, 1)[1] == 9  # round the end: all but 12
    series = np.array([0.0, 1.0, 0.0, 3.0, 3.0, -1.0])
    assert loop_of(series, series.size, 2, 3) == (0, 5)


def test_command_overrides_rule_and_steel(tmp_path, capsys):
    path, worst = str(write(tmp_path / "a.h5", Scene(per_width=20, travel=9.0), depths=(0.0,))), {}
    for options in ((), ("--set", "post.strain=direct"), ("--set", "contact.material=16MnCr5")):
        assert main([path, *options, "--overwrite"]) == 0
        result = PostResult(tmp_path / "a.post.h5")
        worst[options] = result.passed("2").max()
        assert result.attrs["strain"] == ("direct" if "post.strain=direct" in options else "neuber")
    assert result.attrs["material"] == "16MnCr5, 16MnCr5"
    neuber, direct, hard = worst.values()
    assert direct > 1.2 * neuber and hard < 0.1 * neuber
    assert " SAE4340, " in capsys.readouterr().err
    assert main([path, "--set", "mesh.inlet=-3"]) == 2
    assert main([path, "--set", "post.b=0.3", "--overwrite"]) == 2
    assert "post.b = 0.3: allowed: a number > -2 and < 0" in capsys.readouterr().err


TENSILE = Material(tensile_strength=1.5e9, walker_exponent=0.6)
EQUIVALENT = np.sqrt(1 - 0.3 + 0.09)  # equivalent range of a range of sz in plane strain


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
    found = post.damage(*swing(-1e8, 7e8), TENSILE, mean_stress=name)
    amplitude, mean = 4e8 * EQUIVALENT, 1.3 * 3e8
    life = cycles_to_failure(2 * expected(amplitude, mean), TENSILE, strain="neuber")
    assert found.damage == pytest.approx(found.cycles / life, rel=1e-8)


@pytest.mark.parametrize("name", CORRECTIONS)
def test_no_mean_no_correction(name):
    plain = post.damage(*swing(-5e8, 5e8), TENSILE)
    corrected = post.damage(*swing(-5e8, 5e8), TENSILE, mean_stress=name)
    assert corrected.damage == pytest.approx(plain.damage, rel=1e-9)


def test_order_under_tension_and_compression_and_failure_beyond_the_strength():
    names = ("none", "gerber", "goodman")
    tension = [post.damage(*swing(0, 8e8), TENSILE, mean_stress=name).damage for name in names]
    assert tension == sorted(tension) and tension[0] < tension[2] / 2
    pulse = swing(-9e8, -1e8)
    pressed = {name: post.damage(*pulse, TENSILE, mean_stress=name).damage for name in MEAN_STRESSES}
    assert pressed["swt"] == pressed["walker"] == 0  # never in tension
    assert pressed["gerber"] == pressed["none"] > pressed["goodman"] > 0
    assert post.damage(*swing(1.6e9, 1.7e9), TENSILE, mean_stress="goodman").damage > 1e300
    assert reversed_range(3, 1e8, 2e9, 1.5e9, 0.6) == np.inf


def test_estimates_of_a_steel_and_keys_of_what_is_computed():
    """42CrMo4 of 295 HB: 3.45 HB in MPa, Dowling's exponent."""
    strength, exponent = Material(fatigue_strength=4.25e6 * 295 + 225e6).mean_stress_constants()
    assert strength == pytest.approx(1018e6, abs=1e6)
    assert exponent == pytest.approx(0.678, abs=1e-3)
    assert ("none", "morrow", *CORRECTIONS) == MEAN_STRESSES
    assert POST_KEYS["residual"].choices == RESIDUALS


def test_half_cycles_have_half_the_damage():
    once = np.zeros(5), np.array([0.0, 1.5e9, 0.0, 0.0, 0.0]), np.zeros(5)
    whole, half = (post.damage(*once, TENSILE, residual=name) for name in RESIDUALS)
    assert whole.cycles == half.cycles == 1  # up and down: two halves
    up = tuple(part[:2] for part in once)
    assert post.damage(*up, TENSILE, residual="half").damage == pytest.approx(whole.damage / 2)
