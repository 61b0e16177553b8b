"""Order of accuracy in time and space of film and temperatures: a ridge passes through a full film at 25 m/s.

The scene of test_order.py with a slide/roll ratio of 0.5 and heat; norm: root mean square within
-1 <= x/a <= 0.5. In time successive steps are halved, on a/32 of one node, a half and a quarter, on a/128 of
eight, four and two, in space successive meshes with 40 steps.
"""

import numpy as np
import pytest
from support.convergence import observed_order
from support.driving import Scene

TRAVEL = 2.5  # half-widths, of the mean speed
STEPS = (40, 80, 160)
MESHES = (32, 64, 128)  # points per half-width
SCENE = (
    "contact.load=130e3",
    "motion.entrainment_speed=25",
    "motion.slide_roll_ratio=0.5",
    "mesh.inlet=-1.75",
    "mesh.outlet=1.5",
    "surface.2.synthetic={kind='ridge', amplitude=0.1e-6, wavelength=133e-6, position=133e-6}",
    "heat.bulk_temperature=363.0",
)


def solution(points, steps):
    """Film [um], and temperatures of the film and of both surfaces [K], at the end, at the nodes of a/32."""
    scene = Scene("ridge.toml", f"mesh.points_per_half_width={points}", *SCENE).start()
    s = scene.scales
    scene.solver.snes.setTolerances(atol=1e-11)
    for state in scene.steps(steps, TRAVEL * s.a / s.u / steps):
        record = state.records["heat"]
    inside = np.flatnonzero((s.x >= -1.0 - 1e-9) & (s.x <= 0.5 + 1e-9))[:: points // MESHES[0]]
    return [v[inside] for v in (1e6 * scene.film, record.film, record.wall_1, record.wall_2)]


def orders(setups):
    """Changes of film and temperatures between successive solutions, their orders, and the mean film."""
    solutions = [solution(*setup) for setup in setups]
    pairs = list(zip(solutions, solutions[1:], strict=False))
    norms = [[np.sqrt(np.mean((a[k] - b[k]) ** 2)) for a, b in pairs] for k in range(4)]
    return np.array(norms), [observed_order(differences) for differences in norms], solutions[0][0].mean()


@pytest.mark.slow
def test_second_order_in_time():
    """In steps of one node and less that of the film, in steps above one that of the temperatures.

    Both have other differences of the steady film. Of the other quantities the orders are lower: of surface
    temperatures in short steps 0.8, of the film in long ones, where it hardly changes, 1.4.
    """
    _, (of_film, *_), _ = orders([(MESHES[0], 2 * steps) for steps in STEPS])
    norms, (_, *of_temperatures), film = orders([(MESHES[-1], steps) for steps in STEPS])
    assert of_film >= 1.8
    assert norms[1][0] > 0.004  # K: there is something to converge
    # where a temperature has an extreme along the path of the film its limiter is of first order
    assert min(of_temperatures) >= 1.55, of_temperatures
    assert norms[0][1] < 1e-4 * film


@pytest.mark.slow
def test_second_order_in_space():
    norms, (of_film, *of_temperatures), _ = orders([(points, STEPS[0]) for points in MESHES])
    assert norms[1][0] > 0.004
    assert of_film >= 1.8 and min(of_temperatures) >= 1.55
