"""Random cases within the ranges of the table of extremes, which end with 0 or 3 and a complete file."""

import math
import random
import tempfile
from pathlib import Path

from ehlpetsc.errors import ExitStatus, OutputError
from ehlpetsc.physics.film_formulas import moes_central_film, points_for_opening
from ehlpetsc.physics.scales import moes_groups, reduced_modulus
from ehlpetsc.results.reader import read_result
from ehlpetsc.study.cases import (
    BARUS,
    MODULUS,
    POISSON,
    PROFILES,
    RADIUS,
    ROELANDS,
    TABLE_1,
    ground,
    inlet_of,
    load_of,
    wave,
)
from ehlpetsc.study.runs import csv_table, run

COLUMNS = ("number", "status", "steps", "retries", "newton", "file", "message", "overrides")
STEPS = 50  # time steps of a case
MAX_OPENING = 3.0  # films by which the gap opens from node to node outside the contact
STEEL, SOFT_AND_HARD = [207e9, 207e9], ([3e9, 207e9], [600e9, 600e9])  # Young's moduli [Pa]
MODELS = ("direct", "mixed")
EVERY_SLIDING = (0.0, 0.1, 1.0, 1.9, 2.0, 4.0)


def draw(rng):
    """Draw a case text and its overrides.

    Parameters
    ----------
    rng : random.Random

    Returns
    -------
    text : str
    overrides : list of str
    """

    def between(low, high):  # uniform in the logarithm
        return math.exp(rng.uniform(math.log(low), math.log(high)))

    text = rng.choice((TABLE_1, TABLE_1, BARUS, ROELANDS))
    viscosity, speed, load = between(0.0005, 1.0), between(0.01, 50.0), load_of(1e9 * between(0.2, 3.0))
    if text is BARUS:  # pressures up to 1 GPa
        load = load_of(1e9 * between(0.2, 1.0))
    alpha = {TABLE_1: 11.1, BARUS: rng.uniform(5.0, 25.0), ROELANDS: rng.uniform(10.0, 25.0)}[text]
    moduli = rng.choice(SOFT_AND_HARD) if rng.random() < 0.1 else STEEL
    model, courant = rng.choice(MODELS), between(0.05, 4.0)
    points = int(between(25, 200))
    if model == "direct":  # a mesh that is too coarse for the film is refused
        modulus = reduced_modulus(moduli, POISSON)
        m, ell = moes_groups(viscosity, speed, alpha * 1e-9, load, RADIUS, modulus)
        film = math.pi / (8.0 * m) * moes_central_film(m, ell)
        points = max(points, math.ceil(points_for_opening(film, MAX_OPENING)))
    inlet = inlet_of(load, viscosity, speed, alpha * 1e-9) if rng.random() < 0.5 else -rng.uniform(1.2, 6.0)
    overrides = [
        f"fluid.viscosity={viscosity:.4g}",
        f"fluid.pressure_viscosity={alpha:.3g}e-9",
        f"motion.entrainment_speed={speed:.4g}",
        f"motion.slide_roll_ratio={rng.choice((1, -1)) * rng.choice(EVERY_SLIDING)}",
        f"contact.load={load:.6g}",
        f"mesh.points_per_half_width={points}",
        f"mesh.inlet={max(inlet, -10.0):.3f}",
        f"mesh.near_field={rng.choice((5, 8, 20, 50, 100))}",
        f"time.courant={courant:.3g}",
        f"time.travel={STEPS * courant / points:.6g}",
    ]
    if text is ROELANDS:
        overrides.append(f"fluid.roelands_z={rng.uniform(0.4, 0.8):.3f}")
    if moduli != STEEL:
        overrides.append(f"contact.youngs_modulus={moduli}")
    if rng.random() < 0.1:
        overrides.append(f"fluid.inlet_film={between(0.02e-6, 1e-6):.3g}")
    a = math.sqrt(8.0 * load * RADIUS / (math.pi * MODULUS))
    for side in ("1", "2"):
        overrides += _surface(rng, between, side, a, points)
    return text, [*overrides, f"contact.model={model}"]


def _surface(rng, between, side, a, points):
    """Surface: smooth, ground, waves, a spike, or the dusty profile."""
    length = a * between(6.0 / points, 2.0)
    kind = rng.choice(("smooth", "ground", "ground", "sine", "square", "ridge", "dust"))
    if kind == "smooth":
        return []
    if kind == "dust":
        return [f'surface.{side}.file="{PROFILES / "hommel_stylus_profile.csv"}"']
    height = between(0.01e-6, 1e-6)
    spec = ground(height, rng.randrange(1000), length) if kind == "ground" else wave(kind, height, length)
    return [f"surface.{side}.synthetic={spec}"]


def run_all(count, seed, path, limit, say=print):
    """Run `count` cases, each with its own seed, so that a single case can be repeated.

    Returns
    -------
    int
        Number of cases with another status than 0 and 3, or with a damaged file.
    """
    wrong, converged = 0, 0
    with tempfile.TemporaryDirectory() as folder, csv_table(path, COLUMNS) as append:
        for number in range(count):
            row = run_one(seed + number, Path(folder), limit)
            converged += row["status"] == ExitStatus.DONE
            if row["status"] not in (ExitStatus.DONE, ExitStatus.NOT_CONVERGED) or row["file"] == "broken":
                wrong += 1
            append(row)
            if row["status"] != ExitStatus.DONE:
                say(
                    f"{row['number']}: exit {row['status']}, {row['steps']} steps, file {row['file']}: "
                    f"{row['message']} | {row['overrides']}"
                )
    say(f"{count} cases: {converged} converged, {count - converged - wrong} exit 3, {wrong} wrong")
    return wrong


def run_one(seed, folder, limit):
    """Run the case of a seed; return its row."""
    text, overrides = draw(random.Random(seed))
    case = folder / "case.toml"
    case.write_text(text)
    outcome = run(case, overrides, folder=folder, limit=limit)
    return {
        "number": seed,
        "status": outcome.status,
        "steps": outcome.steps,
        "retries": outcome.retries,
        "newton": outcome.newton,
        "file": _file_state(folder / "run.h5"),
        "message": outcome.message,
        "overrides": "; ".join(overrides),
    }


def _file_state(path):
    """Whether a result file, if it exists, can be opened and is complete."""
    if not path.exists():
        return "none"
    try:
        with read_result(path) as result:
            frames = len(result.time)
            result.frame("pressure", frames - 1)
            return "whole" if frames else "broken"
    except (OutputError, OSError, KeyError, IndexError):
        return "broken"
