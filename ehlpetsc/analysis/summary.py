"""Statistics of results as tables: of runs, of ensembles, of the steps of one run, of one frame.

Means are over the time in which both surfaces fill the contact, or over the whole run if it ends before. SI
units.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ehlpetsc.base.errors import OutputError, UsageError
from ehlpetsc.base.quantities import STEP_SCALARS
from ehlpetsc.results.index import differences, distinguishing_names, groups, key_with_unit, setting_of
from ehlpetsc.results.means import bootstrap_bounds, filled_weights, mean, weighted_percentiles
from ehlpetsc.results.post_result import DAMAGED, PostResult, damage_beside, is_damaged
from ehlpetsc.results.reader import Result

QUANTILES = (0.5, 0.9, 0.99)  # of damage over the points of a surface
EXTREMES = {"h_min": min, "p_max": max, "oil_pressure": max, "mass_error": max, "load_error": max}
UNITS = {"flash_temperature": "K", "life_": "passes", "smooth_depth": "m"}  # of names with the word
ENSEMBLE_COLUMNS = ("ensemble", "scalar", "unit", "runs", "mean", "deviation", "min", "max", "low", "high")


def run_scalars(result: Result) -> dict[str, float]:
    """Scalars of one run, by name; OutputError without a time step.

    Means over the time in which the roughness of both surfaces fills the contact, or over the whole run if it
    never does; extremes of the scalars in `EXTREMES`. If RESULT.post.h5 exists, also quantiles of damage and
    flash temperatures [K].
    """
    if not len(result.steps("time")):
        raise OutputError(f"{result.path}: no time step in it")
    weights = filled_weights(result, or_whole_run=True)
    selected = weights > 0.0
    scalars = {}
    for name in result.scalars:
        values = result.steps(name)[selected].astype(float)
        if name in (*EXCLUDED_SCALARS, "load") or not np.isfinite(values).all():
            continue
        reduce = EXTREMES.get(name)
        scalars[name] = float(reduce(values)) if reduce else mean(result, name, weights)
    post = damage_beside(result)
    return scalars | damage_scalars(post) if post else scalars


def damage_scalars(post: PostResult) -> dict[str, float]:
    """Maximum and quantiles of damage, lives, flash temperatures [K] over the points of each surface.

    Of a criterion that was computed too, the names begin with its name. A life is 1/D of the most damaged
    depth below a point [passes], of the worst point and of the points that 1 and 10 % of the surface exceed.
    A share is that of the points that asperities damage at some depth, see
    :func:`~ehlpetsc.results.post_result.is_damaged`, in one pass. Life [passes] and depth [m] of the smooth
    contact are beside them.
    """
    found: dict[str, float] = {}
    for surface in post.surfaces:
        for criterion in (None, *post.criteria):
            values = post.passed(surface, criterion)
            if values.size:
                found |= _points(values, post, surface, criterion)
        flash = post.temperatures[surface].flash if surface in post.temperatures else np.array([np.nan])
        if np.isfinite(flash).any():
            found[f"flash_temperature_{surface} largest"] = float(np.nanmax(flash))
            found[f"flash_temperature_{surface} q=0.5"] = float(np.nanmedian(flash))
    return found


def _points(values: np.ndarray, post: PostResult, surface: str, criterion: str | None) -> dict[str, float]:
    """Statistics of the damage (depths, points) of a surface, or of the utilisation of the fatigue limit."""
    prefix = f"{criterion} " if criterion else ""
    quantity = "utilisation" if criterion == "dang-van" else "damage"
    found: dict[str, float] = {}
    for depth, row in zip(post.z, values, strict=True):
        name = f"{prefix}{quantity}_{surface} z/a={depth:g}"
        found |= {f"{name} q={q:g}": float(np.quantile(row, q)) for q in QUANTILES}
        found[f"{name} largest"] = float(row.max())
    if quantity == "utilisation":
        return found
    worst = values.max(axis=0)
    smooth = post.smooth[criterion][surface]
    damaged = is_damaged(values, smooth.damage_at(post.a * post.z)[:, None])
    found[f"{prefix}share_{surface} D>{DAMAGED:g}"] = float(damaged.any(axis=0).mean())
    found |= {f"{prefix}smooth_life_{surface}": smooth.life, f"{prefix}smooth_depth_{surface}": smooth.depth}
    name = f"{prefix}life_{surface}"
    with np.errstate(divide="ignore"):
        found[f"{name} worst"] = float(1.0 / worst.max())
        found |= {f"{name} q={1.0 - q:g}": float(1.0 / np.quantile(worst, q)) for q in QUANTILES[:0:-1]}
    return found


def ensembles(results: list[Result]) -> dict[str, dict[str, np.ndarray]]:
    """Scalars of the runs whose cases differ only in keys named seed, shape (runs,), by the other conditions.

    The conditions are keys and values in which ensembles differ, "" for a single ensemble.
    """
    found: dict[str, dict] = {}
    for name, members in groups(results, "seed").items():
        runs = [run_scalars(result) for result in members]
        common = [scalar for scalar in runs[0] if all(scalar in run for run in runs)]
        found[name] = {scalar: np.array([run[scalar] for run in runs]) for scalar in common}
    return found


def ensemble_table(results: list[Result]) -> list[Sequence]:
    """Names of the columns, then a row for each scalar of each ensemble."""
    found = ensembles(results)
    if len(found) == len(results) > 1:
        raise OutputError(
            f"{len(results)} results of as many conditions: no two differ in their seeds alone; "
            "without --ensemble single runs are listed"
        )
    rows: list[Sequence] = [ENSEMBLE_COLUMNS]
    for ensemble, scalars in found.items():
        for name, values in scalars.items():
            with np.errstate(invalid="ignore"):  # of lives without end
                deviation = values.std(ddof=1) if values.size > 1 else np.nan
                bounds = bootstrap_bounds(values)
            reduced = values.mean(), deviation, values.min(), values.max(), *bounds
            rows.append(
                (ensemble, name, _unit(results[0], name), values.size, *(f"{v:.6g}" for v in reduced))
            )
    return rows


EXCLUDED_SCALARS = ("step", "time", "dt", "wall", "approach")
PERCENTILES = (5.0, 50.0, 95.0)
CSV_COLUMNS = tuple("result case scalar unit mean p5 median p95 min max last from_s steps".split())


def statistics(result: Result) -> list[tuple]:
    """Statistics of each scalar of a result: values of `CSV_COLUMNS` from "scalar" on."""
    time, dt = result.steps("time"), np.nan_to_num(result.steps("dt"))
    weights = filled_weights(result, or_whole_run=True)
    rows = []
    for name in [name for name in STEP_SCALARS if name in result.scalars and name not in EXCLUDED_SCALARS]:
        values = result.steps(name).astype(float)
        usable = np.isfinite(values) & (weights > 0.0)
        if usable.any():
            v, percentiles = values[usable], weighted_percentiles(values, weights, PERCENTILES)
            reduced = (mean(result, name, weights), *percentiles, v.min(), v.max(), v[-1])
            unit = result.unit(f"steps/{name}")
            begin = (time - dt)[usable][0]
            rows.append((name, unit, *(f"{x:.6g}" for x in reduced), f"{begin:.6g}", int(usable.sum())))
    return rows


def table(results: list[Result]) -> list[tuple]:
    """Names of the columns, then the rows of all results."""
    cases = distinguishing_names(results) or [str(result.attrs["title"]) for result in results]
    rows = [CSV_COLUMNS]
    for result, case in zip(results, cases, strict=True):
        rows += [(result.path.name, case, *row) for row in statistics(result)]
    return rows


def wide_table(results: list[Result]) -> list[Sequence]:
    """Names with units of keys in which the cases differ and of all scalars; a row of means for each result.

    Values of keys in SI units, as of the case, not as texts with a unit.
    """
    keys = list(differences(results))
    scalars = [run_scalars(result) for result in results]
    names = list(dict.fromkeys(name for of_result in scalars for name in of_result))
    units = [_unit(results[0], name) for name in names]
    rows: list[Sequence] = [
        [
            "result",
            *(key_with_unit(key, results[0].case.kind) for key in keys),
            *(f"{name} [{unit}]" for name, unit in zip(names, units, strict=True)),
        ]
    ]
    for result, found in zip(results, scalars, strict=True):
        settings = [_as_cell(setting_of(result.case, key)) for key in keys]
        rows.append([result.path.name, *settings, *(_as_cell(found.get(name, "")) for name in names)])
    return rows


def _as_cell(value: object) -> str:
    """Text of a cell: nine digits of a number, a blank between those of a list."""
    if isinstance(value, list | tuple):
        return " ".join(map(_as_cell, value))
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    return f"{value:.9g}" if is_number else "" if value is None else str(value)


def _unit(result: Result, name: str) -> str:
    """Unit of a scalar of a run, by its name."""
    if name in result.scalars:
        return result.unit(f"steps/{name}")
    return next((unit for word, unit in UNITS.items() if word in name), "1")


def steps_table(result: Result) -> list[Sequence]:
    """Names with units of the scalars of the steps, in the order of progress, then a row for every step."""
    names = [name for name in STEP_SCALARS if name in result.scalars]
    return _columns({f"{name} [{result.unit(f'steps/{name}')}]": result.steps(name) for name in names})


def frame_table(result: Result, step: int) -> list[Sequence]:
    """Names with units of x and the fields of the frame of a step, then a row for every node."""
    frame = result.nearest_frame(step=step)
    if result.step[frame] != step:
        stored = f"of {result.step[0]} to {result.step[-1]}; the nearest is {result.step[frame]}"
        raise UsageError(f"--frame {step}: {result.path} stores no such step; allowed: a stored one {stored}")
    fields = {f"{name} [{result.unit(name)}]": result[name][frame] for name in result.fields}
    if result.y is None:
        return _columns({"x [m]": result.x} | fields)
    y, x = np.meshgrid(result.y, result.x, indexing="ij")
    return _columns({name: values.ravel() for name, values in {"x [m]": x, "y [m]": y, **fields}.items()})


def _columns(columns: dict[str, np.ndarray]) -> list[Sequence]:
    rows = zip(*(column.tolist() for column in columns.values()), strict=True)
    return [list(columns), *([f"{value:.9g}" for value in row] for row in rows)]
