"""Curves and maps drawn into given axes: one instant, over time, at collisions."""
