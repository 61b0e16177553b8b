"""Time from which the roughness of both surfaces fills the contact: means over a run begin there."""

import tomllib

import numpy as np

RAMP = 0.1  # half-widths of profile over which its heights come in: they belong to the filling
LONE = ("ridge", "dent")  # synthetic features that do not repeat


def filled_from(result):
    """Time [s] from which the roughness of both surfaces fills the Hertz contact.

    A profile fills the contact when its full heights, ramp included, reach the far edge, a lone ridge or dent
    when its centre is at x = 0. Smooth surfaces, also those that have yielded, and surfaces at rest count as
    filled from the start.

    Parameters
    ----------
    result : ehlpetsc.results.reader.Result

    Returns
    -------
    float
        0 without a moving rough surface, inf where a run with varying speeds ends before.
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


def _filled_by(result, side, speed, table, number):
    profile = result.profile(side)
    lone = table.get("synthetic", {}).get("kind") in LONE
    if profile is None or speed == 0.0 or not (lone or profile[1].any()):
        return 0.0
    a, leading = result.attrs["a"], profile[0].max() if speed > 0.0 else profile[0].min()
    distance = a + RAMP * a - np.sign(speed) * leading
    if lone:
        feature = table["synthetic"]
        centre = feature.get("position", 2.0 * feature.get("wavelength", 0.0))
        distance = centre - np.sign(speed) * leading
    return _time_of(result, distance, speed, f"displacement_{number}")


def _time_of(result, distance, speed, name):
    """Time [s] at which a surface has travelled a distance [m], by its displacements if stored."""
    if distance <= 0.0:
        return 0.0
    if f"steps/{name}" not in result:
        return distance / abs(speed)
    furthest = np.maximum.accumulate(np.abs(result.steps(name)))
    return float(np.interp(distance, furthest, result.steps("time"), right=np.inf))
