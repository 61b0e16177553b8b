"""Damage by waves of 5 to 15 um, which the ensembles of `cases/micropitting.md` leave out, on a line.

``ehlpetsc python cases/paper/short_waves.py FOLDER [SEED ...]`` computes one pass of the line contact of
`cases/micropitting.toml` under ridges down to `SHORTEST` and under the same ridges without waves below
`LONGEST`, on a mesh that resolves both and on that of the page, and prints the largest pressure, passes to
the first failure of both surfaces and its depth.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
from micropit_scenes import COMMON, WAVES

from ehlpetsc.case.loading import load
from ehlpetsc.life.driver import run_life
from ehlpetsc.life.history import LifeHistory
from ehlpetsc.surfaces.synthetic import self_affine

CASE = Path(__file__).parent.parent / "micropitting.toml"
SHORTEST, LONGEST = 5e-6, 15e-6  # m, of the waves that are added
SQ = 0.1e-6  # m, of the waves above
SEEDS = (1, 2, 3)
RUNS = (("all", 96), ("long", 96), ("long", 32))  # waves, nodes per half-width


class Figures(NamedTuple):
    """Largest pressure [Pa], passes to the first failure of both surfaces and its depths [m]."""

    pressure: float
    passes: np.ndarray
    depths: np.ndarray


def profiles(seed: int) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Abscissas [m], and heights with all waves and with those above `LONGEST` alone, of Sq `SQ` [m]."""
    waves: dict[str, Any] = WAVES | {"sq": SQ, "short_cutoff": SHORTEST, "seed": seed}
    x, heights = self_affine(SimpleNamespace(**waves))
    transform = np.fft.rfft(heights)
    transform[np.fft.rfftfreq(x.size, x[1] - x[0]) > (1.0 + 1e-9) / LONGEST] = 0.0
    long = np.fft.irfft(transform, x.size)
    factor = SQ / long.std()
    return x, {"all": factor * heights, "long": factor * long}


def settings(file: Path, nodes: int) -> dict[str, Any]:
    """Settings of one pass under the ridges of a file."""
    surface = {"surface.1": {"file": str(file)}, "mesh.width": None, "time.travel": 8.0}
    return COMMON | surface | {"mesh.points_per_half_width": nodes}


def figures(life: LifeHistory) -> Figures:
    """Maximum pressure, passes to failure and its depths in the first pass of a life."""
    bodies, worst = life.bodies[0], []
    for body in bodies:
        of_depth = body.damage_rate.max(axis=1)
        worst.append((1.0 / of_depth.max(), 0.5 * body.edges[of_depth.argmax() :][:2].sum()))
    passes, depths = np.array(worst).T
    return Figures(life.rows[0]["p_max"], passes, depths)


def line(seed: int, waves: str, nodes: int, found: Figures) -> str:
    """Line of a run."""
    text = f"seed {seed}, {waves} waves, a/{nodes}: {found.pressure / 1e9:.2f} GPa, first failures after "
    text += "{:.3g} and {:.3g} passes".format(*found.passes)
    return text + ", {:.1f} and {:.1f} um deep".format(*(1e6 * found.depths))


def main(words: list[str] | None = None) -> None:
    """Compute and print."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("folder", type=Path, help="of the lives and profiles")
    parser.add_argument("seeds", nargs="*", type=int, metavar="SEED", help="of the ridges")
    chosen = parser.parse_args(words)
    chosen.folder.mkdir(exist_ok=True, parents=True)
    for seed in chosen.seeds or SEEDS:
        x, heights = profiles(seed)
        for waves, nodes in RUNS:
            file = chosen.folder.resolve() / f"{waves}_{seed}.csv"
            np.savetxt(file, np.column_stack([x, heights[waves]]), delimiter=",", header="x,z", comments="")
            path = chosen.folder / f"{waves}_{nodes}_{seed}.life.h5"
            life = run_life(load(CASE, settings(file, nodes)), path, unresolved=True)
            print(line(seed, waves, nodes, figures(life)), flush=True)


if __name__ == "__main__":
    main()
