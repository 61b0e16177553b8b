"""Lines at the end of a run about results outside the model's validity; warnings of isothermal cases."""

import pytest
from support import CASES

from ehlpetsc.case.loading import load
from ehlpetsc.physics.scales import Scales
from ehlpetsc.run.forecast.validity import heat_warnings, limits
from ehlpetsc.surfaces.motion.roughness import Roughness

WITHIN = {"p_max": 1.2e9, "oil_pressure": 1.2e9, "mass_error": 1e-7, "nodes_below_1nm": 0}


def limit_lines(name="table1_smooth", overrides=(), boundary_friction=None, **changed):
    case = load(CASES / f"{name}.toml", overrides)
    scales = Scales.of(case)
    return limits(case, scales, Roughness.of(case, scales), WITHIN | changed, boundary_friction)


def test_no_limit_line_within_the_limits():
    assert limit_lines(oil_pressure=5e9) == []  # 5e5 Pa s
    assert limit_lines() == [] and limit_lines("table1_rough") == [] and limit_lines("dry_hertz") == []


@pytest.mark.parametrize(
    "changed, parts",
    [
        ({"p_max": 6.65e9}, ["pressure: ", " 6.65 GPa"]),
        ({"oil_pressure": 9e9}, ["viscosity: 5.0e+08"]),
        ({"mass_error": 0.44}, ["oil balance: ", " 44 % of "]),
        ({"nodes_below_1nm": 7}, ["film: 7 times "]),
    ],
)
def test_each_limit_line_has_its_figure(changed, parts):
    (line,) = limit_lines(**changed)
    assert line.startswith(parts[0]) and parts[-1] in line


def test_friction_beyond_that_of_oils_has_a_limit_line():
    heat = ["heat.bulk_temperature=363.0"]
    (line,) = limit_lines(overrides=heat, friction_coefficient=-1.25)
    assert line.startswith("friction: ") and " 1.25, " in line
    assert limit_lines(overrides=heat, friction_coefficient=0.12) == []
    rubbing = [*heat, "contact.model=mixed", "contact.boundary_film=10e-9", "contact.boundary_friction=0.2"]
    assert limit_lines(overrides=rubbing, friction_coefficient=0.19) == []
    heat = ["heat.bulk_temperature=363.0"]
    assert limit_lines(overrides=heat, boundary_friction=0.3, friction_coefficient=0.25) == []
    (line,) = limit_lines(overrides=heat, boundary_friction=0.1, friction_coefficient=0.25)
    assert line.startswith("friction: a coefficient of 0.25")


SLIDES = "motion={entrainment_speed=1.0,slide_roll_ratio=0.5}"
MIXED = ["contact.model=mixed", "contact.boundary_film=10e-9"]


@pytest.mark.parametrize(
    "name, keys, totals, share",
    [
        ("table1_smooth", MIXED, {"contact_share": 0.031}, "3.1 % of the load"),
        ("table1_smooth", [], {"contacts": 8000, "step": 9}, "%.3g %% of the Hertz contact"),
        ("dry_hertz", [SLIDES], {}, "100 % of the load"),
    ],
)
def test_friction_of_solids_that_is_left_out_has_a_limit_line(name, keys, totals, share):
    heat = [*keys, "heat.bulk_temperature=363.0"]
    points = 2 * load(CASES / f"{name}.toml").mesh.points_per_half_width
    share = share % (8e5 / points / 10) if "%%" in share else share
    (line,) = limit_lines(name, heat, **totals)
    assert line.startswith(f"friction: the solids carry up to {share}") and " of 0.1, the default" in line
    assert limit_lines(name, [*heat, "contact.boundary_friction=0.0"], **totals) == []
    assert limit_lines("table1_smooth", MIXED + heat[-1:], contact_share=0.009) == []
    if name != "dry_hertz":  # nothing slides
        assert limit_lines(name, [*heat, "motion.slide_roll_ratio=0.0"], **totals) == []


def test_unresolved_asperities_and_a_flattened_layer_have_limit_lines():
    found = limit_lines("table1_rough", ["mesh.points_per_half_width=50"])
    for side, line in zip("12", found, strict=True):
        assert line.startswith(f"mesh: surface.{side}: ") and " 51.1 % of its height variance " in line
    (line,) = limit_lines("stribeck", h_min=1.3e-9)
    assert line.startswith("layer: flattened from 132 nm to a film of 1.3 nm")
    assert limit_lines("stribeck", h_min=1.4e-9) == []


HEAT = "heat.bulk_temperature=363.0"


def warned(name, *keys):
    case = load(CASES / f"{name}.toml", keys)
    return heat_warnings(case, Scales.of(case))


def limited(name, friction, *keys):
    found = limit_lines(name, keys, friction_coefficient=friction)
    return [line for line in found if line.startswith("heat")]


def test_damage_case_has_a_heat_warning():
    [line] = warned("table1_damage")
    flash = float(line.split(" K ")[0].split()[-1])
    assert 60.0 < flash < 110.0  # the mean of its surfaces is 50 to 60 K above bulk
    assert warned("table1_damage", HEAT) == []
    [line] = limited("table1_damage", 0.036)
    assert "79 K" in line
    assert limited("table1_damage", 0.036, HEAT) == []


@pytest.mark.parametrize("name", ["table1_smooth", "table1_rough", "waviness", "moes", "dry_hertz"])
def test_slow_or_rolling_contacts_have_no_heat_warning(name):
    assert warned(name) == []
    assert limited(name, 0.0114) == []
