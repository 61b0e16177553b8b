"""Hints beside faults of a case, and constants of the oil that may be left out."""

import math

import numpy as np
import pytest
from support import CASES

from ehlpetsc.base.errors import CaseError
from ehlpetsc.case.loading import load
from ehlpetsc.physics.laws import viscosity

SMOOTH = CASES / "table1_smooth.toml"
OIL = {"fluid.law": "roelands", "fluid.reference_viscosity": None, "fluid.roelands_pressure": None}


def fault(overrides):
    with pytest.raises(CaseError) as refused:
        load(SMOOTH, overrides)
    (line,) = refused.value.faults
    return line


@pytest.mark.parametrize(
    ("key", "value", "hint"),
    [
        ("contact.yield_pressure", 3e9, 'needs contact.model = "mixed"'),
        ("contact.radius", {"a": 1}, "contact.radius: a table here; allowed: a number"),
        ("fluid.limiting_shear_stress", 1e7, 'did you mean "limiting_shear"?'),
    ],
)
def test_fault_suggests_the_probable_value(key, value, hint):
    assert hint in fault({key: value})


def test_single_value_applies_to_both_solids():
    contact = load(SMOOTH, {"contact.youngs_modulus": 206e9, "contact.poisson_ratio": 0.29}).contact
    assert contact.youngs_modulus == (206e9, 206e9) and contact.poisson_ratio == (0.29, 0.29)


def test_omitted_roelands_constants_follow_from_the_pressure_coefficient():
    """z = alpha pr/(ln eta0 + 9.67), and the slope of ln eta at ambient pressure is alpha."""
    fluid = load(SMOOTH, OIL | {"fluid.viscosity": 0.015, "fluid.pressure_viscosity": 18e-9}).fluid
    assert fluid.roelands_pressure == 1.96e8
    assert fluid.roelands_z == pytest.approx(18e-9 * 1.96e8 / (math.log(0.015) + 9.67), rel=1e-4)
    small = 1e3  # Pa
    (exponent,) = viscosity(np.array([small]), fluid)[0]
    assert exponent == pytest.approx(18e-9 * small, rel=1e-5)
    assert "by viscosity and pressure_viscosity it is" in fault(OIL | {"fluid.viscosity": 65e-6})


def test_default_density_is_dowson_higginson():
    fluid = load(SMOOTH, {"fluid.gamma": None, "fluid.lambda": None}).fluid
    assert (fluid.gamma, fluid.lambda_) == (2.3e-9, 1.7e-9)
