"""A Gaussian ridge on the slower surface as it passes the centre of the contact, against a dense solution.

Film at x = 0 [um], least film [um] and greatest pressure [GPa] by mesh, a node a step:

====  =======  =======  =======
a/dx  h(0)     h_min    p_max
====  =======  =======  =======
200   0.14744  0.12482  1.17797
300   0.14749  0.12488  1.17800
====  =======  =======  =======
"""

import numpy as np
import pytest
from support import CASES
from support.driving import Scene
from support.published_values import RIDGE

from ehlpetsc.case.loading import load


@pytest.mark.slow
def test_ridge_at_the_contact_centre():
    scene = Scene("ridge.toml", "mesh.points_per_half_width=200", "contact.model=mixed").start()
    s = scene.scales
    position = load(CASES / "ridge.toml").surface.body_2.synthetic.position
    arrival = (position - s.x[0] * s.a) / s.u2
    count = round(arrival / s.dt)
    for _ in scene.steps(count, arrival / count):
        pass
    # nothing of the ridge is lost where profiles come in
    height = -scene.simulation.roughness.phi_after(s.x * s.a, scene.state.travelled, s.spacing)
    np.testing.assert_allclose(height, 0.1e-6 * np.exp(-((s.x / 0.1) ** 2)), atol=1e-12)
    found = {
        "film at the centre": scene.film[scene.centre],
        "h_min": scene.film.min(),
        "p_max": scene.pressure.max(),
    }
    for name, bounds in RIDGE.items():
        assert found[name] == pytest.approx(bounds.value, abs=bounds.uncertainty), name
