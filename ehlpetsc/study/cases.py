"""Cases of the table of extremes: base cases and their changes, read from extremes.toml."""

import math
import tomllib
from dataclasses import dataclass
from pathlib import Path

from ehlpetsc.physics.film_formulas import moes_central_film
from ehlpetsc.physics.scales import moes_groups, reduced_modulus

PROFILES = Path(__file__).parents[2] / "cases" / "profiles"
FLOODED_GAP = 20.0  # central films: undeformed gap at an inlet that does not affect the film

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

DRY_TABLE_1 = TABLE_1[: TABLE_1.index("[fluid]")] + TABLE_1[TABLE_1.index("[motion]") :]
NEWTON = TABLE_1.replace("eyring_stress = 10e6\n", "")
BASES = {
    "table_1": TABLE_1,
    "barus": BARUS,
    "roelands": ROELANDS,
    "moes": MOES,
    "dry": DRY_TABLE_1,
    "newton": NEWTON,
}
CORRELATION = 25e-6  # m
SHORT_DOMAIN = ("mesh.inlet=-1.5", "mesh.outlet=1.3", "output.every=1000000", 'output.fields=["pressure"]')

_TABLE = tomllib.loads(TABLE_1)
RADIUS = _TABLE["contact"]["radius"]  # R [m]
SPEED, POISSON = _TABLE["motion"]["entrainment_speed"], _TABLE["contact"]["poisson_ratio"]
MODULUS = reduced_modulus(_TABLE["contact"]["youngs_modulus"], POISSON)


@dataclass(frozen=True)
class StudyCase:
    """One case of the table of extremes.

    Attributes
    ----------
    axis, value : str
        As printed in the table.
    overrides : tuple of str
        ``table.key=value``.
    text : str
        Base case.
    short : bool
        Whether the case belongs to the short form.
    before : tuple of str or None
        Overrides of an earlier run from whose restart file this one continues.
    """

    axis: str
    value: str
    overrides: tuple = ()
    text: str = TABLE_1
    short: bool = False
    before: tuple | None = None


def load_of(pressure):
    """Load [N/m] for a Hertz pressure [Pa] of the solids of `TABLE_1`."""
    return 2.0 * math.pi * RADIUS * pressure**2 / MODULUS


def inlet_of(load, viscosity, speed, alpha=11.1e-9, modulus=MODULUS):
    """Inlet [half widths] of a flooded contact: `FLOODED_GAP` central films of undeformed gap."""
    m, ell = moes_groups(viscosity, speed, alpha, load, RADIUS, modulus)
    film = math.pi / (8.0 * m) * moes_central_film(m, ell)  # in a^2/R
    return -max(2.5, math.ceil(10.0 * math.sqrt(1.0 + 2.0 * FLOODED_GAP * film)) / 10.0)


def ground(ra, seed=1, correlation=CORRELATION):
    """Setting of a random ground profile."""
    shape = f"correlation = {correlation:g}, skewness = -1.0"
    return f'{{ kind = "ground", ra = {ra:g}, {shape}, seed = {seed} }}'


def wave(kind, amplitude, wavelength):
    """Setting of a sine, square, ridge or dent."""
    return f'{{ kind = "{kind}", amplitude = {amplitude:g}, wavelength = {wavelength:g} }}'


def read_cases(*groups):
    """Cases of groups of ``extremes.toml``.

    Parameters
    ----------
    *groups : {"steady", "time", "far"}

    Returns
    -------
    list of StudyCase
    """
    tables = tomllib.loads(Path(__file__).with_name("extremes.toml").read_text(encoding="utf-8"))
    return [_case(tables["synthetic"], **entry) for group in groups for entry in tables[group]]


def _case(synthetic, axis, value, base="table_1", travel=None, short=False, before=None, **keys):
    """Case of the table; with `travel` on a short domain, so that few time steps fill the contact."""
    settings = () if travel is None else (*SHORT_DOMAIN, f"time.travel={travel}")
    for side in ("1", "2"):
        if f"surface_{side}" in keys:
            settings += (f"surface.{side}.synthetic={synthetic[keys[f'surface_{side}']]}",)

    def with_settings(overrides):
        return (*settings, *(text.replace("{profiles}", str(PROFILES)) for text in overrides))

    overrides = with_settings(keys.get("set", ()))
    return StudyCase(axis, value, overrides, BASES[base], short, before and with_settings(before))
