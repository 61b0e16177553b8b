"""Errors, estimated uncertainty and picture of the program that measures error over run time."""

import numpy as np
import pytest
from benchmarks import accuracy


def measured(error, contact=0.0):
    x, more = np.linspace(-1.5, 1.5, 31), 1.0 + error
    film = 0.2 * more * np.ones(31)
    return accuracy.Measured({}, x, film, 0.1 * more, 0.2 * more, 1e9 * (1.0 - error), contact, np.nan)


def test_errors_are_relative_and_local():
    found = accuracy.errors(measured(0.02, 1.1), measured(0.0, 1.0))
    assert found == pytest.approx(
        {"h_min": 0.02, "h_c": 0.02, "p_max": 0.02, "film": 0.02, "contact": 0.1, "damage": np.nan},
        nan_ok=True,
    )


def test_uncertainty_of_second_order_is_a_third_of_the_last_change():
    found = accuracy.uncertainty(measured(0.0), measured(0.03), measured(0.15))
    assert found["h_c"] == pytest.approx(0.03 / 3.0)


def test_picture_shows_errors_over_both_costs(tmp_path):
    """Runs that failed are left out; the case as it is has a star, the error of the reference a line."""
    rows = [
        {"varied": "reference", "value": "", "wall_s": 9.0, "newton": 50, "h_min": 1e-5},
        {"varied": "", "value": "as it is", "wall_s": 1.0, "newton": 9, "h_min": 1e-3},
        {"varied": "mesh", "value": 100, "wall_s": 0.8, "newton": 8, "h_min": 2e-3},
        {"varied": "mesh", "value": 50, "wall_s": 0.3, "newton": 7, "h_min": 1e-2},
        {"varied": "mesh", "value": 200, "converged": "no"},
    ]
    rows = [dict.fromkeys(accuracy.COLUMNS, np.nan) | {"converged": "yes"} | row for row in rows]
    figure = accuracy.draw(rows, tmp_path / "picture.png", "title")
    assert (tmp_path / "picture.png").stat().st_size > 1000 and len(
        figure.axes
    ) == 2  # h_min alone has values
    for axes, costs, own in zip(figure.axes, ([0.3, 0.8], [7, 8]), (1.0, 9), strict=True):
        mesh, star, uncertainty = axes.lines
        np.testing.assert_allclose(mesh.get_xydata(), np.column_stack([costs, [1e-2, 2e-3]]))
        np.testing.assert_allclose(star.get_xydata(), [[own, 1e-3]])
        np.testing.assert_allclose(uncertainty.get_ydata(), 1e-5)
