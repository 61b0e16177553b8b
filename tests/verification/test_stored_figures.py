"""Every figure of a step recomputed from the stored fields of a result file, by code that shares nothing.

The equations are written here once more, over whole arrays and in SI units: the film's balance as its
docstrings state it, the half-plane's deflection by the logarithm's integral over each linear piece.
"""

from types import SimpleNamespace

import numpy as np
import pytest
from support import CASES

import ehlpetsc

SHORT = {"mesh.inlet": -1.4, "mesh.outlet": 1.3, "mesh.points_per_half_width": 60, "time.travel": 1.0}
SCENES = {
    "direct": ("table1_rough.toml", SHORT | {"fluid.viscosity": 0.001}),
    "slow direct": ("table1_rough.toml", SHORT | {"motion.entrainment_speed": 0.1, "time.travel": 0.7}),
    "mixed": ("table1_mixed.toml", SHORT | {"fluid.viscosity": 0.001}),
    "film": ("ridge.toml", SHORT | {"surface.2.synthetic.position": 0.0}),
    "dry": ("dry_hertz.toml", {}),
}


def scene(name):
    """A result, and the constants of Table 1 that its case has."""
    file, changed = SCENES[name]
    case = ehlpetsc.load(CASES / file, changed)
    result = ehlpetsc.solve(case, options={"snes_atol": 1e-7})
    e_reduced = 207e9 / (1.0 - 0.3**2)
    load, radius = 527e3, 0.0191
    a = np.sqrt(8.0 * load * radius / (np.pi * e_reduced))
    u = case.motion.entrainment_speed if case.motion else 0.0
    xi = case.motion.slide_roll_ratio if case.motion else 0.0
    return case, result, SimpleNamespace(E=e_reduced, R=radius, load=load, a=a, u=u, slip=u * xi)


@pytest.fixture(scope="module", params=SCENES)
def run(request):
    return scene(request.param)


def spacing(result):
    return (result.x[-1] - result.x[0]) / (len(result.x) - 1)


def rho(p, void):
    """Mass of oil in the film over that of the full film at ambient pressure."""
    return (1.0 + 2.27e-9 * p) / (1.0 + 1.68e-9 * p) * (1.0 - void)


def eta(p, eta0):
    z = 11.1e-9 / (5.1e-9 * np.log(eta0 / 63.2e-6))
    return eta0 * np.exp(np.log(eta0 / 63.2e-6) * ((1.0 + 5.1e-9 * p) ** z - 1.0))


def beyond(m, behind, k):
    return np.maximum(m + k * (m - behind), 0.5 * m)


def carried(m, nodes=1):
    """One node downstream for each step; the film of the first node enters."""
    return np.concatenate([m[:1].repeat(nodes), m[:-nodes]])


def flux(p, h, void, eta0, of, dx, leaks):
    """Driven by the pressure through the faces between the nodes, and out of the last one [m^2/s]."""
    gradient, tau0 = np.diff(p) / dx, 10e6
    film = 0.5 * (h[1:] + h[:-1]) if leaks else np.cbrt(2.0 * (h[1:] * h[:-1]) ** 2 / (h[1:] + h[:-1]))
    sigma = np.maximum(np.abs(film * gradient) / (2.0 * tau0), 1e-3)
    with np.errstate(over="ignore", invalid="ignore"):
        rolling = 3.0 * (sigma * np.cosh(sigma) - np.sinh(sigma)) / sigma**3
        sliding = 3.0 * (sigma / np.tanh(sigma) - 1.0) / sigma**2
    flow = [
        (rho(at, 0.0) * np.hypot(film**3 * rolling / eta(at, eta0), film**2 * of.slip * sliding / tau0)) / 12
        for at in (p[:-1], p[1:])
    ]
    mean = 0.5 * (flow[0] + flow[1])
    if not leaks:
        ratio = np.log(flow[0] / flow[1])
        apart = np.abs(ratio) > 1e-3
        mean[apart] = (flow[0] - flow[1])[apart] / ratio[apart]
    return np.append(-mean * gradient, 0.0)


def oil_lost(case, result, of):
    """Sum over the nodes behind the inlet of what each step loses or makes, over the oil carried."""
    dx, eta0 = spacing(result), case.fluid.viscosity
    dt, lost = result.steps("dt"), []
    # the oil's own pressure: the solids' is not in the stored one of direct contact
    solids = result.contact_pressure if "contact_pressure" in result else 0.0
    p, h, void = result.pressure - solids, result.film_thickness, result.void_fraction
    m = rho(p, void) * h
    for k in range(len(dt)):
        out = flux(p[k], h[k], void[k], eta0, of, dx, case.contact.model == "direct")
        balance = out[1:] - out[:-1]
        if k == 0:
            face = np.append(m[0][0], beyond(m[0][1:], m[0][:-1], 0.5))
            balance += of.u * (face[1:] - face[:-1])
        if k > 0 and abs(of.u * dt[k] / dx - 1.0) > 1e-9:
            break  # a halved step, which interpolates
        if k > 0:
            now = beyond(m[k], carried(m[k - 1]), 0.5)
            then = beyond(carried(m[k - 1]), carried(m[max(k - 2, 0)], 2), 0.5)
            balance += (now - then)[1:] * dx / dt[k]
        inside = np.abs(result.x) <= of.a * (1.0 + 1e-9)
        lost.append(np.abs(balance).sum() / (of.u * max(m[k][inside].mean(), 1e-10)))
    return np.array(lost)


def logarithms(x):
    """Integral of the hat of node j times ln|x_i - s|, for the node i at the inlet [m]."""
    dx = x[1] - x[0]
    k = np.arange(len(x), dtype=float)

    def twice(s):  # integrated
        return np.where(s == 0.0, 0.0, 0.5 * s**2 * np.log(np.abs(np.where(s == 0.0, 1.0, s))) - 0.75 * s**2)

    return dx * (twice(k + 1) - 2.0 * twice(k) + twice(k - 1) + np.log(dx))


@pytest.mark.slow
def test_film_pressure_contacts_and_load(run):
    case, result, of = run
    dx, steps = spacing(result), result.steps
    np.testing.assert_array_equal(steps.h_min, result.film_thickness.min(axis=1))
    np.testing.assert_array_equal(steps.p_max, result.pressure.max(axis=1))
    np.testing.assert_array_equal(steps.contacts, result.in_contact.sum(axis=1))
    np.testing.assert_array_equal(result.contact_count, result.in_contact.sum(axis=0))
    load = dx * result.pressure.sum(axis=1)
    np.testing.assert_allclose(steps.load, load, rtol=1e-12)
    np.testing.assert_allclose(steps.load_error, np.abs(load / of.load - 1.0), rtol=0, atol=1e-12)
    assert steps.load_error.max() < 1e-9


def test_times_and_steps(run):
    _, result, _ = run
    np.testing.assert_array_equal(result.steps.time, result.time)
    np.testing.assert_allclose(result.steps.dt[1:], np.diff(result.time), rtol=1e-9)
    np.testing.assert_array_equal(result.steps.step, np.arange(len(result.time)))


def test_contact_flag_equals_film_at_its_bound(run):
    case, result, _ = run
    touching = result.in_contact.astype(bool)
    if "contact_pressure" in result:
        np.testing.assert_array_equal(touching, result.contact_pressure > 0.0)
        assert np.all(result.film_thickness[touching] == result.film_thickness.min())
    else:
        np.testing.assert_array_equal(touching, result.film_thickness == 0.0)


def test_oil_balance_of_every_step(run):
    case, result, of = run
    stored_error = result.steps.mass_error
    if case.fluid is None:
        assert (stored_error == 0.0).all()
        return
    lost = oil_lost(case, result, of)
    stored_error = stored_error[: len(lost)]
    assert len(lost) > 20
    some = lost > 1e-3
    assert some.any() == (result.in_contact.any() and case.contact.model == "direct")
    np.testing.assert_allclose(stored_error[some], lost[some], rtol=1e-3)
    # Newton's tolerance alone: both are nothing
    assert stored_error[~some].max() < 1e-3 and (~some).any()
    if not some.any():
        assert stored_error.max() < 2e-6


def test_friction_and_films(run):
    case, result, of = run
    dx, steps = spacing(result), result.steps
    friction = dx * result.shear_stress_2.sum(axis=1)
    np.testing.assert_allclose(steps.friction, friction, rtol=1e-9, atol=1e-9)
    other = dx * result.shear_stress_1.sum(axis=1)
    np.testing.assert_allclose(steps.friction_1, other, rtol=1e-9, atol=1e-9)
    coefficient = 0.5 * (friction - other) / steps.load
    np.testing.assert_allclose(steps.friction_coefficient, coefficient, rtol=1e-9, atol=1e-15)
    middle = np.abs(result.x) <= 0.5 * of.a * (1.0 + 1e-9)
    film = result.film_thickness[:, middle].mean(axis=1)
    np.testing.assert_allclose(steps.film_central, film, rtol=1e-6, atol=1e-12)
    heights = [result.profile(side) for side in ("1", "2")]
    if not any(heights):
        assert np.isnan(steps.lambda_ratio).all() and np.isnan(steps.mean_gap_ratio).all()


def test_figures_of_the_oil_and_of_thin_films(run):
    case, result, _ = run
    if case.fluid is None:
        assert "oil_pressure" not in result.scalars
        return
    touching, steps = result.in_contact.astype(bool), result.steps
    if case.contact.model == "mixed":
        oil = result.pressure - result.contact_pressure
    else:
        oil = np.where(touching, 0.0, result.pressure)
    np.testing.assert_allclose(steps.oil_pressure, oil.max(axis=1), rtol=1e-12)
    thin = ~touching & (result.film_thickness < 1e-9)
    np.testing.assert_array_equal(steps.nodes_below_1nm, thin.sum(axis=1))


def test_fractions_and_lengths_of_mixed_contact(run):
    case, result, _ = run
    if case.contact.model == "direct":
        assert "contact_share" not in result.scalars
        return
    dx, steps = spacing(result), result.steps
    solids, load = result.contact_pressure, dx * result.pressure.sum(axis=1)
    assert steps.contact_share.max() > 0.01
    np.testing.assert_allclose(steps.contact_share, dx * solids.sum(axis=1) / load, rtol=1e-9)
    np.testing.assert_allclose(steps.contact_length, dx * (solids > 0.0).sum(axis=1), rtol=1e-9)
    thin = result.film_thickness < 2.0 * 10e-9
    np.testing.assert_allclose(steps.thin_length, dx * thin.sum(axis=1), rtol=1e-9)
    np.testing.assert_allclose(steps.thin_share, dx * (result.pressure * thin).sum(axis=1) / load, rtol=1e-9)


def test_approach_follows_from_the_inlet_film(run):
    """h = h00 + x^2/2R + phi - (4/pi E') int p ln|x-s| ds, smooth at step 0."""
    case, result, of = run
    deflection = -4.0 / (np.pi * of.E) * (result.pressure @ logarithms(result.x))
    gap = result.film_thickness[:, 0] - result.x[0] ** 2 / (2.0 * of.R) - deflection
    # the solver's logarithms are of x/a and pressures of p0: a constant times the load
    gap -= 4.0 / (np.pi * of.E) * result.steps.load * np.log(of.a)
    few = slice(0, 1) if case.time else slice(None)
    np.testing.assert_allclose(-result.steps.approach[few], gap[few], rtol=0, atol=1e-6 * of.a**2 / of.R)


def test_excluded_nodes_are_flagged_and_their_oil_counted():
    """PETSc takes a film under its zero tolerance, here a wide one, for none where oil would leave."""
    file, changed = SCENES["direct"]
    case = ehlpetsc.load(CASES / file, changed)
    simulation = ehlpetsc.Simulation(case, options={"snes_vi_zero_tolerance": "1e-3", "snes_atol": "1e-7"})
    above, lost = 0, 0.0
    for state in simulation:
        left_out = state.in_contact & (state.dimensionless.w > 0.0)
        assert (state.film_thickness[state.in_contact] == 0.0).all()
        above += left_out.sum()
        residual = np.abs(state.dimensionless.reynolds_residual)
        assert residual[~state.in_contact].max() < 1e-6
        if left_out.any():
            lost = max(lost, residual[left_out].sum())
            assert state.mass_error > 0.1 * residual[left_out].sum()
    assert above > 10 and lost > 0.01
