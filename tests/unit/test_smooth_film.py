"""Smooth films: formulas of points against computed films; the film behind a result's lambda ratio."""

import sys

import numpy as np
import pytest
from support import CASES

from ehlpetsc.case.loading import load
from ehlpetsc.physics.contact.films import POINT_COMPRESSION, fit_terms, fitted_point_films
from ehlpetsc.physics.film_formulas import smooth_films
from ehlpetsc.physics.scales import Scales
from ehlpetsc.run.simulation import Simulation

sys.path.append(str(CASES / "paper"))
import measured_data

BALL = {
    "title": "Ball",
    "contact": {"radius": [0.01, 0.01], "load": 100.0, "material": "100Cr6"},
    "fluid": {
        "viscosity": 0.02,
        "law": "roelands",
        "pressure_viscosity": 18e-9,
        "density": "dowson-higginson",
    },
    "motion": {"entrainment_speed": 3.0},
    "mesh": {"inlet": -4.0, "outlet": 1.5, "points_per_half_width": [32, 20]},
}


def test_films_of_points_are_within_a_tenth_of_computed_ones():
    stored = measured_data.read("point_films.csv").columns
    groups = zip(*(stored[name] for name in ("M", "L", "ratio")), strict=True)
    found = np.array([fitted_point_films(*group) for group in groups])
    for films, name, exponent in zip(found.T, ("central", "minimum"), POINT_COMPRESSION, strict=True):
        np.testing.assert_allclose(films * stored["density"] ** -exponent, stored[name], rtol=0.1)
    for name, (low, high) in {"M": (20, 8000), "L": (2, 15), "ratio": (0.2, 10)}.items():
        assert stored[name].min() == low and stored[name].max() == high
    assert len(stored["M"]) > 80
    for ratio, highest in ((0.2, 2500), (0.5, 8000), (1.0, 8000)):
        assert stored["M"][stored["ratio"] == ratio].max() == highest


def test_films_of_points_continue_beyond_their_range():
    """Rigid bodies: the limit itself. Beyond M, L and ratio: factors of the nearest ones of the range."""
    central, minimum = fitted_point_films(0.01, 5.0, 1.0)
    assert central == pytest.approx(minimum, rel=0.02)
    for group, near in (((2e4, 5.0, 1.0), (8e3, 5.0, 1.0)), ((5e3, 5.0, 30.0), (5e3, 5.0, 10.0))):
        ratios = [np.array(fitted_point_films(*of)) / fit_terms(*of)[0] for of in (group, near)]
        assert ratios[0] == pytest.approx(ratios[1], rel=1e-3)


@pytest.mark.parametrize("across", [0.005, 0.01, 0.04])
def test_expected_films_of_a_point_are_those_of_the_solver(across):
    case = load(BALL | {"contact": BALL["contact"] | {"radius": [0.01, across]}})
    scales = Scales.of(case)
    central, minimum = smooth_films(scales, case.fluid, scales.conditions)
    state = Simulation(case).advance()
    film = state.film_thickness.flat[np.argmin(scales.grid.distance)]
    assert central == pytest.approx(film, rel=0.1) and minimum == pytest.approx(state.h_min, rel=0.12)


ROUGH = {"mesh.inlet": -1.4, "mesh.outlet": 1.3, "mesh.points_per_half_width": 100, "time.travel": 0.1}
STARVED = {"fluid.inlet_film": 60e-9}


@pytest.mark.parametrize(
    ("changes", "is_computed"),
    [
        ({}, True),
        (STARVED, True),
        ({"time.start": "rough"}, True),
        ({"mesh.points_per_half_width": 25}, False),
        ({"contact.model": "mixed", "contact.asperity_height": 0.2e-6}, False),
        ({"time": None}, False),
    ],
)
def test_lambda_ratio_takes_the_smooth_film_of_the_start_where_it_is_one(changes, is_computed):
    """Not on a mesh too coarse for the inlet, nor over a layer that carries, nor with roughness at rest."""
    case = load(CASES / "table1_rough.toml", ROUGH | changes)
    simulation = Simulation(case)
    film = simulation.advance().lambda_ratio * simulation.scene.rq
    expected = smooth_films(simulation.scales, case.fluid, simulation.scales.conditions)[1]
    if is_computed:
        smooth = load(CASES / "table1_rough.toml", ROUGH | changes | {"surface": None, "time": None})
        expected = Simulation(smooth).advance().h_min
    assert film == pytest.approx(expected, rel=1e-4)
