"""Smooth Newtonian films of an incompressible Barus fluid against dimensionless reference values.

Points per half-width and what they give, H_min and H_c:

====  ================  =================
a/dx  M = 20, L = 10    M = 100, L = 11
====  ================  =================
100   3.9512, 5.2478    3.3635, 4.5235
200   3.9613, 5.2583    3.4501, 4.6229
400   3.9648, 5.2609    3.4770, 4.6480
800   3.9658, 5.2616    3.4839, 4.6543
====  ================  =================

With the inlet at -8 instead of -4 half-widths the lighter load gives 0.26 % more film, the heavier 0.03 %.
"""

import numpy as np
import pytest
from support.convergence import observed_order
from support.driving import Scene
from support.published_values import MOES_POINTS

LIGHT, HEAVY = MOES_POINTS
SETTINGS = {LIGHT: (), HEAVY: ("contact.load=2.09915459e6", "fluid.viscosity=0.01014206817")}


def films(point, points):
    """H_min and H_c, and the scales."""
    scene = Scene("moes.toml", *SETTINGS[point], f"mesh.points_per_half_width={points}").start()
    s = scene.scales
    unit = s.R * np.sqrt(2.0 * s.eta0 * s.u / (s.E * s.R))
    return scene.film.min() / unit, scene.film[scene.centre] / unit, s


@pytest.mark.parametrize("point, points", [(LIGHT, 200), (HEAVY, 400)])
def test_film_within_half_a_percent(point, points):
    h_min, h_central, s = films(point, points)
    assert (s.moes_m, s.moes_l) == pytest.approx((point.M, point.L), rel=1e-6)
    assert h_min == pytest.approx(point.h_min, rel=5e-3)
    assert h_central == pytest.approx(point.h_central, rel=5e-3)


def test_film_converges_to_the_reference_value():
    """Errors against the value itself at a/50, a/100, a/200, a/400: a wrong limit would spoil the slope."""
    found = np.array([films(HEAVY, points)[:2] for points in (50, 100, 200, 400)])
    error_min, error_central = np.abs(found / (HEAVY.h_min, HEAVY.h_central) - 1.0).T
    assert observed_order(error_min) > 1.5
    assert observed_order(error_central) > 1.8
