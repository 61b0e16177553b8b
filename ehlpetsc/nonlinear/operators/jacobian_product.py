"""Product with the Jacobian, compiled, with one collective."""

from typing import NamedTuple

from ehlpetsc.compiled import compiled
from ehlpetsc.discretisation.contact.node_state import directional_derivative
from ehlpetsc.discretisation.ehl_problem import jacobian_rows
from ehlpetsc.nonlinear.halo_exchange import exchange_unknowns


class Linearisation(NamedTuple):
    """Coefficients of the product with the Jacobian, and work arrays.

    Attributes
    ----------
    state : tuple
        :meth:`.contact.node_state.NodeState.derivatives`, shape (4, 2, window); derivatives of the Reynolds
        rows, (local nodes, 8); local nodes whose second unknown is not in the system; constants of
        :func:`.deflection.deflection_rows`.
    work : tuple of ndarray
        Work arrays: changes of pressure (local nodes,); of Reynolds unknown, film and separation (3, window).
    """

    state: tuple
    work: tuple


@compiled
def jacobian_product(state, work, halo, v, out):
    """Fill in the local rows of the product with a vector, zero in inactive rows; collective.

    Parameters
    ----------
    state, work : tuple
        Fields of a `Linearisation`.
    halo : tuple
        Fields of a `halo_exchange.Halo`.
    v, out : ndarray
    """
    (by, derivatives, inactive_nodes, form), (pressure, change) = state, work
    directional_derivative(by[0], v[: 2 * len(pressure)].reshape(len(pressure), 2), form[0], pressure)
    nodes, h00, curvature, load = exchange_unknowns(*halo, v, pressure, False)
    jacobian_rows(by, derivatives, nodes, h00, curvature, load, *form, change, out)
    for i in inactive_nodes:
        out[2 * i + 1] = 0.0
