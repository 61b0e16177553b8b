"""Temperature of the film at a node and its transport: equations, derivatives, order, bounds and balance."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.film_stress import film_stress

from ehlpetsc.case.loading import load
from ehlpetsc.discretisation import finite_volumes as volumes
from ehlpetsc.discretisation.reynolds import Reynolds
from ehlpetsc.discretisation.step_inputs import IsothermalOil, StepInputs
from ehlpetsc.discretisation.unknowns import Share
from ehlpetsc.effects.heat.film import FilmHeat
from ehlpetsc.effects.heat.film_law import T_MEAN, film_temperature
from ehlpetsc.effects.heat.film_oil import FilmLaw, film_law
from ehlpetsc.effects.heat.film_shear import wall_exchange
from ehlpetsc.effects.heat.transport import explicit_transport, heat_taken, transport
from ehlpetsc.physics.oil.laws import ln_viscosity, padded
from ehlpetsc.physics.oil.rheology import CARREAU, EYRING, NEWTON, FlowLaw
from ehlpetsc.physics.oil.viscosity_laws import EXPONENTIAL, ROELANDS
from ehlpetsc.physics.scales import Scales

CASE = Path(__file__).parents[2] / "cases" / "table1_smooth.toml"


def oil(*thermal):
    """Roelands' viscosity of pressure, temperature by two constants."""
    return 1, padded((4.0, 0.196e9, 0.6, *thermal, 363.0)), 363.0


VISCOSITY, FLOW = oil(EXPONENTIAL, 0.04, 0.0), tuple(FlowLaw(EYRING, 10e6))
LAW = FilmLaw(VISCOSITY, True, 0.02, FLOW, np.inf, 0.14, 0.0, 0.0)
SLIDING = 12.5
WALLS = (372.0, 368.0, 1.4e-8, 1.9e-8, 1.0)
A, B, G, SPREAD = 2e4, 2e4 * 365.0, 3e7, 2.0


MIDDLE, REFERENCE = 395.0, 375.0


def solved(p=0.8e9, h=3e-7, left=0.9, walls=WALLS, law=LAW, guess=370.0, sliding=SLIDING):
    return film_at((p, h, left, sliding), (A, B, G), (SPREAD, MIDDLE, REFERENCE), walls, law, guess)


def film_at(node, balance, last, walls, law, guess=370.0):
    return film_temperature((guess, 0.0), node, balance, last, walls, law)[0]


LAWS = {
    "eyring": LAW,
    "newtonian": LAW._replace(flow=tuple(FlowLaw(NEWTON))),
    "limited": LAW._replace(limit=0.06),
    "carreau": LAW._replace(flow=tuple(FlowLaw(CARREAU, 7e6, 0.45, 2.0)), limit=0.06),
    "eyring of p": LAW._replace(stress_pressure=0.6e-9, stress_temperature=0.003, limit=0.06),
    "limit of T": LAW._replace(limit=0.06, limit_temperature=-0.01),
    "conducting": LAW._replace(conductivity_pressure=1.7e-9, conductivity_saturation=0.5e-9),
    "roelands": LAW._replace(viscosity=oil(ROELANDS, 1.1, 0.0), is_linear=False),
}


@pytest.mark.parametrize("between", [1.0, 2.5])
@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_balance_and_fluxes(law, between):
    t, _, _, q1, q2, shear, *_ = solved(law=law, walls=(*WALLS[:4], between))
    walls = [w + r * q for w, r, q in zip(WALLS[:2], WALLS[2:4], (q1, q2), strict=True)]
    conductivity = 1.0 + law.conductivity_pressure * 0.8e9 / (1.0 + law.conductivity_saturation * 0.8e9)
    exchange = 2.0 * 0.14 * conductivity * 0.9 / (3e-7 * between) * (walls[0] - walls[1])
    assert q2 - q1 == pytest.approx(exchange, rel=1e-8)
    assert A * t - B == pytest.approx(shear + G - q1 - q2, abs=1e-9 * shear)


@pytest.mark.parametrize("t1, t2", [(385.0, 365.0), (365.0, 405.0)])
def test_unequal_walls_get_the_heat_of_the_closed_form(t1, t2):
    """The hotter wall more than by conduction, as the oil near it is the most fluid."""
    eta = 0.02 * np.exp(ln_viscosity(LAW.viscosity, 0.8e9, 0.5 * (t1 + t2))[0])
    film = film_stress(3e-7, eta, 0.04, t1, t2, 0.14, 12.5, FlowLaw(*LAW.flow))
    exchange = wall_exchange(float(film.y), 0.02 * (t1 - t2))
    walls = t1, t2, 0.0, 0.0, 1.0 / exchange
    balance, last = (1e-6, 1e-6 * 363.0, 0.0), (0.0, 375.0, 375.0)
    _, _, _, q1, q2, shear, *_ = film_at((0.8e9, 3e-7, 1.0, SLIDING), balance, last, walls, LAW)
    assert shear == pytest.approx(12.5 * film.stress, rel=1e-8)
    assert (q1, q2) == pytest.approx((float(film.q1), float(film.q2)), rel=1e-8)
    assert exchange < 0.9


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_shear_stress_of_a_film_without_transport(law):
    """That of the closed form between the walls, whose temperatures follow from the fluxes."""
    a, walls = 1e-6, (372.0, 372.0, 1.4e-8, 1.4e-8, 1.0)
    balance, last = (a, a * 363.0, 0.0), (SPREAD, MIDDLE, REFERENCE)
    t, _, _, q1, q2, shear, *_ = film_at((0.8e9, 3e-7, 1.0, SLIDING), balance, last, walls, law)
    wall = 372.0 + 1.4e-8 * q1
    ln_eta, middle = (ln_viscosity(law.viscosity, 0.8e9, t)[0] for t in (REFERENCE, MIDDLE))
    slope = (middle - ln_eta) / (MIDDLE - REFERENCE)
    eta = ln_eta + slope * (wall - REFERENCE)
    rise = law.conductivity_pressure * 0.8e9 / (1.0 + law.conductivity_saturation * 0.8e9)
    grown = (1.0 + law.stress_pressure * 0.8e9) * (1.0 + law.stress_temperature * (REFERENCE - 363.0))
    flow = FlowLaw(law.flow[0], law.flow[1] * grown, *law.flow[2:])
    state = 3e-7, 0.02 * np.exp(eta - SPREAD), -slope, wall, wall
    limit = law.limit * (1.0 + law.limit_temperature * (REFERENCE - 363.0)) * 0.8e9
    film = film_stress(*state, 0.14 * (1.0 + rise), 12.5, flow, limit)
    assert shear == pytest.approx(12.5 * film.stress, rel=1e-8)
    assert t - wall == pytest.approx(film.mean, rel=1e-8)
    assert q1 == pytest.approx(0.5 * shear, rel=1e-8) and q2 == pytest.approx(q1)


@pytest.mark.parametrize(
    "walls, accuracy",
    [((370.0, 370.0, 1.4e-8, 1.4e-8, 1.0), 1e-4), (WALLS, 5e-3), ((*WALLS[:4], 2.5), 1e-2)],
    ids=["equal", "unequal", "resisting"],
)
@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
@pytest.mark.parametrize("p, h", [(0.8e9, 3e-7), (0.05e9, 5e-6), (2.5e9, 2e-8)])
def test_derivatives(law, p, h, walls, accuracy):
    """At a constant difference of the walls, which hardly changes."""
    _, by_p, by_h, *_ = solved(p, h, law=law, walls=walls)
    step = 1e-5
    low, high = (solved(p * factor, h, law=law, walls=walls)[0] for factor in (1 - step, 1 + step))
    numeric_p = (high - low) / (2 * step * p)
    low, high = (solved(p, h * factor, law=law, walls=walls)[0] for factor in (1 - step, 1 + step))
    numeric_h = (high - low) / (2 * step * h)
    assert by_p == pytest.approx(numeric_p, rel=accuracy, abs=1e-8 * accuracy)
    assert by_h == pytest.approx(numeric_h, rel=accuracy)


OIL = {"colder than both": -5.0, "colder than the mean": 5.0, "near the mean": 30.0}  # K over surface 1


@pytest.mark.parametrize("over", OIL.values(), ids=OIL)
def test_a_film_does_not_cool_the_colder_surface_unless_it_is_colder_still(over):
    """Between surfaces far apart in temperature a parabola takes heat from the colder one into warmer oil."""
    a, walls, h = 1e9, (363.0, 423.0, 1.4e-8, 1.9e-8, 1.0), 1e-6

    def found(h):
        balance = a, a * (363.0 + over), 0.0
        return film_at((1e6, h, 1.0, 0.0), balance, (0.0, 363.0, 363.0), walls, LAW)

    t, _, by_h, q1, q2, *_ = found(h)
    t1, t2 = walls[0] + walls[2] * q1, walls[1] + walls[3] * q2
    assert a * (t - 363.0 - over) == pytest.approx(-q1 - q2, rel=1e-9)
    assert q1 + q2 == pytest.approx(12.0 * 0.14 / h * (t - 0.5 * (t1 + t2)), rel=1e-9)
    if over < 0.0:
        assert q1 == pytest.approx(6.0 * 0.14 / h * (t - t1), rel=1e-9)
        assert t < t1
    else:
        assert q1 >= 0.0 and t1 >= 363.0
        assert (q1 == 0.0) == (over < 20.0)
    step = 1e-5
    numeric = (found(h * (1 + step))[0] - found(h * (1 - step))[0]) / (2 * step * h)
    assert by_h == pytest.approx(numeric, rel=1e-4)


def test_exchange_is_continuous_and_surfaces_in_contact_have_one_temperature():
    a, walls = 1e9, (363.0, 423.0, 1.4e-8, 1.9e-8, 1.0)
    law, inlet = LAW, np.linspace(343.0, 443.0, 2001)
    node, last = (1e6, 1e-6, 1.0, 0.0), (0.0, 363.0, 363.0)
    fluxes = [film_at(node, (a, a * float(t), 0.0), last, walls, law)[3:5] for t in inlet]
    steps = np.diff(np.array(fluxes), axis=0)
    assert (steps > -1e-3).all()
    assert steps.max() < 12.0 * 0.14 / 1e-6 * 0.05
    t, _, _, q1, q2, shear, *_ = solved(h=0.0, left=1.0)
    walls = [w + r * q for w, r, q in zip(WALLS[:2], WALLS[2:4], (q1, q2), strict=True)]
    assert walls[0] == pytest.approx(walls[1], abs=1e-9)
    assert t == pytest.approx(walls[0], abs=1e-9)
    assert shear == 0.0
    law = LAW._replace(thinnest=1e-9)
    thin, thinner, closed = (solved(h=h, law=law) for h in (1e-9, 1e-12, 0.0))
    assert thinner[0] == pytest.approx(closed[0], abs=1e-3)
    assert closed[5] == pytest.approx(thin[5], rel=0.01)
    assert solved(h=0.0)[5] == 0.0


@pytest.mark.parametrize("sliding", [1e-17, 1e-9, 12.5])
def test_stress_of_a_film_at_rest_but_for_rounding(sliding):
    """The heat of shear is then rounding of the balance, which exceeds the heat itself."""
    law = LAWS["newtonian"]
    node, balance, last = (0.8e9, 3e-7, 0.9, sliding), (A, B, G), (SPREAD, MIDDLE, REFERENCE)
    film, oil = film_temperature((370.0, 0.0), node, balance, last, WALLS, law)
    rate = np.sinh(film.profile) / film.profile if film.profile > 1e-6 else 1.0
    ln_eta = oil.ln_eta - oil.beta * (film.base - REFERENCE)
    viscous = law.eta0 * np.exp(ln_eta - SPREAD) * sliding / 3e-7
    assert film.stress == pytest.approx(viscous / rate, rel=1e-6)


@pytest.mark.parametrize("guess", [150.0, 363.0, 5000.0])
def test_the_temperature_does_not_depend_on_the_guess(guess):
    for law in LAWS.values():
        assert solved(law=law, guess=guess)[0] == pytest.approx(solved(law=law)[0], abs=2e-5)


def state(n):
    """State of the film to start from."""
    return np.array([np.full(n, 370.0), np.zeros(n), np.full(n, 370.0)])


@pytest.mark.parametrize("ends", [(0, None), (20, 60)])
def test_derivatives_of_reynolds_rows(ends):
    mesh = ["mesh.points_per_half_width=32", "mesh.inlet=-1.5", "mesh.outlet=1.3"]
    case = load(CASE, [*mesh, "heat.bulk_temperature=363.0"])
    scales = Scales.of(case)
    n, rng = scales.nx, np.random.default_rng(5)
    q, h = 0.6 * rng.uniform(0.2, 1.0, n), 5e-4 * rng.uniform(0.3, 3.0, n)
    q[3 * n // 4 :] = rng.uniform(-0.8, -0.1, n - 3 * n // 4)
    first, last = ends[0], ends[1] or n
    reynolds = Reynolds(scales, 5e-4, Share(first, last, slice(0, n), slice(first, last)))
    arrays = [1e4 * rng.uniform(0.0, 2.0, n), 1e4 * 363.0 * rng.uniform(0.0, 2.0, n)]
    arrays += [1e7 * rng.uniform(0.0, 1.0, n), rng.uniform(0.0, 3.0, n)]
    arrays += [363.0 + 20.0 * rng.uniform(0.0, 1.0, n) for _ in range(2)]
    arrays += [1e-8 * rng.uniform(0.5, 1.0, n)] * 2 + [np.ones(n)]
    arrays[4] = arrays[5]  # derivatives are at a constant difference of the walls
    arrays += [np.full(n, 375.0)] * 2 + [np.full(n, abs(scales.conditions.sliding))]
    law = film_law(case.fluid, case.heat)
    oil = IsothermalOil(case.fluid, scales)
    heat = FilmHeat(oil, law, np.array(arrays), state(n), None, np.zeros(n))
    inputs = StepInputs(np.zeros(n), None, oil, None, scales.conditions)
    thermal = replace(inputs, oil=heat)
    values = reynolds.evaluate(q, h, thermal)[1]
    assert np.abs(values - reynolds.evaluate(q, h, inputs)[1]).max() > 1.0
    for side, vector in enumerate((q, h)):
        for node in range(max(first - 2, 0), min(last + 1, n)):
            changed, step = [], 1e-6 * abs(vector[node])
            for sign in (1, -1):
                kept, vector[node] = vector[node], vector[node] + sign * step
                changed.append(reynolds.evaluate(q, h, thermal)[0])
                vector[node] = kept
            numeric = (changed[0] - changed[1]) / (2.0 * step)
            for row in range(last - first):
                place = node - (first + row) + 2
                exact = values[row, 2 * place + side] if 0 <= place < 4 else 0.0
                scale = np.abs(values[row]).max()
                assert numeric[row] == pytest.approx(exact, abs=2e-5 * scale)


def test_neighbours_flow_at_the_mean_of_their_temperatures():
    """A hot node of higher pressure must not be the more fluid one: its outflow fell as its pressure rose."""
    heat = ["heat.bulk_temperature=363.0", "heat.viscosity_temperature=0.04"]
    case = load(CASE, ["mesh.points_per_half_width=16", *heat])
    scales = Scales.of(case)
    n, whole = scales.nx, slice(0, scales.nx)
    reynolds = Reynolds(scales, 5e-4, Share(0, n, whole, whole))
    q, h, b = np.full(n, 0.5), np.full(n, 5e-4), np.full(n, 363e6)
    q[20], b[20] = 1.0, 563e6
    zero, response = np.zeros(n), np.full(n, 1e-8)
    t = b / 1e6
    of_nodes = (np.full(n, 1e6), b, zero, zero, t, t, response, response, zero + 1, t, t, zero)
    oil, law = IsothermalOil(case.fluid, scales), film_law(case.fluid, case.heat)
    heat = FilmHeat(oil, law, np.array(of_nodes), state(n), None, zero)
    solved = heat.begin()
    cold, hot = (reynolds.properties(q, h, one) for one in (oil, solved))
    found = solved.guess
    assert found[T_MEAN, 20] == pytest.approx(563.0) and heat.guess[T_MEAN, 20] == 370.0
    factor = np.exp(0.04 * 0.5 * (found[T_MEAN, 19] + found[T_MEAN, 20] - 2.0 * 363.0))
    found = np.array(volumes.fluidities(hot, np.uint64(19), np.uint64(20)))
    np.testing.assert_allclose(found, factor * cold[volumes.FLUIDITY, 19:21], rtol=1e-9)
    own = hot[volumes.THINNING, 19:21] ** 2 * hot[volumes.FLUIDITY, 19:21]
    assert own[1] > own[0] and found[1] < found[0]


def test_nodes_in_rows_have_the_properties_of_each_row_alone():
    """Flat fields, x fastest; the nodes beyond the outlet, one of each row, come last."""
    case = load(CASE, ["mesh.points_per_half_width=16", "heat.bulk_temperature=363.0"])
    scales, (rows, n), rng = Scales.of(case), (3, 7), np.random.default_rng(2)
    q, h = rng.uniform(-0.2, 0.8, rows * n), 5e-4 * rng.uniform(0.5, 2.0, rows * n)
    constants = [
        1e6,
        363e6,
        0.0,
        0.0,
        363.0,
        363.0,
        1e-8,
        1e-8,
        1.0,
        363.0,
        363.0,
        abs(scales.conditions.sliding),
    ]
    of_nodes = np.outer(constants, np.ones(rows * n))
    of_nodes[1] *= rng.uniform(1.0, 1.1, rows * n)
    oil = IsothermalOil(case.fluid, scales)
    law = film_law(case.fluid, case.heat)
    for one in (oil, FilmHeat(oil, law, of_nodes, state(rows * n), None, np.zeros(rows * n))):
        whole = np.empty((one.rows, rows * (n + 1)))
        one.fill(q, h, slice(0, rows * n), whole)
        for row in range(rows):
            nodes, alone = slice(row * n, (row + 1) * n), np.empty((one.rows, n + 1))
            one.fill(q[nodes], h[nodes], nodes, alone)
            np.testing.assert_array_equal(whole[:, nodes], alone[:, :-1])
            np.testing.assert_array_equal(whole[:, rows * n + row], alone[:, -1])


INLET, CAPACITY, LENGTH, TRAVEL = 363.0, 1e5, 1.0, 0.4
THIN, NEWTONIAN = (0, padded((0.0, 1.0, 1.0)), 300.0), tuple(FlowLaw(NEWTON))
STILL = FilmLaw(THIN, True, 1.0, NEWTONIAN, np.inf, 0.14, 0.0, 0.0)


def carried(profile, nodes, way=1.0, moving=False):
    """Rise over INLET at the begin and the end, and the largest imbalance, of oil moved by TRAVEL.

    At the begin the oil starts from rest, or it is moving already.
    """
    courant = 0.5
    dx = LENGTH / nodes
    x = dx * (np.arange(nodes) + 0.5)
    dt, steps = courant * dx, round(TRAVEL / (courant * dx))
    full, zero = np.ones(nodes), np.zeros(nodes)
    stored, flow = CAPACITY / dt * full, way * CAPACITY / dx * np.ones(nodes + 1)
    along = x if way > 0.0 else LENGTH - x
    begin = profile(along)
    change, t, worst = begin - profile(along + dx * courant) if moving else zero, INLET + begin, 0.0
    kept = 0.5 * stored * change
    for _ in range(steps):
        film = np.array((zero, 1e-6 * full, full, t, stored, change, kept))
        a, b = explicit_transport(1, stored, flow, t, INLET)
        walls = [INLET * full] * 2 + [1e12 * full] * 2
        of_nodes = np.array((a, b, zero, zero, *walls, full, INLET * full, INLET * full, zero))
        _, _, new = state = np.array((b / a, zero, b / a))
        q1, q2, _, beyond, _ = out = np.empty((5, nodes))
        assert transport(state, film, flow, (INLET, INLET), tuple(STILL), of_nodes, out) == 1
        taken = heat_taken(t, stored, kept, flow, INLET, new, beyond)
        worst = max(worst, abs(taken + q1.sum() + q2.sum()))
        change, t, kept = new - t, new, beyond
    return begin, t - INLET, worst / (CAPACITY / dt * begin.sum())


def hump(x):
    return 50.0 * np.exp(-(((x - 0.3) / 0.08) ** 2))


def block(x):
    return 50.0 * (np.abs(x - 0.3) < 0.05)


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_smooth_hump_is_carried_with_second_order(way):
    errors = []
    for nodes in (100, 200, 400):
        x = (np.arange(nodes) + 0.5) / nodes
        end = carried(hump, nodes, way, moving=True)[1]
        exact = hump((x if way > 0.0 else LENGTH - x) - TRAVEL)
        errors.append(np.sqrt(np.mean((end - exact) ** 2)))
    assert np.log2(errors[1] / errors[2]) > 1.7
    assert errors[2] < 0.5


def test_a_block_has_no_new_extremes_and_loses_no_heat():
    begin, end, imbalance = carried(block, 200)
    assert end.min() >= 0.0
    assert end.max() <= 50.0 * 1.01
    assert imbalance < 1e-12
    assert end[-1] < 1e-3  # nothing has left
    assert end.sum() == pytest.approx(begin.sum(), rel=1e-3)
    there, back = carried(block, 100)[1], carried(block, 100, way=-1.0)[1]
    np.testing.assert_allclose(back[::-1], there, atol=1e-9)
