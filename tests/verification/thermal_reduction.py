r"""Film and friction of smooth thermal contacts beside published formulas: ``python3 thermal_reduction.py``.

Film over the isothermal one, :math:`L=\beta\eta_0u^2/k_f`, slide/roll ratio S:

* Murch & Wilson (1975), J. Lubr. Technol. 97, 212, pure rolling: :math:`3.94/(3.94+L^{0.62})`;
* Wilson & Sheu (1983), J. Lubr. Technol. 105, 187: :math:`1/(1+0.1(1+14.8(S/2)^{0.83})(4L)^{0.64})`;
* Gupta, Cheng, Zhu, Forster & Schrand (1992), Tribol. Trans. 35, 149:
  :math:`(1-13.2(p_0/E')L^{0.42})/(1+0.213(1+2.23S^{0.83})L^{0.64})`;
* Hsu & Lee (1994), J. Vib. Acoust. 116, 568, for rolling and sliding:
  :math:`1/(1+0.0766\,G^{0.687}W^{0.447}L^{0.527}e^{0.875S})`, :math:`G=\alpha E'`, :math:`W=w'/(E'R)`.

Friction, at the central film and Hertz's pressure:

* Crook (1961), Phil. Trans. R. Soc. A 254, 237, with Eyring's law as in Johnson & Greenwood (1980), Wear 61,
  353: closed form of the temperature across a film that is heated by shear (:func:`film_stress`), between
  walls heated as half-spaces that move past fast (Carslaw & Jaeger 1959), each by half of the heat;
* Xu, Kahraman, Anderson & Maddock (2007), J. Mech. Des. 129, 58: regression of thermal contacts of a 75W-90
  gear oil (:func:`xu_kahraman`).
"""

from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from ehlpetsc.base import environment
from ehlpetsc.case.loading import load
from ehlpetsc.physics import laws

CASES = Path(__file__).parents[2] / "cases"
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
GEAR_OIL = ((0.012, 5.0, 0.1), (0.012, 5.0, 0.5), (0.012, 10.0, 0.25), (0.012, 20.0, 0.1), (0.012, 20.0, 0.5))


class Contact(NamedTuple):
    """Central and least film [m], friction coefficient (the mean of both surfaces') and run."""

    film: float
    least: float
    friction: float
    simulation: object


def solve(viscosity, speed, ratio, heated, points=100):
    """Table 1, smooth and steady, on a/`points`."""
    from ehlpetsc.run.simulation import Simulation  # needs PETSc on the path

    keys = [
        f"fluid.viscosity={viscosity}",
        f"motion.entrainment_speed={speed}",
        f"motion.slide_roll_ratio={ratio}",
        "mesh.inlet=-4.0",
        "mesh.outlet=1.5",
        f"mesh.points_per_half_width={points}",
    ]
    constant = ["heat.viscosity_temperature=0.04", "heat.oil_conductivity_pressure=0"]
    heat = [f"heat.bulk_temperature={BULK}", *constant] if heated else []
    simulation = Simulation(load(CASES / "table1_smooth.toml", keys + heat))
    [state] = list(simulation)
    scales = simulation.scales
    shear = 0.5 * (state.shear_stress_2 - state.shear_stress_1).sum() * scales.dx
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


def gupta(load, ratio, pressure):
    """Thermal over isothermal film; `pressure` is p0 over E', 2/E' the sum of both (1 - nu^2)/E."""
    return (1.0 - 13.2 * pressure * load**0.42) / (1.0 + 0.213 * (1.0 + 2.23 * ratio**0.83) * load**0.64)


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


def xu_kahraman(pressure, ratio, speed, viscosity, radius, roughness=0.0):
    """Friction coefficient.

    p0 [GPa], entrainment speed [m/s], viscosity at ambient pressure [mPa s], radius [m], rms height [um].
    """
    heat = abs(ratio) * pressure * np.log10(viscosity)
    exponent = -8.916465 - 0.354068 * heat + 2.812084 * np.exp(-heat) + 0.620305 * np.exp(roughness)
    powers = pressure**1.03303 * abs(ratio) ** 1.036077 * speed**-0.100601 * viscosity**0.752755
    return np.exp(exponent) * powers * radius**-0.390958


def main():
    """Print two tables."""
    pairs = {
        point: [solve(*point, heated) for heated in (False, True)] for point in ROLLING + POINTS + GEAR_OIL
    }
    print(
        "| eta0, u, slide/roll | L | central, least film | Murch, Wilson | Wilson, Sheu | Gupta | Hsu, Lee |"
    )
    for (viscosity, speed, ratio), (cold, warm) in pairs.items():
        load, p0 = thermal_load(viscosity, speed), cold.simulation.scales.p0
        found = warm.film / cold.film, warm.least / cold.least
        formulas = murch_wilson(load), wilson_sheu(load, ratio), gupta(load, ratio, p0 / MODULUS)
        formulas += (hsu_lee(load, ratio, cold.simulation),)
        row = f"{load:.2f} | {found[0]:.3f}, {found[1]:.3f} | " + " | ".join(
            f"{value:.3f}" for value in formulas
        )
        print(f"| {viscosity:g}, {speed:g}, {ratio:g} | {row} |")
    print("| eta0, u, slide/roll | isothermal | theory | with heat | theory | Xu | reduction | theory |")
    for (viscosity, speed, ratio), (cold, warm) in pairs.items():
        if ratio:
            theory = friction_by_theory(cold, False), friction_by_theory(warm, True)
            regression = xu_kahraman(1e-9 * cold.simulation.scales.p0, ratio, speed, 1e3 * viscosity, RADIUS)
            found = cold.friction, theory[0], warm.friction, theory[1], regression
            row = " | ".join(f"{value:.4f}" for value in found)
            reduction = f"{warm.friction / cold.friction:.3f} | {theory[1] / theory[0]:.3f}"
            print(f"| {viscosity:g}, {speed:g}, {ratio:g} | {row} | {reduction} |")


if __name__ == "__main__":
    environment.prepare()
    main()
