r"""First guess of a time step: the change of the smooth solution by roughness, advected.

It is carried with the mean speed (of films the ratio, which keeps them positive), from that one of the last
three time levels whose way from here is nearest to a whole number of nodes. Asperity pressures are
two or three nodes wide, and interpolating between the nodes is what a predictor loses most by: on the
measured surfaces the last level alone cost 6.0 Newton iterations a step, the best of three 4.6 (over 5 a of
travel). Extrapolation in time gained nothing more.
"""

from typing import NamedTuple

import numpy as np

from ehlpetsc.compiled import compiled
from ehlpetsc.discretisation.contact.node_state import PRESSURE_AFTER_REFILL

MIN_FILM_DIVISOR = 1e-3  # of the expected film: on a coarse mesh the smooth one may touch too
LEVEL_AGE_NODES = 0.03  # distance from a whole number of nodes that outweighs one step of age


class TimeLevel(NamedTuple):
    """Unknowns of an earlier time level, and the distance travelled by the film [m]."""

    travelled: float
    q: np.ndarray
    w: np.ndarray


@compiled
def advected(values, nodes):
    """Advect the change of the smooth solution by roughness by `nodes` nodes.

    Cubic interpolation, kept between the two values it lies between: beside the pressure spikes of
    asperities, two or three nodes wide, a cubic undershoots, and the cavity it makes there costs Newton's
    method iterations.
    """
    whole, last, moved = int(np.floor(nodes)), len(values) - 1, np.empty_like(values)
    t = 1.0 - (nodes - whole)
    for i in range(len(values)):
        k = i - whole - 1
        a, b = values[min(max(k - 1, 0), last)], values[min(max(k, 0), last)]
        c, d = values[min(max(k + 1, 0), last)], values[min(max(k + 2, 0), last)]
        value = (
            -t * (t - 1.0) * (t - 2.0) / 6.0 * a
            + (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0 * b
            - (t + 1.0) * t * (t - 2.0) / 2.0 * c
            + (t + 1.0) * t * (t - 1.0) / 6.0 * d
        )
        moved[i] = min(max(value, min(b, c)), max(b, c))
    return moved


def neighbours(v, nodes):
    """Values of the two nodes upstream of each point moved by `nodes` nodes."""
    source = np.arange(len(v)) - int(np.floor(nodes))
    return v.take(source, mode="clip"), v.take(source - 1, mode="clip")


def whole_nodes(v, nodes):
    """Values moved by the nearest whole number of nodes."""
    return v.take(np.arange(len(v)) - int(np.rint(nodes)), mode="clip")


def predict(problem, smooth, levels, nodes):
    """Guess of q and w.

    Parameters
    ----------
    problem : ehl_problem.EHLProblem
    smooth : TimeLevel
        The steady solution of the start.
    levels : sequence of TimeLevel
        Latest first.
    nodes : sequence of float
        Way of each to the new time, with the mean speed, in nodes.
    """
    best = min(range(len(levels)), key=lambda k: abs(nodes[k] - round(nodes[k])) + LEVEL_AGE_NODES * k)
    level, distance, model = levels[best], nodes[best], problem.model
    q0, film = smooth.q, model.state(level.q, level.w).film
    h0 = np.maximum(model.state(q0, smooth.w).film, MIN_FILM_DIVISOR * problem.film_scale)
    q = q0 + advected(level.q - q0, distance)
    # where there was oil, the differences carried must not leave a cavity: it fills by a few nodes an
    # iteration, one that opens does so at once
    least = np.minimum(*neighbours(level.q, distance))
    refilled = np.minimum(
        np.minimum(least, level.q), PRESSURE_AFTER_REFILL
    )  # where the smooth film cavitates
    full = np.where(q0 > 0.0, 0.5 * np.minimum(q0, least), refilled)
    q = np.maximum(q, np.where(full > 0.0, full, -1.0 + 1e-3))
    interpolated = model.w_from_film(h0 * advected(film / h0, distance))
    return model.reset_yielding(q, model.advected(interpolated, whole_nodes(level.w, distance)))
