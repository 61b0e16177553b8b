"""Laws of the oil and oils by name and grade: check values, derivatives by complex step, films."""

import re
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import least_squares
from support import CASES, one_fault
from support.published_values import SHC_320

from ehlpetsc.base.compiled import compiled, inlined
from ehlpetsc.base.errors import CaseError
from ehlpetsc.case.checking import values_of
from ehlpetsc.case.loading import load
from ehlpetsc.case.tables import FLUID
from ehlpetsc.physics.oil import laws, oils, rheology, viscosity_laws
from ehlpetsc.physics.oil.law import n_constants
from ehlpetsc.physics.scales import Scales
from ehlpetsc.run.forecast.validity import warnings
from ehlpetsc.run.simulation import Simulation

STEP = 1e-20
CASE = CASES / "table1_smooth.toml"
V40, V100 = 220e-6, 19e-6
WALTHER_CONSTANTS = viscosity_laws.walther_constants(V40, V100)
GPA = 1e9 * np.array([0.0, 0.5, 1.0, 2.0, 4.0])
OF_YASUTOMI = {  # constants about those of a naphthenic oil
    **{"yasutomi_c1": 16.09, "yasutomi_c2": 17.38, "yasutomi_glass": 189.95, "yasutomi_a1": 188.95},
    **{"yasutomi_a2": 0.719e-9, "yasutomi_b1": 8.2e-9, "yasutomi_b2": -0.5278},
}
YASUTOMI = [OF_YASUTOMI[name] for name in viscosity_laws.YASUTOMI]


OIL = {"viscosity": 0.005, "law": "roelands", "pressure_viscosity": 11.1e-9}
OIL |= {"reference_viscosity": 63.2e-6, "roelands_pressure": 1.0 / 5.1e-9}
OIL |= {"density": "dowson-higginson", "gamma": 2.27e-9, "lambda": 1.68e-9}


def oil(**changes):
    return values_of(FLUID, OIL | changes)


@pytest.mark.parametrize(
    "eta0, values",
    [(0.005, [0.2333503, 2.962664, 132.4506, 33651.48]), (0.001, [0.113767, 6.14164, 7115.26, 1.63311e9])],
)
def test_roelands_viscosity_by_reference_constants(eta0, values):
    ln_eta, _ = laws.viscosity(GPA, oil(viscosity=eta0))
    np.testing.assert_allclose(eta0 * np.exp(ln_eta), [eta0, *values], rtol=5e-6)


def test_dowson_higginson_density():
    rho, _ = laws.density(GPA, oil())
    np.testing.assert_allclose(rho, [1.0, 1.160326, 1.220149, 1.270642, 1.305699], rtol=5e-7)


@pytest.mark.parametrize("density", laws.DENSITY_LAWS)
def test_derivative_of_the_density(density):
    p, fluid = np.linspace(0.0, 3e9, 40), oil(density=density)
    slope = laws.density(p + 1j * STEP, fluid)[0].imag / STEP
    np.testing.assert_allclose(laws.density(p, fluid)[1], slope, rtol=1e-12)


TEMPERATURE = {
    "isothermal": (viscosity_laws.ISOTHERMAL, 0.0, 0.0, 363.0),
    "exponential": (viscosity_laws.EXPONENTIAL, 0.04, 0.0, 363.0),
    "roelands": (viscosity_laws.ROELANDS, 1.1, 0.0, 363.0),
    "walther": (viscosity_laws.WALTHER, *WALTHER_CONSTANTS, 363.0),
    "walther and roelands": (viscosity_laws.ROELANDS_WALTHER, *WALTHER_CONSTANTS, 363.0),
}


@pytest.mark.parametrize("thermal", TEMPERATURE.values(), ids=TEMPERATURE)
@pytest.mark.parametrize("pressure", [(4.0, 0.196e9, 0.5), (11.1, 1e9, 1.0)], ids=["power", "barus"])
@pytest.mark.parametrize("p", [0.0, 1.3e9])
def test_derivatives_of_the_viscosity(thermal, pressure, p):
    constants = *pressure, *thermal
    value, by_p, by_t = viscosity_laws.power_law(p, 371.0, *constants)
    stepped = viscosity_laws.power_law(p + STEP * 1j, 371.0 + 0j, *constants)[0]
    assert stepped.imag / STEP == pytest.approx(by_p, rel=1e-12)
    stepped = viscosity_laws.power_law(p + 0j, 371.0 + STEP * 1j, *constants)[0]
    assert stepped.imag / STEP == pytest.approx(by_t, rel=1e-12, abs=1e-30)
    assert viscosity_laws.power_law(0.0, 363.0, *constants)[0] == pytest.approx(0.0, abs=1e-14)


@compiled
def _both(viscosity, density, p, T):
    return laws.ln_viscosity(viscosity, p, T), laws.relative_density(density, p)


def test_yasutomi_by_the_equation_in_degrees_celsius():
    """lg(eta/1e12) = -C1 (T - Tg) F/(C2 + (T - Tg) F), values [Pa s] of a second program."""
    p, celsius = np.array([1e5, 1e8, 3.5e8, 6e8]), np.array([20.0, 40.0, 80.0, 100.0])
    found = 1e12 * np.exp(viscosity_laws.yasutomi(p, celsius[:, None] + 273.15, *YASUTOMI, 0.0)[0])
    expected = [
        [0.01699, 0.1893, 69.55, 7.268e4],
        [0.007946, 0.05947, 6.638, 1171.0],
        [0.002879, 0.01305, 0.3672, 10.5],
        [0.002018, 0.007728, 0.1413, 2.409],
    ]
    np.testing.assert_allclose(found, expected, rtol=6e-4)


def test_constants_in_degrees_celsius_are_converted_or_refused():
    """C2 and A1 are differences of temperatures, Tg is a temperature: C2 and A1 were 273.15 K too large."""
    celsius = {"yasutomi_c2": "17.38 degC", "yasutomi_glass": "-83.2 C", "yasutomi_a1": "340.11 degF"}
    given = {f"fluid.{key}": value for key, value in ({"law": "yasutomi"} | OF_YASUTOMI | celsius).items()}
    others = dict.fromkeys(f"fluid.{key}" for key in ("reference_viscosity", "roelands_pressure"))
    fluid = load(CASE, others | {"fluid.pressure_viscosity": None} | given).fluid
    found = fluid.yasutomi_c2, fluid.yasutomi_glass, fluid.yasutomi_a1
    assert found == pytest.approx((17.38, 273.15 - 83.2, 188.95), rel=1e-12)
    with pytest.raises(CaseError, match=r"fluid\.yasutomi_c2 = -17: allowed: a number > 0 .*\)$"):
        load(CASE, given | {"fluid.yasutomi_c2": -17})  # no hint to degrees Celsius
    celsius = {"law": "modulus", "modulus_c": 1021.7, "modulus_d": -171.6, "modulus_a1": 327.8}
    celsius |= {"modulus_a2": 2.9862, "modulus_b1": 4.4e-3, "modulus_b2": 3e-4, "pressure_viscosity": None}
    given = {f"fluid.{key}": value for key, value in celsius.items()}
    given |= dict.fromkeys(("fluid.reference_viscosity", "fluid.roelands_pressure"))
    with pytest.raises(CaseError, match=r"fluid\.modulus_a1 = 327\.8: .* 1\.26e\+03 Pa at 313\.15 K"):
        load(CASE, given)
    with pytest.raises(CaseError, match=r"fluid\.modulus_d = -301"):
        load(CASE, given | {"fluid.modulus_d": -301.0})


def of_oil(name, **keys):
    """`[fluid]` of a case with the oil."""
    given = dict.fromkeys(f"fluid.{key}" for key in OIL) | {"fluid.oil": name, "fluid.eyring_stress": None}
    return load(CASE, given | keys)


FVA3 = laws.viscosity_law(of_oil("fva3").fluid).constants[:8]


@pytest.mark.parametrize("heat", [{}, {"heat.bulk_temperature": "60 degC"}], ids=["isothermal", "with heat"])
def test_modulus_law_by_the_equation_of_its_source(heat):
    """Constants of FVA 3 in bar and degrees Celsius, viscosity [mPa s]."""
    p, celsius = np.array([0.0, 1000.0, 5000.0, 12000.0]), np.array([[25.0], [60.0], [110.0]])
    expected = 0.062 * np.exp(1021.7 / (101.5517 + celsius)) * np.ones(4)
    expected *= np.exp(p / (327.7918 + 2.9862 * celsius + (4.419e-3 + 3.0115e-4 * celsius) * p))
    case = of_oil("fva3", **({"fluid.temperature": "60 degC"} if not heat else heat))
    found = laws.viscosity(1e5 * p, case.fluid, case.heat, 273.15 + celsius)[0]
    np.testing.assert_allclose(1e3 * case.fluid.viscosity * np.exp(found), expected, rtol=1e-9)


@pytest.mark.parametrize(
    "fluid",
    [oil(law="barus", density="incompressible"), oil(), of_oil("pao100").fluid],
    ids=lambda oil: oil.law,
)
def test_compiled_loops_get_the_law_of_the_case(fluid):
    viscosity, p = laws.viscosity_law(fluid), 1.1e9
    found = _both(tuple(viscosity), tuple(laws.density_law(fluid)), p, viscosity.temperature)
    assert found[0][:2] == pytest.approx(laws.viscosity(p, fluid), rel=1e-14)
    assert found[1] == pytest.approx(laws.density(p, fluid), rel=1e-14)


def test_eyring_stress_of_bair_and_winer_and_another_one_grow_with_pressure():
    """2 Lambda/alpha(p, T) at 60 degrees C: 4.9 MPa without pressure, 7.2 MPa at 1 GPa."""
    fluid = of_oil("m100", **{"fluid.temperature": "60 degC"}).fluid
    secant = laws.viscosity(1e9, fluid)[0] / 1e9
    assert fluid.eyring_stress == pytest.approx(2.0 * 0.047 / fluid.pressure_viscosity, rel=1e-12)
    assert fluid.eyring_stress == pytest.approx(4.93e6, rel=2e-3)
    under_pressure = fluid.eyring_stress * (1.0 + 1e9 * fluid.eyring_stress_pressure)
    assert under_pressure == pytest.approx(2.0 * 0.047 / secant, rel=1e-12)
    assert under_pressure == pytest.approx(7.19e6, rel=2e-3)
    stress = of_oil("m100").fluid.eyring_stress
    own = of_oil("m100", **{"fluid.eyring_stress": 1.3 * stress}).fluid
    assert own.eyring_stress == 1.3 * stress
    assert own.eyring_stress_pressure == of_oil("m100").fluid.eyring_stress_pressure > 0.0
    heated = {"heat.bulk_temperature": "60 degC", "fluid.eyring_stress": 5e6}
    assert of_oil("m100", **heated).fluid.eyring_stress_pressure > 0.0
    assert of_oil("m100", **{"fluid.eyring_stress_pressure": 0.0}).fluid.eyring_stress_pressure == 0.0


def test_another_shear_law_of_a_measured_oil_is_warned_of():
    case = of_oil("m100", **{"fluid.carreau_stress": 5e6, "fluid.carreau_exponent": 0.5})
    assert case.fluid.eyring_stress is None and case.fluid.eyring_stress_pressure is None
    rise = 1e9 * of_oil("m100").fluid.eyring_stress_pressure
    (note,) = (line for line in warnings(case, Scales.of(case)) if "carreau law" in line)
    assert f"it is constant, and that grows by {rise:.3g} of itself per GPa" in note
    plain = of_oil("m100")
    assert not any("takes the place" in line for line in warnings(plain, Scales.of(plain)))


def test_constants_of_shc_320_are_fitted_to_its_measured_viscosities():
    """Viscosity to 2.0 % rms and 5.9 % at most, density by one law for all temperatures to 2.1 %."""
    T, p, eta = 273.15 + SHC_320["celsius"], 1e5 * SHC_320["bar"], SHC_320["viscosity"]
    ambient = SHC_320[SHC_320["bar"] == 0]
    rho = SHC_320["density"] / np.interp(SHC_320["celsius"], ambient["celsius"], ambient["density"])
    assert len(T) == 67
    scales = np.array([1.0, 1e3, 1e2, 1e7, 1e5, 1.0, 1e-4])

    def misfit(x):
        ln_k, c, d, a1, a2, b1, b2 = x * scales
        return ln_k + c / (d + T) + p / (a1 + a2 * T + (b1 + b2 * T) * p) - np.log(1e-3 * eta)

    fit = least_squares(misfit, [-11, 1.5, -1.4, -3, 3, -0.05, 3], xtol=1e-14, ftol=1e-14, gtol=1e-14)
    fluid = of_oil("shc320").fluid
    c, d, *others = (getattr(fluid, name) for name in viscosity_laws.MODULUS)
    ln_k = np.log(fluid.viscosity) - c / (d + 313.15)
    np.testing.assert_allclose([ln_k, c, d, *others], fit.x * scales, rtol=1e-4)
    error = misfit(np.array([ln_k, c, d, *others]) / scales)
    assert error.std() == pytest.approx(0.0204, abs=1e-4)
    assert np.abs(error).max() == pytest.approx(0.0592, abs=3e-4)
    density = laws.density(p, fluid)[0] - rho
    assert np.abs(density).max() == pytest.approx(0.0210, abs=2e-4)


SQUALANE = {"doolittle_b": 4.710, "doolittle_occupied": 0.6568, "doolittle_occupied_rise": -4.1e-4}
SQUALANE |= {"tait_slope": 11.74, "tait_modulus": 8.658e9, "tait_decay": 6.332e-3, "tait_expansion": 8.36e-4}
SQUALANE["doolittle_temperature"] = 313.15  # near those of squalane, 15.6 mPa s at 40 C


def squalane(temperature):
    fluid = SimpleNamespace(law="doolittle", temperature=temperature, pressure_viscosity=None, **SQUALANE)
    fluid.pressure_viscosity = laws.LAWS["doolittle"].complete(fluid)["pressure_viscosity"]
    return fluid


def test_squalane():
    fluid = squalane(313.15)
    ln_eta = laws.viscosity(np.array([0.0, 0.5e9, 1e9]), fluid)[0]
    assert ln_eta[0] == pytest.approx(0.0, abs=1e-14)
    assert 16e-9 < fluid.pressure_viscosity < 24e-9
    hot = laws.viscosity(0.0, fluid, T=373.15)[0]
    assert 0.0156 * np.exp(hot) == pytest.approx(3.0e-3, rel=0.05)  # Pa s at 100 C


FREE_VOLUME = {
    "modulus": (viscosity_laws.modulus, FVA3),
    "yasutomi": (viscosity_laws.yasutomi, (*YASUTOMI, 0.9)),
    "doolittle": (viscosity_laws.doolittle, laws.viscosity_law(squalane(313.15)).constants[:9]),
}


@pytest.mark.parametrize("law, constants", FREE_VOLUME.values(), ids=FREE_VOLUME)
@pytest.mark.parametrize("p, T", [(0.0, 313.1), (0.8e9, 340.0), (1.2e9, 330.0), (1.5e9, 390.0), (3e9, 313.0)])
def test_derivatives_of_free_volume_laws_also_beyond_the_glass_transition(law, constants, p, T):
    value, by_p, by_t = law(p, T, *constants)
    assert law(p + 1j * STEP, T, *constants)[0].imag / STEP == pytest.approx(by_p, rel=1e-10)
    assert law(p, T + 1j * STEP, *constants)[0].imag / STEP == pytest.approx(by_t, rel=1e-10)
    assert inlined(law)(p, T, *constants) == pytest.approx((value, by_p, by_t))
    assert by_p > 0.0 > by_t


def test_conductivity_about_doubles_in_a_gigapascal():
    heat = {key.removeprefix("oil_"): value for key, value in oils.OILS["fva3"].heat.items()}
    constants = [heat[f"conductivity{part}"] for part in ("", "_pressure", "_saturation")]
    value, by_p = laws.conductivity(1e9, *constants)
    assert 2.0 < value / constants[0] < 2.2
    assert laws.conductivity(1e9 + 1j * STEP, *constants)[0].imag / STEP == pytest.approx(by_p, rel=1e-12)


GRADE = {"fluid.grade": {"v40": 220e-6, "v100": 19e-6, "density": 880.0}}
LEFT_OUT = {"fluid.viscosity": None, "fluid.pressure_viscosity": None}


def test_films_by_formulas_have_the_coefficient_of_the_law():
    coefficients = []
    for given in ({}, {"pressure_viscosity": 1e-8}):
        coefficients.append(load(CASE, {"fluid": {"oil": "fva3"} | given}).fluid.pressure_viscosity)
    assert coefficients[0] == pytest.approx(22.36e-9, rel=1e-3) == coefficients[1]


@pytest.mark.parametrize("missing", ["gamma", "lambda"])
def test_one_constant_of_the_density_law_alone_is_refused(missing):
    given = {"fluid.oil": "fva3", "fluid.gamma": 2e-9, "fluid.lambda": 1e-9} | {f"fluid.{missing}": None}
    oil = {"fluid": {"oil": "fva3"}}
    assert f"fluid.{missing} is missing" in one_fault(load, CASE, oil | given)


BARUS = {"fluid.law": "barus", "fluid.reference_viscosity": None, "fluid.roelands_pressure": None}
ROELANDS = {"fluid.law": "roelands", "fluid.reference_viscosity": None}


ALPHA = {"fva3": 22.36e-9, "m100": 20.85e-9, "n100": 27.26e-9, "pao100": 15.43e-9, "shc320": 12.41e-9}  # 40 C


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
    assert fluid.pressure_viscosity == pytest.approx(ALPHA[name], rel=2e-3)


@pytest.mark.parametrize("celsius, nu", [(40.0, 220e-6), (100.0, 19e-6)])
def test_viscosity_of_a_grade(celsius, nu):
    case = load(CASE, GRADE | LEFT_OUT | ROELANDS | {"fluid.temperature": celsius + 273.15})
    assert case.fluid.viscosity == pytest.approx(880.0 * nu, rel=1e-10)
    secant = 9.904e-9 * (1e6 * nu) ** 0.139  # over 2000 bar: the initial slope is steeper
    assert laws.viscosity(2e8, case.fluid)[0] == pytest.approx(2e8 * secant, rel=1e-10)
    assert 1.05 * secant < case.fluid.pressure_viscosity < 1.25 * secant
    given = load(CASE, GRADE | LEFT_OUT | ROELANDS | {"fluid.temperature": 350.0, "fluid.roelands_z": 0.55})
    nu = given.fluid.viscosity / 880e-6
    assert laws.viscosity(2e8, given.fluid)[0] == pytest.approx(2e8 * 9.904e-9 * nu**0.139, rel=1e-10)
    assert 50.0 < viscosity_laws.walther(343.15, *WALTHER_CONSTANTS)[0] < 60.0  # charts: about 54 mm^2/s
    barus = load(CASE, GRADE | LEFT_OUT | BARUS | {"fluid.temperature": celsius + 273.15})
    assert barus.fluid.pressure_viscosity == pytest.approx(secant, rel=1e-10)


@pytest.mark.parametrize(
    "temperature, message",
    [
        (None, r'fluid.grade = "ISO VG 220": needs the temperature of the oil, fluid.temperature$'),
        (
            205.0,
            r'fluid.grade = "ISO VG 220": the viscosity at 205.0 K, .*, is not allowed; allowed: .* 10000',
        ),
    ],
)
def test_a_grade_without_a_viscosity_is_a_fault_of_the_grade(temperature, message):
    changes = {"fluid.grade": "ISO VG 220", "fluid.temperature": temperature} | LEFT_OUT
    fault = one_fault(load, CASE, changes)
    assert re.search(message, fault), fault
    load(CASE, changes | {"fluid.viscosity": 0.02, "fluid.pressure_viscosity": 2e-8})


def test_named_grade_has_the_viscosities_of_its_class_and_keys_override_it():
    named = {"fluid.grade": "ISO VG 220"} | LEFT_OUT | ROELANDS
    for celsius, nu in ((40.0, 220e-6), (100.0, 19.4e-6)):
        fluid = load(CASE, named | {"fluid.temperature": f"{celsius} degC"}).fluid
        assert fluid.viscosity == pytest.approx(nu * 899.0 * (1 - 7e-4 * (celsius - 15.0)), rel=1e-9)
    with pytest.raises(CaseError, match=r'fluid\.grade = "VG 220": .*ISO VG 220'):
        load(CASE, named | {"fluid.grade": "VG 220", "fluid.temperature": 350.0})
    case = load(CASE, GRADE | {"fluid.temperature": 333.15})
    assert case.fluid.viscosity == 0.005 and case.fluid.pressure_viscosity == 11.1e-9
    case = load(CASE, GRADE | LEFT_OUT | ROELANDS | {"heat.bulk_temperature": 373.15})
    assert case.fluid.viscosity == pytest.approx(880.0 * 19e-6, rel=1e-10)
    assert case.heat.oil_density == 880.0
    kind, _, _, reference = laws.temperature_constants(case.fluid, case.heat)
    assert kind == viscosity_laws.WALTHER and reference == 373.15


def test_faults():
    with pytest.raises(CaseError, match=r"fluid\.grade = .*needs the temperature"):
        load(CASE, GRADE | LEFT_OUT)  # no temperature
    message = r"fluid\.temperature = 350.*: needs fluid\.grade or oil.*reference_t"
    with pytest.raises(CaseError, match=message):
        load(CASE, {"fluid.temperature": 350.0})  # would move the temperature of a viscosity that is given
    with pytest.raises(CaseError, match="v100"):
        load(CASE, {"fluid.grade": {"v40": 19e-6, "v100": 220e-6, "density": 880.0}})
    fault = one_fault(load, CASE, GRADE | LEFT_OUT | {"fluid.temperature": 80})
    assert "fluid.temperature = 80: " in fault and fault.endswith('; "80 degC"?')


DOOLITTLE = {"law": "doolittle", "viscosity": 0.0156, **SQUALANE}
YASUTOMI_NEWTON = {"law": "yasutomi", "viscosity": 0.007946, "density": "dowson-higginson"} | OF_YASUTOMI
FVA3_NEWTON = {"law": "modulus", "viscosity": 0.0104, "density": "dowson-higginson"}
FVA3_NEWTON |= {key: oils.OILS["fva3"].fluid[key] for key in viscosity_laws.MODULUS}
CONDITIONS = {"motion.entrainment_speed": 1.0, "contact.load": 100e3}
MESH = {"mesh.points_per_half_width": 64, "mesh.inlet": -3.0, "mesh.outlet": 1.4}
NONE = dict.fromkeys(f"fluid.{key}" for key in ("eyring_stress", "roelands_pressure", "reference_viscosity"))
OTHER = {"fluid.density": "dowson-higginson", "fluid.gamma": None, "fluid.lambda": None}


def solved(fluid, **others):
    keys = {f"fluid.{key}": value for key, value in fluid.items()}
    simulation = Simulation(load(CASE, CONDITIONS | MESH | NONE | OTHER | keys | others))
    (state,) = simulation
    return state.film_thickness[np.argmin(np.abs(simulation.scales.x))], simulation


@pytest.mark.parametrize(
    "fluid, accuracy",
    [(DOOLITTLE, 0.04), (YASUTOMI_NEWTON, 0.015), (FVA3_NEWTON, 0.02)],
    ids=["doolittle", "yasutomi", "modulus"],
)
def test_film_beside_that_of_the_asymptotic_isoviscous_pressure(fluid, accuracy):
    """Barus' oil with alpha* = 1/integral(eta0/eta dp), by which films are compared (Blok 1963)."""
    film, simulation = solved({"pressure_viscosity": None} | fluid)
    p = np.linspace(0.0, 1.5e9, 30001)
    alpha = 1.0 / (np.exp(-laws.viscosity(p, simulation.case.fluid)[0]).sum() * p[1])
    of_barus, _ = solved({"law": "barus", "viscosity": fluid["viscosity"], "pressure_viscosity": alpha})
    assert of_barus == pytest.approx(film, rel=accuracy)


def test_film_of_doolittles_law_with_heat():
    cold, _ = solved(DOOLITTLE | {"temperature": 313.15, "pressure_viscosity": None})
    heat = {"heat.bulk_temperature": 333.15, "heat.reference_temperature": 313.15}
    hot, _ = solved(DOOLITTLE | {"pressure_viscosity": None}, **heat)
    assert 0.55 * cold < hot < 0.75 * cold


@pytest.mark.parametrize("heat", [{}, {"heat.bulk_temperature": 313.15}], ids=["isothermal", "with heat"])
def test_film_of_carreaus_law(heat):
    newton, films = {"pressure_viscosity": None} | YASUTOMI_NEWTON, []
    for stress in (None, 1e12, 1e5):
        exponent = None if stress is None else 0.6
        film, _ = solved(newton | {"carreau_stress": stress, "carreau_exponent": exponent}, **heat)
        films.append(film)
    assert films[1] == pytest.approx(films[0], rel=1e-4)
    assert 0.75 < films[2] / films[0] < 0.9


FACTORS = {name: {} for name in ("barus", "roelands")}
FACTORS |= {"yasutomi": OF_YASUTOMI, "doolittle": SQUALANE}
FACTORS |= {"modulus": {name: oils.OILS["fva3"].fluid[name] for name in viscosity_laws.MODULUS}}


def test_first_constant_of_a_law_is_a_factor():
    """Of the logarithm of the viscosity, by which a steady start is continued, or of the shear stress."""
    assert set(FACTORS) == set(laws.LAWS)
    for name, keys in FACTORS.items():
        first, *others = laws.LAWS[name].constants(oil(law=name, **keys), None)
        one, two = (laws.LAWS[name].function(0.7e9, 320.0, factor * first, *others) for factor in (1.0, 2.0))
        assert two == pytest.approx([2.0 * value for value in one], rel=1e-14), name
    for name, law in rheology.SHEAR_LAWS.items():
        others = (0.45, 2.0)[: n_constants(law.function, 1) - 1]
        one, two = (law.function(1.3, stress, *others) for stress in (1e6, 2e6))
        assert two == pytest.approx([2.0 * value for value in one], rel=1e-14), name
