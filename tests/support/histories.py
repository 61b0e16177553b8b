"""Stress and temperature of one body point on its way through the nodes, for comparison with closed forms."""

import numpy as np

from ehlpetsc.post.stresses.body_points import passage
from ehlpetsc.post.stresses.body_stress import BodyStress, histories


def history_at(loads, surface, s, depth, quantum=0.0):
    """Times and stresses (3, samples) at body point s [m] and depth [m] while it is among the nodes [Pa]."""
    motion = passage(np.array([s]), loads.x, loads.dx, loads.travelled[surface])
    stress = BodyStress(loads.x.size, np.array([depth / loads.dx]))
    found = histories(loads, surface, motion, stress, np.array([0]), quantum, float)
    return loads.time[motion.enter[0] : motion.leave[0] + 1], found[0, 0]


def temperature_history(loads, surface, s):
    """Temperatures (samples,) [K] of the surface at body point s [m] while it is among the nodes."""
    places = s + loads.travelled[surface]
    values = [loads.temperatures(surface, frame, place) for frame, place in enumerate(places)]
    return np.array(values)[(places >= loads.x[0]) & (places <= loads.x[-1])]
