"""Order of accuracy in time and space of film and temperatures: a ridge passes through a full film at 25 m/s.

The scene of test_order.py with a slide/roll ratio of 0.5 and heat; norm: root mean square within
-1 <= x/a <= 0.5. In time successive steps are halved on a/128, of four nodes, two and one, in space
successive meshes with 40 steps.
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


@pytest.mark.slow
@pytest.mark.parametrize(
    "setups",
    [[(MESHES[-1], 2 * steps) for steps in STEPS], [(points, STEPS[0]) for points in MESHES]],
    ids=["time", "space"],
)
def test_second_order(setups):
    solutions = [solution(*setup) for setup in setups]
    pairs = list(zip(solutions, solutions[1:], strict=False))
    norms = [[np.sqrt(np.mean((a[k] - b[k]) ** 2)) for a, b in pairs] for k in range(4)]
    assert norms[1][0] > 0.002  # K: there is something to converge
    orders = [observed_order(differences) for differences in norms]
    # where a temperature has an extreme along the path of the film its limiter is of first order
    assert min(orders) >= 1.55, orders
    in_time = len({points for points, _ in setups}) == 1
    # in time the film changes by less than 1e-4 of itself, in the order of the temperatures
    assert norms[0][0] < 1e-4 * solutions[0][0].mean() if in_time else orders[0] >= 1.8
