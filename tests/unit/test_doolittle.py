"""Doolittle's law on Tait's volume: an oil like squalane, derivatives, a film without and with heat."""

from types import SimpleNamespace

import numpy as np
import pytest
from support.driving import Scene

from ehlpetsc.physics import laws

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


KEYS = [f"fluid.{key}={value}" for key, value in SQUALANE.items()]
NEWTONIAN = ["fluid.viscosity=0.0156", "motion.entrainment_speed=1.0", "contact.load=100e3"]
MESH = ["mesh.points_per_half_width=32", "mesh.inlet=-2.5", "mesh.outlet=1.4"]


def film(*keys):
    scene = Scene("table1_smooth.toml", *NEWTONIAN, *MESH, *keys).start()
    return scene.film[scene.centre]


def test_film_of_the_law_without_and_with_heat():
    """The film is that of Barus' law with the same coefficient, within what the laws differ in the inlet."""
    keys = [*KEYS, "fluid.law=doolittle"]
    of_law = film(*keys, "fluid.temperature=313.15")
    of_barus = film("fluid.law=barus", f"fluid.pressure_viscosity={squalane(313.15).pressure_viscosity}")
    assert of_law == pytest.approx(of_barus, rel=0.1)
    hot = film(*keys, "heat.bulk_temperature=333.15", "heat.reference_temperature=313.15")
    assert 0.55 * of_law < hot < 0.75 * of_law
