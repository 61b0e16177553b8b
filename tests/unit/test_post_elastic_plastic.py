"""Neuber's and Glinka's rules against their own equations, and closed loops against trying every pair."""

import numpy as np
import pytest
from support.made_loads import Scene, write

from ehlpetsc.post import Material, cycles_to_failure, damage
from ehlpetsc.post.command import main
from ehlpetsc.post.fatigue.cycles import loop_of
from ehlpetsc.post.fatigue.strain_life import STRAINS, life_table, log_local_range, look_up
from ehlpetsc.results.post_result import PostResult

STEEL = Material()
RANGES = np.logspace(7, 10.5, 30)


def curve_strain(stress):
    """The doubled cyclic stress-strain curve (13)."""
    return stress / STEEL.youngs_modulus + 2 * (stress / (2 * STEEL.hardening_coefficient)) ** (
        1 / STEEL.cyclic_hardening
    )


def local_range(rule):
    curve = STEEL.constants()[:3]
    return np.exp([log_local_range(value, *curve, STRAINS.index(rule))[0] for value in np.log(RANGES)])


def test_loop_extends_over_samples_equal_to_its_ends():
    series = np.array([0.0, 1.0, 0.0, 3.0, 3.0, -1.0])
    assert loop_of(series, series.size, 2, 3) == (0, 5)


def test_neuber_rule_conserves_the_product():
    local = local_range("neuber")
    assert local * curve_strain(local) == pytest.approx(RANGES**2 / STEEL.youngs_modulus, rel=1e-12)


def test_glinka_rule_conserves_the_strain_energy():
    for elastic, local in zip(RANGES, local_range("glinka"), strict=True):
        share = np.linspace(0, 1, 20001) ** 0.25  # fine where the curve bends
        stress = local * share
        strain = curve_strain(stress)
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


@pytest.mark.parametrize("rule", ["neuber", "glinka"])
def test_table_error_is_below_1e9(rule):
    table = life_table(STEEL, rule)
    ranges = np.exp(np.random.default_rng(0).uniform(np.log(2e3), np.log(2e11), 2000))
    exact = 1 / cycles_to_failure(ranges, STEEL, strain=rule)
    found = np.array([look_up(value * value, table) for value in ranges])
    assert found == pytest.approx(exact, rel=1e-9)


def test_strain_rules_apply_with_and_without_morrow():
    sz = -2e9 * np.sin(np.linspace(0, np.pi, 41)) ** 2
    parts, dsv = (0 * sz, sz, 0 * sz), 2e9 * np.sqrt(0.79)
    for rule in ("neuber", "glinka"):
        plain = damage(*parts, STEEL, strain=rule)
        assert plain.damage == pytest.approx(1 / cycles_to_failure(dsv, STEEL, strain=rule), rel=1e-9)
        morrow = damage(*parts, STEEL, strain=rule, mean_stress="morrow")
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
    assert "only 1 point of surface 2 " in message.err
    assert "raise time.travel" in message.err and "of surface 1 passed the" not in message.err
    assert "nan" not in message.out
