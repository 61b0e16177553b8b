"""What the lay of roughness changes: strips with one spectrum along x, from ridges to a longitudinal lay.

``./run_mpi.sh python cases/paper/anisotropy.py TABLE [options]`` prints a line for each lay and pressure or
speed; TABLE is

- ``film``: lubricated, 1 GPa, FVA 3 at 90 degrees C, slide/roll 0.25, waves below ``--border`` in the layer;
- ``dry``: the same contact without oil, all waves below ``--border`` left out;
- ``flat``: dry, nominally flat, by boundary elements periodic in both directions, of the package ``tamaas``;
- ``layer``: the same, isotropic (``--lays 1``), of the waves below ``--border`` alone: mean separation and
  factor of the flow, beside those of the laws of the layer.

With ``--map FILE``, ``film`` takes surface 1 from a measured map, and surface 2 is smooth; a line takes the
row ``--seed`` of the map.

The lay is Peklenik's number, wavelengths along x over those across. At 1/100 waves are ridges, solved as a
line contact; 0 is a line contact of smooth bodies with all roughness in the layer.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ehlpetsc.api import Result, solve
from ehlpetsc.physics.contact.asperities import GAMMA, asperity_separation, flow_factor
from ehlpetsc.results.means import filled_weights, mean
from ehlpetsc.surfaces.files.areal import read_map
from ehlpetsc.surfaces.files.profiles import Layout
from ehlpetsc.surfaces.filters import without_form
from ehlpetsc.surfaces.synthetic import Spectrum, random_heights

HALF_WIDTH, MODULUS = 150e-6, 227.4725e9  # m, E' of steel [Pa]
SQ, HURST, ROLL_OFF, SHORTEST = 0.28e-6, 0.8, 80e-6, 2.5e-6  # of both surfaces together [m]
RIDGES = 0.01  # lay
RIDGE_POINTS, RIDGE_SPACING = 2560, 1.25e-6  # of a profile [m]
PRESSURES, SPEEDS = (0.1e9, 0.5e9, 1e9), (15.0, 3.3, 0.6)  # Pa, m/s
MEANS = ("lambda_ratio", "friction_coefficient", "contact_share", "contact_length", "film_central", "p_max")
CLOSED = 0.5  # of the layer's rms height: of a film that lets 0.16 of the pressure flow pass
FLOW = 5e9  # above which asperities of steel flow [Pa]


def sq_down_to(shortest: float) -> float:
    """Root mean square height [m] of the waves down to `shortest` when all down to `SHORTEST` have `SQ`."""

    def variance(wave: float) -> float:
        return 0.5 + (1.0 - (wave / ROLL_OFF) ** (2 * HURST)) / (2 * HURST)

    return SQ * float(np.sqrt(variance(shortest) / variance(SHORTEST)))


def contact(chosen: argparse.Namespace, lay: float, pressure: float) -> dict[str, Any]:
    """Case of a dry smooth strip of Hertz pressure `pressure`; of ridges the line contact."""
    points, mesh = chosen.points, {"inlet": -2.5, "outlet": chosen.outlet if chosen.table == "film" else 2.5}
    if lay > RIDGES:
        across = {"points_per_half_width": [points, max(4, round(points * lay))], "width": chosen.width}
    else:
        across = {"points_per_half_width": points}
    return {
        "title": f"lay {lay:.3g}",
        "contact": {
            "radius": HALF_WIDTH * MODULUS / (4.0 * pressure),
            "load": 0.5 * np.pi * HALF_WIDTH * pressure,
            "youngs_modulus": 0.91 * MODULUS,
            "poisson_ratio": 0.3,
        },
        "mesh": mesh | across,
    }


def surface(chosen: argparse.Namespace, lay: float, sq: float, seed: int) -> dict[str, Any]:
    """One self-affine surface; ridges as a profile, with the spectrum of the isotropic one along x."""
    waves = {"sq": sq, "hurst": HURST, "roll_off": ROLL_OFF, "short_cutoff": chosen.border}
    if lay > RIDGES:
        return {"synthetic": {"kind": "self-affine", "peklenik": lay, "seed": seed, **waves}}
    spacing = 0.25 * chosen.width * HALF_WIDTH, RIDGE_SPACING
    z = random_heights((4, RIDGE_POINTS), spacing, Spectrum(*waves.values(), RIDGES), seed)[0]
    return {"x": RIDGE_SPACING * np.arange(RIDGE_POINTS), "z": z}


def of_map(chosen: argparse.Namespace, lay: float) -> dict[str, Any]:
    """Surface of the map, or the profile of one of its rows, scaled to `SQ`."""
    z, dx, dy, _ = read_map(chosen.map, Layout())
    z = without_form((dy * np.arange(z.shape[0]), dx * np.arange(z.shape[1])), z, 1)
    z = SQ / z.std() * z
    common = {"short_cutoff": chosen.border, "level": True}
    if lay > RIDGES:
        return {"z": z.tolist(), "spacing": dx, "spacing_across": dy} | common
    return {"x": dx * np.arange(z.shape[1]), "z": z[chosen.seed]} | common


def statistics(p: np.ndarray, nodes: int) -> str:
    """Real area over nominal area, pressures of contact [Pa], as a line."""
    return (
        f"area {len(p) / nodes:.3f}, mean {p.mean() / 1e9:.2f} GPa, 99th percentile "
        f"{np.percentile(p, 99) / 1e9:.2f} GPa, load above 5 GPa {p[p > FLOW].sum() / p.sum():.3f}"
    )


def dry(chosen: argparse.Namespace, lay: float, pressure: float) -> str:
    """Real area over the Hertz area, pressures."""
    case = contact(chosen, lay, pressure)
    case["surface"] = {"1": surface(chosen, lay, sq_down_to(chosen.border), chosen.seed)}
    result = solve(case, progress=False)
    p = np.ravel(result["pressure"][-1])[result.contacts_at(-1).ravel()]
    return statistics(p, 2 * chosen.points * (1 if result.y is None else len(result.y)))


def flat(chosen: argparse.Namespace, lay: float, pressure: float) -> str:
    """Real area over the nominal area, pressures; square mesh, spacing a fifth of the shortest wave."""
    n, step = chosen.points, chosen.border / 5
    rows, across = (n, step / lay) if lay > RIDGES else (4, HALF_WIDTH / 4)
    spectrum = Spectrum(sq_down_to(chosen.border), HURST, ROLL_OFF, chosen.border, lay)
    z = random_heights((rows, n), (across, step), spectrum, chosen.seed)
    if lay <= RIDGES:
        z = np.repeat(z[:1], rows, axis=0)
    p = pressed(z, (across, step), pressure)[0].ravel()
    return statistics(p[p > 0.0], rows * n)


def pressed(z: np.ndarray, spacing: tuple[float, float], pressure: float) -> tuple[np.ndarray, np.ndarray]:
    """Pressure [Pa] and gap [m] of nominally flat heights, both periodic."""
    import tamaas

    (rows, n), (across, step) = z.shape, spacing
    model = tamaas.Model(tamaas.model_type.basic_2d, [rows * across / step, n], [rows, n])
    model.E, model.nu = 0.5 * MODULUS, 0.0
    tamaas.PolonskyKeerRey(model, np.ascontiguousarray(z / step), 1e-8).solve(pressure)
    gap = step * np.array(model.displacement).reshape(z.shape) - z
    return np.array(model.traction).reshape(z.shape), gap - gap.min()


def flow(gap: np.ndarray) -> float:
    """Flow through a periodic gap of square cells over that through its mean, by finite volumes."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.linalg import spsolve

    node = np.arange(gap.size).reshape(gap.shape)
    cubes = np.maximum(gap / gap.mean(), 1e-6) ** 3
    across, along = (
        (2.0 * cubes * other / (cubes + other)).ravel()
        for other in (np.roll(cubes, -1, axis) for axis in (0, 1))
    )
    above, ahead = (np.roll(node, -1, axis).ravel() for axis in (0, 1))
    here, count = node.ravel(), gap.size
    faces = [(here, above, across), (here, ahead, along)]
    matrix = sum(
        coo_matrix((np.r_[c, c, -c, -c], (np.r_[i, j, i, j], np.r_[i, j, j, i])), (count, count)).tocsc()
        for i, j, c in faces
    )
    source = along - along[np.roll(node, 1, 1).ravel()]
    p = np.append(spsolve(matrix[:-1, :-1], source[:-1]), 0.0)
    return float(np.mean(along * (1.0 + p[ahead] - p[here])))


def beside_laws(chosen: argparse.Namespace, lay: float, pressure: float) -> str:
    """Separation and flow of the roughness of the layer, isotropic, and by its laws."""
    n, step = chosen.points, SHORTEST / 5
    z = random_heights((n, n), (step, step), Spectrum(SQ, HURST, ROLL_OFF, SHORTEST, lay), chosen.seed)
    k = np.hypot(np.fft.fftfreq(n, step)[:, None], np.fft.rfftfreq(n, step))
    z = np.fft.irfft2(np.where(k < 1.0 / chosen.border, 0.0, np.fft.rfft2(z)), (n, n))
    sigma = float(np.sqrt(SQ**2 - sq_down_to(chosen.border) ** 2))
    gap = pressed(sigma / z.std() * z, (step, step), pressure)[1]
    prefactor = np.pi * sigma / chosen.border * MODULUS
    law = asperity_separation(pressure, GAMMA * sigma, prefactor, 0.0, 0.0)
    passing = flow_factor(float(gap.mean()), sigma)[0]
    return (
        f"separation {gap.mean() / sigma:.2f} sigma, by the law {law / sigma:.2f}; "
        f"flow {flow(gap):.3f}, by the law {passing:.3f}"
    )


def enclosed(result: Result, closed: float) -> float:
    """Share of the oil in the contact that films below `closed` [m] enclose, mean over stored frames."""
    from scipy.ndimage import label

    inside, shares = np.abs(result.x) < result.attrs["a"], []
    for index in range(len(result.time)):
        h = np.atleast_2d(result.frame("film_thickness", index))
        regions, _ = label(np.vstack([h > closed] * 3))  # periodic across
        middle = regions[len(h) : 2 * len(h)]
        trapped = (middle > 0) & ~np.isin(middle, regions[:, [0, -1]])
        shares.append((trapped * h)[:, inside].sum() / h[:, inside].sum())
    return float(np.mean(shares))


class Film(NamedTuple):
    """Means over the time; lengths in m, `enclosed` as of :func:`enclosed`."""

    lambda_ratio: float
    friction: float
    share: float
    length: float
    central: float
    p_max: float
    enclosed: float
    iterations: int
    steps: int


def film(chosen: argparse.Namespace, lay: float, speed: float) -> str:
    """Means over the time, as a line."""
    of = lubricated(chosen, lay, speed)
    return (
        f"lambda {of.lambda_ratio:.2f}, friction {of.friction:.4f}, share {of.share:.4f}, "
        f"length {of.length / HALF_WIDTH:.4f} a, film {1e9 * of.central:.0f} nm, "
        f"highest pressure {of.p_max / 1e9:.2f} GPa, enclosed {of.enclosed:.3f}, "
        f"{of.iterations} iterations in {of.steps} steps"
    )


def lubricated(chosen: argparse.Namespace, lay: float, speed: float) -> Film:
    """Means of a lubricated contact over the time."""
    case, sq = contact(chosen, lay, 1e9), sq_down_to(chosen.border) if lay else 0.0
    layer = float(np.sqrt(SQ**2 - sq**2))
    stiffness = 2 * np.pi * layer / (chosen.border if lay else ROLL_OFF)
    case["contact"] |= {"model": "mixed", "asperity_height": layer, "asperity_stiffness": stiffness}
    case["contact"]["boundary_friction"] = 0.1
    case["fluid"] = {"oil": "fva3", "temperature": 363.15}
    case["motion"] = {"entrainment_speed": speed, "slide_roll_ratio": 0.25}
    if chosen.map:
        case["surface"] = {"1": of_map(chosen, lay)}
        case["contact"]["asperity_height"] = "measured"
        del case["contact"]["asperity_stiffness"]
    elif lay:
        seeds = {"1": 2 * chosen.seed, "2": 2 * chosen.seed + 1}
        case["surface"] = {side: surface(chosen, lay, sq / 2**0.5, seed) for side, seed in seeds.items()}
    if lay:
        case["time"] = {"travel": chosen.travel, "courant": chosen.courant, "start": "rough"}
    case["output"] = {"every": 1 if chosen.output else 4}
    output = chosen.output and chosen.output / f"lay{lay:.2g}_{speed:g}.h5"
    result = solve(case, output, progress=False)
    layer, weights = result.case.contact.asperity_height, filled_weights(result)
    means = (float(mean(result, name, weights)) for name in MEANS)
    iterations = int(result.steps("newton").sum())
    return Film(*means, enclosed(result, CLOSED * layer), iterations, len(weights) - 1)


TABLES: dict[str, tuple[Callable[[argparse.Namespace, float, float], str], tuple[float, ...]]] = {
    "film": (film, SPEEDS),
    "dry": (dry, PRESSURES),
    "flat": (flat, PRESSURES),
    "layer": (beside_laws, (30e6, 0.1e9, 0.3e9, 1e9)),
}


def arguments() -> argparse.ArgumentParser:
    """Arguments of the command."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("table", choices=TABLES)
    parser.add_argument("--lays", type=Fraction, nargs="+", default=[Fraction(1, 100), Fraction(1)])
    parser.add_argument("--at", type=float, nargs="+", help="pressures [Pa] or speeds [m/s]")
    parser.add_argument("--points", type=int, default=64, help="nodes per half-width; of flat along x")
    parser.add_argument("--width", type=float, default=1.0, help="of a strip [half-widths]")
    parser.add_argument("--outlet", type=float, default=1.5, help="of film [half-widths]")
    parser.add_argument("--border", type=float, default=40e-6, help="shortest wave on the mesh [m]")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--map", type=Path, help="of film: file of a measured map")
    parser.add_argument("--travel", type=float, default=4.0, help="of the faster surface [half-widths]")
    parser.add_argument("--courant", type=float, default=1.0)
    parser.add_argument("-o", "--output", type=Path, metavar="FOLDER", help="of film: results with all steps")
    return parser


def main(words: list[str] | None = None) -> None:
    """Run the command."""
    chosen = arguments().parse_args(words)
    row, values = TABLES[chosen.table]
    for lay in chosen.lays:
        for at in chosen.at or values:
            print(f"lay {lay}, {at:g}: {row(chosen, float(lay), at)}", flush=True)


if __name__ == "__main__":
    main()
