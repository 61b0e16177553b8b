r"""Several results as passes of one surface: mean, scatter and passes to failure by Miner's sum.

In each pass the surface is in contact with another part of the other surface. After M passes
:math:`\sum_m D_m = M\bar D`, and failure is expected after :math:`1/\bar D` passes (Palmgren-Miner).
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ehlpetsc.base.errors import PostError
from ehlpetsc.post.contents import write_result
from ehlpetsc.results.index import read_index
from ehlpetsc.results.output_guard import Lock, atomic_write
from ehlpetsc.results.post_result import PostResult, damage_beside
from ehlpetsc.results.reader import read_result

PROFILE_TOLERANCE = 1e-3  # of a spacing of body points; of the profile's height


class Passes(NamedTuple):
    """Statistics of D of each point over its `count` passes; deviation with n - 1, nan for one pass.

    `life` is the number of passes to failure 1/mean, infinite without damage.
    """

    mean: np.ndarray
    deviation: np.ndarray
    largest: np.ndarray
    count: np.ndarray  # type: ignore[assignment]
    life: np.ndarray


def pass_statistics(damages: np.ndarray) -> Passes:
    """Statistics over passes, shape (...), from D of each pass, shape (passes, ...).

    D is nan for points that did not pass.
    """
    damages = np.asarray(damages, float)
    passed = ~np.isnan(damages)
    count = passed.sum(axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        mean = np.where(passed, damages, 0).sum(axis=0) / count
        squares = np.where(passed, (damages - mean) ** 2, 0).sum(axis=0)
        deviation = np.where(count > 1, np.sqrt(squares / (count - 1)), np.nan)
        largest = np.where(count > 0, np.where(passed, damages, -np.inf).max(axis=0), np.nan)
        return Passes(mean, deviation, largest, count, 1 / mean)


def same_points(results: Sequence[PostResult], surface: str) -> tuple[np.ndarray, np.ndarray]:
    """s [m] of the points that passed in every result, and their damage (results, nz, points).

    PostError if the results are not passes of one body.
    """
    first = results[0]
    spacing = first.s[1] - first.s[0]
    offsets = []  # of the points of each result, in spacings from the first point of the first one
    for other in results:
        if other.z.shape != first.z.shape or not np.allclose(other.z, first.z):
            raise PostError("the results have different depths: give --depths")
        if not _is_same_profile(first, other, surface):
            raise PostError(f"the profiles of surface {surface} differ: these are not passes of one body")
        offset = (other.s[0] - first.s[0]) / spacing
        is_on_grid = abs(offset - round(offset)) <= PROFILE_TOLERANCE
        if abs((other.s[1] - other.s[0]) / spacing - 1) > 1e-6 or not is_on_grid:
            raise PostError("the results have different body points: passes need one mesh")
        offsets.append(round(offset))
    passed = [
        set(start + np.flatnonzero(r.complete[surface])) for start, r in zip(offsets, results, strict=True)
    ]
    common = np.array(sorted(set.intersection(*passed)), int)
    if not common.size:
        raise PostError(f"no point of surface {surface} passed the whole contact in all of the results")
    rows = [r.damage[surface][:, common - start] for start, r in zip(offsets, results, strict=True)]
    return first.s[0] + spacing * common, np.stack(rows)


def _is_same_profile(first: PostResult, other: PostResult, surface: str) -> bool:
    if (surface in first.profiles) != (surface in other.profiles):
        return False
    if surface not in first.profiles:
        return True
    (s, z), (other_s, other_z) = first.profiles[surface], other.profiles[surface]
    inside = (s >= other_s[0]) & (s <= other_s[-1])
    deviation = np.abs(np.interp(s[inside], other_s, other_z) - z[inside])
    return bool(inside.any() and deviation.max() <= PROFILE_TOLERANCE * np.ptp(z))


def store_passes(path: str | Path, results: Sequence[PostResult], surface: str) -> Passes:
    """Statistics (nz, points) of each point of a surface over its passes, also written to `path`."""
    s, damages = same_points(results, surface)
    statistics = pass_statistics(damages)
    values = {"damage/s": s, "damage/z_over_a": results[0].z}
    values |= {f"damage/{surface}_{name}": value for name, value in statistics._asdict().items()}
    sources = "\n".join(str(result.path) for result in results)
    attributes = {"a": results[0].a, "surface": surface, "sources": sources, "passes": len(results)}
    write_result(path, values, attributes)
    return statistics


def note_damage(index: str | Path) -> list[tuple[int, dict]]:
    """Add the damage of every pass to an index of passes, under "damage"; the number and damage of each pass.

    The damage is that of `ehlpetsc.results.post_result.PostResult.summary`.
    """
    index = Path(index)
    with Lock(index, "wait for it"):
        content, damages = read_index(index), []
        for row in content["passes"]:
            with read_result(index.with_name(row["file"])) as result:
                damage = damage_beside(result)
            if damage is not None:
                row["damage"] = damage.summary()
                damages.append((row["pass"], row["damage"]))
        atomic_write(index, json.dumps(content, indent=1).encode())
    return damages
