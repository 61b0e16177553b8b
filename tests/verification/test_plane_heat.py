"""Heat in points and strips: a strip is the line; Blok's temperature of fast points; long ellipses."""

import numpy as np
import pytest
from support import roelands_oil

from ehlpetsc.case.loading import load
from ehlpetsc.physics.flash_temperature import STEEL, blok_flash_temperature
from ehlpetsc.run.simulation import Simulation

BULK, FRICTION = 363.0, 0.1
SOLIDS = {"material": "100Cr6", "boundary_friction": FRICTION}
TIGHT = {"snes_atol": 1e-13}
TEMPERATURES = ("film_temperature", "temperature_1", "temperature_2")
OIL = roelands_oil(0.04, 18e-9, eyring_stress=6e6)


def tables(radius, contact_load, speed, mesh, **more):
    """Tables of a case with heat at slide/roll 0.4."""
    return {
        "title": "heat",
        "contact": {"radius": radius, "load": contact_load, **SOLIDS},
        "motion": {"entrainment_speed": speed, "slide_roll_ratio": 0.4},
        "mesh": {"inlet": -1.5, "outlet": 1.5, "points_per_half_width": 20} | mesh,
        "heat": {"bulk_temperature": BULK},
    } | more


def solved(case, **options):
    simulation = Simulation(load(case), options=options)
    return simulation, list(simulation)


def row(state, name):
    """Middle row of a field."""
    return state.fields[name][len(state.fields[name]) // 2]


def test_a_strip_is_the_line_with_its_heat():
    mesh, more = {"points_per_half_width": 16}, {"fluid": OIL, "time": {"travel": 0.2}}
    _, line = solved(tables(0.0125, 1e5, 3.0, mesh, **more), **TIGHT)
    _, strip = solved(tables(0.0125, 1e5, 3.0, mesh | {"width": 0.3}, **more), **TIGHT)
    assert len(line) == len(strip) > 3
    for one, other in zip(line, strip, strict=True):
        for name in (*TEMPERATURES, "heat_flux_1", "film_thickness", "shear_stress_1"):
            rows, alone = other.fields[name], one.fields[name]
            np.testing.assert_allclose(rows - alone, 0.0, atol=1e-9 * np.ptp(alone))
        for name in ("heat", "friction", "film_temperature_max", "film_temperature_mean"):
            assert other.scalars[name] == pytest.approx(one.scalars[name], rel=1e-10)
        assert other.heat_error < 1e-9


@pytest.mark.parametrize("radii", [[0.0125, 0.0125], [0.005, 0.02]], ids=["circle", "ellipse"])
def test_a_fast_dry_point_has_bloks_temperature_in_its_middle_row(radii):
    """Conduction into the depth alone: the middle row is Blok's band under the flux there; heat in W."""
    simulation, [state] = solved(tables(radii, 20.0, 100.0, {"width": 2.6}))
    s = simulation.scales
    flash = blok_flash_temperature(
        FRICTION, 0.5 * np.pi * s.p0 * s.a, s.u1 - s.u2, s.u1, s.u2, s.a, (STEEL.effusivity,) * 2
    )
    assert row(state, "temperature_1").max() - BULK == pytest.approx(flash, rel=0.005)
    assert state.temperature_1_max == row(state, "temperature_1").max()
    assert state.heat == pytest.approx(FRICTION * 20.0 * (s.u1 - s.u2), rel=1e-6)
    assert state.heat_error < 1e-9


@pytest.mark.parametrize("speed, ratio, exact", [(0.05, 1.0, 3.42), (0.05, 2.0, 6.85), (1.0, 2.0, 77.5)])
def test_a_slow_ball_and_a_pin_at_rest_heat_as_on_a_free_half_space(speed, ratio, exact):
    """Dry; maximum temperatures [K] by moving point sources, on a mesh 1.5 times as wide as the contact."""
    mesh = {"inlet": -1.5, "points_per_half_width": 10, "width": 3.0}
    case = tables(
        [0.01, 0.01], 20.0, speed, mesh, motion={"entrainment_speed": speed, "slide_roll_ratio": ratio}
    )
    _, [state] = solved(case)
    assert state.temperature_1_max - BULK == pytest.approx(exact, rel=0.01)


def test_a_long_ellipse_is_a_line_in_its_middle_row():
    mesh = {"inlet": -2.5, "points_per_half_width": [20, 8], "width": 3.0}
    simulation, [state] = solved(tables([0.0125, 0.375], 600.0, 3.0, mesh, fluid=OIL))
    s = simulation.scales
    equal = (
        0.25 * s.E * s.a / s.p0,
        0.5 * np.pi * s.p0 * s.a,
    )  # radius and load per length of the same a and p0
    _, [line] = solved(tables(*equal, 3.0, {"inlet": -2.5}, fluid=OIL))
    for name in TEMPERATURES:
        found, alone = row(state, name), line.fields[name]
        assert found.max() - BULK == pytest.approx(alone.max() - BULK, rel=0.025)
        np.testing.assert_allclose(found, alone, atol=0.05 * np.ptp(alone))


def test_heat_of_the_pressure_flow_is_the_work_of_entrainment():
    r"""Of an incompressible oil in pure rolling, :math:`\int M|\nabla p|^2=\int uh\,\partial_xp`."""
    case = tables([0.0125, 0.0125], 20.0, 3.0, {"inlet": -3.0, "width": 5.0}, fluid=OIL)
    case["fluid"] = OIL | {"density": "incompressible", "eyring_stress": None}
    case["motion"] = {"entrainment_speed": 3.0, "slide_roll_ratio": 0.0}
    simulation, [state] = solved(case)
    s = simulation.scales
    work = s.u * (state.film_thickness * np.gradient(state.pressure, s.a * s.grid.dx, axis=1)).sum()
    assert simulation.dimensionless.records["heat"].source.sum() == pytest.approx(work, rel=0.05)
