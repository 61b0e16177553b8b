"""Stiffness, damping and electrical capacitance of a smooth ball in oil."""

import numpy as np
import pytest
from support import CASES

from ehlpetsc.__main__ import main
from ehlpetsc.case.loading import load
from ehlpetsc.run.simulation import Simulation
from ehlpetsc.run.stiffness import fitted, quasi_static, response

SMALL = {"mesh": {"inlet": -2.0, "outlet": 1.5, "width": 4.0, "points_per_half_width": 10}}


def test_amplitude_of_a_wave():
    """A delay by a quarter of a period makes the amplitude of a sine real."""
    time, omega = np.linspace(0.0, 3.0, 100), 4.2
    amplitude, misfit = fitted(time, 7.0 + 0.3 * np.cos(omega * time - 0.5), omega)
    assert amplitude == pytest.approx(0.3 * np.exp(-0.5j), rel=1e-12)
    assert misfit < 1e-12


@pytest.mark.slow
def test_slow_loads_have_the_stiffness_of_steady_ones_and_fast_ones_less_damping():
    case = load(CASES / "optical.toml", SMALL)
    still, slow, fast = quasi_static(case, 0.01), response(case, 20.0, 0.01), response(case, 2000.0, 0.01)
    assert slow.stiffness == pytest.approx(still.stiffness, rel=1e-3)
    assert 1.03 < fast.stiffness / still.stiffness < 1.08
    dry = 1.5 * 20.0 / Simulation(load(CASES / "optical.toml", SMALL | {"fluid": None})).advance().approach
    assert 0.8 * dry < still.stiffness < 1.2 * dry
    assert 0.0 < fast.damping < slow.damping
    assert max(slow.misfit, fast.misfit) < 0.02


@pytest.mark.parametrize(
    "changes, message",
    [
        (
            [
                "contact.radius=0.01",
                "contact.load=2e5",
                "mesh={inlet=-2, outlet=1.5, points_per_half_width=10}",
            ],
            "a line",
        ),
        (["fluid={}"], "oil"),
        (["surface.1.synthetic={kind='sine', amplitude=1e-9, wavelength=1e-4}", "time.travel=1"], "smooth"),
    ],
)
def test_contacts_without_an_approach_of_their_own_are_refused(changes, message, capsys):
    words = [word for change in changes for word in ("--set", change)]
    assert main(["stiffness", str(CASES / "optical.toml"), *words]) == 2
    assert message in capsys.readouterr().err


def test_capacitance_is_that_of_plates_with_the_field_of_films():
    """Oil of 2.2 between plates as far apart as the film, of a mesh with its own film everywhere."""
    state = Simulation(load(CASES / "optical.toml", SMALL | {"fluid.permittivity": 2.2})).advance()
    film, void = state.film_thickness, state.void_fraction
    x, y = (np.linspace(-2.0, 1.5, film.shape[1]), np.linspace(-2.0, 2.0, film.shape[0]))
    a = Simulation(load(CASES / "optical.toml", SMALL)).scales.a
    cell = (x[1] - x[0]) * (y[1] - y[0]) * a * a
    expected = 8.8541878188e-12 * cell * ((1.0 + 1.2 * (1.0 - void)) / film).sum()
    assert state.capacitance == pytest.approx(expected, rel=1e-6)
    assert 1.5 < state.capacitance_ratio < 11.0
