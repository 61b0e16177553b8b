"""Warnings of isothermal cases: before the run by an estimated friction, after it by its own."""

import pytest
from support import CASES

from ehlpetsc.case.loading import load
from ehlpetsc.physics.scales import Scales
from ehlpetsc.run.outputs.limits import limits
from ehlpetsc.run.warnings import heat_warnings

TOTALS = {"p_max": 1e9, "oil_pressure": 1e9, "mass_error": 0.0, "nodes_below_1nm": 0}
HEAT = "heat.bulk_temperature=363.0"


def warned(name, *keys):
    case = load(CASES / f"{name}.toml", keys)
    return heat_warnings(case, Scales.of(case))


def limited(name, friction, *keys):
    case = load(CASES / f"{name}.toml", keys)
    found = limits(case, Scales.of(case), None, TOTALS | {"friction_coefficient": friction})
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
