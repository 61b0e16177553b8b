"""Values with a unit: every unit of the keys with what data sheets write for it."""

import math
import re
import tomllib

import pytest
from support import CASES, one_fault

from ehlpetsc.base.units import UnitFault, converted
from ehlpetsc.case import keys
from ehlpetsc.case.loading import load, members

SMOOTH = CASES / "table1_smooth.toml"
PLAUSIBLE = {
    "m": {"12 mm": 0.012, "5um": 5e-6, "5 \u00b5m": 5e-6, "5 \u03bcm": 5e-6, "3 nm": 3e-9, "1.2 cm": 0.012}
    | {"1 in": 0.0254},
    "N": {"20 N": 20.0, "2.4 kN": 2400.0, "1 lbf": 4.4482216152605},
    "N/m": dict.fromkeys(("350 N/mm", "0.35 kN/mm", "350 kN/m"), 350e3)
    | {"2 lbf/in": 2 * 4.4482216152605 / 0.0254},
    "Pa": {"206 GPa": 206e9, "3 N/mm^2": 3e6, "3 N/mm2": 3e6, "10 bar": 1e6, "1 MPa": 1e6}
    | {"1 psi": 6894.757293},
    "1/Pa": {"18 1/GPa": 18e-9, "15 /GPa": 15e-9, "18 GPa^-1": 18e-9, "18 GPa-1": 18e-9, "1 mm^2/N": 1e-6},
    "Pa s": {"15 mPa s": 0.015, "15 mPa*s": 0.015, "15 mPas": 0.015, "15 cP": 0.015, "0.15 P": 0.015},
    "m^2/s": {"46 cSt": 46e-6, "46 mm^2/s": 46e-6, "46 mm\u00b2/s": 46e-6, "0.46 St": 46e-6},
    "kg/m^3": {"0.88 g/cm^3": 880.0, "0.88 kg/l": 880.0, "880 kg/m3": 880.0},
    "K": {"90 degC": 363.15, "90 C": 363.15, "90 \u00b0C": 363.15, "194 degF": 363.15, "300 K": 300.0},
    "Pa/K": {"0.5 MPa/K": 5e5, "500 kPa/degC": 5e5},
    "1/K": {"0.04/K": 0.04, "0.04 1/K": 0.04, "4 %/K": 0.04, "0.04 /degC": 0.04},
    "m/s": {"500 mm/s": 0.5, "36 m/min": 0.6},
    "1/min": {text: 2250.0 for text in ("2250 rpm", "37.5 rps", "37.5 Hz", "2250 1/min", "2250 /min")}
    | {"37.5 turn/s": 2250.0, "37.5 rev/s": 2250.0, "13500 deg/s": 2250.0, "10 rad/s": 300.0 / math.pi},
    "rad/s": {"300 rpm": 10.0 * math.pi, "20 rad/s": 20.0, "360 deg/s": 2.0 * math.pi},
    "rad": {"0.5 mrad": 5e-4, "0.1 deg": math.pi / 1800.0},
    "degrees": {"20 deg": 20.0, "20\u00b0": 20.0, "0.5 rad": 90.0 / math.pi},
    "N m": {"302 Nm": 302.0, "302 N m": 302.0, "302e3 N mm": 302.0, "0.302 kNm": 302.0, "302e3 Nmm": 302.0},
    "m^2/N": {"1e-9 mm^3/Nm": 1e-18, "1e-9 mm^3/(N m)": 1e-18, "1e-12 mm2/N": 1e-18, "1 1/Pa": 1.0},
    "W/(m^2 K)": {"500 W/(m^2 K)": 500.0, "0.5 kW/m^2/K": 500.0},
    "W/(m K)": {"46 W/(m K)": 46.0, "46 W/m/K": 46.0, "0.046 kW/(m K)": 46.0},
    "J/(kg K)": {"470 J/(kg K)": 470.0, "0.47 J/(g K)": 470.0, "0.47 kJ/(kg degC)": 470.0},
    "s": {"0.1 ms": 1e-4, "100 us": 1e-4, "2 min": 120.0},
    "minutes": {"2 min": 2.0, "30 s": 0.5, "1 h": 60.0},
    "": {"20 %": 0.2},
}
WITHOUT = {"half-widths", "boundary films"}  # numbers only


@pytest.mark.parametrize("unit", PLAUSIBLE)
def test_every_unit_of_the_keys_is_converted(unit):
    for text, value in PLAUSIBLE[unit].items():
        assert converted(text, unit) == pytest.approx(value, rel=1e-9, abs=0.0), text
    assert converted(12.0, unit) == 12.0 and converted("direct", unit) == "direct"


def test_every_unit_of_a_key_is_in_the_table_without_rounding_error():
    tables = keys.tables().values()
    used = {key.unit for table in tables for key in table.keys.values() if key.kind is float}
    assert used == set(PLAUSIBLE) | WITHOUT
    assert (converted("5 um", "m"), converted("90 degC", "K")) == (5e-6, 363.15)
    assert converted(["206 GPa", 207e9], "Pa") == [206e9, 207e9]


def test_case_series_and_gears_with_units_equal_those_in_si(tmp_path):
    ridge = {"kind": "ridge", "amplitude": "0.2 um", "wavelength": "0.1 mm"}
    given = {"contact.radius": "19.1 mm", "contact.load": "500 N/mm", "fluid.viscosity": "6 mPa s"}
    plain = {"contact.radius": 0.0191, "contact.load": 500e3, "fluid.viscosity": 0.006}
    given |= {"contact.youngs_modulus": "206 GPa", "motion.entrainment_speed": "4 m/s", "time.travel": 4.0}
    plain |= {"contact.youngs_modulus": 206e9, "motion.entrainment_speed": 4.0, "time.travel": 4.0}
    one = load(SMOOTH, given | {"surface.1.synthetic": ridge})
    other = load(SMOOTH, plain | {"surface.1.synthetic": ridge | {"amplitude": 2e-7, "wavelength": 1e-4}})
    assert one.as_dict() == other.as_dict()
    table = tomllib.loads(one.text)  # what results hold and their readers take
    assert table["contact"]["load"] == 500e3 and table["surface"]["1"]["synthetic"]["amplitude"] == 2e-7
    path = tmp_path / "c.toml"
    path.write_text(SMOOTH.read_text().replace("load = 527e3 ", 'load = "527 N/mm" ', 1))
    assert load(path).contact.load == 527e3
    fzg = CASES / "fzg.toml"
    speeds = [load(fzg, {"gears.speed": text}).conditions.u1[0] for text in ("2250 rpm", "2250 1/min")]
    assert speeds == [load(fzg, {"gears.speed": 2250}).conditions.u1[0]] * 2
    series = {"series.key": "fluid.viscosity", "series.values": ["5 mPa s", "10 mPa s"]}
    assert [value for value, _ in members(load(SMOOTH, series))] == [0.005, 0.01]
    keys = ["contact.load", "motion.slide_roll_ratio"]
    both = {"series.keys": keys, "series.values": [["300 N/mm", "400 N/mm"], [0.1]]}
    assert [value for value, _ in members(load(SMOOTH, both))] == [(300e3, 0.1), (400e3, 0.1)]


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("contact.load", "350 N", 'contact.load = "350 N": not a unit'),
        ("contact.radius", "12 mmm", 'contact.radius = "12 mmm": unknown'),
        ("motion.slide_roll_ratio", "25 mm", 'motion.slide_roll_ratio = "25 mm": not a unit'),
        ("surface.1.synthetic", {"kind": ["sine"], "amplitude": "1 um"}, '"ground" | "sine"'),
        ("contact.load", "-1 N/mm", "contact.load = -1000.0: "),
        ("contact.radius", "10,5 mm", '"10,5 mm": a comma in a number; allowed: digits .* as "10.5 mm"$'),
        ("contact.load", "1.000,5 N/mm", 'as "1000.5 N/mm"$'),
        ("motion.entrainment_speed", "3,0", 'as "3.0"$'),
        ("motion.entrainment_speed", "3.0", '"3.0": a number in quotation marks; allowed: 3.0$'),
        ("motion.entrainment_speed", ".5", '".5": a number in quotation marks; allowed: 0.5$'),
        ("motion.entrainment_speed", "2.", '"2.": a number in quotation marks; allowed: 2.0$'),
        ("contact.load", "350 kn/mm", "unknown unit; .* or with a unit, a product of such as N, kN, "),
        ("fluid.viscosity", "15 cSt", '"15 cSt": kinematic, .* density, at 870 kg/m.3 "13.05 mPa s"$'),
        ("fluid.viscosity", "0.2 St", '"0.2 St": kinematic, .* "17.4 mPa s"$'),
    ],
)
def test_wrong_unit_is_refused_in_one_line(key, value, words):
    line = one_fault(load, SMOOTH, {key: value})
    assert words in line or re.search(words, line)


def test_dynamic_viscosity_is_refused_where_a_kinematic_one_belongs():
    with pytest.raises(UnitFault, match='^"87 mPa s": dynamic, .* over the density, .* "100 cSt"$'):
        converted("87 mPa s", "m^2/s")


def test_a_rough_strip_whose_speed_has_no_number_is_refused_in_a_sentence():
    """Its map, which depends on the width of the contact, is then not computed."""
    strip = CASES / "micropitting.toml"
    text = one_fault(load, strip, {"motion.entrainment_speed": ".71"})
    assert text.endswith('".71": a number in quotation marks; allowed: 0.71')
