r"""Thermal reduction of the film of smooth contacts against published formulas.

Film over the isothermal one, :math:`L=\beta\eta_0u^2/k_f`, slide/roll ratio S:

* Murch & Wilson (1975), J. Lubr. Technol. 97, 212, pure rolling: :math:`3.94/(3.94+L^{0.62})`;
* Wilson & Sheu (1983), J. Lubr. Technol. 105, 187: :math:`1/(1+0.1(1+14.8(S/2)^{0.83})(4L)^{0.64})`;
* Hsu & Lee (1994), J. Vib. Acoust. 116, 568, for rolling and sliding:
  :math:`1/(1+0.0766\,G^{0.687}W^{0.447}L^{0.527}e^{0.875S})`, :math:`G=\alpha E'`, :math:`W=w'/(E'R)`.
"""

import sys
from typing import NamedTuple

import numpy as np
import pytest
from support import CASES

from ehlpetsc.case.loading import load
from ehlpetsc.run.simulation import Simulation

sys.path.append(str(CASES / "paper"))
import thermal_films

BULK, BETA, OIL = 363.0, 0.04, 0.14
MODULUS, RADIUS = 207e9 / (1.0 - 0.3**2), 0.0191  # Pa, m
POINTS = (
    (0.005, 5.0, 0.25),
    (0.005, 5.0, 1.0),
    (0.02, 10.0, 0.5),
    (0.05, 10.0, 0.25),
    (0.005, 25.0, 0.5),
)  # Pa s, m/s, slide/roll ratio
ROLLING = ((0.02, 5.0, 0.0), (0.02, 10.0, 0.0), (0.02, 20.0, 0.0))


class Contact(NamedTuple):
    """Central and least film [m], and run."""

    film: float
    least: float
    simulation: object


def solve(viscosity, speed, ratio, heated):
    """Table 1, smooth and steady, on a/50."""
    keys = [
        f"fluid.viscosity={viscosity}",
        f"motion.entrainment_speed={speed}",
        f"motion.slide_roll_ratio={ratio}",
        "mesh.inlet=-4.0",
        "mesh.outlet=1.5",
        "mesh.points_per_half_width=50",
    ]
    constant = ["heat.viscosity_temperature=0.04", "heat.oil_conductivity_pressure=0"]
    heat = [f"heat.bulk_temperature={BULK}", *constant] if heated else []
    simulation = Simulation(load(CASES / "table1_smooth.toml", keys + heat))
    [state] = list(simulation)
    film = state.film_thickness[np.abs(simulation.scales.x).argmin()]
    return Contact(film, state.h_min, simulation)


def thermal_load(viscosity, speed):
    """L of the film formulas."""
    return BETA * viscosity * speed**2 / OIL


def murch_wilson(load):
    """Thermal over isothermal film."""
    return 3.94 / (3.94 + load**0.62)


def wilson_sheu(load, ratio):
    """Thermal over isothermal film."""
    return 1.0 / (1.0 + 0.1 * (1.0 + 14.8 * (0.5 * ratio) ** 0.83) * (4.0 * load) ** 0.64)


def hsu_lee(load, ratio, simulation):
    """Thermal over isothermal film."""
    scales, fluid = simulation.scales, simulation.case.fluid
    g, w = fluid.pressure_viscosity * MODULUS, scales.load / (MODULUS * RADIUS)
    return 1.0 / (1.0 + 0.0766 * g**0.687 * w**0.447 * load**0.527 * np.exp(0.875 * ratio))


@pytest.mark.parametrize("point", ROLLING)
def test_film_in_pure_rolling(point):
    cold, warm = (solve(*point, heated) for heated in (False, True))
    load, found = thermal_load(*point[:2]), warm.film / cold.film
    assert found == pytest.approx(wilson_sheu(load, 0.0), rel=0.015)
    assert found == pytest.approx(murch_wilson(load), rel=0.02)


@pytest.mark.parametrize("kind, points, published", [("line", 50, 0.916), ("ball", 12, 0.954)])
def test_a_ball_loses_half_of_what_a_line_loses(kind, points, published):
    """First pair of thermal_films.py: film with heat over the isothermal one."""
    assert thermal_films.reduction(kind, thermal_films.PAIRS[0], points) == pytest.approx(published, abs=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("point", POINTS)
def test_minimum_film(point):
    cold, warm = (solve(*point, heated) for heated in (False, True))
    least = hsu_lee(thermal_load(*point[:2]), point[2], cold.simulation)
    assert warm.least / cold.least == pytest.approx(least, rel=0.08)
