"""Conditions that change with time: load, radius and speeds, reversal, squeeze."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from support import CASES
from support.convergence import observed_order

import ehlpetsc
from ehlpetsc.analysis.gear_run import GearRun
from ehlpetsc.case.loading import load
from ehlpetsc.commands.gears import main as gears
from ehlpetsc.discretisation.unknowns import Unknowns
from ehlpetsc.gears import path_of_contact
from ehlpetsc.physics.contact.hertz import hertz_line
from ehlpetsc.physics.scales import Scales
from ehlpetsc.run.recorder import Recorder
from ehlpetsc.run.simulation import Simulation
from ehlpetsc.stepping.state import State

COARSE = {"mesh.points_per_half_width": 50, "mesh.inlet": -2.5, "mesh.outlet": 1.5}


def states(name, overrides):
    """All accepted solutions of a case."""
    simulation = Simulation(load(CASES / name, overrides))
    return simulation, [state.dimensionless for state in simulation]


def test_constant_conditions_in_a_table_are_the_plain_case():
    plain = COARSE | {"time.travel": 0.4, "time.courant": 0.5}
    simulation, expected = states("table1_mixed.toml", plain)
    s = simulation.scales
    table = {"load": s.load, "radius": s.R, "speed_1": s.u1, "speed_2": s.u2}
    table = {name: [value] * 2 for name, value in table.items()}
    table["time"] = [0.0, 1.7003 * s.duration]  # no whole number of steps: the travel ends the run
    _, found = states("table1_mixed.toml", plain | {"operation": table})
    assert len(found) == len(expected) > 20
    for one, other in zip(found, expected, strict=True):
        assert one.time == pytest.approx(other.time, rel=1e-12)
        np.testing.assert_allclose(one.p, other.p, atol=1e-12)
        np.testing.assert_allclose(one.h, other.h, atol=1e-12)


FZG = {"module": 4.5e-3, "teeth": [16, 24], "centre_distance": 91.5e-3, "tip_diameter": [82.5e-3, 118.4e-3]}
FZG |= {"face_width": 14e-3, "torque": 302.0, "speed": 2250.0, "tip_relief": 20e-6}
WAVE = {"synthetic": {"kind": "sine", "amplitude": 1e-7, "wavelength": 3e-4}}
BOTH_WAVY = {"surface.1": WAVE, "surface.2": WAVE, "time": None}
OF_GEARS = ("contact.radius", "contact.load", "motion.entrainment_speed", "motion.slide_roll_ratio")


def test_flank_profile_is_indexed_by_arc_length():
    gears = COARSE | dict.fromkeys(OF_GEARS) | {"gears": FZG}
    simulation = Simulation(load(CASES / "table1_mixed.toml", gears | BOTH_WAVY))
    path, roughness = path_of_contact(FZG), simulation.roughness
    started = np.interp(0.05 * path.load.max(), path.load[:50], path.time[:50])
    for point in "BCD":
        time = path.time[path.index(point)] - started
        arcs = path.pair.flank_arcs(path.pair.points[point])
        heights = [1e-7 * np.cos(2 * np.pi * arc / 3e-4) for arc in arcs]
        middle = roughness.phi_after(np.zeros(1), simulation.operation.travelled(time))
        assert middle[0] == pytest.approx(-sum(heights), abs=2e-11)
    shift = path.pair.hunting_shift
    second = Simulation(simulation.case, pass_number=2)
    offsets = np.subtract(second.scene.begin, simulation.scene.begin)
    assert offsets == pytest.approx((0.0, shift))


def test_reversed_body_passes_the_same_points_back():
    table = {"time": [0.0, 1e-4, 2e-4], "speed_1": [2.0, 0.0, -2.0], "speed_2": [2.0, 2.0, 2.0]}
    sides = {"mesh.inlet": -2.0, "mesh.outlet": 2.0, "mesh.points_per_half_width": 50}
    simulation = Simulation(load(CASES / "table1_mixed.toml", {"operation": table} | sides | BOTH_WAVY))
    x, moved = simulation.scales.x * simulation.scales.a, simulation.operation.travelled
    fast, slow = simulation.roughness.surface_1, simulation.roughness.surface_2
    assert not fast.is_moving and slow.is_moving
    there, back = moved(0.4e-4)[0], moved(1.6e-4)[0]
    assert there == pytest.approx(back, rel=1e-9)
    np.testing.assert_allclose(fast.height(x - there), fast.height(x - back), atol=1e-12)
    assert fast.height(x).std() > 0.5e-7 and fast.s[0] <= x[0] - moved(1e-4)[0]


def test_load_step_equals_a_restart_under_the_other_load():
    """On one mesh, the state after some steps under one load continues under the other."""
    heavy, light, dt, before, after = 527e3, 0.64 * 527e3, 5e-7, 12, 25
    step = dt * before
    table = {"time": [0.0, step, step + 1e-12, 1e-4], "load": [light, light, heavy, heavy]}
    stepped = Simulation(load(CASES / "table1_smooth.toml", COARSE | {"operation": table, "time": None}))
    restarted = Simulation(load(CASES / "table1_smooth.toml", COARSE | {"time.travel": 5.0}))
    stepped.advance()
    for _ in range(before):
        stepped.advance(dt)
    restarted.dimensionless = stepped.dimensionless
    for _ in range(after):
        one, other = stepped.advance(dt), restarted.advance(dt)
        assert one.load == pytest.approx(heavy, rel=1e-10)
        np.testing.assert_allclose(one.film_thickness, other.film_thickness, rtol=1e-9)
        np.testing.assert_allclose(one.pressure, other.pressure, atol=1.0)


def test_mean_film_is_of_the_contact_of_the_instant():
    """Under a twentieth of the load the half-width is 0.22 a; the film at a/2 is that of the inlet."""
    loads = {"operation.time": [0.0, 1e-4], "operation.load": [527e3, 26.35e3], "time": None}
    simulation = Simulation(load(CASES / "table1_smooth.toml", COARSE | loads))
    *_, accepted = simulation
    s, scalars = simulation.scales, accepted.scalars
    a, _ = hertz_line(scalars["load_given"], scalars["radius"], s.E)
    assert a == pytest.approx(s.a / 20.0**0.5, rel=1e-9)
    film, x = accepted.film_thickness, s.a * np.abs(s.x)
    middle = film[x <= 0.5 * a].mean()
    assert scalars["film_central"] == pytest.approx(middle, rel=1e-12)
    assert middle < 0.9 * film[x <= 0.5 * s.a].mean()


@pytest.mark.slow
def test_half_strokes_of_oscillating_entrainment_mirror_each_other():
    n, stroke, u = 32, 8.0, 5.0
    half = u * np.cos(np.pi * np.arange(n) / n)
    half[n // 2] = 0.0
    speed = np.concatenate([half, -half, half[:1]])
    period = np.pi * stroke * 0.33568e-3 / u
    table = {
        "operation.time": np.arange(2 * n + 1) / (2 * n) * period,
        "operation.speed_1": speed,
        "operation.speed_2": 0.8 * speed,
        "operation.repeat": 2,
        "mesh.points_per_half_width": 25,
        "mesh.inlet": -4.0,
        "mesh.outlet": 4.0,
        "time": None,
    }
    # nothing damps what the tolerance leaves in a film
    simulation = Simulation(load(CASES / "table1_smooth.toml", table), options={"snes_atol": 1e-9})
    states = list(simulation)
    steps = simulation.operation.step_count(None) // 2
    assert len(states) == 2 * steps + 1 and steps % 4 == 0
    assert not any(state.retries for state in states)
    assert max(state.scalars["mass_error"] for state in states) < 8e-7  # through rest and reversal
    steady = states[0]  # begins with the largest speed
    last = states[-steps:]
    for k in range(steps // 2):
        there, back = last[k], last[k + steps // 2]
        np.testing.assert_allclose(back.film_thickness, there.film_thickness[::-1], rtol=1e-6)
        np.testing.assert_allclose(back.pressure, there.pressure[::-1], atol=1e-6 * simulation.scales.p0)
    assert max(state.load_error for state in states) < 1e-12
    assert max(state.mass_error for state in states) < 1e-3
    assert np.median([state.mass_error for state in states]) <= 1e-4
    reversal = [state.h_min for state in last if abs(state.speed_1) < 0.5 * u]
    assert min(reversal) < 0.6 * steady.h_min
    assert min(state.h_min for state in last) == min(reversal)


def harmonic(steps):
    """Film and pressure in the window after three quarters of a period of load, radius and speeds."""
    base = {"mesh.points_per_half_width": 32, "mesh.inlet": -1.75, "mesh.outlet": 1.5, "surface": None}
    base |= {"contact.load": 130e3, "motion.entrainment_speed": 25.0, "time": None}
    case = load(CASES / "ridge.toml", base | {"time.travel": 1.0})
    s = Scales.of(case)
    period = 4.0 * s.a / s.u
    phase = np.arange(65) / 64
    factor = 1.0 - 0.1 * (1.0 - np.cos(2.0 * np.pi * phase))
    columns = {"load": s.load, "radius": s.R, "speed_1": s.u1, "speed_2": s.u2}
    table = {name: value * factor for name, value in columns.items()}
    keys = base | {"operation": table | {"time": phase * period}}
    simulation = Simulation(load(CASES / "ridge.toml", keys), options={"snes_atol": 1e-11})
    simulation.advance()
    for _ in range(steps):
        assert simulation.advance(0.75 * period / steps).retries == 0
    window = (simulation.scales.x >= -1.0) & (simulation.scales.x <= 0.5)
    return simulation.dimensionless.h[window], simulation.dimensionless.p[window]


def test_second_order_in_time_under_harmonic_conditions():
    solutions = [harmonic(steps) for steps in (160, 320, 640)]
    for field in (0, 1):
        pairs = zip(solutions, solutions[1:], strict=False)
        differences = [np.sqrt(np.mean((one[field] - other[field]) ** 2)) for one, other in pairs]
        assert observed_order(differences) >= 1.8


def test_squeeze_film_of_an_approaching_cylinder():
    r"""A cylinder at rest sinks as the rigid one does: :math:`p=6\eta VR(1/h^2-1/h_L^2)`, h_L at both ends.

    On an infinite domain :math:`h_0^{-1/2}` grows by :math:`w't/(6\sqrt2\pi\eta R^{3/2})` (closed form).
    The film is 200 a^2/R, so that deflection changes it by 0.5 %.
    """
    oil = {"viscosity": 1.0, "law": "barus", "pressure_viscosity": 1e-12, "density": "incompressible"}
    oil = {"fluid": oil}
    mesh = {"mesh.points_per_half_width": 4, "mesh.inlet": -100.0, "mesh.outlet": 100.0, "time": None}
    s = Scales.of(load(CASES / "table1_smooth.toml", oil | mesh))
    load_, radius, first = s.load, s.R, 200.0 * s.h
    rate = load_ / (6.0 * np.sqrt(2.0) * np.pi * radius**1.5)
    end = (np.sqrt(2.0) - 1.0) / (rate * np.sqrt(first))  # half the film is left
    rest = {"operation.time": [0.0, end, 2.0 * end]}
    rest |= {"operation.speed_1": [0.0, 0.0, 1.0], "operation.speed_2": [0.0, 0.0, 1.0]}
    simulation = Simulation(load(CASES / "table1_smooth.toml", oil | mesh | rest))
    x, y = simulation.scales.x, simulation.scales.x * s.a
    film = 200.0 + 0.5 * x**2
    pressure = (200.0 / film) ** 2
    pressure *= 0.5 * np.pi / (pressure.sum() * (x[1] - x[0]))
    model = simulation.stepper.problem.model
    simulation.dimensionless = State(
        Unknowns(pressure, model.w_from_film(film), np.array([200.0])), m=film.copy()
    )

    def sinking(_, h):
        gap = h[0] + y**2 / (2.0 * radius)
        return [-load_ / (s.spacing * (6.0 * radius * (gap**-2 - gap[0] ** -2)).sum())]

    exact = solve_ivp(sinking, (0.0, end), [first], rtol=1e-9, atol=1e-12, dense_output=True).sol
    dt = end / 64
    for _ in range(64):
        state = simulation.advance(dt)
        assert state.h_min == pytest.approx(exact(simulation.dimensionless.time)[0], rel=5e-3)
    assert state.h_min < 0.51 * first
    grown = (state.h_min**-0.5 - first**-0.5) / (rate * simulation.dimensionless.time)
    assert grown == pytest.approx(1.0, rel=1e-2)


def test_stopped_gear_run_resumes_identically(tmp_path, capsys):
    short = {"mesh.points_per_half_width": 25, "time.travel": 2.0, "time.courant": 0.3, "output.every": 10}
    short |= {"gears.tip_relief": 52e-6, "gears.load_sharing": "tip-relief"}  # begins without load, after A
    case = load(CASES / "fzg.toml", short)
    whole = ehlpetsc.solve(case)
    simulation = Simulation(case)
    with Recorder(simulation, tmp_path / "gear.h5") as recorder:
        for _ in range(43):
            recorder.write(simulation.advance())
        recorder.checkpoint()
    resumed = ehlpetsc.solve(case, tmp_path / "gear.h5", restart=tmp_path / "gear.restart.h5")
    assert len(resumed.steps.time) == len(whole.steps.time) > 90
    for name in ("time", "h_min", "p_max", "friction", "radius", "displacement_2", "contact_share"):
        one, other = (np.asarray(getattr(result.steps, name)) for result in (resumed, whole))
        np.testing.assert_allclose(one, other, rtol=1e-9, atol=1e-9 * np.abs(other).max())
    np.testing.assert_allclose(resumed.pressure[:], whole.pressure[:], atol=1.0)
    np.testing.assert_allclose(resumed.film_thickness[:], whole.film_thickness[:], rtol=1e-9)
    resumed.close()
    assert gears([str(tmp_path / "gear.h5"), "-o", str(tmp_path / "gear.png")]) == 0
    printed = capsys.readouterr().out
    assert "mean friction coefficient 0.0" in printed and (tmp_path / "gear.png").stat().st_size > 10_000
    run = GearRun(tmp_path / "gear.h5")
    radius = np.interp(run.rho, run.path.rho, run.path.radius)
    np.testing.assert_allclose(radius, np.asarray(whole.steps.radius), rtol=1e-4)
    a_to_c = run.path.pair.points["C"] - run.path.pair.points["A"]
    assert -a_to_c < run.position[0] < -0.95 * a_to_c
