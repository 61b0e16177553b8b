"""Whole numbers of steps and nodes from quotients of lengths and times.

A quotient such as a/dx is a whole number except for rounding where one length is a multiple of the other.
Without a tolerance its last digit would then decide about one step or node more.
"""

from math import ceil, floor

COUNT_TOLERANCE = 1e-6  # of a step or node: numbers this near to a whole one are whole


def whole_up(number: float) -> int:
    """Smallest whole number that is not smaller, except for rounding."""
    return ceil(number - COUNT_TOLERANCE)


def whole_down(number: float) -> int:
    """Largest whole number that is not larger, except for rounding."""
    return floor(number + COUNT_TOLERANCE)


def whole_near(number: float) -> int:
    """Nearest whole number; halves, except for rounding, are rounded up."""
    return whole_down(number + 0.5)
