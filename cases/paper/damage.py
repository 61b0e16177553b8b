"""Damage at several slide/roll ratios: figures 9, 11 and 12 of Holmes et al. (2005).

``./run_mpi.sh python cases/paper/damage.py A.post.h5 B.post.h5 [...] [-o FOLDER]`` draws damage near the main
surface on one scale, and its distributions over the asperities at each depth.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from ehlpetsc.pictures import style
from ehlpetsc.pictures.damage_maps import SECTION_LENGTH, Map, draw_maps, rule_name
from ehlpetsc.pictures.weibull import draw_distributions
from ehlpetsc.results.post_result import PostResult

LAYER_DEPTH = 0.2  # half-widths: damage below asperities is shallower


def label(result: PostResult) -> str:
    """Slide/roll ratio of a result."""
    return f"slide/roll ratio {result.ratio:.3g}"


def maps(results: list[PostResult]) -> Figure:
    """Damage near the surface on one scale (figure 9)."""
    first = results[0]
    panels = [Map(label(result), result, result.damage[first.main]) for result in results]
    title = [f"surface {first.main}, {rule_name(first)}"]
    return draw_maps(panels, first.main, title, SECTION_LENGTH, LAYER_DEPTH)


def distributions(results: list[PostResult], depth: int) -> Figure:
    """Damage at the asperities at one depth (figures 11 and 12)."""
    first = results[0]
    curves = [(label(result), result.under[depth], result.fits[depth]) for result in results]
    return draw_distributions(curves, f"z/a = {first.z[depth]:g}, surface {first.main}, {rule_name(first)}")


def main(words: list[str] | None = None) -> None:
    """Run the command."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("results", nargs="+", type=Path, help="RESULT.post.h5, of the same depths")
    parser.add_argument("-o", "--output", type=Path, default=Path("."), metavar="FOLDER")
    chosen = parser.parse_args(words)
    results = sorted(map(PostResult, chosen.results), key=lambda result: result.ratio)
    if any(not np.array_equal(result.z, results[0].z) for result in results):
        parser.error("results of different depths")
    chosen.output.mkdir(exist_ok=True)
    style.save(maps(results), chosen.output / "damage_ratios.png")
    for depth, z in enumerate(results[0].z):
        style.save(distributions(results, depth), chosen.output / f"exceedance_z{z:g}.png")


if __name__ == "__main__":
    main()
