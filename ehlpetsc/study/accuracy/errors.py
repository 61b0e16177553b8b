"""What is compared of a run, its errors against a reference, and the reference's own."""

from dataclasses import dataclass

import numpy as np

from ehlpetsc.results.reader import read_result
from ehlpetsc.study.runs import greatest_damage

MEASURES = ("h_min", "h_c", "p_max", "film", "contact", "damage")
NO_MEASURES = dict.fromkeys(MEASURES, np.nan)


@dataclass
class Figures:
    """What is compared of one run."""

    x: np.ndarray
    h: np.ndarray
    h_min: float
    h_c: float
    p_max: float
    contact: float
    damage: float | None = None


def figures(path, damage=False):
    """Figures of a result file: films at its last frame, extremes and contact of the whole run.

    Contact is the length of the contacts times their duration over that of the whole run [m s/s]; damage the
    greatest on surface 2, by ``ehlpetsc.post``.
    """
    with read_result(path) as result:
        x = np.asarray(result.x) / result.attrs["a"]
        h = np.asarray(result.frame("film_thickness", -1))
        dt = np.asarray(result.steps("dt"))
        contact = (result.steps("contacts") * dt).sum() / dt.sum() if dt.sum() else 0.0
        return Figures(
            x,
            h,
            float(result.steps("h_min").min()),
            float(h[np.argmin(np.abs(x))]),
            float(result.steps("p_max").max()),
            float(contact * (x[1] - x[0])),
            float(np.log10(greatest_damage(path, "2").max())) if damage else None,
        )


def errors(ours, reference):
    """Relative errors; film is the greatest local one over h_c, damage the difference in decades."""
    inside = np.abs(ours.x) <= 1.0
    film = np.abs(ours.h - np.interp(ours.x, reference.x, reference.h))[inside].max() / reference.h_c
    found = {"film": film, "damage": np.nan, "contact": np.nan}
    for name in ("h_min", "h_c", "p_max", "contact"):
        true = getattr(reference, name)
        if true > 0.0:
            found[name] = abs(getattr(ours, name) / true - 1.0)
    if reference.damage is not None:
        found["damage"] = abs(ours.damage - reference.damage)
    return {name: found.get(name, np.nan) for name in MEASURES}


def uncertainty(fine, middle, coarse):
    """Estimated error of the finest of three runs, for each measure."""
    one, two = errors(middle, fine), errors(coarse, fine)
    estimate = {}
    for name in MEASURES:
        # |f1-f3|/|f1-f2| = 1 + 2^p
        growth = two[name] / one[name] - 1.0 if one[name] > 0.0 else np.inf
        order = np.clip(np.log2(growth), 0.5, 2.0) if growth > 0.0 else 0.5
        estimate[name] = one[name] / (2.0**order - 1.0)
    return estimate
