"""A state into a restart file and back, with the case as it was and with other settings."""

from pathlib import Path

import numpy as np
import pytest

from ehlpetsc.case.loading import load
from ehlpetsc.discretisation.contact_model import contact_model
from ehlpetsc.errors import OutputError
from ehlpetsc.physics.film_formulas import expected_film
from ehlpetsc.physics.scales import Scales
from ehlpetsc.run import checkpoint
from ehlpetsc.stepping.predictor import Level
from ehlpetsc.stepping.time_stepping import State

CASE = Path(__file__).parents[2] / "cases" / "table1_rough.toml"
MESH = ["mesh.points_per_half_width=20"]
TOTALS = {"newton": 17, "h_min": 1e-9, "contacts": 3}


class Scene:
    def __init__(self, *overrides):
        self.case = load(CASE, [*MESH, *overrides])
        self.scales = Scales.of(self.case)
        self.model = contact_model(self.case, self.scales, expected_film(self.case, self.scales))

    def save(self, path, state, smooth):
        count = np.arange(self.scales.nx)
        checkpoint.save(path, state, smooth, count, TOTALS, self.case, self.scales, self.model)

    def load(self, path):
        return checkpoint.load(path, self.case, self.scales, self.model)

    def physical(self, q, w):
        """Oil pressure and contact pressure [Pa], void, film [m]."""
        s = self.scales
        film, solids = self.model.relations(q, w).film, self.model.contact_pressure(w)
        return np.maximum(q, 0.0) * s.p0, solids * s.p0, np.maximum(-q, 0.0), film * s.h


def state_of(scene, mixed=False):
    """A state with oil, cavity and contact, two earlier levels, and the smooth solution."""
    rng, n = np.random.default_rng(1), scene.scales.nx

    def unknowns():
        q, w = rng.uniform(0.1, 1.5, n), 1e-3 * rng.uniform(0.1, 1.0, n)
        q[-9:] = -rng.uniform(0.1, 0.9, 9)
        w[[20, 41]] = [-1e-4, -3e-4] if mixed else 0.0
        return q, w

    earlier = tuple(Level(time, *unknowns()) for time in (2e-6, 1e-6))
    m, m_older = rng.uniform(0.0, 1e-3, (2, n))
    more = dict(time=3e-6, dt=1e-6, step=3, retries=1, earlier=earlier)
    return State(*unknowns(), -0.4, m=m, m_older=m_older, **more), unknowns()


@pytest.mark.parametrize("model", ["direct", "mixed"])
def test_the_same_case_gets_back_what_was_saved(tmp_path, model):
    scene = Scene(f"contact.model='{model}'")
    state, smooth = state_of(scene, model == "mixed")
    scene.save(tmp_path / "f.restart.h5", state, smooth)
    found, found_smooth, count, totals, notes = scene.load(tmp_path / "f.restart.h5")
    assert notes == [] and totals == TOTALS
    np.testing.assert_array_equal(count, np.arange(scene.scales.nx))
    for name in ("q", "w", "m", "m_older"):
        np.testing.assert_allclose(getattr(found, name), getattr(state, name), rtol=1e-14, atol=1e-18)
    for name in ("h00", "time", "dt", "step", "retries"):
        assert getattr(found, name) == getattr(state, name), name
    for one, other in zip((*found.earlier, (0, *found_smooth)), (*state.earlier, (0, *smooth)), strict=True):
        assert one[0] == other[0]
        np.testing.assert_allclose(one[1:], other[1:], rtol=1e-14, atol=1e-18)


def test_under_another_load_pressures_films_and_voids_stay_what_they_were(tmp_path):
    """Twice the load at half the radius: the nodes stay, but p0 and the unit of films double."""
    scene = Scene()
    state, smooth = state_of(scene)
    scene.save(tmp_path / "f.restart.h5", state, smooth)
    other = Scene("contact.load=1054e3", "contact.radius=0.00955")
    assert other.scales.a == pytest.approx(scene.scales.a, rel=1e-12)
    assert other.scales.p0 == pytest.approx(2.0 * scene.scales.p0, rel=1e-12)
    found, found_smooth, _, _, notes = other.load(tmp_path / "f.restart.h5")
    pairs = [((found.q, found.w), (state.q, state.w)), (found_smooth, smooth)]
    pairs += [(one[1:], before[1:]) for one, before in zip(found.earlier, state.earlier, strict=True)]
    for one, before in pairs:
        for value, expected in zip(other.physical(*one), scene.physical(*before), strict=True):
            np.testing.assert_allclose(value, expected, rtol=1e-12)
    unit = scene.scales.h / other.scales.h
    np.testing.assert_allclose(found.m, unit * state.m, rtol=1e-12)
    np.testing.assert_allclose(found.m_older, unit * state.m_older, rtol=1e-12)
    assert found.h00 == pytest.approx(unit * state.h00, rel=1e-12)
    assert (found.time, found.dt) == (state.time, state.dt)
    assert notes == ["contact.radius was 0.0191, is 0.00955", "contact.load was 527000.0, is 1054000.0"]


def test_a_run_may_go_on_with_solids_that_carry_and_back(tmp_path):
    direct, mixed = Scene(), Scene("contact.model='mixed'", "contact.boundary_film=20e-9")
    state, smooth = state_of(mixed, mixed=True)
    mixed.save(tmp_path / "m.restart.h5", state, smooth)
    found, *_, notes = direct.load(tmp_path / "m.restart.h5")
    assert "contact.model was mixed, is left out" in notes
    np.testing.assert_allclose(direct.physical(found.q, found.w)[3], mixed.physical(state.q, state.w)[3])
    state, smooth = state_of(direct)
    direct.save(tmp_path / "d.restart.h5", state, smooth)
    found, *_, notes = mixed.load(tmp_path / "d.restart.h5")
    film = mixed.physical(found.q, found.w)[3]
    np.testing.assert_allclose(film, np.maximum(direct.physical(state.q, state.w)[3], 20e-9), rtol=1e-12)
    assert "contact.boundary_film was left out, is 2e-08" in notes


def test_every_other_key_may_change_and_is_told_but_what_is_no_physics(tmp_path):
    scene = Scene()
    scene.save(tmp_path / "f.restart.h5", *state_of(scene))
    changed = ("fluid.viscosity=0.004", "time.courant=0.25", "title='x'", "output.every=7")
    *_, notes = Scene(*changed).load(tmp_path / "f.restart.h5")
    assert notes == ["fluid.viscosity was 0.002, is 0.004", "time.courant was 0.5, is 0.25"]


@pytest.mark.parametrize(
    "change, message",
    [
        (["mesh.points_per_half_width=21"], "nodes, the case"),
        (["contact.load=400e3"], "its nodes lie from"),
        (["mesh.inlet=-2.45", "mesh.outlet=1.55"], "its nodes lie from"),
    ],
)
def test_another_mesh_is_refused(tmp_path, change, message):
    scene = Scene()
    scene.save(tmp_path / "f.restart.h5", *state_of(scene))
    with pytest.raises(OutputError, match=message):
        Scene(*change).load(tmp_path / "f.restart.h5")
