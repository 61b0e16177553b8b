"""Kernels of both bodies: terms, images beyond plane ends, compliance of waves."""

from pathlib import Path

import numpy as np
import pytest

from ehlpetsc.discretisation.plane.deflection import Convolution, Transposition
from ehlpetsc.elasticity import kernel
from ehlpetsc.elasticity.bodies import Bodies
from ehlpetsc.elasticity.half_plane import curvature_kernel, deflection_kernel
from ehlpetsc.elasticity.half_space import free_kernel
from ehlpetsc.elasticity.kernel import Kernel, Mesh, kernel_of
from ehlpetsc.elasticity.terms.free_ends import images, of_quarter_spaces
from ehlpetsc.nonlinear.plane.screened_poisson import fitted_term

MESH = Mesh((6, 9), (0.05, 0.03), False, 1e-4)
IMAGES = images(MESH, free_kernel(9, 12, 0.03, 0.05))


class Contact:
    youngs_modulus, poisson_ratio = (2e11, 6e10), (0.3, 0.2)
    coating = length = None


BODIES = Bodies.of(Contact)


def test_kernels_of_a_line_are_the_integral_of_the_hat_near_and_far():
    """By Gauss points on either side of its middle; the asymptotic series begin at 40 nodes."""
    points, weights = np.polynomial.legendre.leggauss(24)
    t = np.concatenate([0.5 * (points - 1.0), 0.5 * (points + 1.0)])
    hat = np.tile(0.5 * weights, 2) * (1.0 - np.abs(t))
    k = np.arange(3.0, 200.0)[:, None]
    np.testing.assert_allclose(deflection_kernel(200)[3:], -np.log(k - t) @ hat, rtol=0, atol=2e-14)
    curvature = -np.log1p(-1.0 / (k - t) ** 2) @ hat
    np.testing.assert_allclose(curvature_kernel(200)[3:], curvature, rtol=2e-10, atol=0)


def test_images_are_the_pressures_mirrored_about_both_end_planes():
    (n_y, n_x), (dy, dx) = MESH.shape, MESH.spacings
    pressure = np.random.default_rng(2).random(MESH.shape)
    product = Convolution(Kernel(free_kernel(n_x, n_y, dx, dy), IMAGES), False, Transposition())
    rows = np.concatenate([pressure[::-1], pressure, pressure[::-1]])  # planes half a cell beyond the rows
    long = Convolution(Kernel(free_kernel(n_x, 3 * n_y, dx, dy)), False, Transposition())
    expected = long(rows.ravel()).reshape(3 * n_y, n_x)[n_y : 2 * n_y]
    np.testing.assert_allclose(product(pressure.ravel()), expected.ravel(), rtol=1e-13)
    single = product(pressure.ravel().astype(np.float32))
    assert single.dtype == np.float32
    np.testing.assert_allclose(single, expected.ravel(), rtol=1e-6)


def test_every_module_of_the_folder_is_a_term():
    folder = Path(kernel.__file__).with_name("terms")
    names = {path.stem for path in folder.glob("*.py")} - {"__init__"}
    assert (
        {term.__module__.rpartition(".")[2] for term in kernel.terms()} == names >= {"coatings", "free_ends"}
    )


def test_a_term_is_added_to_the_half_spaces(monkeypatch):
    def of_first_body(bodies, mesh):
        share = bodies.shares[0]
        return Kernel(np.full(mesh.shape, share), share * IMAGES, lambda k: share / k)

    alone = kernel_of(BODIES, MESH)
    assert alone.mirrored is None and alone.softening(np.array([1.0, 7.0])) == pytest.approx(1.0, rel=0)
    monkeypatch.setattr(kernel, "terms", lambda: [of_first_body, lambda bodies, mesh: None, of_first_body])
    both = kernel_of(BODIES, MESH)
    np.testing.assert_allclose(both.direct, alone.direct + 2.0 * BODIES.shares[0], rtol=1e-15)
    np.testing.assert_allclose(both.mirrored, 2.0 * BODIES.shares[0] * IMAGES, rtol=1e-15)
    assert both.softening(np.array([1.0, 4.0])) == pytest.approx(
        [1.0 + 2.0 * BODIES.shares[0], 1.0 + 0.5 * BODIES.shares[0]], rel=1e-15
    )
    layered = alone._replace(is_homogeneous=False)
    assert [one.plus(other).is_homogeneous for one, other in ((both, alone), (alone, layered))] == [
        True,
        False,
    ]


@pytest.mark.parametrize("shape", [(12, 15), (300, 9)])
def test_ends_deflect_by_both_distances_from_the_end_face(shape):
    """Sum over all rows; of 300 rows only the long waves reach all."""
    (n_y, n_x), (dy, dx), beyond = shape, (0.5, 0.4), (2, 5)
    mesh = Mesh(shape, (dy, dx), False, 1e-4, beyond)
    ends = of_quarter_spaces(mesh, 0.3).ends
    product = Convolution(Kernel(np.zeros(shape), ends=ends), False, Transposition())
    pressure = np.random.default_rng(6).random(shape)
    x = dx * np.abs(np.subtract.outer(np.arange(n_x), np.arange(n_x)))
    expected = np.zeros(shape)
    for rows, to_end in zip((slice(None), slice(None, None, -1)), beyond, strict=True):
        y = dy * (np.arange(n_y) + 0.5 + to_end)
        s = np.add.outer(y, y)
        for m, along in enumerate(x):
            weight = 1.5 * dx * dy * np.outer(y, y)[:, :, None] / np.hypot(s[:, :, None], along) ** 3
            expected[rows, m] += np.einsum("jli,li->j", weight, pressure[rows])
    found = product(pressure.ravel()).reshape(shape)
    np.testing.assert_allclose(found, expected, rtol=0, atol=4e-6 * expected.max())  # white noise
    single = product(pressure.ravel().astype(np.float32)).reshape(shape)
    np.testing.assert_allclose(single, found, rtol=0, atol=1e-6 * expected.max())
    octaves = product.ends[0].octaves
    near = [len(octave.distances) for octave in octaves]
    assert near[0] == n_y and (max(near[2:]) < 100 if n_y == 300 else near[-1] == n_y)


def test_free_ends_are_images_on_the_share_of_the_roller():
    class Roller(Contact):
        length, free_ends = 1e-3, True

    kernel, alone = kernel_of(Bodies.of(Roller), MESH), kernel_of(BODIES, MESH)
    np.testing.assert_array_equal(kernel.direct, alone.direct)
    term = of_quarter_spaces(MESH, 0.3)
    np.testing.assert_allclose(kernel.mirrored, BODIES.shares[0] * term.mirrored, rtol=1e-14)
    assert [end.is_last for end in kernel.ends] == [False, True]
    for end, whole in zip(kernel.ends, term.ends, strict=True):
        np.testing.assert_allclose(end.kernel, BODIES.shares[0] * whole.kernel, rtol=1e-14)
    assert kernel.softening(np.array([5.0])) == alone.softening(np.array([5.0]))


def test_sparse_form_is_as_compliant_as_short_waves():
    of_both = fitted_term(0.2, MESH.spacings, kernel_of(BODIES, MESH))
    of_soft = fitted_term(0.2, MESH.spacings, Kernel(np.zeros(MESH.shape), softening=lambda k: 3.0 + 0.0 * k))
    assert of_soft == pytest.approx((3.0 * of_both[0], of_both[1]), rel=1e-14)


def test_shares_of_the_compliance_are_those_of_the_bodies():
    assert sum(BODIES.shares) == pytest.approx(1.0, rel=1e-15)
    assert BODIES.shares[0] / BODIES.shares[1] == pytest.approx(0.91 / 0.96 * 0.3, rel=1e-14)
