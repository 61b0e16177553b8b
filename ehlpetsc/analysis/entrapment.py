"""Lubricant entrapment: a pressure maximum in oil between two contacts (Holmes et al. 2005, figure 5)."""

from dataclasses import dataclass

import numpy as np

from ehlpetsc.analysis.collisions import points_in_contact
from ehlpetsc.errors import OutputError

MIN_GAP_NODES = 3  # mesh spacings between the contacts: two nodes of oil
MAX_GAP = 0.05  # half widths between the contacts


@dataclass(frozen=True)
class Entrapment:
    """Oil between two contacts in one stored frame.

    Attributes
    ----------
    frame : int
    left, right, peak : int
        Nodes of the contacts and of the pressure maximum between them.
    excess : float
        Pressure maximum over the higher pressure of both contacts, minus 1.
    """

    frame: int
    left: int
    right: int
    peak: int
    excess: float


def find(result):
    """Entrapments of all stored frames, in the order of falling excess pressure.

    Raises
    ------
    OutputError
        No entrapment.
    """
    frames, nodes = points_in_contact(result)
    widest = MAX_GAP * result.attrs["a"] / float(np.diff(result.x).min())
    distances = np.diff(nodes)
    pairs = np.flatnonzero((np.diff(frames) == 0) & (distances >= MIN_GAP_NODES) & (distances <= widest))
    entrapments = []
    for frame, left, right in zip(frames[pairs], nodes[pairs], nodes[pairs + 1], strict=True):
        pressure = result["pressure"][frame, left : right + 1].astype(float)
        peak = int(np.argmax(pressure))
        highest = max(pressure[0], pressure[-1])
        if 0.0 < highest < pressure[peak] and _is_single(pressure, peak):
            excess = float(pressure[peak] / highest - 1.0)
            entrapments.append(Entrapment(int(frame), int(left), int(right), int(left) + peak, excess))
    if not entrapments:
        raise OutputError(
            f"{result.path}: no pressure maximum between two contacts {MAX_GAP} a apart or less"
        )
    return sorted(entrapments, key=lambda e: e.excess * result["pressure"][e.frame, e.peak], reverse=True)


def _is_single(pressure, peak):
    """Whether the pressure has a single peak between the contacts."""
    rise = np.diff(pressure)
    return bool((rise[:peak] > 0.0).all() and (rise[peak:] < 0.0).all())


def instants(result, entrapment, interval=30, count=4):
    """Frames about `interval` nominal time steps apart; the last but one shows the entrapment.

    Returns
    -------
    list of (int, float)
        Frame and position [m] of the oil in it, which moves with the entrainment speed.
    """
    at, x = result.time[entrapment.frame], result.x[entrapment.peak]
    speed, step = 0.5 * (result.attrs["u1"] + result.attrs["u2"]), float(np.nanmax(result.steps("dt")))
    times = at + interval * step * (np.arange(count) - (count - 2))
    frames = [result.nearest_frame(time=time) for time in times]
    return [(frame, float(x + speed * (result.time[frame] - at))) for frame in frames]


def surfaces(result, frame):
    """Deformed heights [m] of the lower (2) and upper (1) surface about their mean plane, shape (nx,).

    Both solids are assumed to deform equally: the middle of the gap is that of the undeformed rough surfaces.
    """
    time, middle = result.time[frame], np.zeros(len(result.x))
    for side, sign in (("2", 1.0), ("1", -1.0)):
        profile = result.profile(side)
        if profile is not None:
            s, z, speed = profile
            middle += 0.5 * sign * np.interp(result.x - speed * time, s, z, left=0.0, right=0.0)
    film = result.frame("film_thickness", frame)
    return middle - 0.5 * film, middle + 0.5 * film
