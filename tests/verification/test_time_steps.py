"""Time steps of any length: a steady film stays, conditions over time and waves in long steps."""

import numpy as np
import pytest

from ehlpetsc.base.errors import CaseError
from ehlpetsc.case.loading import load
from ehlpetsc.discretisation.film_history import FilmLevels, film_history
from ehlpetsc.physics.scales import Scales
from ehlpetsc.run.checkpoint import load as load_checkpoint
from ehlpetsc.run.checkpoint import save
from ehlpetsc.run.forecast.validity import warnings
from ehlpetsc.run.simulation import Simulation
from ehlpetsc.stepping import time_stepping
from ehlpetsc.stepping.step_control import film_error

LINE = {
    "title": "long steps",
    "contact": {"radius": 0.018, "load": 200e3, "material": "16MnCr5"},
    "fluid": {
        "viscosity": 0.01,
        "law": "roelands",
        "pressure_viscosity": 16e-9,
        "density": "dowson-higginson",
        "eyring_stress": 6e6,
    },
    "motion": {"entrainment_speed": 1.4137, "slide_roll_ratio": 0.5},
    "mesh": {"inlet": -4.0, "outlet": 2.0, "points_per_half_width": 50},
}
NEAR = {"inlet": -2.5, "outlet": 1.5}
SCENES = {
    "line": {},
    "fine line": {"mesh": NEAR | {"points_per_half_width": 200}},
    "strip": {"mesh": NEAR | {"points_per_half_width": 24, "width": 0.5}},
    "point": {
        "contact": {"radius": [0.0095, 0.0095], "load": 20.0, "material": "16MnCr5"},
        "mesh": NEAR | {"points_per_half_width": 16},
    },
}


def over_first(case: dict, names: tuple[str, ...]) -> np.ndarray:
    """Scalars of every state of a run over those of the steady start, shape (states, names)."""
    values = [[state.scalars[name] for name in names] for state in Simulation(load(case))]
    return np.array(values) / values[0]


@pytest.mark.parametrize("courant", [4.0, 16.0, 100.0])
@pytest.mark.parametrize("scene", SCENES)
def test_a_steady_film_stays(scene, courant):
    case = LINE | SCENES[scene]
    travel = 7.5 * courant / case["mesh"]["points_per_half_width"]
    found = over_first(case | {"time": {"courant": courant, "travel": travel}}, ("film_central", "h_min"))
    assert len(found) > 5
    np.testing.assert_allclose(found, 1.0, atol=1e-6)


@pytest.mark.parametrize("courant", [4.0, 100.0])
@pytest.mark.parametrize("scene", ["line", "point", "strip"])
def test_a_heated_film_stays(scene, courant):
    case = LINE | SCENES[scene] | {"heat": {"bulk_temperature": 333.0}}
    travel = 7.5 * courant / case["mesh"]["points_per_half_width"]
    names = "film_central", "h_min", "friction_coefficient"
    found = over_first(case | {"time": {"courant": courant, "travel": travel}}, names)
    np.testing.assert_allclose(found[:, :2], 1.0, atol=1e-3)
    np.testing.assert_allclose(found[:, 2], 1.0, atol=5e-3)


def test_a_steady_film_stays_in_unequal_steps():
    simulation = Simulation(load(LINE | {"time": {"courant": 1.0, "travel": 10.0}}))
    first = simulation.advance()
    for nodes in (1.5, 8.0, 3.0, 40.0, 1.1, 2.0):
        state = simulation.advance(nodes * simulation.scales.dt)
        assert state.film_central == pytest.approx(first.film_central, rel=1e-6)
        assert state.h_min == pytest.approx(first.h_min, rel=1e-6)


@pytest.mark.parametrize("scene", ["line", "point"])
def test_the_smooth_film_stays_below_moving_roughness(scene):
    """The deviation follows the path: waves of a picometre are 5e-6 of the film."""
    wave = {"synthetic": {"kind": "sine", "amplitude": 1e-12, "wavelength": 40e-6}}
    case = LINE | SCENES[scene] | {"time": {"courant": 8.0, "travel": 3.0}, "surface": {"1": wave}}
    np.testing.assert_allclose(over_first(case, ("film_central", "h_min")), 1.0, atol=2e-5)
    heated = over_first(case | {"heat": {"bulk_temperature": 333.0}}, ("film_central", "h_min"))
    np.testing.assert_allclose(heated, 1.0, atol=1e-3)


def films_over_time(case: dict) -> tuple[np.ndarray, np.ndarray, int]:
    """Times, central and minimum films of a run, and its Newton iterations."""
    states = [state.scalars for state in Simulation(load(case))]
    films = np.array([[s["film_central"], s["h_min"]] for s in states])
    return np.array([s["time"] for s in states]), films, sum(s["newton"] for s in states)


@pytest.mark.slow
def test_conditions_over_time_in_steps_of_ten_nodes():
    """Load by 1 % at 1 kHz and speeds by 30 % at 250 Hz: films of one node a step, by a fifth of the work."""
    time = np.linspace(0.0, 4e-3, 161)
    speed = 1.4137 * (1.0 + 0.3 * np.sin(2.0 * np.pi * 250.0 * time))
    operation = {
        "time": list(time),
        "load": list(200e3 * (1.0 + 0.01 * np.sin(2.0 * np.pi * 1000.0 * time))),
        "speed_1": list(1.25 * speed),
        "speed_2": list(0.75 * speed),
    }
    case = {key: values for key, values in LINE.items() if key != "motion"} | {"operation": operation}
    exact_time, exact, iterations = films_over_time(case | {"time": {"courant": 1.0, "travel": 60.0}})
    for steps, bound, work in (
        ({"courant": 10.0}, 0.003, 0.25),
        ({"courant": 30.0}, 0.008, 0.1),
        ({"courant": 100.0, "tolerance": 1e-3}, 0.003, 0.25),
    ):
        times, films, newton = films_over_time(case | {"time": steps | {"travel": 60.0}})
        expected = np.array([np.interp(times, exact_time, film) for film in exact.T]).T
        np.testing.assert_allclose(films, expected, rtol=bound)
        assert newton < work * iterations


def wave_amplitudes(courant: float) -> tuple[float, float]:
    """Root mean squares of the waves of film and pressure under the middle of a rolling contact."""
    wave = {"synthetic": {"kind": "sine", "amplitude": 5e-9, "wavelength": 43.7e-6}}
    mesh = NEAR | {"points_per_half_width": 64}
    rolling = {"entrainment_speed": 1.4137}
    case = LINE | {"mesh": mesh, "motion": rolling, "surface": {"1": wave}}
    simulation = Simulation(load(case | {"time": {"courant": courant, "travel": 6.0}}))
    smooth, *states = simulation
    middle = np.abs(simulation.scales.grid.coordinates[-1]) < 0.45
    late = states[len(states) * 3 // 4 :]
    film, pressure = (
        np.array([(getattr(state, name) - getattr(smooth, name))[middle] for state in late])
        for name in ("film_thickness", "pressure")
    )
    return float(film.std()), float(pressure.std())


def test_waves_that_pass_in_four_steps():
    """A wave of 16 nodes in steps of one and of four nodes."""
    (film, pressure), (of_long, pressure_of_long) = wave_amplitudes(1.0), wave_amplitudes(4.0)
    assert of_long == pytest.approx(film, rel=0.005)
    assert pressure_of_long == pytest.approx(pressure, rel=0.1)


@pytest.mark.parametrize("moved", [2.3, 8.0, -5.0, 11.0, -16.0])
def test_the_history_of_a_rough_film_keeps_mass_and_is_positive(moved):
    """Films of a thousandth to three times the smooth one, which enters and leaves."""
    x = np.linspace(-3.0, 3.0, 301)
    smooth = np.tile(0.2 + np.maximum(np.abs(x) - 1.0, 0.0) ** 1.5, (2, 1))
    random, inside = np.random.default_rng(3), np.abs(x) < 2.0
    m, m_older = (smooth * 10.0 ** (inside * random.uniform(-3.0, 0.5, smooth.shape)) for _ in range(2))
    levels = FilmLevels(m, m_older, 0.1, 0.1, moved, moved)
    of_smooth = levels._replace(m=smooth, m_older=smooth)
    change, change_of_smooth = (
        film_history(these, True, smooth).extrapolated - film_history(these, True).extrapolated
        for these in (levels, of_smooth)
    )
    assert film_history(levels, True, smooth).extrapolated.min() > 0.0
    # inside nothing is made or lost: the sum is that of what passes the ends
    assert change.sum() == pytest.approx(change_of_smooth.sum(), rel=1e-12)
    assert np.abs(change).sum() > 10.0 * abs(change.sum())


@pytest.mark.parametrize("varies", [False, True])
def test_rough_films_deviate_from_a_smooth_one_under_constant_conditions_alone(monkeypatch, varies):
    """In steps of two nodes; the smooth film of the start is not that of later conditions."""
    has_smooth = []

    def history(levels, is_rough, smooth, has_one_speed):
        has_smooth.append(smooth is not None)
        return film_history(levels, is_rough, smooth, has_one_speed)

    monkeypatch.setattr(time_stepping, "film_history", history)
    wave = {"synthetic": {"kind": "sine", "amplitude": 5e-9, "wavelength": 43.7e-6}}
    case = LINE | {"mesh": NEAR | {"points_per_half_width": 32}, "surface": {"1": wave}}
    case |= {"time": {"courant": 2.0, "travel": 1.0, "start": "rough"}}
    if varies:
        del case["motion"]
        case["operation"] = {"time": [0.0, 1e-3], "speed_1": [1.5, 1.2], "speed_2": [1.0, 1.0]}
    simulation = Simulation(load(case))
    assert [simulation.advance().step for _ in range(3)] == [0, 1, 2]
    assert has_smooth[-2:] == [not varies] * 2


def step_notes(courant: float, **changes: dict) -> list[str]:
    """Warnings of a case with waves of 16 nodes that name the Courant number."""
    wave = {"synthetic": {"kind": "sine", "amplitude": 5e-9, "wavelength": 43.7e-6}}
    mesh = NEAR | {"points_per_half_width": 64}
    case = (
        LINE | {"mesh": mesh, "surface": {"1": wave}, "time": {"courant": courant, "travel": 3.0}} | changes
    )
    case = load({key: values for key, values in case.items() if values is not None})
    return [note for note in warnings(case, Scales.of(case)) if "time.courant" in note]


def test_waves_in_fewer_than_four_steps_cause_a_warning():
    """The faster surface moves by 1.25 C of the 16 nodes of its waves in a step."""
    assert step_notes(2.0) == []
    assert "surface.1: 100 %" in step_notes(4.0)[0]


def test_roughness_in_long_steps_under_varying_conditions_causes_a_warning():
    speeds = {"time": [0.0, 1e-3], "speed_1": [1.5, 1.2], "speed_2": [1.0, 1.0]}
    assert step_notes(1.0, motion=None, operation=speeds) == []
    assert "2 times coarser" in step_notes(2.0, motion=None, operation=speeds)[0]


def step_of(values: list[np.ndarray], dt: float, dt_older: float, rate: np.ndarray) -> np.ndarray:
    """BDF2 step from two earlier values, the latest first, with a rate at its end."""
    k = dt / (dt + dt_older)
    return (values[0] + k * values[0] + k * dt / dt_older * (values[0] - values[1]) + dt * rate) / (1.0 + k)


def test_error_estimate_is_the_local_error_of_a_cubic():
    times = [2.0, 1.6, 1.3, 0.5]
    films = [np.full(5, 7.0) + t**3 for t in times]
    found = step_of(films[1:], times[0] - times[1], times[1] - times[2], np.full(5, 3.0 * times[0] ** 2))
    expected = abs(found[0] - films[0][0]) / films[0][0]
    assert film_error(films, times, np.ones(5)) == pytest.approx(expected, rel=1e-12)
    assert film_error(films[:3], times[:3], np.ones(5)) is None


def test_steps_of_a_restart_are_those_of_the_whole_run(tmp_path):
    """The estimate of the last step is in the restart file."""
    speeds = {"time": [0.0, 1e-3, 2e-3], "speed_1": [1.5, 2.2, 1.5], "speed_2": [1.0, 1.0, 1.0]}
    case = load(
        {key: of for key, of in LINE.items() if key != "motion"}
        | {"operation": speeds, "time": {"courant": 50.0, "tolerance": 1e-3, "travel": 60.0}}
    )
    whole = Simulation(case)
    for _ in range(9):
        whole.advance()
    save(tmp_path / "a.restart.h5", whole, np.zeros(whole.scales.grid.n, int), {})
    again = Simulation(case)
    checkpoint, _ = load_checkpoint(tmp_path / "a.restart.h5", case, again.scales)
    again.resume(checkpoint.state, checkpoint.baseline)
    lengths = [[one.advance().scalars["dt"] for _ in range(5)] for one in (whole, again)]
    assert lengths[0] == lengths[1]
    assert max(lengths[0]) > 5.0 * whole.scales.dt


def test_tolerance_under_constant_conditions_is_refused():
    with pytest.raises(CaseError, match=r"time.tolerance: allowed: with \[operation\] or \[gears\]"):
        Simulation(load(LINE | {"time": {"courant": 10.0, "tolerance": 1e-3, "travel": 3.0}}))


def reversal(outlet: float, end: float) -> list[str]:
    """Warnings of a border of entrainment that falls from 1 to -1 m/s between 1 and 3 ms."""
    speeds = {
        "time": [0.0, 1e-3, 3e-3, end],
        "speed_1": [1.2, 1.2, -0.8, -0.8],
        "speed_2": [0.8, 0.8, -1.2, -1.2],
    }
    case = {key: of for key, of in LINE.items() if key != "motion"} | {"operation": speeds}
    case = load(case | {"mesh": {"inlet": -outlet, "outlet": outlet, "points_per_half_width": 30}})
    return [note for note in warnings(case, Scales.of(case)) if "reverses" in note]


def test_border_whose_oil_arrives_late_after_a_reversal_causes_a_warning():
    assert reversal(2.6, 6e-3) == []
    assert "mesh.outlet = 3, arrives after 2 of the 18 half-widths" in reversal(3.0, 6e-3)[0]
    assert "does not arrive within the 3.35 half-widths" in reversal(12.0, 3.05e-3)[0]
