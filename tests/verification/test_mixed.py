"""Mixed contact: oil conserved everywhere, complementarity exact, the direct model's answer in full film."""

import numpy as np
import pytest
from support import CASES
from support.driving import Scene

from ehlpetsc.case.loading import load
from ehlpetsc.physics.oil.laws import density, viscosity
from ehlpetsc.run.simulation import Simulation

MIXED = "contact.model=mixed"
# the inlet near the contact, thin oil: the asperities touch within few steps
SHORT = ("mesh.inlet=-1.3", "mesh.points_per_half_width=60", "time.travel=1.5", "fluid.viscosity=0.0005")


@pytest.fixture(scope="module")
def rough():
    """States of a run in contact: (figures and fields, unknowns)."""
    simulation = Simulation(load(CASES / "table1_mixed.toml", SHORT))
    return simulation, list(simulation)


@pytest.mark.slow
def test_solids_and_film_are_complementary_to_the_bit_in_every_step(rough):
    """With load and oil balance, and without a halved step."""
    simulation, states = rough
    bound = simulation.case.contact.boundary_film
    touching = sum(int(s.in_contact.sum()) for s in states)
    assert touching > 200
    for state in states:
        over = state.film_thickness - simulation.stepper.solver.bound * simulation.scales.h
        assert state.film_thickness.min() >= bound * (1.0 - 1e-15)
        assert (over >= 0.0).all() and (state.contact_pressure >= 0.0).all()
        assert (state.contact_pressure * over == 0.0).all()
        np.testing.assert_array_equal(state.in_contact, state.contact_pressure > 0.0)
        assert state.load_error < 1e-10 and state.mass_error < 1e-6 and state.retries == 0
    assert np.mean([s.newton for s in states[1:]]) < 7.0


@pytest.mark.slow
@pytest.mark.parametrize("name", ["table1_smooth.toml", "waviness.toml"])
def test_in_full_film_both_models_have_one_limit(name):
    """Faces of direct contact leak, those of mixed contact do not: the films meet with the square of dx."""
    apart = []
    for points in (25, 50, 100):
        keys = {"mesh.points_per_half_width": points, "mesh.inlet": -2.0, "surface": {}, "time": None}
        direct = {"contact.model": "direct", "contact.boundary_film": None}
        films = [
            Simulation(load(CASES / name, keys | model)).advance().film_central
            for model in (direct, {"contact.model": "mixed"})
        ]
        apart.append(films[1] / films[0] - 1.0)
    assert 1.7 < np.log2(apart[1] / apart[2]) < 2.3 and 0.0 < apart[2] < 1e-2


@pytest.mark.parametrize("speed", [5.0, 0.1, 0.01, 1e-3, 1e-4])
def test_smooth_starts_converge_in_every_regime(speed):
    scene = Scene(
        "table1_smooth.toml", MIXED, f"motion.entrainment_speed={speed}", "mesh.points_per_half_width=100"
    )
    state = scene.start().state
    share = scene.problem.model.contact_pressure(state.w).sum() / state.p.sum()
    assert (share == 0.0) if speed == 5.0 else (1e-5 < share < 1e-3) if speed == 0.1 else (share > 0.999)


def flow(case, scales, state, left):
    """Oil that the pressure drives through the face right of node `left`, over rho0 u a^2/R.

    By the textbook's formulas, in SI units: Conry, Wang & Cusano 1987 for the Eyring factor, with the film of
    the face and the logarithmic mean of the fluidities with both nodes' viscosities.
    """
    fluid, at = case.fluid, [left, left + 1]
    p = np.maximum(state.q[at], 0.0) * scales.p0
    film = state.h * scales.h
    rho, eta = density(p, fluid)[0], fluid.viscosity * np.exp(viscosity(p, fluid)[0])
    gradient = (p[1] - p[0]) / scales.spacing
    h = np.cbrt(2.0 * film[at].prod() ** 2 / film[at].sum())
    factor = np.ones(2)
    if fluid.eyring_stress:
        sigma = abs(h * gradient / (2.0 * fluid.eyring_stress)) + 1e-12
        zeta = eta * (scales.u1 - scales.u2) / (fluid.eyring_stress * h)
        rolling, sliding = 1.0 + sigma**2 / 10.0, 1.0 - sigma**2 / 15.0
        if sigma > 0.02:
            rolling = 3.0 * (sigma * np.cosh(sigma) - np.sinh(sigma)) / sigma**3
            sliding = 3.0 * (sigma / np.tanh(sigma) - 1.0) / sigma**2
        factor = np.sqrt(rolling**2 + (zeta * sliding) ** 2)
    one, other = rho * h**3 * factor / (12.0 * eta)
    mean = (one - other) / np.log(one / other) if abs(one / other - 1.0) > 1e-4 else 0.5 * (one + other)
    return -mean * gradient / (scales.u * scales.h)


def carried(values):
    """One node downstream; the value of the first node enters."""
    return np.append(values[:1], values[:-1])


def stored(state):
    """Mass per area that BDF2 keeps with equal steps of a node, at every node."""
    return np.maximum(state.m + 0.5 * (state.m - carried(state.m_older)), 0.5 * state.m)


@pytest.mark.slow
def test_oil_inflow_minus_outflow_equals_storage(rough):
    """Over a whole run with contact, to 1e-8 of what has passed, from the flows at both ends."""
    simulation, states = rough
    case, scales = simulation.case, simulation.scales
    passed = gained = 0.0
    begin = None
    for accepted in states:
        state = accepted.dimensionless
        if state.step < 2:  # the first step is of another order
            continue
        if begin is None:
            begin = last = stored(state)
            continue
        assert scales.u * state.dt == pytest.approx(
            scales.spacing, rel=1e-9
        )  # all that a node holds moves on
        inflow = last[0] + flow(case, scales, state, 0)
        outflow = last[-2] + flow(case, scales, state, scales.nx - 2)
        passed, gained, last = passed + inflow, gained + inflow - outflow, stored(state)
    change = (stored(state) - begin)[1:-1].sum()
    assert abs(change) > 1e-3 * passed
    assert abs(change - gained) < 1e-8 * passed


RIDGES = """
[surface.2]
file = "ridges.csv"
[time]
travel = 2.0
courant = 1.0
"""
POCKET = (
    "motion.slide_roll_ratio=0.0",
    "motion.entrainment_speed=0.2",
    "fluid.viscosity=0.005",
    "fluid.law=barus",
    "fluid.pressure_viscosity=2e-8",
    "fluid.density=incompressible",
    "mesh.inlet=-1.5",
    "mesh.outlet=1.3",
)


@pytest.mark.slow
def test_pocket_between_two_contacts_conserves_its_oil(tmp_path):
    """Two flat ridges, 1 um high, 90 um apart, in pure rolling: one node a step, as windows travel along."""
    x, first, apart = np.arange(0.0, 600e-6, 0.5e-6), 100e-6, 90e-6
    z = 1e-6 * sum(np.exp(-(((x - place) / 15e-6) ** 6)) for place in (first, first + apart))
    np.savetxt(tmp_path / "ridges.csv", np.column_stack([x, z]), delimiter=",")
    text = (CASES / "table1_mixed.toml").read_text()
    (tmp_path / "case.toml").write_text(text[: text.index("[surface.1]")] + RIDGES)
    simulation = Simulation(load(tmp_path / "case.toml", POCKET), options={"snes_atol": "1e-9"})
    case, scales = simulation.case, simulation.scales
    front = round((first + apart) / scales.spacing)  # nodes that the second ridge is behind
    contents, leak = [], 0.0
    for accepted in simulation:
        state, left = accepted.dimensionless, accepted.step - front
        right = left + round(apart / scales.spacing)
        if left < 10 or not (accepted.in_contact[left - 2 : left + 2].all()):
            continue
        assert accepted.in_contact[right - 2 : right + 2].all()
        if contents:
            # the window moves on by a node, as what it holds
            leak += flow(case, scales, state, left - 1) - flow(case, scales, state, right - 1)
        contents.append(stored(state)[left:right].sum())
        middle, width = (left + right) // 2, (right - left) // 2
        within, beyond = accepted.pressure[middle], accepted.pressure[[left - width, right + width]]
    assert len(contents) > 200
    assert contents[-1] - contents[0] == pytest.approx(leak, abs=1e-9 * contents[0])
    assert abs(leak) < 3e-3 * contents[0]
    assert within > beyond.max()


@pytest.mark.slow
def test_vinewtonrsls_takes_the_iterations_of_newtonls(rough):
    simulation, states = rough
    bounded = iter(Simulation(simulation.case, options={"snes_type": "vinewtonrsls"}))
    assert any(state.in_contact.any() for state in states[:80])
    for one, other in zip(states[:80], bounded, strict=False):
        assert other.newton == one.newton and other.retries == 0
        np.testing.assert_array_equal(other.in_contact, one.in_contact)
        np.testing.assert_allclose(other.pressure, one.pressure, rtol=1e-9)
