r"""Thermal reduction of film and friction of smooth contacts against published formulas.

Film over the isothermal one, :math:`L=\beta\eta_0u^2/k_f`, slide/roll ratio S:

* Murch & Wilson (1975), J. Lubr. Technol. 97, 212, pure rolling: :math:`3.94/(3.94+L^{0.62})`;
* Wilson & Sheu (1983), J. Lubr. Technol. 105, 187: :math:`1/(1+0.1(1+14.8(S/2)^{0.83})(4L)^{0.64})`;
* Hsu & Lee (1994), J. Vib. Acoust. 116, 568, for rolling and sliding:
  :math:`1/(1+0.0766\,G^{0.687}W^{0.447}L^{0.527}e^{0.875S})`, :math:`G=\alpha E'`, :math:`W=w'/(E'R)`.

Friction, at the central film and Hertz's pressure: Crook (1961), Phil. Trans. R. Soc. A 254, 237, with
Eyring's law as in Johnson & Greenwood (1980), Wear 61, 353: closed form of the temperature across a film
heated by shear (:func:`film_stress`), between walls heated as half-spaces that move past fast (Carslaw &
Jaeger 1959), each by half of the heat.
"""

import sys
from typing import NamedTuple

import numpy as np
import pytest
from scipy.optimize import brentq
from support import CASES

from ehlpetsc.case.loading import load
from ehlpetsc.physics.oil import laws
from ehlpetsc.run.simulation import Simulation

sys.path.append(str(CASES / "paper"))
import thermal_films

BULK, BETA, OIL, EFFUSIVITY = 363.0, 0.04, 0.14, np.sqrt(46.0 * 7850.0 * 470.0)
EYRING, MODULUS, RADIUS = 10e6, 207e9 / (1.0 - 0.3**2), 0.0191  # Pa, Pa, m
POINTS = (
    (0.005, 5.0, 0.25),
    (0.005, 5.0, 1.0),
    (0.02, 10.0, 0.5),
    (0.05, 10.0, 0.25),
    (0.005, 25.0, 0.5),
)  # Pa s, m/s, slide/roll ratio
ROLLING = ((0.02, 5.0, 0.0), (0.02, 10.0, 0.0), (0.02, 20.0, 0.0))


class Contact(NamedTuple):
    """Central and least film [m], friction coefficient (the mean of both surfaces') and run."""

    film: float
    least: float
    friction: float
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
    scales = simulation.scales
    shear = 0.5 * (state.shear_stress_2 - state.shear_stress_1).sum() * scales.spacing
    film = state.film_thickness[np.abs(scales.x).argmin()]
    return Contact(film, state.h_min, shear / state.load, simulation)


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


def film_stress(viscosity, film, sliding):
    r"""Shear stress [Pa] of a film heated by its shear, its walls at the temperature of `viscosity`.

    :math:`kT''=-\tau\dot\gamma_we^{\beta(T-T_w)}` is solved by
    :math:`e^{\beta(T-T_w)}=\cosh^2b/\cosh^2(2by/h)`, so that with
    :math:`B=\beta\tau\Delta u^2/(8k\dot\gamma_w)=\sinh^2b`

    .. math:: \Delta u=\dot\gamma_wh\sqrt{B(1+B)}/\sinh^{-1}\sqrt B,\quad
       \dot\gamma_w=(\tau_E/\eta)\sinh(\tau/\tau_E).
    """

    def excess(stress):
        rate = EYRING / viscosity * np.sinh(stress / EYRING)
        root = np.sqrt(BETA * stress * sliding**2 / (8.0 * OIL * rate))
        return np.log(rate * film * root * np.hypot(1.0, root) / np.arcsinh(root) / sliding)

    cold = isothermal_stress(viscosity, film, sliding)
    return brentq(excess, 1e-6 * cold, cold, rtol=1e-10)


def isothermal_stress(viscosity, film, sliding):
    """Shear stress [Pa] by Eyring's law."""
    return EYRING * np.arcsinh(viscosity * sliding / (film * EYRING))


def friction_by_theory(contact, heated, nodes=160):
    """Friction coefficient of Hertz's pressure and a film of one thickness."""
    scales, fluid = contact.simulation.scales, contact.simulation.case.fluid
    dx, sliding = 2.0 * scales.a / nodes, abs(scales.u1 - scales.u2)
    pressure = scales.p0 * np.sqrt(1.0 - (dx * (np.arange(nodes) + 0.5) / scales.a - 1.0) ** 2)
    at_pressure = fluid.viscosity * np.exp(laws.viscosity(pressure, fluid)[0])
    law = film_stress if heated else isothermal_stress
    mean_wall = 0.5 * (abs(scales.u1) ** -0.5 + abs(scales.u2) ** -0.5) * _response(nodes, dx)
    rise = np.zeros(nodes)
    for _ in range(30 if heated else 1):
        at_wall = at_pressure * np.exp(-BETA * rise)
        stress = np.array([law(value, contact.film, sliding) for value in at_wall])
        rise = 0.5 * (rise + np.convolve(0.5 * stress * sliding, mean_wall)[:nodes])
    return stress.sum() * dx / scales.load


def _response(nodes, dx):
    """Mean rise over a cell of a wall of speed 1 for a flux of 1 in a cell before it, (nodes,)."""
    integral = 4.0 / (3.0 * np.sqrt(np.pi) * EFFUSIVITY) * (np.arange(-1, nodes + 1).clip(0) * dx) ** 1.5 / dx
    return np.diff(integral, 2)


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
def test_friction_and_minimum_film(point):
    """At 25 m/s the film's own heating and what its inlet carries in, left out by theory, count most."""
    cold, warm = (solve(*point, heated) for heated in (False, True))
    theory = friction_by_theory(cold, False), friction_by_theory(warm, True)
    assert cold.friction == pytest.approx(theory[0], rel=0.1)
    assert warm.friction == pytest.approx(theory[1], rel=0.1)
    least = hsu_lee(thermal_load(*point[:2]), point[2], cold.simulation)
    assert warm.least / cold.least == pytest.approx(least, rel=0.08)
