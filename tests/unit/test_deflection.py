"""The deflection in second differences and as one integral: the same equations."""

import itertools
from pathlib import Path

import numpy as np
import pytest

from ehlpetsc.case.loading import load
from ehlpetsc.discretisation.deflection import Deflection
from ehlpetsc.discretisation.ehl_problem import EHLProblem
from ehlpetsc.discretisation.far_pressures import FarPressures
from ehlpetsc.discretisation.interleaving import firsts
from ehlpetsc.physics.film_formulas import expected_film
from ehlpetsc.physics.scales import Scales

CASE = Path(__file__).parents[2] / "cases" / "table1_smooth.toml"
N, DX = 137, 0.021


@pytest.mark.parametrize("seed", [0, 1])
def test_the_integral_fulfils_the_second_differences(seed):
    """Any pressure, smooth or not: the film of the integral form leaves no residual in any row."""
    rng = np.random.default_rng(seed)
    p, approach = rng.uniform(-1.0, 3.0, N), -0.7
    d = Deflection(N, DX, 0, N)
    rows, load = d.rows(approach + d.integral(p), p, approach)
    terms = d.stretch * np.abs(d.integral(p)).max()
    assert np.abs(rows).max() < 1e-12 * terms
    assert load == pytest.approx(DX * p.sum(), rel=1e-14)


def test_the_second_differences_fulfil_the_integral():
    """The rows solved for the separation give the film of the integral: nothing is lost in differencing."""
    rng = np.random.default_rng(3)
    p, approach = rng.uniform(0.0, 2.0, N), 0.4
    d = Deflection(N, DX, 0, N)
    by_separation = np.array([d.rows(unit, np.zeros(N), 0.0)[0] for unit in np.eye(N)]).T
    found = np.linalg.solve(by_separation, -d.rows(np.zeros(N), p, approach)[0])
    np.testing.assert_allclose(found, approach + d.integral(p), rtol=0, atol=1e-9)


@pytest.mark.parametrize("cuts", [(0, 50, N), (0, 50, 90, N), (0, 16, 32, 60, 77, 101, 120, N)])
def test_parts_of_the_mesh_have_the_rows_of_the_whole(cuts):
    """Each knows its window, and of all beyond only the moments that the others tell."""
    rng = np.random.default_rng(4)
    g, p = rng.standard_normal((2, N))
    rows, load = Deflection(N, DX, 0, N).rows(g, p, 0.3)
    parts = [Deflection(N, DX, *ends) for ends in itertools.pairwise(cuts)]
    far = [FarPressures(part, cuts, k) for k, part in enumerate(parts)]
    told = np.full((len(parts), far[0].told), np.nan)  # all of it is filled in
    for one, d, its in zip(far, parts, told, strict=True):
        one.tell(p[d.first : d.last], its)
    for k, d in enumerate(parts):
        mine, whole_load = d.rows(g[d.window], p[d.window], 0.3, far[k].outside(told))
        np.testing.assert_allclose(mine, rows[d.first : d.last], rtol=0, atol=1e-11)
        assert whole_load == pytest.approx(load, rel=1e-13)


@pytest.mark.parametrize("model", ["direct", "mixed"])
def test_the_problems_film_leaves_no_residual_in_its_deflection_rows(model):
    """Parabola, roughness, approach and deflection as `EHLProblem.film` has them, against its residual."""
    mesh = ["mesh.points_per_half_width=32", f"contact.model='{model}'"]
    case = load(CASE, mesh)
    scales = Scales.of(case)
    problem = EHLProblem(case, scales, expected_film(case, scales), 0, scales.nx)
    rng = np.random.default_rng(5)
    q, phi, h00 = rng.uniform(0.1, 1.5, scales.nx), 1e-3 * rng.standard_normal(scales.nx), 9.0
    film = problem.film(q, h00, phi)
    assert film.min() > 0.0
    evaluation = problem.evaluate(q, problem.model.w_from_film(film), h00, problem.inputs(phi))
    terms = problem.deflection.stretch * film.max()
    assert np.abs(firsts(evaluation.residual, problem.n)).max() < 1e-12 * terms
