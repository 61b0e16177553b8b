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
