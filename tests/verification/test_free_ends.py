"""Images with the published factor against finite elements of a quarter space."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import k0
from support.quarter_space import deflection

from ehlpetsc.elasticity.images import image_factor


@pytest.mark.parametrize(
    ("poisson_ratio", "at_edge", "lowest", "highest"),
    [(0.0, 1.0, 0.0, 0.106), (0.2, 1.118, 0.0, 0.036), (0.3, 1.236, -0.047, 0.0)],
)
def test_images_deflect_as_a_quarter_space_within_a_few_percent(poisson_ratio, at_edge, lowest, highest):
    """Waves along the edge, uniform across: deflection near a free edge over that far from it."""
    y, exact = deflection(lambda y: 1.0, poisson_ratio, False)
    y, mirrored = deflection(lambda y: 1.0, poisson_ratio, True)
    near = y < 3.0
    np.testing.assert_allclose(mirrored[near], 1.0, rtol=1e-4)
    assert exact[0] == pytest.approx(at_edge, abs=1e-3)
    by_images = np.array([quad(k0, max(place, 1e-9), 30.0)[0] / np.pi for place in y])
    errors = (1.0 - by_images + image_factor(poisson_ratio) * by_images) / exact - 1.0
    assert lowest - 1e-3 <= errors[near].min() and errors[near].max() <= highest + 1e-3
