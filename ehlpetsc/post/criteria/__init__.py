"""Fatigue criteria other than the paper's: critical planes in three dimensions, fatigue limit."""

CRITERIA = ("fatemi-socie", "dang-van")
