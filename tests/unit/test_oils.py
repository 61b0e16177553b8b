"""Oils under pressure and by their grade: check values, derivatives by complex step, thermal law."""

from pathlib import Path

import numpy as np
import pytest

from ehlpetsc.base.compiled import inlined
from ehlpetsc.case.loading import CaseError, load
from ehlpetsc.physics import laws, oils
from ehlpetsc.physics.laws import WALTHER, temperature_constants

T9 = [oils.OILS["t9"].fluid[name] for name in laws.YASUTOMI]
STEP = 1e-20


def test_yasutomi_by_the_equation_in_degrees_celsius():
    """lg(eta/1e12) = -C1 (T - Tg) F/(C2 + (T - Tg) F), values [Pa s] of a second program."""
    p, celsius = np.array([1e5, 1e8, 3.5e8, 6e8]), np.array([20.0, 40.0, 80.0, 100.0])
    found = 1e12 * np.exp(laws.yasutomi(p, celsius[:, None] + 273.15, *T9, 0.0)[0])
    expected = [
        [0.01699, 0.1893, 69.55, 7.268e4],
        [0.007946, 0.05947, 6.638, 1171.0],
        [0.002879, 0.01305, 0.3672, 10.5],
        [0.002018, 0.007728, 0.1413, 2.409],
    ]
    np.testing.assert_allclose(found, expected, rtol=6e-4)


@pytest.mark.parametrize("p, T", [(0.0, 313.15), (0.8e9, 340.0), (1.2e9, 330.0), (3e9, 313.0)])
def test_derivatives_of_yasutomi_also_beyond_the_glass_transition(p, T):
    value, by_p, by_t = laws.yasutomi(p, T, *T9, 0.9)
    assert laws.yasutomi(p + 1j * STEP, T, *T9, 0.9)[0].imag / STEP == pytest.approx(by_p, rel=1e-10)
    assert laws.yasutomi(p, T + 1j * STEP, *T9, 0.9)[0].imag / STEP == pytest.approx(by_t, rel=1e-10)
    assert inlined(laws.yasutomi)(p, T, *T9, 0.9) == pytest.approx((value, by_p, by_t))
    assert by_p > 0.0 > by_t


def test_conductivity_about_doubles_in_a_gigapascal():
    heat = {key.removeprefix("oil_"): value for key, value in oils.OILS["t9"].heat.items()}
    constants = [heat[f"conductivity{part}"] for part in ("", "_pressure", "_saturation")]
    value, by_p = laws.conductivity(1e9, *constants)
    assert 2.0 < value / constants[0] < 2.2
    assert laws.conductivity(1e9 + 1j * STEP, *constants)[0].imag / STEP == pytest.approx(by_p, rel=1e-12)


@pytest.mark.parametrize("name", oils.OILS)
def test_named_oil_has_its_law_at_any_reference_temperature(name):
    """The same viscosity of pressure and temperature from 40 as from 90 degrees C; left out: 40."""
    given = LEFT_OUT | {"fluid.oil": name, "fluid.law": None, "fluid.density": None, "fluid.gamma": None}
    given |= {"fluid.lambda": None, "fluid.roelands_pressure": None, "fluid.eyring_stress": None}
    given |= ROELANDS | {"fluid.law": None}
    p, T, found = np.array([0.0, 0.3e9, 1e9]), 350.0, []
    for reference in (313.15, 363.15):
        case = load(CASE, given | {"heat.bulk_temperature": 340.0, "heat.reference_temperature": reference})
        ln_eta = laws.viscosity(p, case.fluid, case.heat, T)[0]
        found.append(np.log(case.fluid.viscosity) + ln_eta)
    np.testing.assert_allclose(*found, rtol=1e-6)
    fluid = load(CASE, given).fluid
    assert fluid.viscosity == pytest.approx(oils.OILS[name].fluid["viscosity"])
    assert 14e-9 < fluid.pressure_viscosity < 25e-9


CASE = Path(__file__).parents[2] / "cases" / "table1_smooth.toml"
GRADE = {"fluid.grade": {"v40": 220e-6, "v100": 19e-6, "density": 880.0}}
LEFT_OUT = {"fluid.viscosity": None, "fluid.pressure_viscosity": None}
BARUS = {"fluid.law": "barus", "fluid.reference_viscosity": None, "fluid.roelands_pressure": None}
ROELANDS = {"fluid.law": "roelands", "fluid.reference_viscosity": None}


@pytest.mark.parametrize("celsius, nu", [(40.0, 220e-6), (100.0, 19e-6)])
def test_viscosity_of_a_grade(celsius, nu):
    case = load(CASE, GRADE | LEFT_OUT | ROELANDS | {"fluid.temperature": celsius + 273.15})
    assert case.fluid.viscosity == pytest.approx(880.0 * nu, rel=1e-10)
    secant = 9.904e-9 * (1e6 * nu) ** 0.139  # over 2000 bar: the initial slope is steeper
    assert laws.viscosity(2e8, case.fluid)[0] == pytest.approx(2e8 * secant, rel=1e-10)
    assert 1.05 * secant < case.fluid.pressure_viscosity < 1.25 * secant
    barus = load(CASE, GRADE | LEFT_OUT | BARUS | {"fluid.temperature": celsius + 273.15})
    assert barus.fluid.pressure_viscosity == pytest.approx(secant, rel=1e-10)


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
    with pytest.raises(
        CaseError, match=r"fluid\.temperature = 350.*: needs fluid\.grade or oil.*reference_t"
    ):
        load(CASE, {"fluid.temperature": 350.0})  # would move the temperature of a viscosity that is given
    with pytest.raises(CaseError, match="v100"):
        load(CASE, {"fluid.grade": {"v40": 19e-6, "v100": 220e-6, "density": 880.0}})
