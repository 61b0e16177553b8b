"""Values with a unit, at the case's door only."""

import subprocess
import sys
import tomllib

import pytest
from support import CASES

from ehlpetsc.case import units
from ehlpetsc.case.loading import load, members
from ehlpetsc.errors import CaseError

SMOOTH = CASES / "table1_smooth.toml"


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("350 N/mm", "N/m", 350e3),
        ("12 mm", "m", 0.012),
        ("5um", "m", 5e-6),
        ("5 µm", "m", 5e-6),
        ("15 mPa s", "Pa s", 0.015),
        ("15 mPa*s", "Pa s", 0.015),
        ("15 cP", "Pa s", 0.015),
        ("18 1/GPa", "1/Pa", 18e-9),
        ("18 GPa^-1", "1/Pa", 18e-9),
        ("206 GPa", "Pa", 206e9),
        ("90 degC", "K", 363.15),
        ("1e-12 mm2/N", "m2/N", 1e-18),
        (["206 GPa", 207e9], "Pa", [206e9, 207e9]),
        (12.0, "m", 12.0),
        ("direct", "m", "direct"),
    ],
)
def test_values_are_converted_exactly(text, unit, value):
    assert units.converted(text, unit) == value


def test_case_with_units_equals_the_case_in_si(tmp_path):
    overrides = {
        "contact.radius": "19.1 mm",
        "contact.load": "527 N/mm",
        "contact.youngs_modulus": "207 GPa",
        "fluid.viscosity": "5 mPa s",
        "fluid.pressure_viscosity": "11.1 1/GPa",
        "motion.entrainment_speed": "5 m/s",
        "surface.1.synthetic": {"kind": "ridge", "amplitude": "0.2 um", "wavelength": "0.1 mm"},
        "time.travel": 4.0,
    }
    plain = {
        "contact.radius": 0.0191,
        "contact.load": 527e3,
        "fluid.viscosity": 0.005,
        "surface.1.synthetic": {"kind": "ridge", "amplitude": 2e-7, "wavelength": 1e-4},
        "time.travel": 4.0,
    }
    one, other = load(SMOOTH, overrides), load(SMOOTH, plain)
    assert one.dict() == other.dict()
    table = tomllib.loads(one.text)  # what results hold and their readers take
    assert table["contact"]["load"] == 527e3 and table["surface"]["1"]["synthetic"]["amplitude"] == 2e-7
    path = tmp_path / "c.toml"
    path.write_text(SMOOTH.read_text().replace("load = 527e3 ", 'load = "527 N/mm" ', 1))
    case = load(path)
    assert case.contact.load == 527e3
    assert "# N/m" in case.text  # comments are kept


def test_series_accepts_units():
    series = {"series.key": "fluid.viscosity", "series.values": ["5 mPa s", "10 mPa s"]}
    assert [value for value, _ in members(load(SMOOTH, series))] == [0.005, 0.01]
    both = {
        "series.keys": ["contact.load", "motion.slide_roll_ratio"],
        "series.values": [["300 N/mm", "400 N/mm"], [0.1]],
    }
    assert [value for value, _ in members(load(SMOOTH, both))] == [(300e3, 0.1), (400e3, 0.1)]


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("contact.load", "350 N", 'contact.load = "350 N": not a unit'),
        ("contact.radius", "12 mmm", 'contact.radius = "12 mmm": unknown'),
        ("contact.radius", "twelve", 'contact.radius = "twelve": allowed: '),
        ("motion.slide_roll_ratio", "25 %", 'motion.slide_roll_ratio = "25 %": '),
        ("surface.1.synthetic", {"kind": ["sine"], "amplitude": "1 um"}, '"ground" | "sine"'),
        ("series", {"keys": 5, "values": ["1 mm"]}, "series.keys = 5"),
        ("contact.load", "-1 N/mm", "contact.load = -1000.0: "),
    ],
)
def test_wrong_unit_is_refused_in_one_line(key, value, words):
    with pytest.raises(CaseError) as refused:
        load(SMOOTH, {key: value})
    (line,) = refused.value.faults
    assert words in line


def test_unit_without_pint_names_the_package(monkeypatch):
    units._registry.cache_clear()
    monkeypatch.setitem(sys.modules, "pint", None)
    with pytest.raises(CaseError, match=r"contact\.radius = .*pint"):
        load(SMOOTH, {"contact.radius": "12 mm"})
    units._registry.cache_clear()


def test_case_without_units_does_not_import_pint():
    code = f"import sys, ehlpetsc; ehlpetsc.load({str(SMOOTH)!r}); assert 'pint' not in sys.modules"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
