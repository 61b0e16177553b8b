r"""Transport of the film with the mean speed of the surfaces: fields carried along x (compiled).

In the balance of a time step the oil is followed along its path. What a cell holds at a time t is what the
cell upstream by the distance d of the film held at t - dt, and what the pressure has driven into it since:
without pressure flow :math:`m(x,t)=m(x-d,t-\Delta t)`. Differences at fixed nodes would damp waves that move
with the film, most of whose convective and local changes cancel.

A field is carried by whole nodes exactly. A remaining fraction t of a node is a flux: of each cell the part
within t of its downstream face leaves it. The part is the difference of the integral of the field, which is
known at the faces, from a polynomial through the integral at sixteen faces (order 15; finite volumes along
the path as of Lin & Rood 1996). The sum is kept whatever the fluxes are. What leaves and what stays are held
to at least half of those of an even cell, so that a positive field stays positive: next to solids the film
falls by a factor of ten within a node, where a polynomial is no guide.
"""

import numpy as np

from ehlpetsc.base.compiled import compiled

WHOLE = 1e-9  # distance in nodes from a whole number that is rounding
REACH = 7  # cells on either side of the one whose downstream part leaves it


@compiled
def downstream_weights(t: float) -> np.ndarray:
    """Weights of the cells -7 .. 7 in the part of a cell within t cells of its downstream face."""
    weights = np.zeros(2 * REACH + 1)
    for k in range(-REACH - 1, REACH + 1):  # faces; 0 is the downstream face of the cell itself
        basis = 1.0
        for j in range(-REACH - 1, REACH + 1):
            if j != k:
                basis *= (-t - j) / (k - j)
        if k > 0:  # integral up to face k: cells 1 .. k
            for cell in range(1, k + 1):
                weights[cell + REACH] -= basis
        else:
            for cell in range(k + 1, 1):
                weights[cell + REACH] += basis
    return weights


@compiled
def value_at(values: np.ndarray, i: int, beyond: float, as_end: bool) -> float:
    """Value of a node; of one beyond an end `beyond`, or the value at the end."""
    if 0 <= i < len(values):
        return values[i]
    return (values[0] if i < 0 else values[-1]) if as_end else beyond


def carried(rows: np.ndarray, nodes: float, beyond: float | None = None) -> np.ndarray:
    """Fields carried downstream by `nodes` nodes, upstream where negative.

    `rows`: along x, shape (rows, nx).
    `beyond`: value that enters at an end; None: that at the end.
    """
    as_end = beyond is None
    return _carried(np.ascontiguousarray(rows), float(nodes), 0.0 if as_end else float(beyond), as_end)


@compiled
def _carried(rows: np.ndarray, nodes: float, beyond: float, as_end: bool) -> np.ndarray:
    """Fields carried, see :func:`carried`."""
    last, shift = rows.shape[1] - 1, int(np.rint(nodes))
    out = np.empty_like(rows)
    if abs(nodes - shift) < WHOLE:
        for row in range(len(rows)):
            for i in range(last + 1):
                out[row, i] = value_at(rows[row], i - shift, beyond, as_end)
        return out
    shift = int(np.floor(nodes))
    t = nodes - shift
    weights = downstream_weights(t)
    for row in range(len(rows)):
        values = rows[row]
        entering = 0.0
        for i in range(-1, last + 1):
            here = value_at(values, i - shift, beyond, as_end)
            leaving = 0.0
            for k in range(-REACH, REACH + 1):
                leaving += weights[k + REACH] * value_at(values, i - shift + k, beyond, as_end)
            one, other = 0.5 * t * here, 0.5 * (1.0 + t) * here
            leaving = min(max(leaving, min(one, other)), max(one, other))
            if i >= 0:
                out[row, i] = here - leaving + entering
            entering = leaving
    return out


def carried_with(rows: np.ndarray, of_mass: np.ndarray, nodes: float, beyond: float) -> np.ndarray:
    """A quantity per mass, carried with the oil that has it.

    `rows`, `of_mass`: mass per area, the quantity, along x, shape (rows, nx).
    `beyond`: of the oil that enters at an end.

    Bounded by the four nodes around the place where the oil was.
    """
    near = [carried(of_mass, np.floor(nodes) + k, beyond) for k in range(-1, 3)]
    if abs(nodes - np.rint(nodes)) < WHOLE:
        return carried(of_mass, nodes, beyond)
    mass = carried(rows, nodes)
    content = carried(rows * (of_mass - beyond), nodes, 0.0)
    value = beyond + np.divide(content, mass, out=near[1] - beyond, where=mass > 0.0)
    return np.clip(value, np.minimum.reduce(near), np.maximum.reduce(near))
