"""The case file: values read from it, and messages about its faults, one for each."""

import copy
import math
import pickle
import re
import tomllib

import numpy as np
import pytest
from support import CASES, is_line_with, one_fault
from support.maps import GEARS, LAYER, MAPS, POINT

from ehlpetsc.base.case import KINDS, kind_of
from ehlpetsc.base.declarations import Key, KeyTable, Required
from ehlpetsc.base.errors import CaseError
from ehlpetsc.base.quantities import DEFAULT_FIELDS
from ehlpetsc.base.toml_file import toml_text, with_key
from ehlpetsc.case import loading as case
from ehlpetsc.case.checking import values_of
from ehlpetsc.case.loading import load
from ehlpetsc.case.stages import checked, derived, resolved
from ehlpetsc.physics.oil.laws import viscosity

SMOOTH, ROUGH = CASES / "table1_smooth.toml", CASES / "table1_rough.toml"


def faults(path, *overrides):
    with pytest.raises(CaseError) as caught:
        case.load(path, overrides)
    assert all(len(line) < 1000 and "\n" not in line for line in caught.value.faults)
    return caught.value.faults


def fault(path, *overrides):
    (found,) = faults(path, *overrides)
    return found


@pytest.fixture
def write(tmp_path):
    """A case file made of the smooth one by replacing text."""

    def make(old="", new="", base=SMOOTH):
        text = base.read_text()
        assert old in text
        path = tmp_path / "my.toml"
        path.write_text(text.replace(old, new, 1))
        return path

    return make


def test_values_are_read_as_written_or_overridden_and_left_out_ones_are_none_or_default():
    c = case.load(ROUGH)
    assert c.contact.youngs_modulus == (207e9, 207e9)
    assert (c.fluid.lambda_, c.fluid.eyring_stress) == (1.68e-9, 10e6)
    assert c.surface.body_1.scale == 0.5
    assert (c.time.travel, c.time.courant) == (6.0, 1.0)
    c = case.load(SMOOTH)
    assert (c.time, c.series, c.surface.body_1, c.surface.body_2) == (None,) * 4
    assert (c.mesh.near_field, c.output.every, c.output.precision) == (3, 1, "float64")
    assert c.output.fields == DEFAULT_FIELDS
    dry = case.load(CASES / "dry_hertz.toml")
    assert (dry.fluid, dry.motion) == (None, None)
    assert (dry.contact.boundary_friction, dry.contact.minimum_film) == (0.1, 0.0)
    contact = case.load(SMOOTH, {"contact.youngs_modulus": 206e9, "contact.poisson_ratio": 0.29}).contact
    assert contact.youngs_modulus == (206e9, 206e9) and contact.poisson_ratio == (0.29, 0.29)
    fluid = case.load(SMOOTH, {"fluid.gamma": None, "fluid.lambda": None}).fluid
    assert (fluid.gamma, fluid.lambda_) == (2.3e-9, 1.7e-9)
    given = ["fluid.viscosity=0.003", "output.fields=['pressure']", "time.travel = 2", "title=Mine"]
    c = case.load(ROUGH, given)
    assert (c.fluid.viscosity, c.output.fields, c.time.travel, c.title) == (0.003, ["pressure"], 2, "Mine")
    assert tomllib.loads(c.text)["output"]["fields"] == ["pressure"]
    assert case.load(ROUGH).text == ROUGH.read_text()
    options = {"ksp_rtol": 1e-8, "snes_vi_monitor": True, "ksp_view": False, "pc_type": "lu"}
    c = case.load(SMOOTH, {"petsc": options})
    assert c.petsc == {"ksp_rtol": "1e-08", "snes_vi_monitor": "", "pc_type": "lu"}


WITH_ALL = {  # what stages resolve: units, a profile by points, losses of gears, a measured layer, a series
    "roller": ("roller", {"contact.profile": {"y": ["0 mm", "6 mm"], "z": ["0 um", "5 um"]}}),
    "losses": ("fzg", {"heat.bulk_temperature": "losses", "heat.inlet_temperature": 363.15}),
    "series": ("table1_smooth", {"series": {"keys": ["contact.load"], "values": [["300 N/mm", 2e5]]}}),
    "layer": ("compliant_mixed", {"contact.asperity_height": "measured"}),
}


@pytest.mark.parametrize("name", WITH_ALL)
def test_no_stage_of_a_case_changes_the_tables_it_is_given(name):
    file, changes = WITH_ALL[name]
    tables = tomllib.loads((CASES / f"{file}.toml").read_text())
    for key, value in changes.items():
        tables = with_key(tables, key.split("."), value)
    kind, before = kind_of(tables), copy.deepcopy(tables)
    in_units, _ = resolved(CASES, tables, kind)
    assert tables == before
    between = copy.deepcopy(in_units)
    following = derived(CASES, in_units, kind, (), False)
    stored, *_ = checked(CASES, in_units, kind)
    assert in_units == between
    if name == "losses":
        assert following.tables != in_units and stored["heat"]["bulk_temperature"][0] > 363.15
    else:
        assert in_units != before


def test_series_members_differ_in_the_series_key_only_and_all_are_checked():
    c = case.load(CASES / "fig4.toml")
    members = case.members(c)
    assert [value for value, _ in members] == c.series.values
    for value, member in members:
        assert member.fluid.viscosity == value
        assert member.series is None
        assert "series" not in tomllib.loads(member.text)
        assert member.motion == c.motion and member.surface == c.surface and member.path == c.path
    found = faults(SMOOTH, "series.key='fluid.viscosity'", "series.values=[0.01, -1, 0.02, nan]")
    assert len(found) == 2
    assert "fluid.viscosity = -1" in found[0] and "fluid.viscosity = nan" in found[1]
    assert "fluid.visc" in fault(SMOOTH, "series.key='fluid.visc'", "series.values=[1]")
    for key in ("title", "fluid", "petsc"):
        message = f'series.key = "{key}": allowed: a key of a table, as "fluid.viscosity"'
        assert fault(SMOOTH, f"series.key='{key}'", "series.values=[1]").endswith(message)


def test_an_empty_table_leaves_out_one_that_must_have_keys():
    whole = case.load(ROUGH, ["wear.coefficient=1e-17", "contact.model=mixed"])
    assert whole.time and whole.wear and whole.surface.body_1
    kept = case.load(ROUGH, ["time={}", "surface.1={}", "fluid.grade={}", "output={}", "life={}"])
    assert kept.time is None and kept.surface.body_1 is None and kept.surface.body_2
    assert kept.life and kept.output.every == 1  # which need no keys
    assert case.load(ROUGH, {"fluid": {}, "motion": {}, "time": {}}).fluid is None
    assert "contact is missing" in fault(SMOOTH, "contact={}")


def test_an_override_without_a_value_leaves_out_a_key_or_table():
    left_out = [
        "fluid.eyring_stress=",
        "contact.boundary_friction = ",
        "time=",
        "heat.bulk_temperature=",
        "life=",
    ]
    c = case.load(ROUGH, ["life={}", "contact.boundary_friction=0.2", *left_out])
    assert (c.fluid.eyring_stress, c.contact.boundary_friction) == (None, 0.1)
    assert (c.time, c.heat, c.life) == (None, None, None)
    assert case.load(SMOOTH, {"heat.bulk_temperature": None}).heat is None  # of a table that is not there
    instead = ["contact.material=16MnCr5", "contact.youngs_modulus=", "contact.poisson_ratio="]
    assert case.load(SMOOTH, instead).contact.youngs_modulus == (206e9, 206e9)
    assert "title is missing" in fault(SMOOTH, "title=")
    assert 'fluid.eyring = "": unknown key' in fault(SMOOTH, "fluid.eyring=")
    assert case.load(SMOOTH, ["petsc.snes_monitor="]).petsc == {"snes_monitor": ""}


def test_all_faults_of_a_case_and_needs_that_are_not_met_are_reported():
    given = "contact.radius=-1 fluid.viscosity=nan mesh.inlett=4 surface.1.file='nowhere.csv'".split()
    given += "surface.2.file='missing.csv' motion.entrainment_speed=0 nonsense".split()
    found = faults(ROUGH, *given)
    for word in given:
        key = f"{word.partition('=')[0]}{' =' if '=' in word else ':'}"
        assert sum(key in line for line in found) == 1
    assert len(found) == 7
    bound = fault(CASES / "running_in.toml", "contact.minimum_film=1e-9")
    assert "contact.minimum_film = 1e-09: " in bound and 'contact.model = "direct"' in bound
    assert fault(SMOOTH, "wear.coefficient=1e-18").endswith('wear: needs contact.model = "mixed" and [time]')
    mixed = ("contact.model='mixed'", "contact.boundary_film=1e-8", "contact.asperity_height=2e-8")
    assert "contact.boundary_film = 1e-08: needs contact.asperity_height left out (" in fault(SMOOTH, *mixed)
    steel = {"contact.material": "16MnCr6", "contact.youngs_modulus": None, "contact.poisson_ratio": None}
    assert 'contact.material = "16MnCr6": allowed: one of "16MnCr5"' in fault(SMOOTH, *steel.items())


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("contact.radius=-0.02", [f"{ROUGH}: contact.radius = -0.02: ", ">= 1e-09 and <= 100 [m]"]),
        ("contact.radius=inf", ["contact.radius = Infinity: ", ">= 1e-09 and <= 100 [m]"]),
        ("contact.youngs_modulus=[207e9]", ["youngs_modulus = [207000000000.0]", "<= 1e+18 [Pa]"]),
        ("contact.poisson_ratio=[0.3, 0.6]", ["contact.poisson_ratio = [0.3, 0.6]: ", "<= 0.5"]),
        ("fluid.law='sead'", ['fluid.law = "sead": ', '"barus", "roelands"']),
        ("fluid.reference_viscosity=0.01", ["reference_viscosity", "viscosity"]),
        ("fluid.lambda=3e-9", ["fluid.lambda = 3e-09: ", "gamma"]),
        ("mesh.points_per_half_width=200.5", ["mesh.points_per_half_width = 200.5: ", ">= 4"]),
        ("mesh.points_per_half_width=90000", ["mesh.points_per_half_width = 90000: ", " 200000 nodes"]),
        ("mesh.inlet=-0.5", ["mesh.inlet = -0.5: ", "< -1 "]),
        ("output.fields=['presure']", ['output.fields = ["presure"]: ', '"pressure"']),
        ("petsc.-snes_monitor=''", ["petsc = ", '"-snes_monitor"', "dash"]),
        ("time=5", ["time = 5: ", "table"]),
        ("surface.1.synthetic={kind='ridge', amplitude=1e-7, wavelength=1e-4}", ["surface.1: ", "file or "]),
        ("surface.1.cutoff=0.05", ["surface.1.file", "cutoff = 0.05 m", "0.001712 m"]),
        ("post.b=0.09", ["post.b = 0.09: ", "< 0"]),
        ("contact.yield_pressure=3e9", ['needs contact.model = "mixed"']),
        ("contact.radius={a=1}", ["contact.radius: a table here; allowed: a number"]),
        ("fluid.limiting_shear_stress=1e7", ['did you mean "limiting_shear"?']),
    ],
)
def test_every_kind_of_fault_is_reported(override, words):
    line = fault(ROUGH, override)
    for word in words:
        assert word in line


@pytest.mark.parametrize("key", ["radius", "viscosity", "outlet"])
def test_missing_key_is_named(write, key):
    line = fault(write(f"\n{key} = ", "\n# "))
    assert f".{key} " in line and "missing" in line and " <= " in line


def test_missing_tables_and_keys_of_another_kind_are_named(write, tmp_path):
    path = tmp_path / "empty.toml"
    path.write_text("")
    found = faults(path)
    assert [line.split(": ")[1].split()[0] for line in found] == ["title", "contact", "mesh"]
    line = fault(write("[motion]\nentrainment_speed = 5.0          # m/s, mean\nslide_roll_ratio = 0.25\n"))
    assert line.split(": ")[1].startswith("motion ") and "missing" in line
    layer = {name: table for name, table in tomllib.loads(POINT).items() if name not in ("motion", "wear")}
    layer |= {"contact": layer["contact"] | {"asperity_height": 1e-8}}
    assert "motion is missing" in one_fault(load, layer)
    wave = "surface.2.synthetic={kind='sine', amplitude=1e-7, ra=1e-7}"
    named = [line.partition(": surface.2.synthetic.")[2].split()[0] for line in faults(SMOOTH, wave)]
    assert named == ["wavelength", "ra"]
    assert 'surface.2.synthetic.kind = "squar": allowed: one of "ground", "sine", "square", ' in (
        found := fault(SMOOTH, "surface.2.synthetic={kind='squar'}")
    )
    assert found.endswith('; did you mean "square"?')
    mixed = "surface.2={synthetic={kind='sine', amplitude=1e-7, wavelength=1e-4}, level=true}"
    assert is_line_with(fault(SMOOTH, mixed), "surface.2: level: ", "file", "synthetic")


def test_invalid_toml_and_names_of_two_lines_are_refused_and_a_byte_order_mark_ignored(tmp_path, write):
    path = tmp_path / "bad.toml"
    path.write_text("title = 'x'\n[contact\n")
    assert is_line_with(fault(path), f"{path}: ", "TOML", "line 2")
    path = tmp_path / "a\nb.toml"
    path.write_text(SMOOTH.read_text())
    assert is_line_with(fault(path), r"a\nb.toml", "without line breaks; rename the file")
    path = write()
    path.write_text("\ufeff" + SMOOTH.read_text())
    assert case.load(path).text == SMOOTH.read_text()


@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-le", "utf-16-be"])
def test_utf_16_is_named(tmp_path, encoding):
    path = tmp_path / "case.toml"
    path.write_bytes(SMOOTH.read_text().encode(encoding))
    assert is_line_with(fault(path), f"{path}: UTF-16 text; allowed: UTF-8")


@pytest.mark.parametrize(
    ("line", "hint"),
    [
        ("a = 0,0191", '; "0,0191" is written 0.0191'),
        ("a = -12,5  # x", '; "-12,5" is written -12.5'),
        ("a = [0,0191, 0,02]", '; "0,0191" is written 0.0191'),
        ("a = [16,24", ""),
        ("a = 1.5 # 2,5\nb = ", "; 'b =': a value is missing"),
        ("law = roelands  # Pa", "; 'law = roelands': text needs quotation marks"),
        ("a = 1\na = 2.5", "; 'a = 2.5': the table has this key already"),
    ],
)
def test_the_cause_of_a_fault_of_toml_is_named(tmp_path, line, hint):
    path = tmp_path / "case.toml"
    path.write_text(f"title = 'x'\n{line}\n")
    assert fault(path).endswith(f"){hint}")


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (None, "file: "),
        ("0,0\n1e-6,0\n2e-6,0\n", ": 3 points; "),
        ("0,0\n1e-6,nan\n2e-6,0\n3e-6,0\n", ": 3 heights are not missing; "),
    ],
)
def test_bad_profile_is_a_fault_of_the_case(write, tmp_path, content, words):
    if content is not None:
        (tmp_path / "p.csv").write_text(content)
    path = write("[mesh]", "[surface.1]\nfile = 'p.csv'\n[mesh]")
    line = fault(path)
    assert line.startswith(f'{path}: surface.1.file = "p.csv": ') and words in line


def test_values_can_be_sent_to_other_ranks_and_tables_declared_elsewhere_are_checked():
    sent = case.load(ROUGH, {"time.courant": 1})
    received = pickle.loads(pickle.dumps(sent))
    assert received == sent and (received.text, received.path) == (sent.text, sent.path)
    assert type(received.time.courant) is float and received.time != sent.mesh
    thickness = Required("of both surfaces", "m", 1e-9, 1e-4, many="both")
    keys, shared = {"thickness": thickness, "share": Key("of 1", "", 0, 1)}, "left out: none"
    coating = KeyTable("coating", shared, keys, complete=lambda values: {"share": values.share or 0.5})
    assert values_of(coating, {"thickness": 1e-6}).as_dict() == {"thickness": (1e-6, 1e-6), "share": 0.5}
    with pytest.raises(CaseError, match=r"coating\.thickness = 1e-10: allowed: .*\[m\] \(of both surfaces\)"):
        values_of(coating, {"thickness": 1e-10})


OIL = {"fluid.law": "roelands", "fluid.reference_viscosity": None, "fluid.roelands_pressure": None}


def test_omitted_roelands_constants_follow_from_the_pressure_coefficient():
    """z = alpha pr/(ln eta0 + 9.67), and the slope of ln eta at ambient pressure is alpha."""
    fluid = case.load(SMOOTH, OIL | {"fluid.viscosity": 0.015, "fluid.pressure_viscosity": 18e-9}).fluid
    assert fluid.roelands_pressure == 1.96e8
    assert fluid.roelands_z == pytest.approx(18e-9 * 1.96e8 / (math.log(0.015) + 9.67), rel=1e-4)
    small = 1e3  # Pa
    (exponent,) = viscosity(np.array([small]), fluid)[0]
    assert exponent == pytest.approx(18e-9 * small, rel=1e-5)
    other = fault(SMOOTH, *OIL.items(), ("fluid.viscosity", 65e-6))
    assert "by viscosity and pressure_viscosity it is" in other


@pytest.mark.parametrize("sign", ["\\u0000", "\\u0007", "\\n", "\\u007f"])
def test_control_characters_in_a_title_are_refused(write, sign):
    assert "title = " in fault(write('title = "', f'title = "{sign}'))


@pytest.mark.parametrize("path", sorted(CASES.glob("*.toml")), ids=lambda path: path.stem)
def test_every_case_has_a_description_and_is_the_same_written_and_stored(path):
    tables, head = tomllib.loads(path.read_text()), path.read_text().splitlines()[:2]
    assert tables["title"] and all(line.startswith("# ") for line in head)
    own = "ball cam coated fzg groove mixed roller tapered life micropitting wear traction cmod discs optical"
    is_own = path.stem.partition("_")[0] in (*own.split(), "superfinished")
    assert is_own or "Holmes" in head[1] and "2005" in head[1]
    tables["petsc"] = {'a "b"': "tab\t, \\, \u00e9", "": [[1, 2.5e-17], [True]], "c": {"d": {"e": -0.0}}}
    assert tomllib.loads(toml_text(tables)) == tables
    load = {"contact.load": "25 N" if KINDS[kind_of(tables)].is_whole else "400 N/mm"}
    load = {"gears.torque": "200 N m"} if "gears" in tables else load
    sets = load | {"petsc.snes_atol": 1e-9, "output.every": 3, "title": 'a "b" \u00b5'}
    wave = {"kind": "sine", "amplitude": 2e-7, "wavelength": 1e-4}
    is_smooth = "surface.2" in str(tables.get("series")) or "groove_radius" in tables["contact"]
    changed = case.load(path, sets if is_smooth else sets | {"surface.2": {"synthetic": wave}})
    stored = case.stored_case(changed.text)
    if changed.operation and changed.operation.file:  # its columns are stored
        for one, other in zip(stored.conditions, changed.conditions, strict=True):
            np.testing.assert_array_equal(one, other)
        stored, changed = (of.copy({"operation": None}) for of in (stored, changed))
    assert stored == changed


@pytest.mark.parametrize(
    "name, message",
    [
        ("mine.tml", r"No such file or directory; did you mean \S+mine\.toml\?"),
        ("other/x.toml", "No such file or directory"),
        ("", ": a folder; allowed: a TOML file of a case"),
    ],
)
def test_mistyped_name_of_a_case_is_answered_by_a_close_one(name, message, tmp_path):
    (tmp_path / "mine.toml").touch()
    with pytest.raises(CaseError, match=rf"{message}$"):
        case.load(tmp_path / name)


def places(tables, above=()):
    """Paths of all tables and keys."""
    for name, value in tables.items():
        yield (*above, name)
        if isinstance(value, dict):
            yield from places(value, (*above, name))


def wrong_value(table, name):
    table[name] = "no such value"


def misspelt(table, name):
    table[name + name[-1]] = table.pop(name)


@pytest.mark.parametrize("fault", [wrong_value, misspelt])
@pytest.mark.parametrize("base", MAPS)
def test_any_fault_of_a_key_is_one_message(base, fault):
    tables = tomllib.loads(MAPS[base])
    assert load(copy.deepcopy(tables)).surface.body_1.z is not None
    for *above, name in places(tables):
        if name == "title" and fault is wrong_value or name in ("1", "z"):
            continue
        faulty = copy.deepcopy(tables)
        table = faulty
        for key in above:
            table = table[key]
        fault(table, name)
        assert ".".join((*above, name)) in one_fault(load, faulty)


def test_faults_of_files_and_bounds_are_reported_beside_others_or_alone(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "map.txt").write_text("\n".join(["0 1 0 2 1 0"] * 6))
    surfaces = {"1": {"file": "no.txt"}, "2": {"file": "map.txt", "spacing": 1e-5}}
    faulty = tomllib.loads(POINT) | {"surface": surfaces}
    with pytest.raises(CaseError) as refused:
        load(faulty, ["mesh.inlet=4"])
    heads = sorted(line.split(": ")[1].split(" = ")[0] for line in refused.value.faults)
    assert heads == ["mesh.inlet", "surface.1.file"]
    monkeypatch.chdir(tmp_path)
    assert load(tomllib.loads(GEARS)).heat.bulk_temperature[0] > 313.0
    fault = one_fault(load, tomllib.loads(GEARS), {"surface.1": {"file": "no.txt", "spacing": 1e-5}})
    assert re.search("surface.1.* no such file", fault)
    assert "cutoff" in one_fault(load, tomllib.loads(LAYER.replace("cutoff = 3e-5", "cutoff = -1")))


@pytest.mark.parametrize(
    ("name", "message"),
    [("fank.csv", r"no such file: \S+; did you mean \S+flank\.csv\?"), ("", r"a folder: \S+")],
)
def test_a_surface_file_that_is_none_is_answered_by_a_close_one(tmp_path, name, message):
    (tmp_path / "flank.csv").write_text("0 1")
    fault = one_fault(load, CASES / "resolved_mixed.toml", {"surface": {"1": {"file": str(tmp_path / name)}}})
    assert re.search(f"{message}$", fault)
