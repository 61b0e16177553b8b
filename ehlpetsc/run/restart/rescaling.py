r"""Conversion of a state to another load, radius or elasticity, with other scales a, p0 and a^2/R.

Fields keep their position x/a, that is, their node:

* pressures in p0 do not change: their sum over the nodes carries the new load;
* the excess of the film over the gap outside Hertz' dry contact keeps its thickness in metres, and the gap is
  that of the new contact, :math:`h=g+r(h_0-g)` in a^2/R, :math:`r` the old a^2/R over the new one and g as in
  :func:`ehlpetsc.physics.exact_solutions.hertz_gap`;
* a cavity keeps its oil film in metres, :math:`(1+q)h=r(1+q_0)h_0`.

Earlier masses per area do not apply to the new contact: the next step is a step of backward Euler from the
mass of the converted state, without earlier levels.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ehlpetsc.physics.exact_solutions import hertz_gap

if TYPE_CHECKING:
    from ehlpetsc.physics.scales import Scales

SCALE_TOLERANCE = 1e-12  # relative
CORE_HALF_WIDTH = 0.5  # in a: the approach changes by the mean change of the film between -0.5 and 0.5
STATE_PREFIXES = ("", "smooth_")  # of the names of the converted states
HISTORY = ("m", "m_older", "earlier_travelled", "earlier_q", "earlier_h", "earlier_contact_pressure")


def rescale(arrays: dict[str, np.ndarray], attributes: dict[str, Any], scales: Scales) -> bool:
    """Convert the content of a restart file to the scales of a case, in place; whether they differ."""
    old = np.array([attributes[name] for name in ("a", "p0", "h_scale")])
    new = np.array([scales.a, scales.p0, scales.h])
    if (np.abs(old - new) <= SCALE_TOLERANCE * new).all():
        return False
    ratio, x = attributes["h_scale"] / scales.h, scales.x
    gap = hertz_gap(x, 1.0, 1.0)
    core = np.abs(x) <= CORE_HALF_WIDTH
    if core.any():
        attributes["h00"] += (ratio - 1.0) * (arrays["h"] - gap)[core].mean()
    for prefix in STATE_PREFIXES:
        q, h = arrays[prefix + "q"], arrays[prefix + "h"]
        arrays[prefix + "q"], arrays[prefix + "h"] = _fields(q, h, gap, ratio)
    for name in HISTORY:
        arrays.pop(name, None)
    attributes["dt"] = 0.0
    return True


def _fields(q: np.ndarray, h: np.ndarray, gap: np.ndarray, ratio: float) -> tuple[np.ndarray, np.ndarray]:
    film = np.maximum(gap + ratio * (h - gap), 0.0)
    oil = ratio * (1.0 + q) * h
    void = np.clip(oil / np.where(film > 0.0, film, np.inf) - 1.0, -1.0, 0.0)
    return np.where((q < 0.0) & (film > 0.0), void, q), film
