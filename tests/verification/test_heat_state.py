"""Runs with heat: oil balance of the stored state, heat of rubbing solids, next to no heat."""

from dataclasses import replace
from itertools import islice
from types import SimpleNamespace

import numpy as np
import pytest
from support import CASES

from ehlpetsc.case.loading import load
from ehlpetsc.discretisation import finite_volumes as volumes
from ehlpetsc.discretisation.contact import face_gap
from ehlpetsc.discretisation.reynolds import Reynolds
from ehlpetsc.discretisation.step_inputs import IsothermalOil
from ehlpetsc.discretisation.unknowns import Share
from ehlpetsc.effects.heat.step import HeatStep, Temperatures
from ehlpetsc.effects.heat.transport import Film
from ehlpetsc.physics.oil.laws import viscosity
from ehlpetsc.run.simulation import Simulation

MESH = {"mesh.inlet": -1.4, "mesh.outlet": 1.3, "mesh.points_per_half_width": 50}


class StoredTemperature(IsothermalOil):
    """Viscosity of the nodes at a stored temperature."""

    rows = volumes.THINNED_PROPERTIES

    def __init__(self, case, temperature, scales):
        super().__init__(case.fluid, scales)
        vars(self).update(case=case, temperature=temperature)

    def fill(self, q, h, nodes, at):
        fluid, heat, n = self.case.fluid, self.case.heat, len(q)
        for i in range(at.shape[1]):
            volumes.fill_mass(i, q[i] if i < n else 0.0, h[min(i, n - 1)], self.density, *self.units, at)
        p = self.scales.p0 * at[volumes.P]
        temperature = np.append(self.temperature, self.temperature[-1])[: len(p)]
        cold, hot = viscosity(p, fluid, heat)[0], viscosity(p, fluid, heat, temperature)[0]
        at[volumes.FLUIDITY], at[volumes.LN_ETA_P] = np.exp(-cold) / fluid.viscosity, 0.0
        at[volumes.THINNING], at[volumes.LN_THINNING_P :] = np.exp(0.5 * (cold - hot)), 0.0


@pytest.mark.parametrize(
    "name, keys",
    [
        ("table1_heat.toml", MESH | {"time.travel": 0.4}),
        ("table1_heat.toml", MESH | {"time.travel": 0.4, "heat.viscosity_temperature": 0.04}),
        ("fzg.toml", {"mesh.points_per_half_width": 25}),
    ],
    ids=["roelands", "exponential", "gears"],
)
def test_oil_balance_of_the_stored_state(name, keys):
    """Mass defect by stored pressure, film, void fraction and temperature, over the oil that is carried."""
    case = load(CASES / name, keys)
    simulation = Simulation(case)
    for accepted in islice(simulation, 200):
        state = simulation.dimensionless
        temperature = StoredTemperature(case, accepted.film_temperature, simulation.scales)
        inputs = replace(state.solution.inputs, oil=temperature)
        n = simulation.scales.nx
        share = Share(0, n, slice(0, n), slice(0, n))
        reynolds = Reynolds(simulation.scales, 1.0, share, gap=face_gap(case.contact))
        nodes = state.solution.nodes
        defect, _ = reynolds.evaluate(nodes.reynolds_unknown, nodes.film, inputs)
        carried = state.m[np.abs(simulation.scales.x) <= 1.0].mean()
        assert np.abs(defect[1:]).sum() < 1e-5 * carried, accepted.time


def test_rubbing_solids_heat_the_walls():
    """At 20 m/s the film was tens of kelvin above the walls by the heat of solids that touch."""
    keys = {"motion.entrainment_speed": 20.0, "fluid.viscosity": 0.0004, "time.travel": 3.2}
    simulation = Simulation(load(CASES / "table1_heat.toml", MESH | keys | {"mesh.inlet": -1.6}))
    above, walls = [], []
    for accepted in simulation:
        record, touching = simulation.dimensionless.records["heat"], accepted.contact_pressure > 0.5e9
        wall = 0.5 * (record.wall_1 + record.wall_2)[touching]
        above.append(record.film[touching] - wall)
        walls.append(wall)
        assert accepted.scalars["heat_error"] < 1e-10
    above, walls = np.concatenate(above), np.concatenate(walls)
    assert len(above) > 100 and above.max() < 10.0
    assert walls.max() > 363.0 + 50.0


def test_next_to_no_heat_does_not_divide_its_imbalance():
    """At a start from rest the heat is that of rounding."""
    zero, inlet = np.zeros(5), np.full(5, 363.0)
    scales = SimpleNamespace(spacing=1e-6, u_max=0.0, h=0.0, grid=SimpleNamespace(node_size=1e-6))
    steps = SimpleNamespace(scales=scales, rows=1, capacity=0.0, inlet=363.0)
    flux = np.full(5, 1e-6)
    film = Film(zero, zero, zero, inlet, *[zero] * 3, np.full(6, 1e4), zero)
    state = np.array([inlet, zero, inlet])
    found = Temperatures(state, [inlet] * 2, [flux] * 2, np.full(5, 1e-20), zero, zero, [], [])
    assert HeatStep.balance(steps, found, film, zero)[1] < 1e-5


@pytest.mark.parametrize("end", [0.0, 1e-16])
def test_friction_vanishes_with_the_sliding_of_a_heated_film(end):
    """Speeds of a stroke that ends at rest are rounding in its last step."""
    speed_1 = [2.384353324024164, 1.192176662012082, end]
    speed_2 = [0.4356466759758361, 0.21782333798791806, 0.0]
    operation = {"time": [0.0, 5.28147e-05, 7.15735e-05], "speed_1": speed_1, "speed_2": speed_2}
    contact = {"radius": 0.01, "load": 2e5, "youngs_modulus": 206e9, "poisson_ratio": 0.3, "model": "mixed"}
    fluid = {"viscosity": 0.01, "law": "barus", "pressure_viscosity": 9e-9, "density": "dowson-higginson"}
    case = {
        "title": "to rest",
        "contact": contact,
        "fluid": fluid | {"eyring_stress": 3e6},
        "mesh": {"inlet": -1.5, "outlet": 1.3, "points_per_half_width": 12},
        "time": {"courant": 1.0},
        "operation": operation,
        "heat": {"bulk_temperature": 340.0},
    }
    friction = [accepted.scalars["friction_coefficient"] for accepted in Simulation(load(case))]
    assert friction[0] > 0.01 and friction[-1] < 1e-6


def test_oil_and_pressure_flow_of_an_accepted_state(monkeypatch):
    """Oil in the cavity, stresses of Eyring's law spread by the pressure gradient, mean over the contact."""
    found, solve = [], HeatStep.solve
    monkeypatch.setattr(HeatStep, "solve", lambda *given: found.append(solve(*given)) or found[-1])
    case = load(
        CASES / "table1_heat.toml", {"mesh.points_per_half_width": 40, "mesh.inlet": -1.6, "time": None}
    )
    simulation = Simulation(case)
    accepted, scales = simulation.advance(), simulation.scales
    _, film, _, spread, _ = found[-1]
    assert accepted.void_fraction.max() > 0.1
    np.testing.assert_allclose(film.left, 1.0 - accepted.void_fraction, atol=1e-12)
    gradient = np.gradient(film.pressure, scales.spacing)[1:-1]
    sigma = 0.5 * accepted.film_thickness[1:-1] * np.abs(gradient) / case.fluid.eyring_stress
    expected = np.log(np.sinh(sigma + 1e-9) / (sigma + 1e-9))
    assert expected.max() > 0.1
    np.testing.assert_allclose(spread[1:-1], expected, rtol=1e-6, atol=1e-9)
    mean = accepted.film_temperature[np.abs(scales.x) <= 1.0].mean()
    assert accepted.scalars["film_temperature_mean"] == pytest.approx(mean, rel=1e-12)
