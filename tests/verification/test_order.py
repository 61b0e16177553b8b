"""Orders of accuracy in space, in time and in both on a full-film transient.

A ridge of 0.1 um, 0.8 half-widths wide, on the slower surface enters a film of 0.53 um and is followed until
it fills the contact. Compared are successive refinements by two, at the nodes of the coarsest mesh within
-1 <= x/a <= 0.5, which leaves out the rupture of the film near x = 1.15 a; norm: root mean square.

Found, fitted over three refinements, of both over two:

=====  =====  ========
over   film   pressure
=====  =====  ========
space  1.992  2.043
time   1.899  1.826
both   1.985  2.111
=====  =====  ========
"""

from functools import cache

import numpy as np
import pytest
from support.convergence import observed_order
from support.driving import Scene

COARSEST = 16  # points per half-width
WINDOW = (-1.0, 0.5)
TRAVEL = 2.5  # half-widths, of the mean speed
SCENE = (
    "contact.load=130e3",
    "motion.entrainment_speed=25",
    "mesh.inlet=-1.75",
    "mesh.outlet=1.5",
    "surface.2.synthetic={kind='ridge', amplitude=0.1e-6, wavelength=133e-6, position=133e-6}",
)


@cache
def solution(points, steps):
    """Film [um] and pressure [p0] in the window at the end, and how near the schemes came to their limiter.

    The limiter of :func:`positive_extrapolation` acts where the mass per area halves within a
    cell or a step: the last value is the least ratio, full film up to the end of the window.
    """
    scene = Scene("ridge.toml", f"mesh.points_per_half_width={points}", *SCENE).start()
    s = scene.scales
    scene.solver.snes.setTolerances(atol=1e-11)  # two thousandths of the smallest difference
    upstream = s.x <= WINDOW[1]
    ratio = 1.0
    for state in scene.steps(steps, TRAVEL * s.a / s.u / steps):
        m = state.m[upstream]
        assert (state.q[upstream][1:] > 0.0).all()
        ratio = min(ratio, (m[1:] / m[:-1]).min(), (m / state.m_older[upstream]).min())
    every = points // COARSEST
    x = s.x[::every]
    inside = (x >= WINDOW[0]) & (x <= WINDOW[1])
    return 1e6 * scene.film[::every][inside], scene.pressure[::every][inside] / s.p0, ratio


def orders(solutions):
    """Observed orders of film and pressure from the differences of successive solutions."""
    assert min(ratio for _, _, ratio in solutions) > 0.5
    pairs = list(zip(solutions, solutions[1:], strict=False))
    norms = [[np.sqrt(np.mean((coarse[k] - fine[k]) ** 2)) for coarse, fine in pairs] for k in (0, 1)]
    return [observed_order(differences) for differences in norms]


@pytest.mark.slow
@pytest.mark.parametrize(
    "refinements",
    [
        pytest.param([(n, 40) for n in (16, 32, 64, 128)], id="space"),
        pytest.param([(16, n) for n in (80, 160, 320, 640)], id="time"),
        pytest.param([(n, 5 * n) for n in (16, 32, 64)], id="both"),
    ],
)
def test_second_order(refinements):
    film, pressure = orders([solution(points, steps) for points, steps in refinements])
    print(f"observed order: film {film:.3f}, pressure {pressure:.3f}")
    assert film >= 1.8
    assert pressure >= 1.8
