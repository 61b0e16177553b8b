"""Load along a roller: lamina model, edge factors, moment and life, printed and stored."""

import numpy as np
import pytest

import ehlpetsc
from ehlpetsc.physics.contact.roller_loads import RollerLoads, lamina_load, life_factor
from ehlpetsc.run.forecast.kinds import ROLLER

L, R, W, E = 12e-3, 6e-3, 2400.0, 2.274725e11
ROWS = 600
DY = L / ROWS
Y = (np.arange(ROWS) - 0.5 * (ROWS - 1)) * DY
ISO = -4.2e-6 * np.log1p(-((2 * Y / L) ** 2))
BLEND = 25.0 * np.maximum(np.abs(Y) - 5.5e-3, 0.0) ** 2


@pytest.mark.parametrize(
    ("gap", "mrad", "moment", "highest", "life"),
    [  # of two public codes with the formulas of the standard
        (ISO, 0.0, 0.0, 1.413, 0.496),
        (ISO, 0.2, 0.807, 1.426, 0.485),
        (ISO, 0.5, 1.985, 1.491, 0.434),
        (ISO, 1.0, 3.761, 1.682, 0.315),
        (ISO, 2.0, 6.329, 2.167, 0.151),
        (BLEND, 0.0, 0.0, None, 0.930),
        (BLEND, 0.5, 2.593, None, 0.573),
        (BLEND, 2.0, 7.884, None, 0.084),
    ],
)
def test_lamina_model_of_the_standard(gap, mrad, moment, highest, life):
    w = lamina_load(gap + 1e-3 * mrad * Y, DY, W, L, E)
    assert w.sum() * DY == pytest.approx(W, rel=1e-10)
    assert -(w * Y).sum() * DY == pytest.approx(moment, abs=2e-3)
    assert highest is None or w.max() * L / W == pytest.approx(highest, abs=2e-3)
    assert life_factor(w, DY, L) == pytest.approx(life, abs=2e-3)


def test_life_of_an_even_load_is_one_and_of_half_the_length_half_of_its_rating():
    even = np.full(ROWS, 2e5)
    assert life_factor(even, DY, L) == pytest.approx(1.0, rel=1e-12)
    half = np.where(Y > 0.0, 4e5, -1e-9)  # of rounding
    assert life_factor(half, DY, L) == pytest.approx((2.0**4.5 / 2.0) ** (-8.0 / 9.0), rel=1e-12)


def test_figures_of_a_roller():
    w = 2e5 * (1.0 - 0.5 * Y / (0.5 * L))
    highest = np.sqrt(w * E / (2.0 * np.pi * R))
    highest[5] *= 1.5
    thinnest = np.where((np.abs(Y) > 3.5e-3) & (np.abs(Y) < 5e-3), 0.2e-6, 0.3e-6)
    loads = RollerLoads(Y, w, highest, thinnest, np.zeros(ROWS), L, R, E)
    assert loads.load == pytest.approx(W)
    p0 = np.sqrt(2e5 * E / (2.0 * np.pi * R))
    assert loads.edge_factor == pytest.approx(highest[5] / p0) and loads.local_edge_factor == pytest.approx(
        1.5
    )
    assert loads.edge_factor_inside == pytest.approx(np.sqrt(1.5 - 0.5 * 0.1159 / 6.0), rel=1e-3)
    assert loads.moment == pytest.approx(-2e5 / L * L**3 / 12.0, rel=1e-5)
    assert (loads.middle, loads.highest_at) == pytest.approx((2e5, Y[0]))
    assert loads.ends == pytest.approx((3e5, 1e5), rel=2e-3)
    assert loads.film_of_ends == pytest.approx(2.0 / 3.0)
    np.testing.assert_allclose(loads.lamina, 2e5, rtol=1e-9)


def test_run_stores_the_load_along_a_tilted_roller(tmp_path):
    case = {
        "title": "a tilted roller",
        "contact": {"radius": R, "length": L, "load": W, "material": "100Cr6", "tilt": 1e-3},
        "mesh": {"inlet": -1.9, "outlet": 1.9, "points_per_half_width": [8, 30]},
    }
    case["contact"] |= {"profile": {"kind": "iso", "diameter": 12e-3}, "free_ends": False}
    result = ehlpetsc.solve(case, output=tmp_path / "roller.h5")
    steps = result.steps
    assert steps.moment[-1] == pytest.approx(-4.2825, rel=3e-3)  # 30 um
    assert steps.moment_lamina[-1] == pytest.approx(-3.761, rel=3e-3)
    assert steps.edge_factor[-1] == pytest.approx(1.348, rel=5e-3)
    assert steps.load_per_length_max[-1] == pytest.approx(1.812 * W / L, rel=3e-3)
    assert steps.life_factor[-1] == pytest.approx(0.254, rel=1e-2)
    assert steps.load_per_length_end_1[-1] == 0.0
    w = result.load_per_length()
    assert w.sum() * (result.y[1] - result.y[0]) == pytest.approx(W, rel=1e-6)
    assert result.load_per_length(0.0) == pytest.approx(steps.load_per_length_middle[-1])
    np.testing.assert_allclose(result.load_per_length(result.y[3:5]), w[3:5])
    lines = ROLLER.found({name: steps(name)[-1] for name in result.scalars})
    assert "at the ends, largest 362" in lines[0] and "N/mm at y = -3.7 mm" in lines[0]
    assert "by the lamina model -3.752 N m; tilt 1 mrad, stiffness 428" in lines[2]
    assert result.roller().lamina_moment == pytest.approx(steps.moment_lamina[-1])
