"""Life and damage against the restored equations; elastic-plastic rules and closed loops against theirs."""

from functools import partial

import numpy as np
import pytest
from support import ROOT
from support.made_loads import Scene, write
from support.running import PYTHON, called

from ehlpetsc import post
from ehlpetsc.post import Material, cycles_to_failure
from ehlpetsc.post.command import main
from ehlpetsc.post.fatigue.cycles import loop_of
from ehlpetsc.post.fatigue.strain_life import STRAINS, life_table, log_local_range, look_up
from ehlpetsc.results.post_result import PostResult

STEEL = Material()
damage = partial(post.damage, strain="direct")
RANGES = np.array([1e9, 1.5e9, 2e9, 3e9, 4e9])


def life_curve(n, material):
    """Strain range that N cycles stand: Holmes et al. 2005, eq. (14)."""
    return 2 * (
        material.fatigue_strength / material.youngs_modulus * (2 * n) ** material.b
        + material.fatigue_ductility * (2 * n) ** material.c
    )


def strain_range(stress, material):
    """Cyclic stress-strain curve: Holmes et al. 2005, eq. (13)."""
    plastic = (stress / (2 * material.hardening_coefficient)) ** (1 / material.cyclic_hardening)
    return stress / material.youngs_modulus + 2 * plastic


def pulse(size, samples=41):
    """One loading of sz alone in plane strain, from 0 to -size and back."""
    sz = -size * np.sin(np.linspace(0, np.pi, samples)) ** 2
    return np.zeros(samples), sz, np.zeros(samples)


def test_restored_values():
    assert STEEL.hardening_coefficient == pytest.approx(2232.77e6, rel=1e-6)
    assert strain_range(RANGES, STEEL) == pytest.approx(
        [4.92393e-3, 8.634665e-3, 1.911124e-2, 0.1555341, 0.9793237], rel=1e-6
    )
    assert cycles_to_failure(RANGES, STEEL) == pytest.approx(
        [2.106877e6, 2.565758e4, 1093.558, 12.21644, 0.5], rel=1e-6
    )


def test_inversion_to_1e10_over_23_decades():
    """Find the stress range of each life by bisection, then get the life back."""
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


def test_extremes_do_not_overflow():
    with np.errstate(all="raise"):
        lives = cycles_to_failure(np.array([0.0, 1e-300, 1e-30, 1e30, np.inf]), STEEL)
    assert lives[0] == lives[1] == np.inf and lives[2] > 1e300 and lives[3] < 1e-30 and lives[4] == 0


def test_one_pulse_is_one_cycle():
    size = 2e9
    result = damage(*pulse(size), STEEL)
    dsv = size * np.sqrt(1 - 0.3 + 0.09)  # sx = 0, sy = nu sz
    assert result.peak_range == pytest.approx(dsv, rel=1e-12)
    assert result.cycles == 1
    assert result.damage == pytest.approx(1 / cycles_to_failure(dsv, STEEL), rel=1e-9)


@pytest.mark.parametrize("first", [True, False])
def test_component_of_most_damage_counts_not_that_of_the_largest_range(first):
    many = np.append(1.5e9 * np.sin(np.linspace(0, 20 * np.pi, 401)) ** 2, np.zeros(41))
    one = np.append(np.zeros(401), 1.6e9 * np.sin(np.linspace(0, np.pi, 41)) ** 2)
    both = damage(*((many, one) if first else (one, many)), 0 * one, STEEL)
    assert both.cycles == 20 and both.damage == pytest.approx(20 * float(damage(*pulse(1.5e9), STEEL).damage))
    assert both.peak_range == pytest.approx(1.5e9 * np.sqrt(0.79))


def test_rotating_shear_is_counted_at_constant_von_mises_stress():
    t = np.linspace(0, 2 * np.pi, 81)
    parts = np.zeros(81), np.zeros(81), 5e8 * np.sin(t)
    assert damage(*parts, STEEL).peak_range == pytest.approx(np.sqrt(3) * 1e9, rel=1e-6)


def test_morrow_lengthens_life_under_compression_to_a_floor():
    result = damage(*pulse(1e9), STEEL, mean_stress="morrow")
    dsv = 1e9 * np.sqrt(0.79)
    assert 1.3 * -0.5e9 < -dsv / 2  # the trace asks for more than the floor gives
    assert result.damage == pytest.approx(1 / cycles_to_failure(dsv, STEEL, -dsv / 2), rel=1e-9)
    assert result.damage < damage(*pulse(1e9), STEEL).damage
    tension = damage(*pulse(-1e9), STEEL, mean_stress="morrow")
    assert tension.damage == pytest.approx(1 / cycles_to_failure(dsv, STEEL, 1.3 * 0.5e9), rel=1e-9)
    beyond = cycles_to_failure(1e9, STEEL, 3e9)  # mean above the strength: the plastic term alone
    assert np.isfinite(beyond) and 0 < beyond < cycles_to_failure(1e9, STEEL)


def test_benefit_of_contact_pressure_is_limited():
    """Ten times the hydrostatic pressure about the same cycle gives the same damage."""
    sx, sz, txz = pulse(1e9)
    lives = [damage(sx - p, sz - p, txz, STEEL, mean_stress="morrow").damage for p in (2e9, 2e10)]
    assert lives[0] == pytest.approx(lives[1], rel=1e-6)


def test_residual_stress_enters_the_mean():
    dsv = 1e9 * np.sqrt(0.79)
    tension, residual = pulse(-1e9), -2e8
    result = damage(*tension, STEEL, mean_stress="morrow", residual_stress=residual)
    mean = 1.3 * 0.5e9 + 2 * residual  # the same in x and y
    assert result.damage == pytest.approx(1 / cycles_to_failure(dsv, STEEL, mean), rel=1e-9)
    assert damage(*tension, STEEL, residual_stress=residual).damage == damage(*tension, STEEL).damage
    with pytest.raises(ValueError, match="residual_stress"):
        damage(*tension, STEEL, residual_stress=np.nan)


def test_no_stress_no_damage():
    result = damage(np.zeros((2, 9)), np.zeros((2, 9)), np.zeros((2, 9)), STEEL)
    assert (result.damage == 0).all() and (result.cycles == 0).all() and (result.peak_range == 0).all()


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


def test_loop_extends_over_samples_equal_to_its_ends():
    series = np.array([0.0, 1.0, 0.0, 3.0, 3.0, -1.0])
    assert loop_of(series, series.size, 2, 3) == (0, 5)


def test_neuber_rule_conserves_the_product():
    local = local_range("neuber")
    assert local * strain_range(local, STEEL) == pytest.approx(ELASTIC**2 / STEEL.youngs_modulus, rel=1e-12)


def test_glinka_rule_conserves_the_strain_energy():
    for elastic, local in zip(ELASTIC, local_range("glinka"), strict=True):
        share = np.linspace(0, 1, 20001) ** 0.25  # fine where the curve bends
        stress = local * share
        strain = strain_range(stress, STEEL)
        energy = np.sum((stress[1:] + stress[:-1]) / 4 * np.diff(strain))
        # a strain of half the range on the plain curve is half of that on the doubled one
        assert energy / 2 == pytest.approx((elastic / 2) ** 2 / (2 * STEEL.youngs_modulus), rel=1e-6)


def test_damage_by_direct_entry_over_neuber_and_glinka():
    """The figures of the README: the direct entry is too high against Neuber's rule and against Glinka's."""
    ranges = np.array([1.0, 1.5, 2.0, 3.0]) * 1e9
    direct = cycles_to_failure(ranges, STEEL)
    neuber, glinka = (cycles_to_failure(ranges, STEEL, strain=rule) / direct for rule in ("neuber", "glinka"))
    assert neuber == pytest.approx([1.104, 1.983, 6.048, 66.98], rel=1e-3)
    assert glinka == pytest.approx([1.180, 2.685, 9.969, 129.6], rel=1e-3)


@pytest.mark.parametrize("rule", STRAINS)
def test_table_error_is_below_1e9(rule):
    """Direct: also beyond the ends of the table."""
    low, high = (1e2, 1e12) if rule == "direct" else (2e3, 2e11)
    table = life_table(STEEL, rule)
    ranges = np.exp(np.random.default_rng(0).uniform(np.log(low), np.log(high), 2000))
    exact = 1 / cycles_to_failure(ranges, STEEL, strain=rule)
    found = np.array([look_up(value * value, table) for value in ranges])
    assert found == pytest.approx(exact, rel=1e-9)


def test_strain_rules_apply_with_and_without_morrow():
    sz = -2e9 * np.sin(np.linspace(0, np.pi, 41)) ** 2
    parts, dsv = (0 * sz, sz, 0 * sz), 2e9 * np.sqrt(0.79)
    for rule in ("neuber", "glinka"):
        plain = post.damage(*parts, STEEL, strain=rule)
        assert plain.damage == pytest.approx(1 / cycles_to_failure(dsv, STEEL, strain=rule), rel=1e-9)
        morrow = post.damage(*parts, STEEL, strain=rule, mean_stress="morrow")
        assert morrow.damage == pytest.approx(
            1 / cycles_to_failure(dsv, STEEL, -dsv / 2, strain=rule), rel=1e-9
        )


def test_loop_of_an_inner_cycle_and_of_the_whole():
    series = np.array([0.0, 10, 2, 6, 1, 12, 0])
    assert loop_of(series, 7, 2, 3) == (2, 2)  # beyond 2 and 6 the next samples leave the range
    series = np.array([0.0, 10, 5, 2, 4, 6, 3, 1, 12, 0])
    assert loop_of(series, 10, 3, 5) == (2, 5)  # 5, 2, 4, 6, 3
    assert loop_of(series, 10, 8, 0)[1] == 10
    assert loop_of(series, 10, 9, 1)[1] == 9  # round the end: all but 12


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


def test_few_points_are_a_warning(tmp_path, capsys):
    """Of 6.05 half-widths of travel surface 2 covers 4.03: one node more than the mesh is wide."""
    scene = Scene(per_width=20, ratio=0.4, travel=6.05)
    path = write(tmp_path / "a.h5", scene, depths=(0.0,))
    assert main([str(path)]) == 0
    message = capsys.readouterr()
    assert "surface 2 that passed the whole contact: 1;" in message.err
    assert "raise time.travel" in message.err and "of surface 1 that passed" not in message.err
    assert "nan" not in message.out
