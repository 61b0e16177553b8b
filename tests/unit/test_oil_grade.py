"""Oils by their grade: viscosity, its pressure coefficient, thermal law."""

from pathlib import Path

import pytest

from ehlpetsc.case.loading import CaseError, load
from ehlpetsc.physics.laws import WALTHER, temperature_constants

CASE = Path(__file__).parents[2] / "cases" / "table1_smooth.toml"
GRADE = {"fluid.grade": {"v40": 220e-6, "v100": 19e-6, "density": 880.0}}
LEFT_OUT = {"fluid.viscosity": None, "fluid.pressure_viscosity": None}
ROELANDS = {"fluid.law": "roelands", "fluid.reference_viscosity": None}


@pytest.mark.parametrize("celsius, nu", [(40.0, 220e-6), (100.0, 19e-6)])
def test_viscosity_of_a_grade(celsius, nu):
    case = load(CASE, GRADE | LEFT_OUT | ROELANDS | {"fluid.temperature": celsius + 273.15})
    assert case.fluid.viscosity == pytest.approx(880.0 * nu, rel=1e-10)
    assert case.fluid.pressure_viscosity == pytest.approx(9.904e-9 * (1e6 * nu) ** 0.139, rel=1e-10)


def test_keys_of_the_case_override_the_grade():
    case = load(CASE, GRADE | {"fluid.temperature": 333.15})
    assert case.fluid.viscosity == 0.005 and case.fluid.pressure_viscosity == 11.1e-9


def test_grade_sets_the_thermal_law():
    case = load(CASE, GRADE | LEFT_OUT | ROELANDS | {"heat.bulk_temperature": 373.15})
    assert case.fluid.viscosity == pytest.approx(880.0 * 19e-6, rel=1e-10)
    assert case.heat.oil_density == 880.0
    kind, _, _, reference = temperature_constants(case.fluid, case.heat)
    assert kind == WALTHER and reference == 373.15


def test_faulty_temperature_of_a_grade_is_the_only_fault():
    """The viscosity, which then does not follow, was reported as well."""
    with pytest.raises(CaseError) as refused:
        load(CASE, GRADE | LEFT_OUT | {"fluid.temperature": 80})
    (fault,) = refused.value.faults
    assert "fluid.temperature = 80: " in fault and fault.endswith('; "80 degC"?')


def test_named_oil_has_the_viscosities_of_its_class():
    named = {"fluid.grade": "ISO VG 220"} | LEFT_OUT | ROELANDS
    for celsius, nu in ((40.0, 220e-6), (100.0, 19.4e-6)):
        fluid = load(CASE, named | {"fluid.temperature": f"{celsius} degC"}).fluid
        assert fluid.viscosity == pytest.approx(nu * 899.0 * (1 - 7e-4 * (celsius - 15.0)), rel=1e-9)
    with pytest.raises(CaseError, match=r'fluid\.grade = "VG 220": .*ISO VG 220'):
        load(CASE, named | {"fluid.grade": "VG 220", "fluid.temperature": 350.0})


def test_faults():
    with pytest.raises(CaseError, match=r"fluid\.viscosity .*missing"):
        load(CASE, GRADE | LEFT_OUT)  # no temperature
    with pytest.raises(CaseError, match=r"fluid\.temperature = 350.*: needs fluid\.grade; .*reference_temp"):
        load(CASE, {"fluid.temperature": 350.0})  # would move the temperature of a viscosity that is given
    with pytest.raises(CaseError, match="v100"):
        load(CASE, {"fluid.grade": {"v40": 19e-6, "v100": 220e-6, "density": 880.0}})
