"""A state into a restart file and back, with the case as it was and with other settings."""

import re
import tomllib
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from support import CASES

from ehlpetsc.base.errors import OutputError
from ehlpetsc.case.loading import load
from ehlpetsc.discretisation.unknowns import Unknowns
from ehlpetsc.effects.depths import PlasticRecord, WearRecord
from ehlpetsc.effects.effect import flat
from ehlpetsc.physics import operation_of
from ehlpetsc.physics.scales import Scales
from ehlpetsc.results.output_guard import inputs_of
from ehlpetsc.run import checkpoint
from ehlpetsc.run.forecast.domain import cures
from ehlpetsc.stepping.state import State, TimeLevel
from ehlpetsc.surfaces.motion.body_field import BodyField, BodyFields

CASE = CASES / "table1_rough.toml"
MESH = ["mesh.points_per_half_width=20"]
NO_DEPTH = BodyFields.zero(1e-6)
DEPTHS = BodyFields(BodyField(1e-6, 3, np.arange(4.0)), BodyField(1e-6, -2, np.ones(5)))
TOTALS = {"newton": 17, "h_min": 1e-9, "contacts": 3}


class Scene:
    def __init__(self, *overrides):
        self.case = load(CASE, [*MESH, *overrides])
        self.scales = Scales.of(self.case)

    def save(self, path, state, smooth):
        stepper = SimpleNamespace(baseline=smooth)
        of = dict(case=self.case, scales=self.scales, stepper=stepper, dimensionless=state, pass_number=1)
        checkpoint.save(path, SimpleNamespace(**of), np.arange(self.scales.nx) % 4, TOTALS)

    def load(self, path):
        return checkpoint.load(path, self.case, self.scales)


def state_of(scene, mixed=False):
    """A state with oil, cavity and contact, two earlier levels, and the smooth solution."""
    rng, n = np.random.default_rng(1), scene.scales.nx

    def unknowns():
        q, w = rng.uniform(0.1, 1.5, n), 1e-3 * rng.uniform(0.1, 1.0, n)
        q[-9:] = -rng.uniform(0.1, 0.9, 9)
        w[[20, 41]] = [-1e-4, -3e-4] if mixed else 0.0
        return q, w

    earlier = tuple(TimeLevel(time, *unknowns(), time) for time in (2e-6, 1e-6))
    m, m_older = rng.uniform(0.0, 1e-3, (2, n))
    more = dict(time=3e-6, dt=1e-6, step=3, retries=1, earlier=earlier, travelled=(2e-5, 1e-5))
    return State(Unknowns(*unknowns(), np.array([-0.4])), m=m, m_older=m_older, **more), unknowns()


@pytest.mark.parametrize("model", ["direct", "mixed"])
def test_restart_file_round_trip(tmp_path, model):
    scene = Scene(f"contact.model='{model}'")
    state, smooth = state_of(scene, model == "mixed")
    scene.save(tmp_path / "f.restart.h5", state, smooth)
    loaded, notes = scene.load(tmp_path / "f.restart.h5")
    found, found_smooth = loaded.state, loaded.baseline
    assert notes == [] and loaded.totals == TOTALS
    np.testing.assert_array_equal(loaded.contact_count, np.arange(scene.scales.nx) % 4)
    for name in ("q", "w", "m", "m_older"):
        np.testing.assert_allclose(getattr(found, name), getattr(state, name), rtol=1e-14, atol=1e-18)
    assert found.unknowns.border == state.unknowns.border
    for name in ("time", "dt", "step", "retries", "travelled"):
        assert getattr(found, name) == getattr(state, name), name
    for one, other in zip((*found.earlier, (0, *found_smooth)), (*state.earlier, (0, *smooth)), strict=True):
        assert one[0] == other[0] and one[3:] == other[3:]
        np.testing.assert_allclose(one[1:3], other[1:3], rtol=1e-14, atol=1e-18)


def test_changed_physical_keys_are_listed(tmp_path):
    scene = Scene()
    scene.save(tmp_path / "f.restart.h5", *state_of(scene))
    changed = ("fluid.viscosity=0.004", "time.courant=0.25", "title='x'", "output.every=7")
    _, notes = Scene(*changed).load(tmp_path / "f.restart.h5")
    assert notes == ["fluid.viscosity was 0.002, is 0.004", "time.courant was left out, is 0.25"]


@pytest.mark.parametrize("table, key", [("operation", "file"), ("gears", "load_file")])
def test_a_changed_column_of_conditions_is_reported_with_its_file(tmp_path, table, key):
    text, columns = (CASES / "fzg.toml").read_text(), "path [mm],load\n-9,2e5\n{},5.{}e5\n9,2e5\n"
    if table == "operation":
        text, columns = (CASES / "table1_smooth.toml").read_text(), "time,load\n0,5e5\n{},5.{}e5\n"
    (tmp_path / "case.toml").write_text(text)
    cases = []
    for last in (2, 3):
        (tmp_path / "loads.csv").write_text(columns.format(1, last))
        cases.append(load(tmp_path / "case.toml", {f"{table}.{key}": "loads.csv"}))
    (change,) = checkpoint.changed_keys(*(tomllib.loads(case.text) for case in cases), cases[1])
    assert re.fullmatch(rf"{table}\.\w+ of loads.csv was \[.*\], is \[.*\]", change), change
    assert tmp_path / "loads.csv" in inputs_of(cases[1])  # so that no output replaces it


@pytest.mark.parametrize(
    "change, text",
    [
        (["mesh.points_per_half_width=21"], "nodes, the case"),
        (["mesh.inlet=-2.4", "mesh.outlet=1.6"], "begins at -2.5 .* -2.4;"),
        (["contact.model='mixed'"], "another contact model"),
        (
            ["motion.entrainment_speed=4.0"],
            "speeds: motion.entrainment_speed was .*, is 4.0; motion",
        ),
        (["contact.load=1054e3"], r"another load, .*: contact.load was .*, is 1054000.0; .* \[operation\]"),
        (["time.start=rough"], r'time\.start was "smooth"'),
    ],
)
def test_state_of_another_contact_is_refused(tmp_path, change, text):
    scene = Scene()
    scene.save(tmp_path / "f.restart.h5", *state_of(scene))
    with pytest.raises(OutputError, match=text):
        Scene(*change).load(tmp_path / "f.restart.h5")


@pytest.mark.parametrize(
    "record", [PlasticRecord(DEPTHS, np.arange(81.0), NO_DEPTH), WearRecord(DEPTHS, NO_DEPTH)]
)
def test_records_of_effects_round_trip(tmp_path, record):
    scene, path = Scene("contact.model='mixed'"), tmp_path / "f.restart.h5"
    state, smooth = state_of(scene, mixed=True)
    name = "plastic_deformation" if isinstance(record, PlasticRecord) else "wear"
    scene.save(path, replace(state, records={name: record}), smooth)
    found = flat(scene.load(path)[0].state.records[name], name)
    assert found.keys() == flat(record, name).keys()
    for key, value in flat(record, name).items():
        np.testing.assert_array_equal(found[key], value)


def test_cure_of_a_layer_far_softer_than_the_hertz_pressure():
    layer = ["contact.model='mixed'", "contact.asperity_height=20e-9", "contact.asperity_stiffness="]
    for stiffness, is_soft in (("5e-4", True), ("0.03", False)):
        scene = Scene(*layer[:2], layer[2] + stiffness)
        conditions = operation_of(scene.case, scene.scales).at(0.0)
        advice = cures(scene.case, scene.scales, conditions, 0.1)
        assert ("contact.asperity_stiffness above 0.0005" in advice) == is_soft
