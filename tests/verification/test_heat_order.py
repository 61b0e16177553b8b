"""Order of accuracy in time of film and temperatures: a ridge passes through a full film at 25 m/s.

The scene of test_order.py with a slide/roll ratio of 0.5 and heat, a/32, successive steps halved; norm: root
mean square within -1 <= x/a <= 0.5.

Found, fitted over three refinements: film 1.97, film temperature 1.83, surfaces 1.88 and 1.86.
"""

import numpy as np
import pytest
from support.driving import Scene

from ehlpetsc.study.convergence import observed_order

TRAVEL = 2.5  # half widths, of the mean speed
STEPS = (40, 80, 160, 320)
SCENE = (
    "mesh.points_per_half_width=32",
    "contact.load=130e3",
    "motion.entrainment_speed=25",
    "motion.slide_roll_ratio=0.5",
    "mesh.inlet=-1.75",
    "mesh.outlet=1.5",
    "surface.2.synthetic={kind='ridge', amplitude=0.1e-6, wavelength=133e-6, position=133e-6}",
    "heat.bulk_temperature=363.0",
)


def solution(steps):
    """Film [um], and temperatures of the film and of both surfaces [K], at the end."""
    scene = Scene("ridge.toml", *SCENE).start()
    s = scene.scales
    scene.solver.snes.setTolerances(atol=1e-11)
    for state in scene.steps(steps, TRAVEL * s.a / s.u / steps):
        record = state.records["heat"]
    inside = (s.x >= -1.0) & (s.x <= 0.5)
    return [v[inside] for v in (1e6 * scene.film, record.film, record.wall_1, record.wall_2)]


@pytest.mark.slow
def test_order_in_time():
    solutions = [solution(steps) for steps in STEPS]
    pairs = list(zip(solutions, solutions[1:], strict=False))
    norms = [[np.sqrt(np.mean((a[k] - b[k]) ** 2)) for a, b in pairs] for k in range(4)]
    assert norms[1][0] > 0.01  # K: there is something to converge
    assert min(observed_order(differences) for differences in norms) >= 1.8
