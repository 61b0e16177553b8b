"""Lines at the end of a run about results outside the model's validity."""

import pytest
from support import CASES

from ehlpetsc.case.loading import load
from ehlpetsc.physics.scales import Scales
from ehlpetsc.run.outputs.limits import limits
from ehlpetsc.surfaces.roughness import Roughness

WITHIN = {
    "p_max": 1.2e9,
    "oil_pressure": 1.2e9,
    "mass_error": 1e-7,
    "nodes_below_1nm": 0,
}


def limit_lines(name="table1_smooth", overrides=(), **changed):
    case = load(CASES / f"{name}.toml", overrides)
    scales = Scales.of(case)
    return limits(case, scales, Roughness.of(case, scales), WITHIN | changed)


def test_no_limit_line_within_the_limits():
    assert limit_lines() == [] and limit_lines("table1_rough") == [] and limit_lines("dry_hertz") == []


@pytest.mark.parametrize(
    "changed, parts",
    [
        ({"p_max": 6.65e9}, ["pressure: ", " 6.65 GPa"]),
        ({"oil_pressure": 9e9}, ["viscosity: 5.0e+08"]),
        ({"mass_error": 0.44}, ["oil balance: ", " 44 % of "]),
        ({"mass_error": 101.3}, ["oil balance: ", " 101 times "]),
        ({"nodes_below_1nm": 7}, ["film: 7 times "]),
        ({"nodes_below_1nm": 1}, ["film: 1 time "]),
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


def test_measured_viscosity_range_has_no_limit_line():
    assert limit_lines(oil_pressure=5e9) == []  # 5e5 Pa s


def test_unresolved_asperities_are_given_with_their_height_fraction():
    (line,) = limit_lines("table1_rough", ["mesh.points_per_half_width=50"])
    assert line.startswith("mesh: ") and " 51.1 % of surface.1 and 51.1 % of surface.2 " in line
