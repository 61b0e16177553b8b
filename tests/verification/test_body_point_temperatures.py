"""Surface temperatures of body points of the damage case, against a quadrature of its stored fluxes.

Its profiles are filtered and carry a compliant layer, so that the mesh resolves the fluxes. Those of rigid
contacts are spikes of one node: quadratures of fluxes that are linear at fixed places, linear in the body, or
cubic there then differ by a tenth from each other.
"""

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import trapezoid
from scipy.special import erf
from support.histories import temperature_history

import ehlpetsc
from ehlpetsc.physics.flash_temperature import Solid
from ehlpetsc.post.loads import Loads
from ehlpetsc.post.run import Job, run
from ehlpetsc.results.post_result import PostResult

CASES = Path(__file__).parents[2] / "cases"
BULK = 363.0
STEEL = Solid(46.0, 7850.0, 470.0)
NAMES = "shear_stress", "temperature", "heat_flux"
FIELDS = ["pressure", *(f"{name}_{side}" for name in NAMES for side in "12")]
CHANGES = {
    "heat.bulk_temperature": BULK,
    "heat.viscosity_temperature": 0.04,
    "heat.oil_conductivity_pressure": 0.0,
    "mesh.points_per_half_width": 50,
    "mesh.inlet": -1.4,
    "mesh.outlet": 1.3,
    "time.travel": 5.8,
    "time.courant": 0.8,  # a node of the faster surface
    "contact.model": "mixed",
    "contact.asperity_height": 200e-9,
    **{
        f"surface.{side}.{key}": value
        for side in "12"
        for key, value in (("short_cutoff", 60e-6), ("scale", 1.0))
    },
    "output.fields": FIELDS,
    "post.depths": [0.0],
}
BEFORE = 0.2  # half-widths outside the mesh at time 0: what came before does not reach such a point
EVERY = 6  # frames between those at which a temperature is recomputed
WITHIN = 0.02
GAUSS = np.polynomial.legendre.leggauss(3)


def rise_of_point(loads, surface, speed, s, flux, frames):
    r"""Temperature rise [K] of body point s in some frames, by quadrature of instantaneous line sources.

    :math:`T=\int\!\!\int\frac{q(s',t')}{2\pi k\tau}e^{-(s-s')^2/(4\chi\tau)}ds'dt'`, :math:`\tau=t-t'`
    (Carslaw & Jaeger 1959, section 10.3), q constant over a cell of the mesh and linear in time.
    """
    return np.array([_rise(loads, speed, s, flux[: frame + 1], loads.time[: frame + 1]) for frame in frames])


def _rise(loads, speed, s, flux, time):
    low, high = np.sqrt(time[-1] - time[1:]), np.sqrt(time[-1] - time[:-1])  # no singularity in sqrt(tau)
    total = 0.0
    for point, weight in zip(*GAUSS, strict=True):
        root = 0.5 * (low + high) + 0.5 * (high - low) * point
        at = time[-1] - root**2
        share = ((at - time[:-1]) / np.diff(time))[:, None]
        q = (1.0 - share) * flux[:-1] + share * flux[1:]
        away = s + speed * at[:, None] - loads.x
        width = np.sqrt(4.0 * STEEL.diffusivity) * root[:, None]
        cell = erf((away + 0.5 * loads.dx) / width) - erf((away - 0.5 * loads.dx) / width)
        kernel = 0.5 * cell / (np.sqrt(np.pi) * STEEL.effusivity * root[:, None])
        total += (q * kernel).sum(axis=1) @ ((high - low) * weight * root)
    return total


@pytest.fixture(scope="module")
def heated(tmp_path_factory):
    path = tmp_path_factory.mktemp("heat") / "damage.h5"
    ehlpetsc.solve(ehlpetsc.load(CASES / "table1_damage.toml", CHANGES), output=path).close()
    run(Job(str(path), str(path.with_suffix(".post.h5"))))
    return path


@pytest.mark.slow
@pytest.mark.parametrize("surface", ["1", "2"])
def test_temperatures_equal_a_quadrature_of_stored_fluxes(heated, surface):
    found = PostResult(heated.with_suffix(".post.h5"))
    known = found.temperatures[surface]
    with Loads(heated) as loads:
        flux, speed = loads.frames(f"heat_flux_{surface}", 0, loads.time.size), loads.speeds[surface]
        late = found.s < loads.x[0] - BEFORE * loads.a
        hottest = np.argsort(np.where(late & found.complete[surface], known.flash, 0.0))[-1]
        for j in (hottest, np.flatnonzero(late & found.complete[surface])[0]):
            s = found.s[j]
            place = s + speed * loads.time
            frames = np.flatnonzero((place >= loads.x[0]) & (place <= loads.x[-1]))
            history = temperature_history(loads, surface, s)
            peak = history.argmax()
            kept = np.unique(np.r_[0 : frames.size : EVERY, max(peak - 3, 0) : peak + 4])
            rise = rise_of_point(loads, surface, speed, s, flux, frames[kept])
            assert known.flash[j] == pytest.approx(rise.max(), rel=WITHIN)
            inside = np.abs(place[frames[kept]]) <= loads.a
            time = loads.time[frames[kept]][inside]
            mean = trapezoid(rise[inside], time) / (time[-1] - time[0])
            assert known.mean[j] - BULK == pytest.approx(mean, rel=WITHIN)
            assert np.sqrt(np.mean((history[kept] - BULK - rise) ** 2)) < WITHIN * rise.max()
