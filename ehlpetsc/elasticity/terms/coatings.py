r"""Bodies with a bonded layer: what it adds to the kernel of homogeneous half-spaces.

A wave k of pressure deflects the coated body by :math:`\Phi(kt)` times as much as its half-space without the
layer, of the thickness t (O'Sullivan and King 1988, without friction),

.. math:: \Phi(z)=\Phi_\infty\frac{1+4\kappa z e^{-2z}-\lambda\kappa e^{-4z}}
   {1-(\lambda+\kappa+4\kappa z^2)e^{-2z}+\lambda\kappa e^{-4z}},
   \qquad\Phi_\infty=\frac{1-\nu_c^2}{E_c}\frac{E_s}{1-\nu_s^2},

with the shear moduli :math:`\mu=G_c/G_s` of layer and body, :math:`\kappa=(\mu-1)/(\mu+3-4\nu_c)`,
:math:`\lambda=1-4(1-\nu_c)/(1+\mu(3-4\nu_s))`. Waves shorter than the layer are those of a half-space of it,
:math:`\Phi_\infty` times the kernel; for the rest :math:`D=\Phi-\Phi_\infty` a unit force deflects at the
distance r by

.. math:: g(r)=\frac1t\gamma\Big(\frac rt\Big),\qquad\gamma(s)=\int_0^\infty D(z)\,J_0(zs)\,dz,

a Hankel transform on a logarithmic grid, smooth on the scale of t. The kernel of a cell is its integral over
the cell, hat along x and constant across, by Gauss' rule: near the node on panels that halve down to the
thickness, so that layers far thinner than a cell are right too; from `NEAR` cells on with three points each
way. In a strip the sum over the periods has the mean of the line contact, an integral over y,

.. math:: g_1(x)=-D(0)\ln(x^2+t^2)+2\int_0^\infty\frac{D(z)-D(0)e^{-z}}z\cos\frac{zx}t\,dz .

Chosen over a sum of images of point forces, whose fit fails for layers much stiffer than their body, where
the deflection oscillates. `tests/unit/test_coating.py` holds it: cells are sums of cells a fifth as large to
1e-7, above layers of a three-hundredth of a spacing to ten, and the transfer function solves layer and body
as a boundary value problem.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from scipy.fft import fht, fhtoffset

from ehlpetsc.elasticity.bodies import Bodies
from ehlpetsc.elasticity.half_space import IMAGES, distant_periods, free_kernel, periodic_kernel
from ehlpetsc.elasticity.kernel import Kernel, Mesh

Function = Callable[[np.ndarray], np.ndarray]
SAMPLES, LONGEST = 4096, 1e8  # of the transforms, z from 1/LONGEST to LONGEST
END = 1e4  # of the grids, where the periodic transforms are wrong
NEAR = 8  # larger spacings: up to here graded panels, beyond them few points a cell
PANEL_POINTS = 8
HAT_POINTS = np.sqrt(0.4) * np.array([-1.0, 0.0, 1.0])  # exact up to the fifth power
HAT_WEIGHTS = np.array([5.0, 14.0, 5.0]) / 24.0
PERIODS_OF_LAYER = 12.0  # thicknesses to the farthest period that is summed
THICK = 3.0  # periods: waves across the strip, exp(-4 pi t/L), do not reach the body below a thicker layer


class Layer(NamedTuple):
    """Layer bonded to a body.

    `thickness`: in half-widths. `modulus`: Young's, over that of the body. `poisson_ratio`, `body_ratio`:
    Poisson's ratios of layer and body.
    """

    thickness: float
    modulus: float
    poisson_ratio: float
    body_ratio: float


def term(bodies: Bodies, mesh: Mesh) -> Kernel | None:
    """Term of the coatings of both bodies, `contact.coating`."""
    contact, terms = bodies.contact, []
    if contact.coating is None:
        return None
    for i, coating in enumerate(contact.coating):
        if coating is not None:
            modulus = coating.youngs_modulus / contact.youngs_modulus[i]
            ratios = coating.poisson_ratio, contact.poisson_ratio[i]
            layer = Layer(coating.thickness / mesh.a, modulus, *ratios)
            terms.append(layer_term(layer, bodies.shares[i], mesh))
    return terms[0] if len(terms) == 1 else terms[0].plus(terms[1])


def layer_term(layer: Layer, share: float, mesh: Mesh) -> Kernel:
    """Term of the layer of a body with a share of the compliance of both bodies."""
    (n_y, n_x), (dy, dx) = mesh.shape, mesh.spacings
    half_space = (periodic_kernel if mesh.periodic else free_kernel)(n_x, n_y, dx, dy)
    smooth = (periodic_cells if mesh.periodic else free_cells)(layer, mesh)
    direct = share * ((short_waves(layer) - 1.0) * half_space + smooth)
    return Kernel(
        direct,
        softening=lambda k: share * (softening(layer, k * layer.thickness) - 1.0),
        is_homogeneous=not direct.any(),  # a layer of the body's own moduli
    )


def short_waves(layer: Layer) -> float:
    """Compliance of waves shorter than the layer over that of the body."""
    return (1.0 - layer.poisson_ratio**2) / (1.0 - layer.body_ratio**2) / layer.modulus


def long_waves(layer: Layer) -> float:
    r"""Compliance of long waves, that of the body, beyond that of short ones, :math:`1-\Phi_\infty`."""
    return 1.0 - short_waves(layer)


def softening(layer: Layer, z: np.ndarray) -> np.ndarray:
    """Compliance of waves, z wave number times thickness, over that of the body."""
    of_layer, of_body = 3.0 - 4.0 * layer.poisson_ratio, 3.0 - 4.0 * layer.body_ratio
    mu = layer.modulus * (1.0 + layer.body_ratio) / (1.0 + layer.poisson_ratio)
    kappa, lam = (mu - 1.0) / (mu + of_layer), (mu * of_body - of_layer) / (1.0 + mu * of_body)
    e = np.exp(-2.0 * z)
    top = 1.0 + 4.0 * kappa * z * e - lam * kappa * e * e
    return short_waves(layer) * top / (1.0 - (lam + kappa + 4.0 * kappa * z * z) * e + lam * kappa * e * e)


def transform(values: Function, order: float) -> tuple[np.ndarray, np.ndarray]:
    """Arguments s and integrals of values(z) J(z s) over z, J the Bessel function of an order."""
    logarithms = np.linspace(-np.log(LONGEST), np.log(LONGEST), SAMPLES)
    step = logarithms[1] - logarithms[0]
    offset = fhtoffset(step, mu=order)
    s = np.exp(offset + logarithms)
    return s, fht(values(np.exp(logarithms)), step, order, offset=offset) / s


def interpolated(s: np.ndarray, values: np.ndarray) -> Function:
    """Function of s >= 0 through values on a logarithmic grid: constant below it, 0 above it."""
    from scipy.interpolate import CubicSpline  # 14 MB, which no other kernel needs

    spline, lowest, highest = CubicSpline(np.log(s), values), END * s[0], s[-1] / END
    return lambda at: np.where(at < highest, spline(np.log(np.clip(at, lowest, highest))), 0.0)


def by_a_force(layer: Layer) -> Function:
    r"""Deflection :math:`g(r)=\frac1t\int_0^\infty D(z)J_0(zr/t)\,dz` by a unit force at the distance r."""
    far, thickness = long_waves(layer), layer.thickness

    def rest(z: np.ndarray) -> np.ndarray:
        return softening(layer, z) - short_waves(layer) - far * np.exp(-z)

    smooth = interpolated(*transform(rest, 0.0))
    return lambda r: smooth(r / thickness) / thickness + far / np.hypot(r, thickness)


def by_a_line(layer: Layer) -> Function:
    r"""Deflection by a unit line force at the distance x.

    :math:`g_1(x)=-D(0)\ln(x^2+t^2)+2\int_0^\infty[D(z)-D(0)e^{-z}]\cos(zx/t)\,dz/z`.
    """
    far, thickness = long_waves(layer), layer.thickness

    def rest(z: np.ndarray) -> np.ndarray:
        return (softening(layer, z) - short_waves(layer) - far * np.exp(-z)) / np.sqrt(z)

    s, integrals = transform(rest, -0.5)
    smooth = interpolated(s, np.sqrt(2.0 * np.pi * s) * integrals)
    return lambda x: smooth(x / thickness) - far * np.log(x * x + thickness * thickness)


def free_cells(layer: Layer, mesh: Mesh) -> np.ndarray:
    """Integrals of g over cells at distances of 0 .. n - 1 nodes, shape (n_y, n_x)."""
    return over_cells(by_a_force(layer), layer.thickness, mesh.shape, mesh.spacings)


def over_cells(g: Function, thickness: float, shape: Sequence[int], spacings: Sequence[float]) -> np.ndarray:
    """Integrals of g(r) over cells, hat along x and constant across, shape (n_y, n_x)."""
    (n_y, n_x), (dy, dx) = shape, spacings
    x, y = np.arange(n_x) * dx, np.arange(n_y) * dy
    points, weights = np.polynomial.legendre.leggauss(len(HAT_POINTS))
    kernel = np.zeros((n_y, n_x))
    for t, of_y in zip(0.5 * dy * points, 0.5 * dy * weights, strict=True):
        for s, of_x in zip(dx * HAT_POINTS, dx * HAT_WEIGHTS, strict=True):
            kernel += of_y * of_x * g(np.hypot(x + s, (y + t)[:, None]))
    reach = NEAR * max(dx, dy)
    near_x, near_y = min(n_x, int(reach / dx) + 1), min(n_y, int(reach / dy) + 1)
    (along, s), (across, t) = hats(near_x, dx, thickness), boxes(near_y, dy, thickness)
    kernel[:near_y, :near_x] = across @ g(np.hypot(s, t[:, None])) @ along.T
    return kernel


def panels(ends: np.ndarray, thickness: float) -> tuple[np.ndarray, np.ndarray]:
    """Points and weights of Gauss' rule between `ends` from 0 on, where panels halve to the thickness."""
    halvings = max(int(np.ceil(np.log2(2.0 * ends[1] / thickness))), 0)
    ends = np.concatenate([[0.0], ends[1] * 0.5 ** np.arange(halvings, 0, -1), ends[1:]])
    points, weights = np.polynomial.legendre.leggauss(PANEL_POINTS)
    half = 0.5 * np.diff(ends)
    return (ends[:-1, None] + np.multiply.outer(half, 1.0 + points)).ravel(), np.outer(half, weights).ravel()


def hats(n: int, step: float, thickness: float) -> tuple[np.ndarray, np.ndarray]:
    """Weights (n, points) of the hats about the first n nodes for an even function, and its points."""
    points, weights = panels(np.arange(n + 1) * step, thickness)
    of_nodes = weights * np.maximum(1.0 - np.abs(points / step - np.arange(n)[:, None]), 0.0)
    of_nodes[0] *= 2.0  # both sides
    return of_nodes, points


def boxes(n: int, step: float, thickness: float) -> tuple[np.ndarray, np.ndarray]:
    """Deflections as of :func:`hats`, by pressures constant over the cells of the nodes."""
    points, weights = panels(np.concatenate([[0.0], (np.arange(n) + 0.5) * step]), thickness)
    of_nodes = weights * (np.rint(points / step) == np.arange(n)[:, None])
    of_nodes[0] *= 2.0
    return of_nodes, points


def periodic_cells(layer: Layer, mesh: Mesh) -> np.ndarray:
    """Deflections as of :func:`free_cells`, summed over all periods across."""
    (n_y, n_x), (dy, dx) = mesh.shape, mesh.spacings
    thickness, period, rows, kernel = layer.thickness, n_y * dy, np.arange(n_y), np.zeros((n_y, n_x))
    if thickness < THICK * period:
        images = max(IMAGES, int(np.ceil(PERIODS_OF_LAYER * thickness / period)))
        one_side = over_cells(by_a_force(layer), thickness, ((images + 1) * n_y + 1, n_x), mesh.spacings)
        for k in range(-images, images + 1):
            kernel += one_side[np.abs(rows + k * n_y)]
        distant = distant_periods(np.arange(n_x) * dx, rows * dy, period, images)
        kernel += long_waves(layer) * dx * dy * distant
        kernel = 0.5 * (kernel + kernel[-rows])  # symmetric to the last digit
        kernel -= kernel.mean(axis=0)
    return kernel + line_cells(layer, n_x, dx) / n_y


def line_cells(layer: Layer, n_x: int, dx: float) -> np.ndarray:
    """Integrals of g_1 over hats at distances of 0 .. n_x - 1 nodes."""
    g_1, x = by_a_line(layer), np.arange(n_x) * dx
    cells = sum(dx * w * g_1(np.abs(x + s)) for w, s in zip(HAT_WEIGHTS, dx * HAT_POINTS, strict=True))
    along, points = hats(min(n_x, NEAR + 1), dx, layer.thickness)
    cells[: len(along)] = along @ g_1(points)
    return cells
