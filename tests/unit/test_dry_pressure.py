"""Dry contacts of any shape and bodies: exact pressures, profiles along the motion, guesses."""

import numpy as np
import pytest

from ehlpetsc.base.errors import CaseError
from ehlpetsc.case.loading import load
from ehlpetsc.elasticity.dry import dry_pressure, project
from ehlpetsc.elasticity.half_plane import deflection_kernel
from ehlpetsc.run.forecast.explain import explain
from ehlpetsc.run.simulation import Simulation
from ehlpetsc.stepping.first_guess import dry_contact

BODIES = {"youngs_modulus": 2.1e11, "poisson_ratio": 0.3}
MESH = {"points_per_half_width": 16, "inlet": -1.6, "outlet": 1.6}
CONTACTS = {
    "line": ({"radius": 0.01, "load": 2e5}, {}),
    "strip": ({"radius": 0.01, "load": 2e5}, {"width": 0.25}),
    "point": ({"radius": [0.01, 0.01], "load": 20.0}, {"width": 3.2}),
    "roller": ({"radius": 0.01, "load": 200.0, "length": 1e-3, "free_ends": False}, {}),
}
RELIEF = 0.5  # gap of x^4 at the half-width of Hertz in a^2/R


def test_projection_shifts_and_clips_to_the_sum():
    p = np.array([5.0, 1.0, 0.0])
    for limit, total, expected in ((np.inf, 2.0, [2.0, 0.0, 0.0]), (1.5, 2.0, [1.5, 0.5, 0.0])):
        np.testing.assert_allclose(project(p, limit, total), expected, atol=1e-12)
    np.testing.assert_allclose(project(-p, np.inf, 2.0), [0.0, 0.5, 1.5], atol=1e-12)


def simulation(kind, **contact):
    (of_kind, mesh), tables = CONTACTS[kind], {"title": "dry"}
    tables |= {"contact": BODIES | of_kind | contact, "mesh": MESH | mesh}
    return Simulation(load(tables))


def fourth_power(x, relief):
    """Half-width, and pressure in p0 beside x^2/2 + relief x^4, by Chebyshev polynomials."""
    a = np.sqrt((np.sqrt(1.0 + 12.0 * relief) - 1.0) / (6.0 * relief))
    t2 = np.minimum((x / a) ** 2, 1.0)
    return a, np.sqrt(1.0 - t2) * (a + 2.0 * relief * a**3 * (1.0 + 2.0 * t2))


@pytest.mark.parametrize("relief", (1e-9, RELIEF))
def test_pressure_of_half_planes_is_exact_for_parabola_and_fourth_power(relief):
    x = np.linspace(-1.5, 1.5, 301)
    distances = np.abs(np.arange(301)[:, None] - np.arange(301))
    deflection = 0.01 / np.pi * (deflection_kernel(301) - np.log(0.01))[distances]
    gap, total = 0.5 * x**2 + relief * x**4, 0.5 * np.pi / 0.01
    found = dry_pressure(gap, total, lambda p: deflection @ p, 0.8, np.ones(301), 1e-6)
    a, exact = fourth_power(x, relief)
    inside = np.abs(np.abs(x) - a) > 0.03
    np.testing.assert_allclose(found[inside], exact[inside], atol=2e-3)
    assert found.sum() == pytest.approx(total, rel=1e-12)


@pytest.mark.parametrize("kind", ("line", "strip"))
def test_profile_of_the_fourth_power_along_the_motion(kind):
    scales = simulation(kind).scales
    power = {"kind": "power", "exponent": 4, "distance": scales.a, "height": RELIEF * scales.h}
    run = simulation(kind, profile_along=power)
    x, (a, exact) = run.scales.x, fourth_power(run.scales.x, RELIEF)
    state = run.advance()
    assert state.step == 0 and state.newton <= 4  # the guess is the dry contact itself
    inside = np.abs(np.abs(x) - a) > 0.1
    for row in np.atleast_2d(state.pressure / scales.p0):
        np.testing.assert_allclose(row[inside], exact[inside], atol=3e-3)


@pytest.mark.parametrize("kind", ("line", "strip", "point"))
def test_a_parabola_given_by_points_halves_the_radius(kind):
    x = np.linspace(-1e-3, 1e-3, 401)
    found = simulation(kind, profile_along={"x": x, "z": x**2 / 0.02}).advance()
    radius = [0.005, 0.01] if kind == "point" else 0.005
    assert found.p_max == pytest.approx(simulation(kind, radius=radius).scales.p0, rel=0.02)


def test_guess_of_a_coated_contact_is_its_own_dry_contact():
    """Hertz's maximum is a tenth off."""
    run = simulation("point", coating={"thickness": 2e-5, "youngs_modulus": 2e10, "poisson_ratio": 0.3})
    problem = run.stepper.problem
    guess, is_outside = dry_contact(problem, problem.inputs())
    solved = run.advance().pressure.ravel() / run.scales.p0
    assert np.abs(np.sqrt(np.maximum(1.0 - problem.grid.distance**2, 0.0)) - solved).max() > 0.1
    assert np.abs(guess - solved).max() < 2e-3
    assert (guess[is_outside] == 0.0).all() and guess[~is_outside].min() > 0.0


@pytest.mark.parametrize("kind", CONTACTS)
def test_guess_of_homogeneous_bodies_is_that_of_hertz_or_of_slices(kind):
    problem = simulation(kind).stepper.problem
    guess, is_outside = dry_contact(problem, problem.inputs())
    room = problem.grid.room(1.0, 1.0)
    np.testing.assert_array_equal(guess, np.sqrt(np.maximum(room, 0.0)))
    np.testing.assert_array_equal(is_outside, room < 0.0)


def test_profiles_along_the_motion_are_checked():
    for given, fault in (
        ({"x": [0.0, 1e-3], "z": [0.0] * 3}, "x has 2 values, z 3"),
        ({"x": [1e-3, 0.0], "z": [0.0, 0.0]}, "increasing distances"),
        ({"kind": "power", "height": 1e-6, "distance": 1e-3}, "exponent is missing"),
        ({"file": "none.csv"}, "none.csv"),
    ):
        with pytest.raises(CaseError, match=fault):
            simulation("line", profile_along=given)


def test_explain_names_the_keys_that_hertz_does_not_know():
    layer = {"thickness": 2e-6, "youngs_modulus": 1e11, "poisson_ratio": 0.2}
    power = {"kind": "power", "exponent": 4, "distance": 1e-4, "height": 1e-7}
    for given, expected in (
        ({}, []),
        ({"coating": layer}, ["contact.coating"]),
        ({"coating": layer, "profile_along": power}, ["contact.coating", "contact.profile_along"]),
    ):
        (of_kind, mesh) = CONTACTS["point"]
        case = load({"title": "dry", "contact": BODIES | of_kind | given, "mesh": MESH | mesh})
        lines = [line for line in explain(case).splitlines() if "those without" in line]
        named = [name.strip() for line in lines for name in line.partition("without")[2].split(",")]
        assert sorted(named) == expected
