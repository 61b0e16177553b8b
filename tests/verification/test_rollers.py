"""Rollers with ends against lines of the local load, Lundberg's profile, converged films of ends."""

import copy

import numpy as np
import pytest
from support import roelands_oil

from ehlpetsc.case.loading import load
from ehlpetsc.run.simulation import Simulation

L, R, W = 12e-3, 6e-3, 2400.0
OIL = {
    "title": "a roller in oil",
    "contact": {"radius": R, "length": L, "load": W, "youngs_modulus": 207e9, "poisson_ratio": 0.3},
    "fluid": roelands_oil(0.02, 2e-8),
    "motion": {"entrainment_speed": 3.0},
    "mesh": {"inlet": -2.5, "outlet": 1.5, "points_per_half_width": [20, 100]},
}
OIL["contact"]["free_ends"] = False
ISO = {"kind": "iso", "diameter": 12e-3}


def arcs(radius, length=L):
    """Straight middle and arcs with a drop of 6.25 um at the ends."""
    return {"kind": "circular", "drop": 6.25e-6, "straight": length - 2.0 * (2.0 * radius * 6.25e-6) ** 0.5}


def solved(profile, rows=100, **tables):
    case = copy.deepcopy(OIL)
    case["contact"]["profile"] = profile
    case["mesh"]["points_per_half_width"] = [20, rows]
    simulation = Simulation(load({k: v for k, v in (case | tables).items() if v is not None}))
    return simulation.advance(), simulation.scales


def test_middle_of_a_roller_is_a_line_contact_of_its_load_and_inlet():
    state, scales = solved(ISO)
    film = state.film_thickness[99:101].mean(axis=0)
    size = np.sqrt(state.load_per_length_middle / (W / L))
    line = copy.deepcopy(OIL)
    line["contact"] = {key: OIL["contact"][key] for key in ("radius", "youngs_modulus", "poisson_ratio")}
    line["contact"]["load"] = state.load_per_length_middle
    ends = {"inlet": -2.5 / size, "outlet": 1.5 / size}
    line["mesh"] = ends | {"points_per_half_width": round(20 * size)}
    assert 20 * size == pytest.approx(24.0, abs=0.06)  # the same spacing
    alone = Simulation(load(line)).advance()
    middle = np.argmin(np.abs(scales.x))
    assert film[middle] == pytest.approx(alone.film_thickness[round(2.5 / size * 24)], rel=1e-3)
    assert film.min() == pytest.approx(alone.h_min, rel=1e-3)
    assert 1e6 * film[middle] == pytest.approx(0.2709, rel=1e-3)


def test_load_is_even_along_lundbergs_profile():
    dry = {"fluid": None, "motion": None, "mesh": OIL["mesh"] | {"inlet": -1.3, "outlet": 1.3}}
    state, scales = solved({"kind": "lundberg"}, **dry)
    y = scales.grid.axes[0] * scales.a
    w = state.pressure.sum(axis=1) * scales.spacing
    inner = np.abs(y) < 0.9 * 0.5 * L
    assert np.abs(w[inner] / w[len(w) // 2] - 1.0).max() < 5e-3


def test_ends_close_as_the_radius_of_the_arcs_falls():
    """As on optical maps of 1967 and in a taper roller of 1974."""
    closures = [solved(arcs(radius))[0].film_of_ends for radius in (0.08, 0.32, 1.28)]
    assert closures[0] < closures[1] < closures[2]
    assert closures == pytest.approx([0.934, 0.971, 0.9985], abs=5e-3)


@pytest.mark.slow
@pytest.mark.parametrize(("radius", "highest", "thinnest"), [(0.32, 4.185, 4.425), (0.08, 5.115, 5.115)])
def test_pressure_and_film_have_their_extremes_where_the_profile_starts(radius, highest, thinnest):
    """As published for finite lines with heat in 2002; the profile starts 4 and 5 mm from the middle."""
    state, scales = solved(arcs(radius), 200)
    y = 1e3 * scales.a * np.abs(scales.grid.axes[0])
    found = y[state.pressure.max(axis=1).argmax()], y[state.film_thickness.min(axis=1).argmin()]
    assert found == pytest.approx((highest, thinnest), abs=0.035)  # a row


def test_film_of_the_ends_converges_with_the_rows():
    """Rows of 60 um; of 7.5 um on a quarter of the roller with its load per length: the same ends."""
    assert 1e6 * solved(arcs(0.02))[0].h_min == pytest.approx(0.109, rel=2e-2)
    shorter = OIL["contact"] | {"length": 0.25 * L, "load": 0.25 * W, "profile": arcs(0.02, 0.25 * L)}
    mesh = OIL["mesh"] | {"points_per_half_width": [20, 200]}
    state = Simulation(load(OIL | {"contact": shorter, "mesh": mesh})).advance()
    assert 1e6 * state.h_min == pytest.approx(0.186, rel=1e-2)  # the whole roller: 0.1856; limit 0.1860
