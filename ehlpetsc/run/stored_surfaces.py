"""Both surfaces as a result stores them: heights, and where solids have yielded the depth, by body point.

A body point s is at x = s + speed time; where a result begins after a change of speed an offset makes it so.
"""

import numpy as np

SAME_PLACE = 1e-6  # mesh spacings: ways nearer than this differ by rounding


def profiles(simulation):
    """Both surfaces as `ehlpetsc.results.hdf5.datasets.Layout` has them.

    Parameters
    ----------
    simulation : run.simulation.Simulation

    Returns
    -------
    dict of str to tuple
        By side: body points and heights [m], speed [m/s], figures of roughness, whether it yields. None for a
        smooth side, unless it may yield.
    """
    yields, rough = bool(simulation.march.bodies), simulation.roughness
    found = {}
    for k, (side, offset) in enumerate(zip(("fast", "slow"), _offsets(simulation), strict=True)):
        profile = rough and getattr(rough, side)
        if profile:
            figures = {"ra": profile.ra, "rq": profile.rq, "rsk": profile.rsk}
            found[side] = profile.s + offset, profile.z, profile.speed, figures, yields
        else:
            found[side] = _smooth_side(simulation.scales, k, offset) if yields else None
    return found


def permanent_sets(simulation):
    """Depths by which both sides have yielded [m], by side, at the body points of :func:`profiles`.

    Empty where solids are elastic.
    """
    bodies = simulation.march.bodies
    if not bodies:
        return {}
    offsets, sets = _offsets(simulation), simulation.solution.sets
    sides = profiles(simulation)
    return {side: bodies.at(k, sets[k], sides[side][0] - offsets[k]) for k, side in enumerate(sides)}


def _offsets(simulation):
    """What makes s = x - speed time hold for both sides [m]."""
    if simulation.solution is None:
        return 0.0, 0.0
    now = simulation.solution.travelled
    constant = simulation.operation.travelled(simulation.solution.time)
    apart = [way - steady for way, steady in zip(now, constant, strict=True)]
    return [offset if abs(offset) > SAME_PLACE * simulation.scales.dx else 0.0 for offset in apart]


def _smooth_side(scales, side, offset):
    """A smooth surface that may yield, 0: fast: the stretch that passes."""
    speed = (scales.u1, scales.u2)[side]
    way = 0.0 if scales.duration is None else speed * scales.duration
    ends = scales.x[[0, -1]] * scales.a
    s = np.arange(ends[0] - max(way, 0.0), ends[1] - min(way, 0.0), scales.dx)
    return s + offset, np.zeros_like(s), speed, {"ra": 0.0, "rq": 0.0, "rsk": 0.0}, True
