"""Oils under pressure and by their grade: check values, derivatives by complex step, thermal law."""

from pathlib import Path

import numpy as np
import pytest

from ehlpetsc.base.compiled import inlined
from ehlpetsc.case.loading import CaseError, load
from ehlpetsc.physics import oils
from ehlpetsc.physics.film_shear import CARREAU, FlowLaw, flow_stress
from ehlpetsc.physics.laws import WALTHER, temperature_constants

T9 = oils.OILS["t9"].yasutomi
STEP = 1e-20


def test_yasutomi_by_the_equation_in_degrees_celsius():
    """lg(eta/1e12) = -C1 (T - Tg) F/(C2 + (T - Tg) F), values [Pa s] of a second program."""
    p, celsius = np.array([1e5, 1e8, 3.5e8, 6e8]), np.array([20.0, 40.0, 80.0, 100.0])
    found = 1e12 * np.exp(oils.yasutomi(p, celsius[:, None] + 273.15, *T9, 0.0)[0])
    expected = [
        [0.01699, 0.1893, 69.55, 7.268e4],
        [0.007946, 0.05947, 6.638, 1171.0],
        [0.002879, 0.01305, 0.3672, 10.5],
        [0.002018, 0.007728, 0.1413, 2.409],
    ]
    np.testing.assert_allclose(found, expected, rtol=6e-4)


def test_reference_and_coefficients_of_t9():
    oil = oils.OILS["t9"]
    offset = oils.yasutomi_offset(oil.temperature, *T9[:3])
    value, by_p, by_t = oils.yasutomi(0.0, oil.temperature, *T9, offset)
    assert value == pytest.approx(0.0, abs=1e-12)
    assert (by_p, -by_t) == pytest.approx((oil.alpha, oil.beta), rel=5e-3)


@pytest.mark.parametrize("p, T", [(0.0, 313.15), (0.8e9, 340.0), (1.2e9, 330.0), (3e9, 313.0)])
def test_derivatives_of_yasutomi_also_beyond_the_glass_transition(p, T):
    value, by_p, by_t = oils.yasutomi(p, T, *T9, 0.9)
    assert oils.yasutomi(p + 1j * STEP, T, *T9, 0.9)[0].imag / STEP == pytest.approx(by_p, rel=1e-10)
    assert oils.yasutomi(p, T + 1j * STEP, *T9, 0.9)[0].imag / STEP == pytest.approx(by_t, rel=1e-10)
    assert inlined(oils.yasutomi)(p, T, *T9, 0.9) == pytest.approx((value, by_p, by_t))
    assert by_p > 0.0 > by_t


@pytest.mark.parametrize("kind", oils.CONDUCTIVITY)
def test_conductivity_about_doubles_in_a_gigapascal(kind):
    ambient, c1, c2 = oils.CONDUCTIVITY[kind]
    value, by_p = oils.conductivity(1e9, ambient, c1, c2)
    assert 2.0 < value / ambient < 2.2
    assert oils.conductivity(1e9 + 1j * STEP, ambient, c1, c2)[0].imag / STEP == pytest.approx(
        by_p, rel=1e-12
    )


def test_slope_of_roelands_law_from_two_viscosities():
    eta, T = (0.0872, 0.0100), (313.15, 373.15)  # mineral oil of ISO VG 100
    s0 = oils.roelands_s0_of_two(eta, T)
    assert 1.0 < s0 < 1.3
    cold, hot = (np.log(value) + 9.67 for value in eta)
    assert cold * ((T[1] - 138.0) / (T[0] - 138.0)) ** -s0 == pytest.approx(hot, rel=1e-12)
    slope = s0 * cold / (T[0] - 138.0)
    assert oils.roelands_s0(eta[0], slope, T[0]) == pytest.approx(s0, rel=1e-12)


def test_initial_slope_exceeds_golds_secant():
    z, alpha = oils.roelands_of_secant(15e-9, 0.0112)
    decades = np.log(0.0112) + 9.67
    assert decades * ((1.0 + 2e8 / 1.96e8) ** z - 1.0) == pytest.approx(15e-9 * 2e8, rel=1e-12)
    assert alpha == pytest.approx(z * decades / 1.96e8)
    assert alpha / 15e-9 == pytest.approx(1.145, abs=0.01)  # films grow with alpha^0.56: 8 %


# ---- Carreau ----

OIL = FlowLaw(CARREAU, 6e6, 0.45, 2.0)
FILM, ETA = 0.4e-6, 5.0


@pytest.mark.parametrize("flow", [OIL, FlowLaw(CARREAU, 7e6, 0.35, 5.0)])
def test_rate_inverts_the_stress(flow):
    for x in np.linspace(-15.0, 15.0, 31):
        stress, by_x, _ = flow_stress(x, flow, np.inf)
        rate, slope = oils.carreau_rate(-stress, flow)
        assert -rate == pytest.approx(flow.stress * np.exp(x), rel=1e-12)
        assert slope == pytest.approx(-rate / by_x, rel=1e-9)


@pytest.mark.parametrize("sliding", [0.0, 0.3, 5.0])
@pytest.mark.parametrize("drop", [0.1, 1.0, 4.0])
def test_flow_of_carreaus_law_across_a_film(sliding, drop):
    """Against 2,000 points across the film."""
    gradient = drop * OIL.stress / FILM
    mobility, *_, stress = oils.carreau_flow(FILM, gradient, sliding, ETA, OIL)
    z = FILM * ((np.arange(2000) + 0.5) / 2000 - 0.5)
    rate = np.array([oils.carreau_rate(stress + at * gradient, OIL)[0] for at in z]) / ETA
    assert rate.mean() * FILM == pytest.approx(sliding, rel=1e-4, abs=1e-12)
    assert (z * rate).mean() * FILM / gradient == pytest.approx(mobility, rel=1e-4)


def test_newtonian_limit_of_the_flow():
    mobility, by_h, by_gradient, by_ln_eta, stress = oils.carreau_flow(FILM, 1e9, 1e-6, ETA, OIL)
    expected = FILM**3 / (12.0 * ETA)
    assert (mobility, by_h, by_ln_eta) == pytest.approx(
        (expected, 3.0 * expected / FILM, -expected), rel=1e-5
    )
    assert stress == pytest.approx(ETA * 1e-6 / FILM, rel=1e-6)


@pytest.mark.parametrize("gradient", [1e10, -8e12, 6e13])
def test_derivatives_of_the_flow(gradient):
    state = {"h": FILM, "gradient": gradient, "ln_eta": np.log(ETA)}

    def mobility(key, step):
        moved = {**state, key: state[key] + step}
        return oils.carreau_flow(moved["h"], moved["gradient"], 2.0, np.exp(moved["ln_eta"]), OIL)[0]

    value, *derivatives, _ = oils.carreau_flow(FILM, gradient, 2.0, ETA, OIL)
    for key, derivative in zip(("h", "gradient", "ln_eta"), derivatives, strict=True):
        step = 1e-5 * abs(state[key])
        found = (mobility(key, step) - mobility(key, -step)) / (2.0 * step)
        assert found == pytest.approx(derivative, rel=1e-5, abs=1e-6 * value / abs(state[key]))


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
