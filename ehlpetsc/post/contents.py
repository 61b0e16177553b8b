"""Datasets of a post-processing result from computed damage, and their file."""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from ehlpetsc.base.materials import DEFAULT
from ehlpetsc.post.fatigue.statistics import (
    MIN_ASPERITIES,
    asperities,
    fitted_asperities,
    log_life,
    weibull_fit,
    weibull_likelihood,
)
from ehlpetsc.post.loads import Loads, PointPassage, Prepared
from ehlpetsc.post.smooth_contact import worst_instant
from ehlpetsc.results.output_guard import atomic_write
from ehlpetsc.results.post_result import UPPER_FIRST, PointTemperatures, WeibullFit, stored_names

POST_FORMAT_VERSION = 1
POST_SCALES = {"s": "damage/s", "z": "damage/z_over_a", "y": "damage/y"}


def datasets_of(
    prepared: Prepared, surface: str, damage: np.ndarray, report: Callable[[str], None]
) -> dict[str, np.ndarray]:
    """Datasets of a surface that follow from its damage (depths, points), by name."""
    loads, depths, motion = prepared.loads, prepared.depths, prepared.motions[surface]
    profile = loads.profiles[surface]
    peaks = asperities(profile, prepared.s, motion.complete, loads.rows_in_contact, loads.is_periodic)
    under = np.stack([layer[peaks.at] for layer in damage])
    at_least_one = (under >= 1).sum(axis=1)
    found = {
        f"damage/{surface}_complete": motion.complete.astype(np.uint8),
        f"asperities/{surface}_s": peaks.s,
        f"asperities/{surface}_height": peaks.height,
        f"asperities/{surface}_damage": under,
        f"weibull/{surface}_at_least_one": at_least_one,
        f"weibull/{surface}_undamaged": (under == 0).sum(axis=1),
    }
    if loads.y is not None:
        found[f"asperities/{surface}_y"] = loads.y[peaks.row]
    if profile is not None:
        found |= {f"profile/{surface}_s": profile[0], f"profile/{surface}_z": profile[1]}
    enough = [fitted_asperities(row) >= MIN_ASPERITIES for row in under]
    lives = [log_life(row) if fitted else np.empty(0) for row, fitted in zip(under, enough, strict=True)]
    fits = [weibull_fit(life) for life in lives]
    for name, column in zip(WeibullFit._fields, np.array(fits).T, strict=True):
        found[f"weibull/{surface}_{name}"] = column
    likely = [weibull_likelihood(life) for life in lives]
    for k, name in enumerate(("alpha", "beta")):
        found[f"weibull/{surface}_likely_{name}"] = np.array([fit[k] for fit in likely])
        found[f"weibull/{surface}_{name}_bounds"] = np.array([fit.interval()[k] for fit in likely])
    for depth, count in zip(depths, at_least_one, strict=True):
        if count:
            report(
                f"note: {count} of {peaks.s.size} asperities of surface {surface} have damage of 1 "
                f"or more at z/a = {depth:g}: failure in the first pass"
            )
    if profile is not None and not all(enough):
        fewest = min(map(fitted_asperities, under))
        with_damage = (
            "" if fewest == peaks.s.size else f", {fewest} with damage between 0 and 1 at some depth"
        )
        report(
            f"note: {peaks.s.size} asperities of surface {surface} passed{with_damage}: a Weibull "
            f"distribution needs {MIN_ASPERITIES} or more"
        )
    if loads.is_heated(surface):
        temperatures = point_temperatures(loads, surface, motion)
        found |= {f"temperature/{surface}_{name}": array for name, array in temperatures._asdict().items()}
    return found


def point_temperatures(loads: Loads, surface: str, motion: PointPassage) -> PointTemperatures:
    r"""Highest and mean surface temperature of body points and their flash temperature.

    The mean is over the time at which a point is inside the Hertz contact of the instant, by the trapezoidal
    rule over the stored frames; the flash temperature is the highest temperature minus that of the body.
    nan for points that did not pass the whole contact.
    """
    shape = (*loads.rows, motion.enter.size)
    highest, (sums, times) = np.full(shape, np.nan), np.zeros((2, *shape))
    step = np.diff(loads.time)
    for frame, duration in enumerate(0.5 * (np.append(step, 0.0) + np.insert(step, 0, 0.0))):
        x = motion.positions(frame, loads.x, loads.dx)
        values, is_inside = loads.temperatures(surface, frame, x), np.abs(x) <= loads.half_width(frame)
        highest = np.fmax(highest, values)
        sums[..., is_inside] += duration * values[..., is_inside]
        times[..., is_inside] += duration
    highest[..., ~motion.complete] = np.nan
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = np.where(motion.complete, sums / times, np.nan)
    return PointTemperatures(highest, mean, highest - loads.case.heat.bulk_temperature[int(surface) - 1])


def slide_roll_ratios(loads: Loads) -> np.ndarray | None:
    """Minimum and maximum slide/roll ratio of conditions over time, infinite where entrainment reverses."""
    if loads.case.conditions is None:
        return None
    table = loads.case.conditions.sampled()
    with np.errstate(divide="ignore", invalid="ignore"):
        ratios = np.where(table.entrainment == 0.0, np.inf, (table.u1 - table.u2) / table.entrainment)
    turns = np.ptp(np.sign(table.entrainment)) > 0.0
    return np.array([-np.inf, np.inf] if turns else [ratios.min(), ratios.max()])


def attributes_of(prepared: Prepared) -> dict[str, Any]:
    """Root attributes: provenance and scales of the result, settings of the case.

    `surface` is that of the summary: 2, whose asperities have more contacts, if it is rough and passed.
    """
    loads, case = prepared.loads, prepared.loads.case
    mean = (loads.speeds["1"] + loads.speeds["2"]) / 2
    ratios = slide_roll_ratios(loads)
    passed = [name for name, motion in prepared.motions.items() if motion.complete.any()]
    return {
        "title": loads.attrs["title"],
        "case": loads.attrs["case"],
        "source": str(loads.path),
        "surface": next((name for name in passed if loads.profiles[name] is not None), passed[0]),
        "a": loads.a,
        "inlet": loads.x[0],
        "outlet": loads.x[-1],
        "p0": loads.p0,
        "smooth_pressure": worst_instant(loads.scales, loads.operation)[1],
        "slide_roll_ratio": (loads.speeds["1"] - loads.speeds["2"]) / mean if mean else 0.0,
        **({} if ratios is None else {"slide_roll_ratios": ratios}),
        "every": case.output.every,
        "material": ", ".join(case.contact.material or (DEFAULT,)),
        "strain": case.post.strain,
        "mean_stress": case.post.mean_stress,
        "residual": case.post.residual,
        "residual_stress": np.array(case.post.residual_stress or (), float).reshape(-1, 2),
        **{f"speed_{name}": loads.speeds[name] for name in prepared.motions},
    }


def write_result(path: str | Path, datasets: Mapping[str, Any], attributes: Mapping[str, Any]) -> None:
    """Write datasets by name, with units, texts and axes of their table; replaces `path` at once."""
    table = stored_names(*UPPER_FIRST)
    image = io.BytesIO()  # HDF5 crashes on a full disk, a plain write does not
    with h5py.File(image, "w") as file:
        file.attrs.update({"format_version": POST_FORMAT_VERSION, **attributes})
        for name, values in datasets.items():
            file[name] = values
            file[name].attrs.update(units=table[name].unit, long_name=table[name].text)
        scales = {axis: name for axis, name in POST_SCALES.items() if name in datasets}
        for axis, name in scales.items():
            file[name].make_scale(axis)
        for name in datasets.keys() - scales.values():
            for dimension, axis in enumerate(table[name].axes_of(datasets[name].ndim)):
                if axis in scales:
                    file[name].dims[dimension].attach_scale(file[scales[axis]])
    atomic_write(Path(path), image.getvalue())
