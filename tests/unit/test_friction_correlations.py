"""Published friction correlations at the pitch point of FZG type C gears, and their units."""

import numpy as np
import pytest

from ehlpetsc.physics.friction_correlations import benedict_kelley, hoehn_michaelis, xu_kahraman

LOAD, SUM_SPEED, RADIUS, VISCOSITY, RA = 637.6e3, 6.583, 8.382e-3, 0.0112, 0.25e-6


def test_hoehn_michaelis_of_fzg_at_302_n_m():
    assert hoehn_michaelis(LOAD, SUM_SPEED, RADIUS, VISCOSITY, RA) == pytest.approx(0.0491, rel=1e-3)
    assert hoehn_michaelis(LOAD, SUM_SPEED, RADIUS, VISCOSITY, RA, 0.8) == pytest.approx(
        0.8 * 0.0491, rel=1e-3
    )


def test_hoehn_michaelis_of_light_loads_is_that_of_150_n_mm():
    light, least = (hoehn_michaelis(load, SUM_SPEED, RADIUS, VISCOSITY, RA) for load in (10e3, 150e3))
    assert light == least


@pytest.mark.parametrize("rms, friction", [(0.0, 0.018), (0.4e-6, 0.025)])
def test_xu_kahraman_of_fzg_at_302_n_m(rms, friction):
    pressure = 1.65e9  # Hertz, 637.6 N/mm on 8.38 mm
    found = xu_kahraman(pressure, np.array([0.2, 0.3]), 0.5 * SUM_SPEED, VISCOSITY, RADIUS, rms)
    assert found.mean() == pytest.approx(friction, rel=0.06)


def test_xu_kahraman_by_hand():
    # f = -8.916465 - 0.354068 * 0.24 + 2.812084 exp(-0.24) + 0.620305 exp(0.2) = -6.03187
    found = xu_kahraman(1.2e9, -0.2, 10.0, 0.01, 0.01, 0.2e-6)
    assert found == pytest.approx(
        np.exp(-6.03187) * 1.207257 * 0.188717 * 0.793235 * 5.659198 * 6.053413, rel=1e-4
    )


def test_benedict_kelley_in_its_imperial_units():
    # 0.0127 lg(3.17e8 w'/(nu v_s v_r^2)): lbf/in, mPa s, in/s
    imperial = 3.17e8 * LOAD / 175.1268 / (11.2 * (1.0 / 0.0254) * (SUM_SPEED / 0.0254) ** 2)
    expected = 0.0127 * np.log10(imperial)
    assert benedict_kelley(LOAD, 1.0, SUM_SPEED, VISCOSITY, 0.0) == pytest.approx(expected, rel=1e-4)
    rough = benedict_kelley(LOAD, 1.0, SUM_SPEED, VISCOSITY, RA)
    assert rough == pytest.approx(expected * 1.13 / 0.88, rel=1e-4)
