r"""A state under another load, radius or elasticity, whose scales a, p0 and a^2/R differ.

Fields stay where they are in x/a, the same node of the mesh. There

* pressures keep their share of p0: the sum over the nodes carries the new load at once;
* what the film has above the gap beside Hertz' dry contact keeps its thickness in metres, and the gap is that
  of the new contact, :math:`h=g+r(h_0-g)` in a^2/R, :math:`r` the old a^2/R over the new one and g as in
  :func:`ehlpetsc.physics.exact_solutions.hertz_gap`;
* a cavity keeps its oil in metres, :math:`(1+q)h=r(1+q_0)h_0`.

Earlier masses per area do not apply to the new contact: the next step is one of backward Euler from that of
the present state, and earlier levels are left out.
"""

import numpy as np

from ehlpetsc.physics.exact_solutions import hertz_gap

SCALE_TOLERANCE = 1e-12  # relative
CORE_HALF_WIDTH = 0.5  # in a: the approach takes up the film's change between -0.5 and 0.5
PREFIXES = ("", "smooth_")
PAST = ("m", "m_older", "earlier_travelled", "earlier_q", "earlier_h", "earlier_contact_pressure")


def rescale(arrays, attributes, scales):
    """Bring the content of a restart file to the units of a case, in place.

    Parameters
    ----------
    arrays, attributes : dict
        As of :mod:`ehlpetsc.run.restart.contents`.
    scales : physics.scales.Scales
        Of the case.

    Returns
    -------
    bool
        Whether anything had to be done.
    """
    then = np.array([attributes[name] for name in ("a", "p0", "h_scale")])
    now = np.array([scales.a, scales.p0, scales.h])
    if (np.abs(then - now) <= SCALE_TOLERANCE * now).all():
        return False
    ratio, x = attributes["h_scale"] / scales.h, scales.x
    gap = hertz_gap(x, 1.0, 1.0)
    core = np.abs(x) <= CORE_HALF_WIDTH
    if core.any():
        attributes["h00"] += (ratio - 1.0) * (arrays["h"] - gap)[core].mean()
    for part in PREFIXES:
        arrays[part + "q"], arrays[part + "h"] = _fields(arrays[part + "q"], arrays[part + "h"], gap, ratio)
    for name in PAST:
        arrays.pop(name, None)
    attributes["dt"] = 0.0
    return True


def _fields(q, h, gap, ratio):
    film = np.maximum(gap + ratio * (h - gap), 0.0)
    oil = ratio * (1.0 + q) * h
    void = np.clip(oil / np.where(film > 0.0, film, np.inf) - 1.0, -1.0, 0.0)
    return np.where((q < 0.0) & (film > 0.0), void, q), film
