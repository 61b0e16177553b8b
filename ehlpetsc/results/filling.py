"""Time from which the roughness of both surfaces fills the contact, the beginning of means over a run."""

import tomllib

import numpy as np

RAMP_LENGTH = 0.1  # half widths at the leading end of a profile over which its heights increase from zero
SINGLE_FEATURES = ("ridge", "dent")  # synthetic features that do not repeat


def filled_from(result):
    """Time [s] from which the roughness of both surfaces fills the Hertz contact.

    A profile fills the contact when its heights after the ramp reach the far edge, a single ridge or dent
    when its centre is at x = 0. Smooth surfaces, including smooth surfaces that have yielded, and surfaces at
    rest fill the contact from the start.

    Parameters
    ----------
    result : ehlpetsc.results.reader.Result

    Returns
    -------
    float
        0 without a moving rough surface; inf if a run with varying speeds ends before.
    """
    if len(result.steps("time")) < 2:
        return 0.0
    table = tomllib.loads(result.attrs["case"]).get("surface", {})
    speeds = result.attrs["u1"], result.attrs["u2"]
    return max(
        _filled_by(result, side, speed, table.get(side, {}), number)
        for number, (side, speed) in enumerate(zip(("1", "2"), speeds, strict=True), 1)
    )


def travelled(result):
    """Distance that the faster surface has travelled by the end of each step [m], shape (nsteps,)."""
    if "steps/displacement_1" in result:
        return np.abs([result.steps("displacement_1"), result.steps("displacement_2")]).max(axis=0)
    return max(abs(result.attrs["u1"]), abs(result.attrs["u2"])) * result.steps("time")


def both_fill(result, times):
    """Whether the roughness of both surfaces fills the contact at `times` [s], array of bool."""
    return np.asarray(times) >= filled_from(result) * (1.0 - 1e-12)


def filled_weights(result):
    """Weights of the steps in means, shape (nsteps,): their lengths [s] while both surfaces fill the contact.

    Lengths of all steps if the surfaces never fill the contact; 1 for a steady run.
    """
    time, dt = result.steps("time"), np.nan_to_num(result.steps("dt"))
    if len(time) == 1:
        return np.ones(1)
    filled = both_fill(result, time)
    return np.where(filled | (not filled.any()), dt, 0.0)


def _filled_by(result, side, speed, table, number):
    profile = result.profile(side)
    is_single = table.get("synthetic", {}).get("kind") in SINGLE_FEATURES
    if profile is None or speed == 0.0 or not (is_single or profile[1].any()):
        return 0.0
    a, leading = result.attrs["a"], profile[0].max() if speed > 0.0 else profile[0].min()
    distance = a + RAMP_LENGTH * a - np.sign(speed) * leading
    if is_single:
        feature = table["synthetic"]
        centre = feature.get("position", 2.0 * feature.get("wavelength", 0.0))
        distance = centre - np.sign(speed) * leading
    return _time_of(result, distance, speed, f"displacement_{number}")


def _time_of(result, distance, speed, name):
    """Time [s] at which a surface has travelled a distance [m], from its displacements if stored."""
    if distance <= 0.0:
        return 0.0
    if f"steps/{name}" not in result:
        return distance / abs(speed)
    furthest = np.maximum.accumulate(np.abs(result.steps(name)))
    return float(np.interp(distance, furthest, result.steps("time"), right=np.inf))
