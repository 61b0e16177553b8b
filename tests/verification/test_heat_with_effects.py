"""Heat in rough contacts, compliant layers, yielding solids and a gear pair; a body at rest."""

import numpy as np
import pytest
from support import CASES
from support.exact_solutions import moving_band

from ehlpetsc.case.loading import load
from ehlpetsc.physics.flash_temperature import Solid
from ehlpetsc.run.simulation import Simulation

BULK = 363.0
HEAT = f"heat.bulk_temperature={BULK}"
SHORT = ("mesh.inlet=-1.5", "mesh.outlet=1.3", "mesh.points_per_half_width=50", "time.travel=1.6")
FAST = ("motion.entrainment_speed=25.0", "motion.slide_roll_ratio=0.5", "fluid.viscosity=0.001")
MODELS = {
    "direct": ("table1_rough.toml", *SHORT, *FAST),
    "compliant": ("compliant_mixed.toml", *SHORT, *FAST),
    "yielding": ("table1_mixed.toml", *SHORT, *FAST, "contact.yield_pressure=1.5e9"),
}


def solved(name, *keys):
    simulation = Simulation(load(CASES / name, list(keys)))
    return simulation, list(simulation)


def assert_balanced(states):
    """Energy balance of every step, and no temperature below bulk."""
    assert max(state.scalars["heat_error"] for state in states) < 1e-6
    for name in ("film_temperature", "temperature_1", "temperature_2"):
        assert min(getattr(state, name).min() for state in states) > BULK - 1e-6


@pytest.mark.parametrize("model", MODELS)
def test_with_a_contact_model(model):
    """Dissipation is at least the work of friction, rubbing solids included; friction falls."""
    simulation, states = solved(*MODELS[model], HEAT)
    _, isothermal = solved(*MODELS[model])
    assert_balanced(states)
    assert sum(state.retries for state in states) == 0
    sliding = abs(simulation.scales.u1 - simulation.scales.u2)
    for state in states[1:]:
        traction = 0.5 * (state.shear_stress_2 - state.shear_stress_1).sum() * simulation.scales.spacing
        assert state.scalars["heat"] > abs(traction) * sliding * (1.0 - 1e-6)
    assert any(state.in_contact.any() for state in states)
    assert 5.0 < states[-1].film_temperature.max() - BULK < 400.0
    half = len(states) // 2
    friction = [np.mean([state.friction for state in run[half:]]) for run in (states, isothermal)]
    assert 0.2 * friction[1] < friction[0] < friction[1]
    if model == "yielding":
        assert states[-1].scalars["set_volume"] > 0.0


def test_in_a_gear_pair():
    """Sliding vanishes at the pitch point: so does the heat of shear, and temperatures fall towards it."""
    keys = ("mesh.points_per_half_width=25", "time.courant=2.0", "surface={}")
    simulation, states = solved("fzg.toml", *keys)
    assert_balanced(states)
    conditions = [simulation.operation.at(state.time) for state in states]
    share = np.array([abs(one.sliding / one.entrainment) for one in conditions])
    rise = np.array([state.scalars["film_temperature_mean"] - BULK for state in states])
    pitch = int(np.argmin(share))
    assert share[pitch] < 0.02
    assert rise[pitch] < 0.3 * rise.max()
    assert share[int(np.argmax(rise))] > 5.0 * share[pitch]


def test_no_surface_below_bulk_beside_one_at_rest():
    """One surface at rest and hot, oil that enters cold; the moving one has Jaeger's temperatures."""
    keys = (
        "mesh.points_per_half_width=50",
        "mesh.inlet=-2.0",
        "mesh.outlet=1.5",
        "motion.slide_roll_ratio=2.0",
    )
    simulation, [state] = solved("table1_smooth.toml", HEAT, *keys)
    s, steel = simulation.scales, Solid(46.0, 7850.0, 470.0)
    assert_balanced([state])
    rise = moving_band(s.x * s.a, state.heat_flux_1, steel.diffusivity, steel.conductivity, s.u1)
    np.testing.assert_allclose(state.temperature_1 - BULK, rise, atol=0.01 * rise.max())
