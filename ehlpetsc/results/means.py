"""Totals of the scalars of all steps, and their means over the time in which roughness fills the contact.

One convention for all means: the steps are weighted by their length, those before the roughness of both
surfaces fills the contact by 0; a steady run is its own mean. Last, surfaces and contact after each pass.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import takewhile
from typing import TYPE_CHECKING, Any

import numpy as np

import ehlpetsc.effects  # noqa: F401 - which adds its quantities to the table of all
from ehlpetsc.base.quantities import MEANS, OTHERS, REDUCTIONS, STEP_SCALARS

if TYPE_CHECKING:
    from ehlpetsc.base.declarations import StepScalar
    from ehlpetsc.results.reader import Result

RESAMPLINGS, MEAN_CONFIDENCE, RESAMPLING_SEED = 4000, 0.9, 1  # of the bootstrap
SERIES_REDUCTIONS = ("sum", "min", "max")  # reductions that are meaningful over several runs


def filled_from(result: Result) -> float:
    """Time [s] from which the roughness of both surfaces fills the Hertz contact.

    A profile fills the contact when its heights after the ramp reach the far edge, a single ridge or dent
    when its centre is at x = 0. Smooth surfaces, including smooth surfaces that have yielded, and surfaces at
    rest fill the contact from the start. inf if a run with varying speeds ends before.
    """
    if len(result.steps("time")) < 2:
        return 0.0
    return max(_filled_by(result, side) for side in ("1", "2"))


def both_fill(result: Result, times: np.ndarray) -> np.ndarray:
    """Whether the roughness of both surfaces fills the contact at `times` [s], array of bool."""
    return np.asarray(times) >= filled_from(result) * (1.0 - 1e-12)


def filled_weights(result: Result, or_whole_run: bool = False) -> np.ndarray:
    """Weights of the steps in every mean [s], shape (nsteps,); 1 for a steady run.

    A run that ends before both surfaces fill the contact has weights of 0 or, with `or_whole_run`, those of
    all its steps.
    """
    time, dt = result.steps("time"), np.nan_to_num(result.steps("dt"))
    if len(time) == 1:
        return np.ones(1)
    filled = both_fill(result, time)
    return np.where(filled | (or_whole_run and not filled.any()), dt, 0.0)


def mean(result: Result, name: str, weights: np.ndarray) -> float:
    """Mean of the finite values of a scalar of the steps; nan without any."""
    if name not in result.scalars:
        return np.nan
    values = result.steps(name).astype(float)
    used = np.isfinite(values) & (weights > 0.0)
    return float(np.average(values[used], weights=weights[used])) if used.any() else np.nan


def means(result: Result) -> dict[str, float]:
    """Means of the scalars `ehlpetsc.base.quantities.MEANS`, by name, in the last line of a run.

    Empty if the run ends before both surfaces fill the contact.
    """
    weights = filled_weights(result)
    found = {name: mean(result, name, weights) for name in MEANS}
    return {name: value for name, value in found.items() if np.isfinite(value)}


def weighted_percentiles(values: np.ndarray, weights: np.ndarray, percentiles: Sequence[float]) -> np.ndarray:
    """Weighted percentiles of the finite values with a weight, both of shape (n,)."""
    used = np.isfinite(values) & (weights > 0.0)
    values, weights = values[used], weights[used]
    order = np.argsort(values)
    reached = 100.0 * (np.cumsum(weights[order]) - 0.5 * weights[order]) / weights.sum()
    return np.interp(percentiles, reached, values[order])


def bootstrap_bounds(values: np.ndarray) -> tuple[float, float]:
    """Bounds of the mean of values (n,): between them lies a share `MEAN_CONFIDENCE` of the means of n values
    that are drawn from them with replacement; nan of fewer than two.

    Efron, Annals of Statistics 7 (1979) 1: percentile method. Of few values it is too narrow: of ten by 15 %.
    """
    if values.size < 2:
        return np.nan, np.nan
    chosen = np.random.default_rng(RESAMPLING_SEED).integers(values.size, size=(RESAMPLINGS, values.size))
    tails = (1.0 - MEAN_CONFIDENCE) / 2.0, (1.0 + MEAN_CONFIDENCE) / 2.0
    low, high = np.quantile(values[chosen].mean(axis=1), tails)
    return float(low), float(high)


def _filled_by(result: Result, side: str) -> float:
    """Time [s] from which the roughness of one surface fills the contact."""
    from ehlpetsc.surfaces.motion.roughness import RAMP_LENGTH
    from ehlpetsc.surfaces.synthetic import SINGLE_FEATURES, bump_centre

    profile, speed = result.profile(side), result.attrs[f"u{side}"]
    if profile is None or speed == 0.0:
        return 0.0
    body = result.case.surface.side(side)
    feature = body and body.synthetic
    is_single = feature is not None and feature.kind in SINGLE_FEATURES
    if not (is_single or profile[1].any()):
        return 0.0
    a, leading = result.attrs["a"], profile[0].max() if speed > 0.0 else profile[0].min()
    reached = bump_centre(feature) if is_single else a + RAMP_LENGTH * a
    distance = reached - np.sign(speed) * leading
    if distance <= 0.0:
        return 0.0
    if f"steps/displacement_{side}" not in result:
        return distance / abs(speed)
    furthest = np.maximum.accumulate(np.abs(result.steps(f"displacement_{side}")))
    return float(np.interp(distance, furthest, result.steps("time"), right=np.inf))


def _reduced() -> list[tuple[str, StepScalar]]:
    return [(name, scalar) for name, scalar in STEP_SCALARS.items() if scalar.over_run]


class Totals:
    """Totals `values` of the steps so far, by name, and `means` of the run, see :func:`means`."""

    def __init__(self, values: dict[str, float] | None = None, means: dict[str, float] | None = None) -> None:
        self.values, self.means = dict(values or {}), dict(means or {})

    @classmethod
    def of_result(cls, result: Result) -> Totals:
        """Totals and means of a stored run."""
        names = [name for name, _ in _reduced() if name in result.scalars]
        steps = {name: result.steps(name).tolist() for name in names}
        return cls({n: REDUCTIONS[STEP_SCALARS[n].over_run](v) for n, v in steps.items() if v}, means(result))

    @classmethod
    def of_series(cls, runs: Iterable[Totals]) -> Totals:
        """Sums and extremes of several runs."""
        totals = [run.values for run in runs]
        kinds = {name: scalar.over_series or scalar.over_run for name, scalar in _reduced()}
        columns = {
            name: [values[name] for values in totals if name in values]
            for name, kind in kinds.items()
            if kind in SERIES_REDUCTIONS
        }
        return cls({name: REDUCTIONS[kinds[name]](values) for name, values in columns.items() if values})

    def add(self, scalars: dict[str, float]) -> None:
        """Add the scalars of the next step."""
        for name, scalar in _reduced():
            if name in scalars:
                values = [self.values[name]] if name in self.values else []
                self.values[name] = REDUCTIONS[scalar.over_run]([*values, scalars[name]])

    def __str__(self) -> str:
        """``name=value`` of the last line of a run, then the means; 0 before the first step."""
        entries = [
            (scalar.label or name, self.values.get(name, 0), scalar.summary)
            for name, scalar in _reduced()
            if scalar.summary and (name in self.values or not scalar.only)
            if not (name in MEANS and scalar.over_run == "last")
        ]
        entries += [(name, value, ".4g") for name, value in self.means.items()]
        return " ".join(f"{label}={value:{form}}" for label, value, form in entries)


SHIFTED_IN_A_ROW = 10  # consecutive run-in passes required with shifted surfaces
RUN_IN = 0.01  # of the volume added by the first pass: surfaces are run in if a pass adds less
OF_A_PASS = ("contact_share", "contact_length", "contact_area", "thin_share", "friction_coefficient")


def pass_summary(result: Result) -> dict[str, Any]:
    """Roughness and depths at the end of a pass, and means over the time that both surfaces fill the contact.

    In SI units; a surface that is not stored is None.
    """
    steps, weights = result.steps, filled_weights(result)
    values = {name: mean(result, name, weights) for name in OF_A_PASS if name in result.scalars}
    summary = {name: value if np.isfinite(value) else None for name, value in values.items()}
    summary |= {"p_max": float(steps("p_max").max()), "newton": int(steps("newton").sum())}
    summary |= {name: float(steps(name)[-1]) for name in result.scalars if name.endswith("_volume")}
    summary.setdefault("set_volume", 0.0)
    return summary | {side: statistics(result, side) for side in ("1", "2")}


def heights(result: Result, side: str) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    """Body points, original heights and heights after the pass [m]; None: not stored."""
    name = f"surface/{side}"
    if f"{name}/s" not in result:
        return None
    s, z = result[f"{name}/s"][:], result[f"{name}/z"][:]
    places = [key.replace("surface", name, 1) for key in OTHERS if key.startswith("surface/")]
    depths = [result[place][:] for place in places[2:] if place in result]  # without s and z
    return s, z, z - sum(depths)


def statistics(result: Result, side: str) -> dict[str, float] | None:
    """Ra, Rq [m], Rsk, Rku and maximum indentation [m] of a surface after a pass."""
    from ehlpetsc.surfaces.parameters import moments

    surface = heights(result, side)
    if surface is None:
        return None
    _, z, z_after = surface
    found = {f"r{name}": float(np.nan_to_num(value)) for name, value in moments(z_after).items()}
    return found | {"deepest": float((z - z_after).max())}


def passes_to_run_in(rows: list[dict], in_a_row: int = 1) -> int | None:
    """First of the passes that all add less than `RUN_IN` of the first pass's volume; None: not run in.

    `rows` are the entries of the index from the first pass on, with the number "pass" and the volume "added".
    `in_a_row` such passes are required: with shifted surfaces, a pass that adds little may be an exception.
    """
    if not rows or rows[0]["pass"] != 1 or rows[0]["added"] <= 0.0:
        return None
    small = list(takewhile(lambda row: row["added"] < RUN_IN * rows[0]["added"], reversed(rows)))
    return small[-1]["pass"] if len(small) >= in_a_row else None
