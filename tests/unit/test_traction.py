"""Signs of shear and the film's balance of forces; published friction correlations."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from ehlpetsc.case.loading import load
from ehlpetsc.discretisation.unknowns import Unknowns
from ehlpetsc.effects.scene import Scene
from ehlpetsc.nonlinear.line.system import line_problem
from ehlpetsc.physics import operation_of
from ehlpetsc.physics.contact.grid import Grid
from ehlpetsc.physics.contact.shape import CYLINDER
from ehlpetsc.physics.scales import Scales
from ehlpetsc.physics.traction import benedict_kelley, hoehn_michaelis, shear_stresses, xu_kahraman
from ehlpetsc.stepping.observables import Observation, diagnostics, mean_film
from ehlpetsc.stepping.state import State

CASE = Path(__file__).parents[2] / "cases" / "table1_smooth.toml"
NEWTONIAN, EYRING = 1e12, 10e6
FRICTION = 0.1


def scene(slide_roll_ratio, eyring=EYRING, speed=5.0):
    """Case, scales, and a pressure [Pa] with its film [m]: the gradient changes sign at x = 0."""
    case = load(
        CASE,
        [
            f"motion.slide_roll_ratio={slide_roll_ratio}",
            f"motion.entrainment_speed={speed}",
            f"fluid.eyring_stress={eyring}",
            f"contact.boundary_friction={FRICTION}",
            "mesh.points_per_half_width=40",
        ],
    )
    scales = Scales.of(case)
    p = 0.3e9 * np.exp(-(scales.x**2))
    return case, scales, p, np.full(scales.nx, 0.2e-6)


def stresses(case, scales, p, solids, h, sheared):
    friction = case.contact.boundary_friction * solids
    gradient = np.gradient(p, scales.spacing)
    return shear_stresses(case.fluid, friction, gradient, scales.u1 - scales.u2, p, h, sheared)


def shear(case, scales, p, h, void=0.0, touching=()):
    in_contact = np.zeros(scales.nx, bool)
    in_contact[list(touching)] = True
    solids, sheared = np.where(in_contact, p, 0.0), np.where(in_contact, 0.0, 1.0 - void)
    return stresses(case, scales, p, solids, h, sheared)


@pytest.mark.parametrize("ratio", [0.5, -0.5])
@pytest.mark.parametrize("eyring", [EYRING, NEWTONIAN])
def test_shear_opposes_the_faster_and_drives_the_slower_surface(ratio, eyring):
    case, scales, p, h = scene(ratio, eyring)
    fast, slow = shear(case, scales, np.full_like(p, 0.3e9), h)
    assert (np.sign(ratio) * fast < 0.0).all() and (np.sign(ratio) * slow > 0.0).all()
    np.testing.assert_allclose(fast, -slow, rtol=1e-12)  # no gradient: all is drag


@pytest.mark.parametrize("ratio", [0.5, -0.5])
def test_at_contact_nodes_friction_opposes_sliding(ratio):
    case, scales, p, h = scene(ratio)
    touching = [30, 31, 60]
    fast, slow = shear(case, scales, p, h, touching=touching)
    np.testing.assert_allclose(slow[touching], np.sign(ratio) * FRICTION * p[touching], rtol=1e-12)
    np.testing.assert_allclose(fast[touching], -slow[touching], rtol=1e-12)
    rolling = scene(0.0)
    for side in shear(*rolling, touching=touching):
        np.testing.assert_array_equal(side[touching], 0.0)


@pytest.mark.parametrize("ratio", [0.0, 0.5, -1.0])
@pytest.mark.parametrize("eyring", [EYRING, NEWTONIAN])
def test_the_film_is_in_balance(ratio, eyring):
    """What both walls give to the solids together is what the pressure does to the film: -h dp/dx."""
    case, scales, p, h = scene(ratio, eyring)
    fast, slow = shear(case, scales, p, h)
    np.testing.assert_allclose(fast + slow, -h * np.gradient(p, scales.spacing), rtol=1e-9, atol=1e-3)


def test_pressure_flow_drags_both_walls_in_pure_rolling():
    case, scales, p, h = scene(0.0)
    fast, slow = shear(case, scales, p, h)
    before, behind = (scales.x < -0.1) & (scales.x > -1.4), scales.x > 0.1
    for side in (fast, slow):
        assert (side[before] < 0.0).all() and (side[behind] > 0.0).all()


def test_shear_stress_of_a_newtonian_film_and_of_a_void():
    """Couette flow: eta (u1 - u2) / h, at the ambient pressure of 0.005 Pa s."""
    case, scales, p, h = scene(0.5, NEWTONIAN)
    _, slow = shear(case, scales, np.zeros_like(p), h)
    np.testing.assert_allclose(slow, 0.005 * (scales.u1 - scales.u2) / h, rtol=1e-6)
    assert scales.u1 - scales.u2 == pytest.approx(2.5)
    case, scales, p, h = scene(0.5)
    full, empty, half = (shear(case, scales, p, h, void=void) for void in (0.0, 1.0, 0.5))
    for side in (0, 1):
        np.testing.assert_array_equal(empty[side], 0.0)
        np.testing.assert_allclose(half[side], 0.5 * full[side], rtol=1e-12)


def state_of(problem, q, w):
    unknowns = Unknowns(q, w, np.zeros(1))
    return State(unknowns, problem.solution(unknowns, np.zeros_like(w), problem.inputs()))


def test_cavity_shear_is_proportional_to_its_oil():
    """Eyring shear of the full gap times the fraction of oil, in the fields of an accepted state."""
    case, scales, _, h = scene(0.5)
    problem = line_problem(case, scales, 1e-2, 0, scales.nx, bound_tolerance=1e-8)
    void = np.linspace(0.1, 0.9, scales.nx)
    film = h / scales.h
    q = np.where(np.arange(scales.nx) < 2, 0.1, -void)  # p0; something carries
    state = state_of(problem, q, film)
    setting = Scene(case, scales, operation_of(case, scales), None)
    _, fields, _ = diagnostics(setting, problem, [], state, 0.0)
    full = EYRING * np.arcsinh(0.005 * (scales.u1 - scales.u2) / h / EYRING)
    expected = (full * (1.0 - void))[4:]
    np.testing.assert_array_equal(fields["void_fraction"][4:], void[4:])
    np.testing.assert_allclose(fields["shear_stress_2"][4:], expected, rtol=1e-9)
    np.testing.assert_allclose(fields["shear_stress_1"][4:], -expected, rtol=1e-9)


def test_mixed_contact_adds_oil_and_solid_shear():
    case, scales, p, h = scene(0.5)
    mixed = case.copy(update={"contact": case.contact.copy(update={"model": "mixed"})})
    touching = np.zeros(scales.nx, bool)
    touching[[30, 60]] = True
    solids, sheared = np.where(touching, 0.2e9, 0.0), np.ones(scales.nx)
    oil_alone = stresses(mixed, scales, p, np.zeros_like(p), h, sheared)
    for sign, both, oil in zip(
        (-1.0, 1.0), stresses(mixed, scales, p, solids, h, sheared), oil_alone, strict=True
    ):
        np.testing.assert_allclose(both - oil, sign * FRICTION * solids, atol=1e-6)


def test_film_of_rounding_size_has_solid_shear():
    """Whether rounding leaves 0 or 1e-17 of it must not matter: runs continued and not differed there."""
    case, scales, p, h = scene(0.5)
    problem = line_problem(case, scales, 1e-2, 0, scales.nx, bound_tolerance=1e-8)  # as SNES has it
    found = []
    for left in (0.0, 1e-17, 1e-9):
        w = h / scales.h
        w[[30, 60]] = left
        state = state_of(problem, p / scales.p0, w)
        setting = Scene(case, scales, operation_of(case, scales), None)
        _, fields, touching = diagnostics(setting, problem, [], state, 0.0)
        assert touching.sum() == (0 if left else 2)
        found.append((fields["shear_stress_2"], fields["shear_stress_1"]))
    for one in found[1:]:
        np.testing.assert_allclose(one, found[0], rtol=1e-12)


def test_mean_film_is_over_the_central_half():
    x = np.array([-1.0, -0.5, 0.0, 0.5, 1.0])
    scales = SimpleNamespace(grid=Grid((x,), (0.5,), (1.0,), (CYLINDER,), 1.0), h=2e-6)
    films = np.array([9.0, 1.0, 2.0, 3.0, 9.0])
    assert mean_film(scales, films, 1.0, films) == pytest.approx(4e-6, rel=1e-14)
    assert mean_film(scales, films, 2.0, films) == pytest.approx(9.6e-6, rel=1e-14)
    assert mean_film(scales, films, 0.1, films) == pytest.approx(4e-6, rel=1e-14)


LOAD, SUM_SPEED, RADIUS, VISCOSITY, RA = 637.6e3, 6.583, 8.382e-3, 0.0112, 0.25e-6


def test_published_correlations_by_hand():
    for factor in (1.0, 0.8):
        found = hoehn_michaelis(LOAD, SUM_SPEED, RADIUS, VISCOSITY, RA, factor)
        assert found == pytest.approx(factor * 0.0491, rel=1e-3)
    light, least = (hoehn_michaelis(load, SUM_SPEED, RADIUS, VISCOSITY, RA) for load in (10e3, 150e3))
    assert light == least
    # f = -8.916465 - 0.354068 * 0.24 + 2.812084 exp(-0.24) + 0.620305 exp(0.2) = -6.03187
    found = xu_kahraman(1.2e9, -0.2, 10.0, 0.01, 0.01, 0.2e-6)
    by_hand = np.exp(-6.03187) * 1.207257 * 0.188717 * 0.793235 * 5.659198 * 6.053413
    assert found == pytest.approx(by_hand, rel=1e-4)
    # 0.0127 lg(3.17e8 w'/(nu v_s v_r^2)): lbf/in, mPa s, in/s
    imperial = 3.17e8 * LOAD / 175.1268 / (11.2 * (1.0 / 0.0254) * (SUM_SPEED / 0.0254) ** 2)
    expected = 0.0127 * np.log10(imperial)
    assert benedict_kelley(LOAD, 1.0, SUM_SPEED, VISCOSITY, 0.0) == pytest.approx(expected, rel=1e-4)
    rough = benedict_kelley(LOAD, 1.0, SUM_SPEED, VISCOSITY, RA)
    assert rough == pytest.approx(expected * 1.13 / 0.88, rel=1e-4)


@pytest.mark.parametrize("film, reference", [(2e-7, 2e-7), (0.0, 1e-10), (5e-11, 1e-10)])
def test_mass_defect_is_related_to_the_oil_in_the_contact_or_to_a_film_of_an_atom(film, reference):
    """Of two rows; the node of the inlet has no balance."""
    h, residual, mass = 4e-6, np.array([9.0, 0.1, -0.2, 9.0, 0.0, 0.3]), np.full(6, film / 4e-6)
    grid = SimpleNamespace(
        rows=lambda values: values.reshape(2, 3), inside=lambda size: np.arange(6) % 3 == 1, breadth=2.0
    )
    problem = SimpleNamespace(fluid="oil", film_scale=1e-3, grid=grid, scales=SimpleNamespace(h=h))
    solution = SimpleNamespace(residual=residual, mass=mass)
    of = SimpleNamespace(problem=problem, state=SimpleNamespace(solution=solution), size=1.0)
    assert Observation.mass_error.fget(of) == pytest.approx(1e-3 * 0.6 / (reference / h * 2.0), rel=1e-12)
