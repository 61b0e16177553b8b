"""Observed order of convergence, and limits by extrapolation."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np


def observed_order(errors: Sequence[float]) -> float:
    """Slope of log2(error) over refinements, each of which halves the spacing."""
    return float(-np.polyfit(np.arange(len(errors)), np.log2(errors), 1)[0])


def order_and_limit(coarse: float, middle: float, fine: float) -> tuple[float, float]:
    """Observed order and limit of three values at halved spacings; nan where they do not converge."""
    first, second = coarse - middle, middle - fine
    if first * second <= 0.0 or abs(second) >= abs(first):
        return np.nan, np.nan
    order = np.log2(first / second)
    return float(order), float(fine - second / (2.0**order - 1.0))
