"""Damage of ground over that of superfinished gears, for three pairs of seeds, beside measured lives.

``ehlpetsc python cases/paper/superfinished.py [--seeds 1,2 3,4 ...] [--store] [-o PICTURE]`` computes
`cases/superfinished.toml` with the seeds of both flanks, and prints and draws, for each depth z, the ratio of
the maximum damage from z down, by the paper's rule and by Fatemi and Socie's, and both over the damage of the
smooth contact. Results are files `superfinished_SEEDS_*.h5`; those that exist are used.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import measured_data
import numpy as np
from matplotlib.figure import Figure

from ehlpetsc.api import solve
from ehlpetsc.case.loading import load, members
from ehlpetsc.pictures import style
from ehlpetsc.post.run import Job
from ehlpetsc.post.run import run as post
from ehlpetsc.results.post_result import PostResult, post_path

CASE = Path(__file__).parents[1] / "superfinished.toml"
FILE = "superfinished.csv"
DEPTHS = (0.05, 0.1, 0.2, 0.3)  # half-widths, of the ratios
MEASURED = (4.0, 5.0)  # ratio of L10
CRITERIA = {
    "neuber": None,
    "fatemi_socie": "fatemi-socie",
}  # column: criterion of a result, None: the paper's
COLUMNS = ("seed_1", "seed_2", "depth", *CRITERIA, "over_smooth")  # the last of superfinished flanks
Pair = tuple[int, int]


def pairs() -> list[Pair]:
    """Published pairs of seeds."""
    data = measured_data.read(FILE).columns
    return list(dict.fromkeys(zip(data["seed_1"].astype(int), data["seed_2"].astype(int), strict=True)))


def pair(word: str) -> Pair:
    """Seeds of both flanks from "1,2"; ValueError of other words."""
    first, second = map(int, word.split(","))
    return first, second


def damaged(
    seeds: Pair, folder: Path = Path(), changes: dict[str, Any] | None = None, criteria: tuple[str, ...] = ()
) -> list[PostResult]:
    """Post-processed results of the ground and of the superfinished flanks; `changes`: keys of the case."""
    of_seeds = {f"surface.{side}.synthetic.seed": seed for side, seed in zip((1, 2), seeds, strict=True)}
    found = []
    finishes = members(load(CASE, of_seeds | (changes or {})))
    for name, (_, member) in zip(("ground", "superfinished"), finishes, strict=True):
        file = folder / f"superfinished_{seeds[0]}_{seeds[1]}_{name}.h5"
        if not file.exists():
            solve(member, file, progress=False).close()
        job = Job(str(file), str(post_path(file)), criteria=criteria)
        if not job.is_done():
            post(job)
        found.append(PostResult(job.output))
    return found


def over_smooth(results: list[PostResult], criterion: str | None = None) -> np.ndarray:
    """Maximum damage from each of `DEPTHS` down over that of the smooth contact, shape (finishes, depths)."""
    maxima = []
    for result in results:
        of_depth = np.max([result.passed(side, criterion).max(axis=1) for side in result.surfaces], axis=0)
        smooth = max(contact.damage.max() for contact in result.smooth[criterion].values())
        maxima.append([of_depth[result.z > depth - 1e-6].max() / smooth for depth in DEPTHS])
    return np.array(maxima)


def draw(found: dict[Pair, np.ndarray]) -> Figure:
    """Ratios over the depth, a colour for each pair, beside the measured ratio of lives.

    Dotted: damage of superfinished flanks over that of the smooth contact.
    """
    figure, panel = style.new_figure(1, 1, (6.4, 4.2))
    panel.axhspan(*MEASURED, color=style.DARK, alpha=0.2, lw=0, label="measured, L10")
    for (seeds, of), colour in zip(found.items(), style.shades(len(found)), strict=True):
        panel.plot(DEPTHS, of[0], "o-", color=colour, lw=1.2, label=f"seeds {seeds[0]}, {seeds[1]}")
        panel.plot(DEPTHS, of[1], "--", color=colour, lw=0.8)
        smooth = "superfinished over smooth contact" if seeds == list(found)[-1] else None
        panel.plot(DEPTHS, of[2], ":", color=colour, lw=1.2, label=smooth)
    panel.set(yscale="log", xlabel="depth z/a", ylabel="damage of ground over superfinished flanks")
    panel.yaxis.set_major_formatter("{x:g}")
    panel.grid(lw=0.3, which="both")
    panel.legend(**style.SMALL)
    style.set_title(figure, "Maximum damage from a depth down (dashed: Fatemi and Socie)")
    return figure


def main(words: list[str] | None = None) -> None:
    """Print the table and write the picture."""
    parser = measured_data.parser(__doc__, "superfinished_lives.png")
    parser.add_argument(
        "--seeds",
        nargs="+",
        type=pair,
        default=pairs(),
        metavar="S1,S2",
        help="of both flanks [as published]",
    )
    parser.add_argument("--store", action="store_true", help="write the file anew")
    chosen = parser.parse_args(words)
    print(
        "seeds: damage of ground over superfinished flanks, from z/a = "
        + ", ".join(map(str, DEPTHS))
        + " down"
    )
    found = {}
    for seeds in chosen.seeds:
        results = damaged(seeds, criteria=("fatemi-socie",))
        by_criterion = [over_smooth(results, criterion) for criterion in CRITERIA.values()]
        found[seeds] = np.array([*(np.divide(*one) for one in by_criterion), by_criterion[0][1]])
        text = [", ".join(f"{ratio:.3g}" for ratio in row) for row in (*found[seeds], by_criterion[0][0])]
        print(
            f"{seeds[0]}, {seeds[1]}: {text[0]}; {text[1]} by Fatemi and Socie; over the smooth contact "
            f"superfinished {text[2]}, ground {text[3]}",
            flush=True,
        )
    if chosen.store:
        rows = [(*seeds, depth, *of[:, k]) for seeds, of in found.items() for k, depth in enumerate(DEPTHS)]
        columns = ([f"{value:.4g}" for value in column] for column in zip(*rows, strict=True))
        measured_data.store(FILE, **dict(zip(COLUMNS, columns, strict=True)))
    style.save(draw(found), chosen.output)
    print(chosen.output)


if __name__ == "__main__":
    main()
