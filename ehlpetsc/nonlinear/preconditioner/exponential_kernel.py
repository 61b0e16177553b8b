r"""The far deflection as a sum of exponentials, which a narrow band can hold.

The kernel of the differential deflection falls as :math:`1/k^2` over the whole mesh. Cut off, it leaves the
long waves of pressure to the Krylov method; as :math:`\sum_mw_me^{-\lambda_md}` of the distance d it is the
solution of M three-point recurrences,

.. math:: -Q_{d-1}+2\cosh\lambda\,Q_d-Q_{d+1}=2\sinh\lambda\;p_d,

M unknowns more with neighbours only. Distances are between groups of `GROUP` nodes: near by, where that would
be too coarse, the kernel is taken as it is (:mod:`ehlpetsc.nonlinear.preconditioner.banded_jacobian`).
"""

import numpy as np

GROUP = 4  # nodes; wider bands cost more than they save iterations, narrower ones need more exponentials
TERMS = 3  # exponentials; a fourth would save iterations of GMRES, and cost more in the band
REACH = 0.1  # half-widths within which the relative error counts; beyond it counts less
SLOWEST, FASTEST = 0.4, 1.4  # rates: over the reach, and over a group


def grouped_kernel(kernel: np.ndarray) -> np.ndarray:
    """Mean of a kernel (n,) over the nodes of two groups, at distances 0, 1, ... groups."""
    apart = np.arange(1 - GROUP, GROUP)
    weights = (GROUP - np.abs(apart)) / GROUP**2
    distance = np.arange(len(kernel) // GROUP - 1)
    return kernel[np.abs(GROUP * distance[:, None] + apart)] @ weights


def exponentials(kernel: np.ndarray, nodes_per_half_width: float) -> tuple[np.ndarray, np.ndarray]:
    """Rates and weights of the exponentials for a kernel, fitted from a distance of two groups on.

    `kernel`: :func:`ehlpetsc.discretisation.deflection.curvature_kernel`, shape (n,).

    The kernel at a distance of d groups is about ``weights @ exp(-rates * d)``, both of shape (TERMS,).
    """
    far = grouped_kernel(kernel)[2:]
    reach = max(REACH * nodes_per_half_width / GROUP, 1.0)
    rates = np.geomspace(SLOWEST / reach, FASTEST, TERMS)
    distance = 2.0 + np.arange(len(far))
    weight = 1.0 / (far * (1.0 + distance / reach))
    terms = np.exp(-np.outer(distance, rates))
    return rates, np.linalg.lstsq(terms * weight[:, None], far * weight, rcond=None)[0]
