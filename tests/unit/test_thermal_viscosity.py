"""Thermal viscosity, grades and limiting shear stress: check values, derivatives by complex step."""

import pytest

from ehlpetsc.physics.heat import thermal_viscosity as thermal

PRESSURE = (4.0, 0.196e9, 0.5)
V40, V100 = 220e-6, 19e-6
LAWS = {
    "isothermal": (thermal.ISOTHERMAL, 0.0, 0.0, 363.0),
    "exponential": (thermal.EXPONENTIAL, 0.04, 0.0, 363.0),
    "roelands": (thermal.ROELANDS, 1.1, 0.0, 363.0),
    "walther": (thermal.WALTHER, *thermal.walther_constants(V40, V100), 363.0),
}
STEP = 1e-30


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
@pytest.mark.parametrize("pressure", [PRESSURE, (11.1, 1e9, 1.0)], ids=["power", "barus"])
@pytest.mark.parametrize("p", [0.0, 1.3e9])
def test_derivatives_of_the_viscosity(law, pressure, p):
    function = thermal.log_viscosity
    function = getattr(function, "py_func", function)
    _, by_p, by_t = function(p, 371.0, pressure, law)
    step = 1e-20  # Pa
    assert function(p + step * 1j, 371.0, pressure, law)[0].imag / step == pytest.approx(by_p, rel=1e-12)
    by_step = function(p, 371.0 + STEP * 1j, pressure, law)[0].imag / STEP if law[0] else 0.0
    assert by_step == pytest.approx(by_t, rel=1e-12, abs=1e-30)
    assert function(0.0, 363.0, pressure, law)[0] == pytest.approx(0.0, abs=1e-14)


def test_walther_law_at_data_sheet_and_iso_vg_220():
    a, b = thermal.walther_constants(V40, V100)
    assert thermal.walther(313.15, a, b)[0] == pytest.approx(220.0, rel=1e-12)
    assert thermal.walther(373.15, a, b)[0] == pytest.approx(19.0, rel=1e-12)
    assert 50.0 < thermal.walther(343.15, a, b)[0] < 60.0  # VI 97: charts show about 54 mm^2/s


def test_gold_of_a_mineral_oil():
    assert thermal.gold_pressure_viscosity(1.0) == pytest.approx(9.904e-9)
    assert thermal.gold_pressure_viscosity(20.0) == pytest.approx(15.02e-9, rel=1e-3)


@pytest.mark.parametrize("stress, limit", [(1e6, 5e7), (5e7, 5e7), (9e8, 5e7), (1e6, 2e6)])
def test_limited_shear(stress, limit):
    value, by_stress, by_limit = thermal.limited_shear(stress, limit)
    assert value <= min(stress, limit)
    if max(stress, limit) >= 2.0 * min(stress, limit):
        assert value == pytest.approx(min(stress, limit), rel=0.016)
    for arguments, slope in (
        ((stress + STEP * 1j, limit), by_stress),
        ((stress, limit + STEP * 1j), by_limit),
    ):
        assert thermal.limited_shear(*arguments)[0].imag / STEP == pytest.approx(slope, rel=1e-12)
