"""Fatigue criteria other than the paper's: critical planes in three dimensions, tension, fatigue limit."""

CRITERIA = ("fatemi-socie", "shear", "swt", "dang-van")
