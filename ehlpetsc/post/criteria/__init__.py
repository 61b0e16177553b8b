"""Fatigue criteria beside the paper's: critical planes in three dimensions, tension, and a fatigue limit."""

CRITERIA = ("fatemi-socie", "shear", "swt", "dang-van")
