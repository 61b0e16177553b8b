"""The lines of the table of extremes: what a user may ask for at the edge of the ranges."""

import math
import tomllib
from dataclasses import dataclass
from pathlib import Path

from ehlpetsc.physics.film_formulas import moes_central_film
from ehlpetsc.physics.scales import hertz_line, moes_groups, reduced_modulus

PROFILES = Path(__file__).parents[2] / "cases" / "profiles"
FLOODED = 20.0  # central films in the undeformed gap at the inlet: further out the film does not feel it

TABLE_1 = """
title = "extreme"
[contact]
radius = 0.0191
load = 527e3
youngs_modulus = [207e9, 207e9]
poisson_ratio = [0.3, 0.3]
[fluid]
viscosity = 0.005
law = "seed"
pressure_viscosity = 11.1e-9
kappa = 63.2e-6
chi = 5.1e-9
density = "dowson-higginson"
gamma = 2.27e-9
lambda = 1.68e-9
eyring_stress = 10e6
[motion]
entrainment_speed = 5.0
slide_roll_ratio = 0.25
[mesh]
inlet = -2.5
outlet = 1.5
points_per_half_width = 100
"""
BARUS = TABLE_1.replace('law = "seed"', 'law = "barus"')
ROELANDS = TABLE_1.replace('law = "seed"', 'law = "roelands"\nroelands_z = 0.68\nroelands_pressure = 0.196e9')
MOES = BARUS.replace("eyring_stress = 10e6", "").replace('"dowson-higginson"', '"incompressible"')

_TABLE = tomllib.loads(TABLE_1)
RADIUS, LOAD = (_TABLE["contact"][key] for key in ("radius", "load"))  # R [m], w' [N/m]
SPEED, POISSON = _TABLE["motion"]["entrainment_speed"], _TABLE["contact"]["poisson_ratio"]
MODULUS = reduced_modulus(_TABLE["contact"]["youngs_modulus"], POISSON)


@dataclass(frozen=True)
class Line:
    """One line of the table.

    Attributes
    ----------
    axis, value : str
        As printed.
    overrides : tuple of str
        ``table.key=value``.
    text : str
        The case that they change.
    short : bool
        Whether the line belongs to the short form.
    before : tuple of str or None
        Overrides of an earlier run from whose restart file this one goes on.
    """

    axis: str
    value: str
    overrides: tuple = ()
    text: str = TABLE_1
    short: bool = False
    before: tuple | None = None


def load_of(pressure):
    """Load [N/m] of a Hertz pressure [Pa] on TABLE_1's solids: p0 goes with its root."""
    return 2.0 * math.pi * RADIUS * pressure**2 / MODULUS


def inlet_of(load, viscosity, speed, alpha=11.1e-9, modulus=MODULUS):
    """Inlet [half widths] that floods the contact: `FLOODED` central films of undeformed gap."""
    m, ell = moes_groups(viscosity, speed, alpha, load, RADIUS, modulus)
    film = math.pi / (8.0 * m) * moes_central_film(m, ell)  # in a^2/R
    return -max(2.5, math.ceil(10.0 * math.sqrt(1.0 + 2.0 * FLOODED * film)) / 10.0)


def steady_lines():
    """Viscosity law, load, Moes numbers, speed, materials, sliding, starvation: no time steps."""
    return [*_viscosity(), *_load(), *_moes(), *_speed(), *_materials(), *_sliding(), *_starved()]


def _viscosity():
    lines = []
    for eta in (0.0005, 0.001, 0.002, 0.01, 0.1, 1.0):
        overrides = (f"fluid.viscosity={eta}", f"mesh.inlet={inlet_of(LOAD, eta, SPEED)}")
        lines.append(Line("viscosity law", f"seed, eta0 {eta:g} Pa s", overrides, short=eta in (0.0005, 1.0)))
    for alpha in (11.1, 18, 25):
        overrides = (f"fluid.pressure_viscosity={alpha}e-9",)
        lines.append(Line("viscosity law", f"Barus, alpha {alpha:g}/GPa", overrides, BARUS, alpha == 25))
    for z in (0.5, 0.68, 0.8):
        overrides = (f"fluid.roelands_z={z}", "fluid.pressure_viscosity=22e-9")
        lines.append(Line("viscosity law", f"Roelands, z {z:g}, alpha 22/GPa", overrides, ROELANDS, z == 0.8))
    return lines


def _load():
    return [
        Line(
            "load",
            f"p0 {p:g} GPa",
            (
                f"contact.load={load_of(p * 1e9):.6g}",
                f"mesh.inlet={inlet_of(load_of(p * 1e9), 0.005, SPEED)}",
            ),
            short=p in (0.2, 3.0),
        )
        for p in (0.2, 0.5, 1.0, 2.0, 3.0)
    ]


def _moes():
    lines = []
    for ell in (5.0, 15.0):
        # alpha fixed: L gives viscosity times speed, M then the load
        two_u = (ell / (22e-9 * MODULUS)) ** 4
        viscosity = two_u * MODULUS * RADIUS / (2.0 * SPEED)
        for m in (5.0, 20.0, 100.0, 500.0, 2000.0):
            load = m * MODULUS * RADIUS * math.sqrt(two_u)
            overrides = (
                f"contact.load={load:.8g}",
                f"fluid.viscosity={viscosity:.8g}",
                "fluid.pressure_viscosity=22e-9",
                f"mesh.inlet={inlet_of(load, viscosity, SPEED, 22e-9)}",
            )
            if m >= 500.0:  # the inlet sweep is the narrower the heavier the load
                overrides += ("mesh.points_per_half_width=400",)
            p0 = 1e-9 * hertz_line(load, RADIUS, MODULUS)[1]
            lines.append(
                Line(
                    "Moes",
                    f"M {m:g}, L {ell:g} (p0 {p0:.2g} GPa)",
                    overrides,
                    MOES,
                    m in (5.0, 100.0) and ell == 5.0,
                )
            )
    return lines


def _speed():
    finer = {0.01: 400, 0.1: 200}  # the thinner the film, the narrower the inlet sweep
    return [
        Line(
            "speed",
            f"u {u:g} m/s",
            (
                f"motion.entrainment_speed={u}",
                f"mesh.inlet={inlet_of(LOAD, 0.005, u)}",
                *([f"mesh.points_per_half_width={finer[u]}"] if u in finer else []),
            ),
            short=u in (0.01, 50.0),
        )
        for u in (0.01, 0.1, 1.0, 10.0, 50.0)
    ]


def _materials():
    lines = []
    for modulus in (3, 207, 600):
        first = "[3e9, 207e9]" if modulus == 3 else f"[{modulus}e9, {modulus}e9]"
        overrides = [f"contact.youngs_modulus={first}"]
        if modulus == 3:  # a polymer carries a tenth of the load
            overrides += [
                "contact.load=20e3",
                f"mesh.inlet={inlet_of(20e3, 0.005, SPEED, modulus=reduced_modulus((3e9, 207e9), POISSON))}",
            ]
        lines.append(
            Line(
                "materials",
                f"E {modulus} GPa" + " on steel" * (modulus == 3),
                tuple(overrides),
                short=modulus == 3,
            )
        )
    return lines


def _sliding():
    return [
        Line("sliding", f"xi {xi:g}", (f"motion.slide_roll_ratio={xi}",), short=xi in (0.0, 4.0, -4.0))
        for xi in (0.0, 0.1, -0.1, 1.0, -1.0, 1.9, -1.9, 2.0, -2.0, 4.0, -4.0)
    ]


def _starved():
    flooded = 0.165e-6  # central film of TABLE_1
    return [
        Line(
            "starvation",
            f"inlet film {share:g} of the flooded one",
            (f"fluid.inlet_film={share * flooded:.4g}",),
            short=share == 0.2,
        )
        for share in (2.0, 1.0, 0.6, 0.4, 0.2)
    ]
