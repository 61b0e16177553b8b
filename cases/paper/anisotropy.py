"""What the lay of roughness changes: strips of one spectrum along x, from ridges to a longitudinal lay.

``python cases/paper/anisotropy.py dry`` and ``... film`` print a line for each lay and nominal pressure, or
speed; ``... film --border 16e-6`` moves waves below 16 um into the compliant layer. Options choose the lays,
mesh, width and seed; README.md beside `contact.md` quotes what follows.
"""

from __future__ import annotations

import argparse
from fractions import Fraction

import numpy as np

from ehlpetsc.api import solve
from ehlpetsc.results.means import filled_weights, mean
from ehlpetsc.surfaces.self_affine import Spectrum, heights

HALF_WIDTH, MODULUS = 150e-6, 227.4725e9  # m, E' of steel [Pa]
SQ, HURST, ROLL_OFF, SHORTEST = 0.28e-6, 0.8, 80e-6, 2.5e-6  # of both surfaces together [m]
RIDGES = 0.01  # Peklenik number of a strip without waves across
PRESSURES, SPEEDS = (0.1e9, 0.5e9, 1e9), (15.0, 3.3, 0.6)  # Hertz [Pa], m/s
MEANS = ("lambda_ratio", "friction_coefficient", "contact_share", "contact_length", "film_central", "p_max")
LENGTH, POINTS_PER_WAVE = 3.2e-3, 12  # of ridges [m]
FLOW = 5e9  # above which asperities of steel flow [Pa]


def rms_of(shortest: float) -> float:
    """Root mean square height [m] of the waves down to `shortest` when all down to `SHORTEST` have `SQ`."""

    def variance(wave: float) -> float:
        return 0.5 + (1.0 - (wave / ROLL_OFF) ** (2 * HURST)) / (2 * HURST)

    return SQ * float(np.sqrt(variance(shortest) / variance(SHORTEST)))


def strip(chosen: argparse.Namespace, lay: float, pressure: float) -> dict:
    """Case of a dry strip."""
    points, is_strip = chosen.points, lay > RIDGES
    return {
        "title": f"Peklenik number {lay:.3g}",
        "contact": {
            "radius": HALF_WIDTH * MODULUS / (4.0 * pressure),
            "load": 0.5 * np.pi * HALF_WIDTH * pressure,
            "youngs_modulus": 0.91 * MODULUS,
            "poisson_ratio": 0.3,
        },
        "mesh": {
            "inlet": -2.5,
            "outlet": 1.5 if chosen.table == "film" else 2.5,
            "points_per_half_width": [points, max(4, round(points * lay))] if is_strip else points,
            **({"width": chosen.width} if is_strip else {}),
        },
    }


def surface(chosen: argparse.Namespace, lay: float, sq: float, seed: int) -> dict:
    """One self-affine surface; ridges as a profile with the spectrum of a section of the isotropic one."""
    waves = {"sq": sq, "hurst": HURST, "roll_off": ROLL_OFF, "short_cutoff": chosen.border}
    if lay > RIDGES:
        return {"synthetic": {"kind": "self-affine", "peklenik": lay, "seed": seed, **waves}}
    n, step = round(LENGTH / chosen.border * POINTS_PER_WAVE), chosen.border / POINTS_PER_WAVE
    period = chosen.width * HALF_WIDTH
    z = heights((4, n), (period / 4, step), Spectrum(*waves.values(), RIDGES), seed)[0]
    return {"x": step * np.arange(n), "z": z}


def dry(chosen: argparse.Namespace, lay: float, pressure: float) -> str:
    """Real area over the Hertz area, mean contact pressure, its 99th percentile, load above `FLOW`."""
    case = strip(chosen, lay, pressure)
    case["surface"] = {"1": surface(chosen, lay, SQ, chosen.seed)}
    result = solve(case, progress=False)
    touching, p = result.contacts_at(-1).ravel(), np.ravel(result["pressure"][-1])
    p = p[touching]
    nodes = 2 * chosen.points * (len(result.y) if lay > RIDGES else 1)
    return (
        f"{pressure / 1e9:g} GPa: area {len(p) / nodes:.3f}, mean {p.mean() / 1e9:.2f} GPa, 99th percentile "
        f"{np.percentile(p, 99) / 1e9:.2f} GPa, load above 5 GPa {p[p > FLOW].sum() / p.sum():.3f}"
    )


def film(chosen: argparse.Namespace, lay: float, speed: float) -> str:
    """Means of friction, load on the solids, length of contact, film; standard errors of the means in time."""
    case = strip(chosen, lay, 1e9)
    layer = float(np.sqrt(SQ**2 - rms_of(chosen.border) ** 2))
    case["contact"] |= {"model": "mixed", "asperity_height": layer, "boundary_friction": 0.1}
    case["contact"]["asperity_stiffness"] = 2 * np.pi * layer / chosen.border
    case["fluid"] = {"oil": "fva3", "temperature": 273.15 + 90.0}
    case["motion"] = {"entrainment_speed": speed, "slide_roll_ratio": 0.25}
    sides = (surface(chosen, lay, rms_of(chosen.border) / 2**0.5, 2 * chosen.seed + k) for k in (0, 1))
    case["surface"] = dict(zip(("1", "2"), sides, strict=True))
    case["time"] = {"travel": chosen.travel, "courant": chosen.courant, "start": "rough"}
    case["output"] = {"every": 100000}
    result = solve(case, progress=False)
    weights = filled_weights(result)
    ratio, friction, share, length, thickness, highest = (mean(result, name, weights) for name in MEANS)
    return (
        f"{speed:g} m/s: lambda {ratio:.2f}, friction {friction:.4f}, share {share:.3f}, length "
        f"{length / HALF_WIDTH:.3f} a, film {1e9 * thickness:.0f} nm, highest pressure {highest / 1e9:.2f} GPa, "
        f"{result.steps('newton').sum()} iterations in {len(weights) - 1} steps"
    )


def main(words: list[str] | None = None) -> None:
    """Run the command."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("table", choices=("dry", "film"))
    parser.add_argument("--lays", type=Fraction, nargs="+", default=[Fraction(RIDGES), Fraction(1)])
    parser.add_argument("--at", type=float, nargs="+", help="pressures [Pa] or speeds [m/s]")
    parser.add_argument("--points", type=int, default=64, help="nodes per half-width")
    parser.add_argument("--width", type=float, default=1.0, help="half-widths")
    parser.add_argument("--border", type=float, default=10e-6, help="shortest wave on the mesh [m]")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--travel", type=float, default=4.0, help="half-widths")
    parser.add_argument("--courant", type=float, default=0.5)
    chosen = parser.parse_args(words)
    row = {"dry": dry, "film": film}[chosen.table]
    for lay in map(float, chosen.lays):
        for at in chosen.at or {"dry": PRESSURES, "film": SPEEDS}[chosen.table]:
            print(f"{vars(chosen)} {lay:.3g} {row(chosen, lay, at)}", flush=True)


if __name__ == "__main__":
    main()
