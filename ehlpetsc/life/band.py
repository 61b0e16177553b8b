"""Band of a life over fatigue criteria: passes to the first failure of one solved pass, without wear.

The criteria are fitted to the same strain-life tests and differ by the stresses that they count; none is
tested for rolling contact. The band is the least uncertainty of a life; ratios of lives by one criterion are
more certain.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from ehlpetsc.post.loads import Loads
from ehlpetsc.post.prepare import prepare
from ehlpetsc.post.run import Job, solve

CRITERIA = {  # name: post.criterion, post.mean_stress
    "von-mises": ("von-mises", "none"),
    "morrow": ("von-mises", "morrow"),
    "goodman": ("von-mises", "goodman"),
    "fatemi-socie": ("fatemi-socie", "none"),
}
SIDES = ("1", "2")


def passes_to_failure(file: Path, settings: tuple[str, ...] = ()) -> tuple[float, float]:
    """Passes until D = 1 at the worst point of each surface, of the pass in a result file."""
    with Loads(file, settings) as loads:
        job, prepared = Job(str(file), "", settings=settings), prepare(loads, SIDES, lambda text: None)
        worst = []
        for side in SIDES:
            values = solve(prepared, side, job)
            damage = values.get(f"criteria/fatemi_socie/{side}_damage", values[f"damage/{side}"])
            worst.append(float(np.nanmax(damage)))
    first, second = (1.0 / damage if damage > 0.0 else np.inf for damage in worst)
    return first, second


def band(file: Path) -> dict[str, tuple[float, float]]:
    """`passes_to_failure` by each of the `CRITERIA`."""
    return {
        name: passes_to_failure(file, (f"post.criterion={criterion}", f"post.mean_stress={mean}"))
        for name, (criterion, mean) in CRITERIA.items()
    }


def lines_of(found: dict[str, tuple[float, float]], chosen: tuple[float, float]) -> Iterator[str]:
    """Lines of a band: ratios of each criterion to the `chosen` one, and the factor of the band."""
    for k, side in enumerate(SIDES):
        lives = [both[k] for both in found.values()]
        ratios = ", ".join(f"{name} {both[k] / chosen[k]:.2g}" for name, both in found.items())
        yield (
            f"first failure of surface {side} by criterion, over {chosen[k]:.3g} passes: {ratios} "
            f"(band of a factor {max(lives) / min(lives):.2g})"
        )
