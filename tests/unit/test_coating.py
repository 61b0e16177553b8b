"""Coated bodies: transfer function, kernel of cells, limits of the thickness, keys."""

import numpy as np
import pytest

from ehlpetsc.case.loading import load
from ehlpetsc.elasticity.half_space import free_kernel, periodic_kernel
from ehlpetsc.elasticity.kernel import Mesh
from ehlpetsc.elasticity.terms.coatings import Layer, layer_term, over_cells, short_waves, softening
from ehlpetsc.elasticity.terms.coatings import by_a_force as force

STIFF, SOFT = Layer(0.1, 3.0, 0.25, 0.3), Layer(0.1, 0.1, 0.45, 0.3)
FREE, STRIP = Mesh((24, 33), (0.05, 0.03), False, 1.0), Mesh((24, 33), (0.05, 0.03), True, 1.0)


def airy(k, y, shear, ratio, decays):
    """Normal and shear stress, displacement along and normal, of the stress functions of plane strain."""
    rows = []
    for sign in (-1,) if decays else (-1, 1):
        e = np.exp(sign * k * (y - (1.0 if decays or sign > 0 else 0.0)))
        for power in (0, 1):
            f = (1.0, y)[power] * e
            d1 = (power + sign * k * (1.0, y)[power]) * e
            d2 = (2.0 * power * sign * k + k * k * (1.0, y)[power]) * e
            d3 = (3.0 * power * k * k + sign * k**3 * (1.0, y)[power]) * e
            along = ((1.0 - ratio) * d2 + ratio * k * k * f) / (2.0 * shear * k)
            slope = ((1.0 - ratio) * d3 + ratio * k * k * d1) / (2.0 * shear * k)
            rows.append((-k * k * f, k * d1, along, (slope - k * d1 / shear) / k))
    return np.array(rows).T


def solved(layer, z):
    """Compliance of a wave over that of the body, from the boundary value problem of layer and body."""
    shear = layer.modulus / (2.0 * (1.0 + layer.poisson_ratio))
    top, below = (airy(z, y, shear, layer.poisson_ratio, False) for y in (0.0, 1.0))
    body = airy(z, 1.0, 0.5 / (1.0 + layer.body_ratio), layer.body_ratio, True)
    matrix = np.zeros((6, 6))
    matrix[:2, :4], matrix[2:, :4], matrix[2:, 4:] = top[:2], below, -body
    constants = np.linalg.solve(matrix, [-1.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    return top[3] @ constants[:4] * z / (2.0 * (1.0 - layer.body_ratio**2))


@pytest.mark.parametrize("layer", (STIFF, SOFT, Layer(0.1, 100.0, 0.2, 0.3), Layer(0.1, 0.01, 0.3, 0.0)))
def test_transfer_function_solves_layer_and_body(layer):
    z = np.array([0.01, 0.3, 1.0, 3.0])
    assert softening(layer, z) == pytest.approx([solved(layer, one) for one in z], rel=1e-9)


def test_confined_thin_layer_is_compressed_by_its_confined_modulus():
    """Thin soft layer: p t (1 + nu)(1 - 2 nu)/(E (1 - nu)) beside 2 p (1 - nu^2)/(E k) of the body."""
    layer = Layer(1.0, 1e-4, 0.3, 0.3)
    confined = 1.3 * 0.4 / 0.7 / 1e-4 / (2.0 * 0.91)
    assert (softening(layer, np.array([1e-3]))[0] - 1.0) / 1e-3 == pytest.approx(confined, rel=2e-3)


@pytest.mark.parametrize("mesh, half_space", ((FREE, free_kernel), (STRIP, periodic_kernel)))
def test_equal_moduli_and_thin_layers_are_the_body_and_thick_layers_a_half_space_of_them(mesh, half_space):
    body = half_space(33, 24, 0.03, 0.05)
    assert not layer_term(Layer(0.1, 1.0, 0.3, 0.3), 0.5, mesh).direct.any()
    for layer in (STIFF, SOFT):
        thin = layer_term(layer._replace(thickness=1e-8), 1.0, mesh).direct
        assert np.abs(thin).max() < 2e-6 * body.max()
        thick = layer_term(layer._replace(thickness=1e5), 1.0, mesh).direct
        expected = (short_waves(layer) - 1.0) * body
        constant = (thick - expected).mean()  # the approach of a body in the distance
        np.testing.assert_allclose(thick - constant, expected, rtol=0, atol=2e-5 * np.abs(expected).max())


@pytest.mark.parametrize("thickness", (1e-4, 1e-3, 0.02, 0.3))
def test_cells_are_sums_of_smaller_ones_also_above_layers_thinner_than_a_cell(thickness):
    """Hats and constants of a cell are sums of those of cells a fifth as large."""
    layer, small, parts = STIFF._replace(thickness=thickness), (0.01, 0.006), 5
    fine = over_cells(force(layer), thickness, (70, 90), small)
    coarse = over_cells(force(layer), thickness, (12, 16), (0.05, 0.03))
    hat, box = 1.0 - np.abs(np.arange(-4, 5)) / parts, np.ones(parts)
    for j, i in ((0, 0), (0, 1), (1, 0), (2, 3), (11, 15)):
        rows = np.abs(parts * j + np.arange(-2, 3))
        columns = np.abs(parts * i + np.arange(-4, 5))
        assert coarse[j, i] == pytest.approx(box @ fine[np.ix_(rows, columns)] @ hat, rel=1e-7)


def test_strip_is_the_sum_over_many_periods():
    """The mean across up to a constant; the waves across to the sum's own 1/periods^2."""
    n_y, periods = 24, 200
    whole = over_cells(force(STIFF), 0.1, ((periods + 1) * n_y + 1, 33), STRIP.spacings)
    summed = whole[np.abs(np.arange(n_y)[:, None] + np.arange(-periods, periods + 1) * n_y)].sum(axis=1)
    bodies = (short_waves(STIFF) - 1.0) * periodic_kernel(33, n_y, 0.03, 0.05)
    strip = layer_term(STIFF, 1.0, STRIP).direct - bodies
    np.testing.assert_allclose(
        strip - strip[0, 9], summed - summed[0, 9], rtol=0, atol=5e-5 * np.abs(strip).max()
    )


BALL = {
    "title": "ball",
    "contact": {"radius": [0.01, 0.01], "load": 20.0, "youngs_modulus": 2.1e11, "poisson_ratio": 0.3},
    "mesh": {"points_per_half_width": 12, "inlet": -1.6, "outlet": 1.6, "width": 3.2},
}
COATED = {"thickness": 2e-6, "youngs_modulus": 1e11, "poisson_ratio": 0.2}


def pressures(coating, **contact):
    from ehlpetsc import solve

    tables = BALL | {"contact": BALL["contact"] | contact | ({"coating": coating} if coating else {})}
    with solve(load(tables), options={}) as result:
        return result.pressure[-1]


def test_dry_contacts_are_monotone_in_thickness_between_body_and_coating():
    bare = pressures(None)
    equal = COATED | {"youngs_modulus": 2.1e11, "poisson_ratio": 0.3}
    assert (pressures(equal) == bare).all()
    maxima = [pressures(COATED | {"thickness": t}).max() for t in (1e-9, 1e-6, 1e-5, 1e-4, 1e-2)]
    assert maxima == sorted(maxima, reverse=True) and maxima[0] == pytest.approx(bare.max(), rel=2e-4)
    of_coating = pressures(None, youngs_modulus=[1e11, 2.1e11], poisson_ratio=[0.2, 0.3])
    assert maxima[-1] == pytest.approx(of_coating.max(), rel=5e-3)
    on_second = pressures([{}, COATED | {"thickness": 1e-5}])
    assert on_second == pytest.approx(pressures([COATED | {"thickness": 1e-5}, {}]), rel=1e-9)
