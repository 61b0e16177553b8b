"""Laws of Doolittle, Yasutomi and Carreau: derivatives; films beside Newtonian ones."""

from types import SimpleNamespace

import numpy as np
import pytest
from support import CASES

from ehlpetsc.case.loading import load
from ehlpetsc.physics import laws
from ehlpetsc.physics.oils import OILS
from ehlpetsc.run.simulation import Simulation

SQUALANE = {
    "doolittle_b": 4.710,
    "doolittle_occupied": 0.6568,
    "doolittle_occupied_rise": -4.1e-4,
    "tait_slope": 11.74,
    "tait_modulus": 8.658e9,
    "tait_decay": 6.332e-3,
    "tait_expansion": 8.36e-4,
    "doolittle_temperature": 313.15,
}  # near those of squalane, 15.6 mPa s at 40 C


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


@pytest.mark.parametrize("p, T", [(0.0, 313.15), (0.8e9, 340.0), (1.5e9, 390.0)])
def test_derivatives(p, T):
    constants, step = laws.viscosity_law(squalane(313.15)).constants[:9], 1e-20
    value, by_p, by_t = laws.doolittle(p, T, *constants)
    assert laws.doolittle(p + 1j * step, T, *constants)[0].imag / step == pytest.approx(by_p, rel=1e-10)
    assert laws.doolittle(p, T + 1j * step, *constants)[0].imag / step == pytest.approx(by_t, rel=1e-10)


DOOLITTLE = {"law": "doolittle", "viscosity": 0.0156, **SQUALANE}
T9 = {
    key: value for key, value in OILS["t9"].fluid.items() if "carreau" not in key and key != "limiting_shear"
}
CONDITIONS = {"motion.entrainment_speed": 1.0, "contact.load": 100e3}
MESH = {"mesh.points_per_half_width": 64, "mesh.inlet": -3.0, "mesh.outlet": 1.4}
NONE = dict.fromkeys(f"fluid.{key}" for key in ("eyring_stress", "roelands_pressure", "reference_viscosity"))
OTHER = {"fluid.density": "dowson-higginson", "fluid.gamma": None, "fluid.lambda": None}


def solved(fluid, **others):
    keys = {f"fluid.{key}": value for key, value in fluid.items()}
    simulation = Simulation(
        load(CASES / "table1_smooth.toml", CONDITIONS | MESH | NONE | OTHER | keys | others)
    )
    (state,) = simulation
    return state.film_thickness[np.argmin(np.abs(simulation.scales.x))], simulation


@pytest.mark.parametrize("fluid, accuracy", [(DOOLITTLE, 0.04), (T9, 0.015)], ids=["doolittle", "yasutomi"])
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
    """Newtonian for a high stress of the law; thinner for a low one."""
    newton, films = {"pressure_viscosity": None} | T9, []
    for stress in (None, 1e12, 1e5):
        exponent = None if stress is None else 0.6
        film, _ = solved(newton | {"carreau_stress": stress, "carreau_exponent": exponent}, **heat)
        films.append(film)
    assert films[1] == pytest.approx(films[0], rel=1e-4)
    assert 0.75 < films[2] / films[0] < 0.9
