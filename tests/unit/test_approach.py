"""Point contacts at a given approach: dry load, mixed contact, restart, refusals."""

import copy
import re

import numpy as np
import pytest
from support import one_fault, self_affine
from support.points import R, point

import ehlpetsc
from ehlpetsc.case.loading import load
from ehlpetsc.physics.contact.hertz import hertz_ellipse, hertz_load
from ehlpetsc.run.forecast.explain import explain
from ehlpetsc.run.recorder import Recorder
from ehlpetsc.run.simulation import Simulation

APPROACH = 1.2e-6
DRY = {
    "title": "A ball pressed against a plane by a given approach",
    "contact": {"radius": [0.01, 0.02], "approach": APPROACH, "material": "16MnCr5"},
    "mesh": {"inlet": -1.25, "outlet": 1.25, "width": 2.5, "points_per_half_width": 32},
}
MIXED = {
    "contact": {"load": None, "approach": APPROACH, "boundary_film": 10e-9},
    "surface": {"1": {"synthetic": self_affine(40e-9, 40e-6, 20e-6)}},
    "motion": {"slide_roll_ratio": 0.3},
    "fluid": {"viscosity": 0.01},
    "time": {"travel": 0.15, "start": "rough", "courant": 1.0},
}


def mixed(changes=None):
    overrides = {f"{table}.{key}": value for table, keys in MIXED.items() for key, value in keys.items()}
    return load(point(50.0, 5.0, 8), overrides | (changes or {}))


def test_dry_load_grows_as_the_power_three_halves_of_the_approach():
    for approach in (0.4e-6, APPROACH, 4e-6):
        simulation = Simulation(load(DRY, {"contact.approach": approach}))
        state, modulus = simulation.advance(), simulation.scales.E
        of_hertz = hertz_ellipse(1.0, 0.01, 0.02, modulus).approach
        assert state.scalars["load"] == pytest.approx((approach / of_hertz) ** 1.5, rel=2e-4)
        assert state.scalars["approach"] == pytest.approx(-approach, rel=1e-9)
        assert state.load_error < 1e-9


def test_load_of_an_approach_inverts_hertz():
    for radii in ((0.01, 0.01), (0.01, 0.08), (0.03, 0.004)):
        approach = hertz_ellipse(25.0, *radii, 2.2e11).approach
        assert hertz_load(approach, *radii, 2.2e11) == pytest.approx(25.0, rel=1e-12)


def test_approach_that_balances_a_load_gives_this_load():
    """A thick film keeps the bodies further apart than in Hertz contact; on the same domain [m]."""
    balanced = Simulation(load(point(20.0, 10.0, 13)))
    state, given, mesh = balanced.advance(), balanced.scales.load, balanced.case.mesh
    approach = -state.scalars["approach"]
    ratio = np.sqrt(approach / hertz_ellipse(given, R, R, balanced.scales.E).approach)
    assert ratio < 0.8
    changes = {f"mesh.{key}": getattr(mesh, key) / ratio for key in ("inlet", "outlet", "width")}
    changes |= {"contact.load": None, "contact.approach": approach}
    again = Simulation(load(point(20.0, 10.0, round(13 * ratio), changes)))
    assert again.advance().scalars["load"] == pytest.approx(given, rel=5e-3)
    assert again.scales.load < 0.6 * given


@pytest.fixture(scope="module")
def states():
    return list(Simulation(mixed()))


def test_mixed_contact_keeps_its_approach_while_the_load_varies(states):
    loads = np.array([state.scalars["load"] for state in states])
    for state in states:
        assert state.scalars["approach"] == pytest.approx(-APPROACH, rel=1e-9)
        assert state.mass_error < 1e-6
    assert states[-1].scalars["contact_share"] > 0.02
    assert np.ptp(loads) > 1e-3 * loads.mean()


def test_restart_at_an_approach_continues_the_run(states, tmp_path):
    case, file, begun = mixed(), tmp_path / "run.h5", tmp_path / "run.restart.h5"
    simulation = Simulation(case)
    with Recorder(simulation, file) as recorder:
        for _ in range(2):
            recorder.write(simulation.advance())
        recorder.checkpoint()
    rest = ehlpetsc.solve(case, file, restart=begun)
    np.testing.assert_allclose(rest.steps.load, [state.scalars["load"] for state in states], rtol=1e-9)
    with pytest.raises(ehlpetsc.OutputError, match="contact.approach"):
        ehlpetsc.solve(mixed({"contact.approach": 1.3e-6}), tmp_path / "other.h5", restart=begun)


@pytest.mark.parametrize(
    "changes, message",
    [
        ({"contact.load": 20.0}, "approach = 1.2e-06: in place of the load, which contact.load would"),
        ({"contact.radius": 0.01}, "contact.approach = 1.2e-06: of point contacts, and one radius"),
        ({"operation": {"time": [0, 1], "speed_1": [1, 2], "speed_2": [1, 2]}}, r"which \[operation\] would"),
        ({"gears": {"speed": 1}}, r"which \[gears\] would give; leave out one of both"),
        ({"contact.approach": 0.0}, "contact.approach = 0.0: allowed: a number >= 1e-09"),
        ({"contact.approach": 1e-9}, "contact.load is missing, and does not follow from approach; allowed: "),
        ({"contact.approach": "2 N"}, 'contact.approach = "2 N"'),
        ({"contact.approach": None}, "contact.load is missing; allowed: .*, or approach"),
    ],
)
def test_refused_approaches_are_one_sentence(changes, message):
    assert re.search(message, fault := one_fault(load, copy.deepcopy(DRY), changes)), fault


def test_approach_has_units_varies_over_a_series_and_is_explained():
    assert load(DRY, {"contact.approach": "1.2 um"}).contact.approach == pytest.approx(APPROACH)
    varied = {"key": "contact.approach", "values": [1e-6, 4e-6]}
    series = load(DRY, {"series": varied, "contact.approach": 1e-6})
    one, other = (member.contact.load for _, member in ehlpetsc.members(series))
    assert other / one == pytest.approx(8.0)
    assert "approach 1.2 um, dry load" in explain(load(DRY))
