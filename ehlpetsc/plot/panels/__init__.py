"""Curves and maps drawn into axes: one instant, over time."""
