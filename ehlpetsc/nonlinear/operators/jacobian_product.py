"""Product with the Jacobian of one state, compiled, with one message."""

from typing import NamedTuple

from ehlpetsc.compiled import compiled
from ehlpetsc.discretisation.contact.node_state import directional_derivative
from ehlpetsc.discretisation.ehl_problem import jacobian_rows
from ehlpetsc.nonlinear.halo_exchange import exchange_unknowns


class Linearisation(NamedTuple):
    """What the product with the Jacobian takes of a state, and room.

    Attributes
    ----------
    state : tuple
        :meth:`.contact.node_state.NodeState.derivatives`, shape (4, 2, window); derivatives of the Reynolds
        rows, (local nodes, 8); local nodes whose second unknown is not in the system; constants of
        :func:`.deflection.deflection_rows`.
    room : tuple of ndarray
        Room for changes of pressure (local nodes,) and of three others (3, window).
    """

    state: tuple
    room: tuple


@compiled
def jacobian_product(state, room, halo, v, out):
    """Fill in the product with the local part of a vector, zero in rows not in the system; collective.

    Parameters
    ----------
    state, room : tuple
        Of a `Linearisation`.
    halo : tuple
        Of a `halo_exchange.Halo`.
    v, out : ndarray
    """
    (by, derivatives, inactive_nodes, form), (pressure, change) = state, room
    directional_derivative(by[0], v[: 2 * len(pressure)].reshape(len(pressure), 2), form[0], pressure)
    nodes, h00, curvature, load = exchange_unknowns(*halo, v, pressure, False)
    jacobian_rows(by, derivatives, nodes, h00, curvature, load, *form, change, out)
    for i in inactive_nodes:
        out[2 * i + 1] = 0.0
