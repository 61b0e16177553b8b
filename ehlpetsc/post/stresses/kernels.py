r"""Half-plane kernels integrated exactly over piecewise-linear (hat) elements.

With u = x - s, D = u^2 + z^2 the plane-strain half plane under pressure p and traction q needs four kernels,

.. math:: A = z^3/D^2,\quad B = z^2u/D^2,\quad C = zu^2/D^2,\quad E = u^3/D^2,

    \sigma_x = -\tfrac2\pi(C*p+E*q),\quad \sigma_z = -\tfrac2\pi(A*p+B*q),
    \quad \tau_{xz} = -\tfrac2\pi(B*p+C*q)

(Holmes et al. 2005, section 2.3). All lengths here are in element lengths, so the integrals are numbers.
"""

import numpy as np

GAUSS_DISTANCE = 8.0  # elements: beyond, quadrature is exact to rounding and the closed form has cancellation
GAUSS_NODES, GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(10)


def point_kernels(u, z):
    """Kernels A, B, C, E at distance u and depth z > 0 or u != 0; shape (4,) + shape of u."""
    d2 = (u * u + z * z) ** 2
    return np.stack([z**3 / d2, z * z * u / d2, z * u * u / d2, u**3 / d2])


def _primitives(u, z):
    """First and second antiderivatives in u of A, B, C, E, with their limits at z = 0."""
    theta = np.arctan2(u, z)
    d = u * u + z * z
    d = np.where(d > 0, d, 1.0)  # u = z = 0: u ln D and z ln D are 0, the rest is the finite part
    log_d = np.log(d)
    first = np.stack(
        [
            theta / 2 + z * u / (2 * d),
            -z * z / (2 * d),
            theta / 2 - z * u / (2 * d),
            log_d / 2 + z * z / (2 * d),
        ]
    )
    second = np.stack(
        [u * theta / 2, -z * theta / 2, u * theta / 2 - z * log_d / 2, u * log_d / 2 - u + 1.5 * z * theta]
    )
    return first, second


def _half_closed(u, z):
    """Closed form of the left half hat, load 1 + s on -1 <= s <= 0."""
    first, second = _primitives(u, z)
    return _primitives(u + 1, z)[1] - second - first


def _hat_closed(u, z):
    return _primitives(u + 1, z)[1] - 2 * _primitives(u, z)[1] + _primitives(u - 1, z)[1]


def _half_quadrature(u, z):
    s = (GAUSS_NODES - 1) / 2
    values = point_kernels(u[:, None] - s, z)
    return values @ (GAUSS_WEIGHTS / 2 * (1 + s))


def _hat_quadrature(u, z):
    mirrored = np.array([1.0, -1.0, 1.0, -1.0])[:, None] * _half_quadrature(-u, z)
    return _half_quadrature(u, z) + mirrored


def _blend(u, z, closed, quadrature):
    u = np.asarray(u, float)
    near = np.hypot(u, z) < GAUSS_DISTANCE
    out = np.empty((4, u.size))
    out[:, near] = closed(u[near], z)
    out[:, ~near] = quadrature(u[~near], z)
    return out


def hat(u, z):
    """Kernels A, B, C, E integrated over a hat of unit height and base -1..1.

    Parameters
    ----------
    u : ndarray, shape (n,)
        Distance from the centre of the hat, in elements.
    z : float
        Depth in elements, >= 0; at z = 0 the limits from inside the body.

    Returns
    -------
    ndarray, shape (4, n)
    """
    return _blend(u, z, _hat_closed, _hat_quadrature)


def half_hat(u, z):
    """Kernels integrated over the left half of a hat: contribution of an end node outside the load.

    At u = z = 0 the stress of a jump of the traction is infinite; the finite part is returned.
    """
    return _blend(u, z, _half_closed, _half_quadrature)
