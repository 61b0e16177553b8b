"""Surfaces of a result: heights, and depths of effects such as wear, at body points.

A body point s is at x = s + speed time; if a result begins after a change of speed, s includes an offset.
"""

import numpy as np

OFFSET_TOLERANCE = 1e-6  # mesh spacings: smaller offsets are rounding


def profiles(simulation):
    """Profiles of both surfaces for `ehlpetsc.results.hdf5.datasets.Layout`.

    Parameters
    ----------
    simulation : run.simulation.Simulation

    Returns
    -------
    dict of str to tuple
        By surface: body points and heights [m], speed [m/s], roughness parameters, names of the effects'
        depths. None for a smooth surface without such depths.
    """
    depths = [name for effect in simulation.stepper.effects for name in effect.surface]
    rough, speeds = simulation.roughness, (simulation.scales.u1, simulation.scales.u2)
    sides = {}
    for k, (side, offset) in enumerate(zip(("1", "2"), _offsets(simulation), strict=True)):
        profile = rough and rough.side(side)
        if profile:
            scalars = {"ra": profile.ra, "rq": profile.rq, "rsk": profile.rsk}
            sides[side] = profile.s + offset, profile.z, speeds[k], scalars, depths
        else:
            sides[side] = _smooth_side(simulation, k, offset, depths) if depths else None
    return sides


def body_depths(simulation):
    """Depths of effects at the body points of :func:`profiles` [m].

    Returns
    -------
    list of (str, str, ndarray)
        Surface, name of the quantity and values.
    """
    offsets, solution = _offsets(simulation), simulation.solution
    sides = profiles(simulation)
    points = [
        None if profile is None else profile[0] - offset
        for profile, offset in zip(sides.values(), offsets, strict=True)
    ]
    depths = []
    for effect in simulation.stepper.effects:
        for name, depth_pair in effect.on_surfaces(solution.records[effect.name], points).items():
            depths += [
                (side, name, depth)
                for side, depth in zip(sides, depth_pair, strict=True)
                if depth is not None
            ]
    return depths


def _offsets(simulation):
    """Offsets of s = x - speed time + offset for both surfaces [m]."""
    if simulation.solution is None:
        return 0.0, 0.0
    now = simulation.solution.travelled
    constant = simulation.operation.travelled(simulation.solution.time)
    offsets = [distance - steady for distance, steady in zip(now, constant, strict=True)]
    return [offset if abs(offset) > OFFSET_TOLERANCE * simulation.scales.dx else 0.0 for offset in offsets]


def _smooth_side(simulation, side, offset, depths):
    """Body points of a smooth surface that pass the mesh, for its depths; `side` 0: surface 1."""
    scales = simulation.scales
    smallest, largest = simulation.operation.extent()[side]
    ends = scales.x[[0, -1]] * scales.a
    s = np.arange(ends[0] - largest, ends[1] - smallest, scales.dx)
    flat = {"ra": 0.0, "rq": 0.0, "rsk": 0.0}
    return s + offset, np.zeros_like(s), (scales.u1, scales.u2)[side], flat, depths
