"""One fault of a case, whatever its kind of contact and whatever else it gives, is one message about it."""

import copy
import re
import tomllib

import pytest
from support import CASES, one_fault
from support.maps import GEARS, LAYER, MAPS, POINT

from ehlpetsc.base.errors import CaseError
from ehlpetsc.case.loading import load


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
    """Tracebacks of maps, maps called profiles, values missing that follow from the faulty one."""
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


def test_a_file_that_no_contact_can_use_is_reported_beside_other_faults(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "map.txt").write_text("\n".join(["0 1 0 2 1 0"] * 6))
    faulty = tomllib.loads(POINT) | {
        "surface": {"1": {"file": "no.txt"}, "2": {"file": "map.txt", "spacing": 1e-5}}
    }
    with pytest.raises(CaseError) as refused:
        load(faulty, ["mesh.inlet=4"])
    heads = sorted(line.split(": ")[1].split(" = ")[0] for line in refused.value.faults)
    assert heads == ["mesh.inlet", "surface.1.file"]


@pytest.mark.parametrize(
    ("name", "message"),
    [("fank.csv", r"no such file: \S+; did you mean \S+flank\.csv\?"), ("", r"a folder: \S+")],
)
def test_a_surface_file_that_is_none_is_answered_by_a_close_one(tmp_path, name, message):
    (tmp_path / "flank.csv").write_text("0 1")
    fault = one_fault(load, CASES / "mixed.toml", {"surface": {"1": {"file": str(tmp_path / name)}}})
    assert re.search(f"{message}$", fault)


def test_bulk_temperature_of_losses_with_a_map_and_without_its_file(tmp_path, monkeypatch):
    """The roughness of maps of gears was taken for that of profiles: a traceback."""
    monkeypatch.chdir(tmp_path)
    assert load(tomllib.loads(GEARS)).heat.bulk_temperature[0] > 313.0
    fault = one_fault(load, tomllib.loads(GEARS), {"surface.1": {"file": "no.txt", "spacing": 1e-5}})
    assert re.search("surface.1.* no such file", fault)


def test_a_bound_by_another_key_is_not_checked_against_a_faulty_one():
    assert "cutoff" in one_fault(load, tomllib.loads(LAYER.replace("cutoff = 3e-5", "cutoff = -1")))
