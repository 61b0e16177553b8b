"""Stress and temperature of one body point on its way through the nodes, for comparison with closed forms."""

import numpy as np

from ehlpetsc.post.loads import passage
from ehlpetsc.post.run import histories
from ehlpetsc.post.stresses.body_stress import BodyStress


def history_at(loads, surface, s, depth, quantum=0.0):
    """Times and stresses (3, samples) at body point s [m] and depth [m] while it is among the nodes [Pa]."""
    motion = passage(np.array([s]), loads.x, loads.dx, loads.travelled[surface])
    stress = BodyStress(loads.x.size, np.array([depth / loads.dx]))
    found = histories(loads, surface, motion, stress, np.array([0]), quantum, float)
    return loads.time[motion.enter[0] : motion.leave[0] + 1], found[0, 0]


def temperature_history(loads, surface, s):
    """Temperatures (samples,) [K] of the surface at body point s [m] while it is among the nodes."""
    motion = passage(np.array([s]), loads.x, loads.dx, loads.travelled[surface])
    frames = range(int(motion.enter[0]), int(motion.leave[0]) + 1)
    places = [motion.positions(frame, loads.x, loads.dx) for frame in frames]
    return np.array([loads.temperatures(surface, *one)[0] for one in zip(frames, places, strict=True)])
