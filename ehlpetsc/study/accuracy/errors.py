"""Measures of a run, their errors against a reference, and the estimated error of the reference."""

from dataclasses import dataclass

import numpy as np

from ehlpetsc.results.reader import read_result
from ehlpetsc.study.convergence import observed_order, richardson_error
from ehlpetsc.study.runs import greatest_damage

MEASURES = ("h_min", "h_c", "p_max", "film", "contact", "damage")
ORDERS = (0.5, 2.0)  # bounds of the observed order in an estimate
NO_MEASURES = dict.fromkeys(MEASURES, np.nan)


@dataclass
class Measures:
    """Measures of one run.

    Attributes
    ----------
    x, h : ndarray
        Nodes [half widths] and the film of the last frame [m].
    h_min, h_c, p_max : float
        Minimum film [m] and maximum pressure [Pa] of the run, central film of the last frame [m].
    contact : float
        Mean length in contact over the run [half widths].
    damage : float or None
        log10 of the largest damage on surface 2.
    """

    x: np.ndarray
    h: np.ndarray
    h_min: float
    h_c: float
    p_max: float
    contact: float
    damage: float | None = None


def measures(path, damage=False):
    """Measures of a result file: films at its last frame, extremes and contact of the whole run.

    Contact is the length of the contacts times their duration over the duration of the run [m s/s]; damage
    is the maximum on surface 2, by ``ehlpetsc.post``.
    """
    with read_result(path) as result:
        x = np.asarray(result.x) / result.attrs["a"]
        h = np.asarray(result.frame("film_thickness", -1))
        dt = np.asarray(result.steps("dt"))
        contact = (result.steps("contacts") * dt).sum() / dt.sum() if dt.sum() else 0.0
        return Measures(
            x,
            h,
            float(result.steps("h_min").min()),
            float(h[np.argmin(np.abs(x))]),
            float(result.steps("p_max").max()),
            float(contact * (x[1] - x[0])),
            float(np.log10(greatest_damage(path, "2").max())) if damage else None,
        )


def errors(values, reference):
    """Relative errors; film: maximum local error over h_c, damage: difference in decades."""
    inside = np.abs(values.x) <= 1.0
    film = np.abs(values.h - np.interp(values.x, reference.x, reference.h))[inside].max() / reference.h_c
    by_measure = {"film": film, "damage": np.nan, "contact": np.nan}
    for name in ("h_min", "h_c", "p_max", "contact"):
        true = getattr(reference, name)
        if true > 0.0:
            by_measure[name] = abs(getattr(values, name) / true - 1.0)
    if reference.damage is not None:
        by_measure["damage"] = abs(values.damage - reference.damage)
    return {name: by_measure.get(name, np.nan) for name in MEASURES}


def uncertainty(fine, middle, coarse):
    """Estimated error of the finest of three runs, for each measure."""
    middle_errors, coarse_errors = errors(middle, fine), errors(coarse, fine)
    estimate = {}
    for name in MEASURES:
        change = middle_errors[name]  # |f1 - f2|
        coarser = coarse_errors[name] - change  # |f2 - f3|
        order = observed_order((coarser, change)) if min(change, coarser) > 0.0 else ORDERS[0]
        estimate[name] = richardson_error(change, np.clip(order, *ORDERS))
    return estimate
