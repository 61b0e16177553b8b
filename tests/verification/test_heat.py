"""Film and surface temperatures: values of an independent solver, energy balance, limits, dry friction."""

import numpy as np
import pytest
from support import CASES
from support.exact_solutions import moving_band

from ehlpetsc.base.errors import NotConverged
from ehlpetsc.case.loading import CaseError, load
from ehlpetsc.physics.flash_temperature import Solid, blok_flash_temperature
from ehlpetsc.run.simulation import Simulation

BULK = 363.0
HEAT = f"heat.bulk_temperature={BULK}"
EXPONENTIAL = ["heat.viscosity_temperature=0.04", "heat.oil_conductivity_pressure=0"]
THICK = ["fluid.viscosity=0.02", "motion.entrainment_speed=10.0", "motion.slide_roll_ratio=0.5"]
WIDE = ["mesh.inlet=-3.0", "mesh.outlet=1.5"]
COARSE = ["mesh.points_per_half_width=50", "mesh.inlet=-2.0", "mesh.outlet=1.5"]


def solved(name, *keys):
    simulation = Simulation(load(CASES / name, list(keys)))
    return simulation, list(simulation)


def friction_of_both(simulation, state):
    """Mean of both walls' friction over the load."""
    shear = 0.5 * (state.shear_stress_2 - state.shear_stress_1)
    return shear.sum() * simulation.scales.spacing / state.load


# smooth and steady, by an independent dense solver: central and least film [um], and of the first one, whose
# film hardly heats, friction coefficient, maximum temperatures of film, surfaces 1 and 2 above bulk [K]
@pytest.mark.parametrize(
    "keys, values",
    [
        (["mesh.points_per_half_width=100"], (0.1591, 0.1367, 0.01003, 6.83, 5.37, 5.68)),
        ([*THICK, "mesh.points_per_half_width=200"], (0.5709, 0.4630)),
    ],
    ids=["5 m/s", "10 m/s"],
)
def test_values_of_an_independent_solver(keys, values):
    simulation, [state] = solved("table1_smooth.toml", HEAT, *EXPONENTIAL, *WIDE, *keys)
    figures = state.scalars
    middle = np.argmin(np.abs(simulation.scales.x))
    rises = [figures[f"{name}_max"] - BULK for name in ("film_temperature", "temperature_1", "temperature_2")]
    films = 1e6 * state.film_thickness[middle], 1e6 * state.h_min
    found = *films, friction_of_both(simulation, state), *rises
    assert found[: len(values)] == pytest.approx(values, rel=0.006)
    assert figures["heat_error"] < 1e-9


THICK_OIL = (
    'fluid={viscosity=0.03,law="roelands",pressure_viscosity=20e-9,density="dowson-higginson",eyring_stress=5e6}',
    "heat.bulk_temperature=333.0",
    "motion.entrainment_speed=10.0",
    "mesh.inlet=-4.0",
)


@pytest.mark.parametrize(
    "keys, ratio, friction",
    [
        ((HEAT, "motion.entrainment_speed=25.0"), 0.5, 0.0083),
        ((HEAT, "motion.entrainment_speed=25.0"), 1.0, 0.0064),
        (THICK_OIL, 0.1, 0.0325),
        (THICK_OIL, 0.2, 0.0290),
        (THICK_OIL, 0.5, 0.0201),
        ((HEAT, "fluid.viscosity=0.01", "motion.entrainment_speed=15.0"), 1.2, 0.00696),
        ((HEAT, "motion.entrainment_speed=10.0"), 1.5, 0.00905),
        ((HEAT, "motion.entrainment_speed=10.0"), 1.9, 0.00672),
    ],
)
def test_friction_of_an_independent_computation_across_the_film(keys, ratio, friction):
    """Boundary value problem across the film, walls by Jaeger; a lumped film has 10 to 30 % more.

    The last three on pressure and film of this program; by the fluxes of a parabola there would be 2 and 8 %
    more at slide/roll 1.5 and 1.9.
    """
    keys = [*keys, *EXPONENTIAL, f"motion.slide_roll_ratio={ratio}", "mesh.points_per_half_width=100"]
    simulation, [state] = solved("table1_smooth.toml", *keys)
    assert friction_of_both(simulation, state) == pytest.approx(friction, rel=0.02)
    assert state.scalars["heat_error"] < 1e-10


def test_a_steady_solution_stays_as_it_is_in_time():
    simulation, states = solved("table1_smooth.toml", HEAT, *THICK, *COARSE, "time.travel=0.4")
    begin, end = states[0], states[-1]
    assert end.h_min == pytest.approx(begin.h_min, rel=1e-4)
    np.testing.assert_allclose(end.film_temperature, begin.film_temperature, atol=0.1)
    np.testing.assert_allclose(end.temperature_1, begin.temperature_1, atol=0.05)
    np.testing.assert_allclose(end.temperature_2, begin.temperature_2, atol=0.05)
    assert max(state.scalars["heat_error"] for state in states) < 1e-9
    before, after = (state.dimensionless.records["heat"] for state in states[-2:])
    upstream = np.append(BULK, before.film[:-1])  # a node a step
    np.testing.assert_allclose(after.rate * simulation.scales.dt, after.film - upstream, atol=1e-9)


@pytest.mark.parametrize("ratio", [0.0, 0.25, 1.0, 1.9, 2.0, -0.5])
def test_slide_roll_ratios(ratio):
    _, [state] = solved("table1_smooth.toml", HEAT, *COARSE, f"motion.slide_roll_ratio={ratio}")
    rises = state.temperature_1.max() - BULK, state.temperature_2.max() - BULK
    assert min(rises) >= 0.0 and state.film_temperature.min() >= BULK - 1e-9
    if ratio in (0.25, 1.0, 1.9, 2.0):
        assert rises[1] > rises[0]  # the slower surface is the hotter one
    if ratio == -0.5:
        _, [mirror] = solved("table1_smooth.toml", HEAT, *COARSE, "motion.slide_roll_ratio=0.5")
        np.testing.assert_allclose(state.temperature_1, mirror.temperature_2, rtol=1e-9)
        assert state.h_min == pytest.approx(mirror.h_min, rel=1e-9)


def test_flow_the_other_way_is_the_mirror_image():
    """Steady and in time; the oil then leaves at the first node, and its heat with it."""
    mesh = ["mesh.inlet=-1.6", "mesh.outlet=1.6", "mesh.points_per_half_width=40"]
    runs = []
    for way in (1.0, -1.0):
        speeds = [f"operation.speed_{side}=[{way * u}, {way * u}]" for side, u in ((1, 12.0), (2, 8.0))]
        table = ["operation.time=[0, 1e-6]", *speeds]
        runs.append(solved("table1_smooth.toml", HEAT, THICK[0], *mesh, *table)[1])
    assert len(runs[0]) == len(runs[1]) > 1
    for there, back in zip(*runs, strict=True):
        for name in ("film_temperature", "temperature_1", "temperature_2"):
            one, other = getattr(there, name), getattr(back, name)[::-1]
            np.testing.assert_allclose(other, one, atol=1e-6 * (one.max() - BULK))
        assert back.film_temperature[0] > BULK + 1.0
        assert max(there.scalars["heat_error"], back.scalars["heat_error"]) < 1e-9


@pytest.mark.parametrize(
    "keys, pressure, low, high",
    [
        (["motion.entrainment_speed=0.001", "fluid.viscosity=5"], 0.9e9, 0.0, 0.1),
        (["motion.entrainment_speed=100", "fluid.viscosity=0.001"], 0.9e9, 20.0, 300.0),
        (["contact.load=4743e3", "fluid.law=barus"], 2.9e9, 20.0, 500.0),
    ],
)
def test_speeds_and_a_heavy_load(keys, pressure, low, high):
    _, [state] = solved("table1_smooth.toml", HEAT, *COARSE, *keys)
    assert state.p_max > pressure and low < state.film_temperature.max() - BULK < high


def test_dry_friction():
    """Frictional heat of a dry Hertz contact: its division between the surfaces, and Blok's temperature."""
    keys = ["contact.boundary_friction=0.1", "motion.entrainment_speed=10.0", "motion.slide_roll_ratio=0.4"]
    simulation, [state] = solved("dry_hertz.toml", HEAT, *keys)
    s, steel = simulation.scales, Solid(46.0, 7850.0, 470.0)
    assert state.scalars["heat"] == pytest.approx(0.1 * state.load * (s.u1 - s.u2), rel=1e-9)
    carries = state.pressure > 1e-3 * s.p0
    np.testing.assert_allclose(state.temperature_1[carries], state.temperature_2[carries], rtol=1e-9)
    rise = moving_band(s.x * s.a, state.heat_flux_2, steel.diffusivity, steel.conductivity, s.u2)
    np.testing.assert_allclose(state.temperature_2 - BULK, rise, atol=0.01 * rise.max())
    flash = blok_flash_temperature(0.1, state.load, s.u1 - s.u2, s.u1, s.u2, s.a, (steel.effusivity,) * 2)
    assert state.temperature_1.max() - BULK == pytest.approx(flash, rel=0.03)


def test_isothermal_without_dependence_on_temperature():
    """With beta = 0 the film is the isothermal one to the last iteration's digits."""
    keys = [*COARSE, "motion.slide_roll_ratio=0.5", "petsc.snes_atol=1e-9"]
    _, [heated] = solved("table1_smooth.toml", HEAT, "heat.viscosity_temperature=0.0", *keys)
    _, [cold] = solved("table1_smooth.toml", *keys)
    assert heated.h_min == pytest.approx(cold.h_min, rel=1e-9)
    assert heated.friction == pytest.approx(cold.friction, rel=1e-9)


def test_faults():
    with pytest.raises(CaseError, match="bulk_temperature"):
        load(CASES / "table1_smooth.toml", ["heat.conductivity=46.0"])
    with pytest.raises(CaseError, match="roelands_s0"):
        load(CASES / "table1_smooth.toml", [HEAT, "heat.roelands_s0=1.1", "heat.viscosity_temperature=0.03"])
    with pytest.raises(CaseError, match="motion"):
        load(CASES / "dry_hertz.toml", [HEAT])


def test_start_under_counter_motion_without_a_limiting_stress_names_the_cure():
    """The sliding of a Newtonian oil heats the film by thousands of kelvins."""
    case = {
        "title": "counter-motion",
        "contact": {"radius": 0.038, "load": 1.5e6, "youngs_modulus": 350e9, "poisson_ratio": 0.3},
        "fluid": {"grade": "ISO VG 460", "law": "barus", "density": "incompressible", "temperature": 320.6},
        "motion": {"entrainment_speed": 0.215, "slide_roll_ratio": 40.0},
        "mesh": {"inlet": -2.0, "outlet": 2.0, "points_per_half_width": 16},
        "heat": {"bulk_temperature": 291.7, "inlet_temperature": 393.1, "viscosity_temperature": 0.0162},
    }
    mixed = {"contact.model": "mixed"}
    with pytest.raises(NotConverged, match="Try a finer mesh or fluid.limiting_shear, as sliding heats"):
        Simulation(
            load(case, mixed | {"motion.slide_roll_ratio": 100.0, "motion.entrainment_speed": 2.0})
        ).advance()
    state = Simulation(load(case, mixed | {"fluid.limiting_shear": 0.08})).advance()
    assert state.heat_error < 1e-9 and state.film_temperature_max > 500.0
