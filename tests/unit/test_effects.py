"""An effect with a scalar of state and a key is one file and one line; effects on oil and friction."""

import re
import shutil
from dataclasses import replace
from types import SimpleNamespace

import h5py
import numpy as np
import pytest
from support import CASES, is_line_with, one_fault, roelands_oil
from support.driving import Scene
from support.running import BARE, PYTHON, SCRIPT, called, command

from ehlpetsc.base.compiled import address_of
from ehlpetsc.base.declarations import Key
from ehlpetsc.base.errors import CaseError
from ehlpetsc.case.loading import load, stored_case
from ehlpetsc.case.tables import extend
from ehlpetsc.effects.effect import Effect
from ehlpetsc.effects.heat.effect import Heat

PAGE = CASES / "own_laws.md"


@pytest.fixture
def folder(tmp_path):
    """Folder with the code of the page and its case."""
    codes = re.findall(r"```python\n(.*?)```", PAGE.read_text(), re.DOTALL)
    names = ("my_oil", "my_density", "my_shear", "my_supply", "starve", "my_module")
    for name, text in zip(names, codes, strict=True):
        (tmp_path / f"{name}.py").write_text(text)
    shutil.copy(CASES / "table1_smooth.toml", tmp_path)
    return tmp_path


def call(folder, *words, **names):
    done = called([PYTHON, *words], folder, SCRIPT | names)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_law_and_effect_of_the_page_work_as_they_are(folder):
    """The supply falls by the loss of the key, the film with it; commands read the result by the variable."""
    line = call(folder, "starve.py").splitlines()[-1]
    assert line in PAGE.read_text()
    printed = line.rpartition("supply ")[2]
    supply, film = map(float, re.findall(r"\d\.\d+", printed))
    assert supply == pytest.approx(0.7**2, rel=0.05)  # the faster surface travels 1.125 as far
    assert film < 0.995
    words = "summary starved.h5", "plot starved.h5 --field oil", "keys starving"
    code = f"from ehlpetsc.__main__ import main\nfor line in {words}: assert main(line.split()) == 0"
    printed = call(folder, "-c", code, EHLPETSC_OWN="my_module")
    assert (
        "starved.h5," in printed and "\nstarved.oil.png\n" in printed and "loss: in a half-width" in printed
    )
    with h5py.File(folder / "starved.h5") as file:
        oil = file["film_thickness"][:] * (1.0 - file["void_fraction"][:])
        np.testing.assert_allclose(file["oil"][:], oil, rtol=1e-15)
        assert file["oil"].attrs["long_name"] == "oil in the film"


def test_built_in_names_are_refused(folder, monkeypatch):
    (folder / "bad.py").write_text("from my_oil import LAWS\nLAWS = {'barus': LAWS['saturating']}")
    done = called([PYTHON, "-m", "ehlpetsc", "keys", "fluid"], folder, SCRIPT | {"EHLPETSC_OWN": "bad"})
    assert done.returncode == 2
    assert done.stderr == '"barus": a viscosity law of this name is built in; allowed: another name\n'
    monkeypatch.syspath_prepend(folder)
    import my_oil
    import my_supply

    law, table = my_oil.LAWS["saturating"], replace(my_supply.Starving.table, name="contact")
    own = {
        '"incompressible": a density law': {"density_laws": {"incompressible": law}},
        '"eyring": a shear law': {"shear_laws": {"eyring": law}},
        r'"gamma": a key of \[fluid\]': {"laws": {"own": replace(law, keys={"gamma": Key("of mine")})}},
        '"wear": an effect': {"effects": [type("Own", (my_supply.Starving,), {"name": "wear"})]},
        '"contact": a table or key': {"effects": [type("Own", (my_supply.Starving,), {"table": table})]},
        '"h_min": a quantity': {
            "effects": [type("Own", (my_supply.Starving,), {"scalars": {"h_min": Key("of mine")}})]
        },
    }
    for replaced, given in own.items():
        with pytest.raises(CaseError, match=f"{replaced} of this name is built in"):
            extend(**given)


BALL = {
    "title": "ball",
    "contact": {"radius": [0.0125, 0.0125], "load": 20.0, "material": "100Cr6", "model": "mixed"},
    "fluid": roelands_oil(0.04, 20e-9),
    "motion": {"entrainment_speed": 0.5},
    "mesh": {"inlet": -1.8, "outlet": 1.4, "points_per_half_width": 10, "width": 3.0},
    "time": {"travel": 0.3},
}
FILMS = f"""
import ehlpetsc, my_density, my_oil, my_shear, my_supply, numpy
keys = {{"mesh.points_per_half_width": 20, "mesh.inlet": -2.0}}

def solved(law, **own):
    case = ehlpetsc.load("table1_smooth.toml", keys | law, **own)
    return case, ehlpetsc.solve(case)

def change(law, film, **own):
    return abs(solved(law, **own)[1].film_thickness / film - 1.0).max()

barus = solved({{"fluid.law": "barus"}})[1].film_thickness
print(change({{"fluid.law": "saturating", "fluid.saturation_pressure": 1e12}}, barus, laws=my_oil.LAWS))
keys |= {{"fluid.gamma": None, "fluid.lambda": None}}
rigid, bulk = solved({{"fluid.density": "incompressible"}})[1].film_thickness, {{"fluid.density": "bulk"}}
for law in (bulk | {{"fluid.bulk_modulus": 1e12}}, bulk):
    print(change(law, rigid, density_laws=my_density.DENSITY_LAWS))
keys |= {{"fluid.density": "incompressible", "fluid.eyring_stress": None, "motion.slide_roll_ratio": 0.5}}
newton, cross = solved({{}})[1].film_thickness, {{"fluid.cross_exponent": 0.9}}
print(change(cross | {{"fluid.cross_stress": 1e12}}, newton, shear_laws=my_shear.SHEAR_LAWS))
case, result = solved(cross | {{"fluid.cross_stress": 5e6}})
print(abs(result.film_thickness / newton - 1.0).max())
k = numpy.argmin(abs(result.x))
p, h = result.pressure[0, k], result.film_thickness[0, k]
eta = case.fluid.viscosity * numpy.exp(ehlpetsc.physics.oil.laws.viscosity(p, case.fluid)[0])
rate = eta * 0.5 * case.motion.entrainment_speed / h
mean = 0.5 * (result.shear_stress_1 - result.shear_stress_2)[0, k]
print(abs(mean) / (rate / (1.0 + (rate / 5e6) ** 0.9)))
case = ehlpetsc.load({BALL} | {{"starving": {{"loss": 0.5}}}}, effects=my_supply.EFFECTS)
*_, state = ehlpetsc.Simulation(case)
oil = (state.film_thickness * (1.0 - state.void_fraction))[:, 0]
print(state.supply / 0.15e-6, abs(oil / state.supply - 1.0).max())
try:
    ehlpetsc.load("table1_smooth.toml", {{"fluid.cross_stress": 5e6}})
except ehlpetsc.CaseError as error:
    print(error)
"""


def test_films_of_the_laws_and_of_the_effect_of_the_page(folder):
    """In a process of its own, as laws stay in the tables."""
    lines = call(folder, "-c", FILMS).splitlines()
    figures, fault = map(float, " ".join(lines[:7]).split()), lines[7]
    saturating, stiff, other, newton, thinning, stress, supply, difference = figures
    assert 0.0 < saturating < 0.01  # that of Barus
    assert stiff == pytest.approx(1e-3, rel=0.2)  # p0 over the bulk modulus
    assert other > 0.05  # by its default the law compresses the film
    assert newton < 1e-3 < 0.05 < thinning
    assert stress == pytest.approx(1.0, rel=1e-5)
    assert supply == pytest.approx(0.5**0.3, rel=1e-6) and difference < 1e-6  # of every row at the inlet
    assert "fluid.cross_stress = 5000000.0: needs fluid.eyring_stress left out" in fault


def test_effects_are_refused_where_they_do_not_serve_and_own_laws_are_named(monkeypatch):
    case = BALL | {"heat": {"bulk_temperature": 363.0}}
    load(case)
    monkeypatch.setattr(Heat, "contacts", ("line", "strip"))
    expected = "case: heat: of line and strip contacts, and this is a point; leave it out"
    assert one_fault(load, case) == expected
    load(BALL)
    text = (CASES / "table1_smooth.toml").read_text().replace('law = "roelands"', 'law = "own"')
    with pytest.raises(CaseError, match='law = "own": .*; if it is of your own, set EHLPETSC_OWN to the'):
        stored_case(text)


class Additive(Effect):
    """Oil twice as thick, and solids twice as rough to rub."""

    name = "additive"

    def inputs(self, record, inputs, step):
        oil = inputs.oil
        if oil:
            oil = replace(oil, fluid=oil.fluid.copy(update={"viscosity": 2.0 * oil.fluid.viscosity}))
        return replace(inputs, oil=oil, boundary_friction=2.0 * inputs.boundary_friction)

    @classmethod
    def is_in(cls, case):
        return True


def started(name, effects, *keys):
    scene = Scene(name, *keys)
    for effect in effects:
        scene.stepper.effects.append(effect)
        scene.simulation._records[effect.name] = effect.start()
    return scene.simulation.advance()


def test_effects_change_oil_and_friction_of_film_and_solids():
    """Two effects that double the viscosity: the friction is that of the oil four times as thick."""
    keys = ["mesh.points_per_half_width=32", "mesh.inlet=-2.5", "fluid.law=barus"]
    more = Additive(SimpleNamespace())
    more.name = "more"
    found = started("table1_smooth.toml", [Additive(SimpleNamespace()), more], *keys, "fluid.viscosity=0.005")
    thick = started("table1_smooth.toml", [], *keys, "fluid.viscosity=0.02")
    np.testing.assert_allclose(found.film_thickness, thick.film_thickness, rtol=1e-5)
    np.testing.assert_allclose(found.shear_stress_2, thick.shear_stress_2, rtol=1e-4)
    keys = ["contact.boundary_friction=0.1", "motion={entrainment_speed=1.0,slide_roll_ratio=0.5}"]
    plain = started("dry_hertz.toml", [], *keys)
    found = started("dry_hertz.toml", [Additive(SimpleNamespace())], *keys)
    np.testing.assert_allclose(found.shear_stress_2, 2.0 * plain.shear_stress_2)


def test_module_that_is_missing_is_named(tmp_path):
    for words in (["explain"], []):
        command = [PYTHON, "-m", "ehlpetsc", *words, CASES / "dry_hertz.toml"]
        done = called(command, tmp_path, SCRIPT | {"EHLPETSC_OWN": "nosuch"})
        assert done.returncode == 2 and done.stderr.count("\n") == 1
        assert "EHLPETSC_OWN = nosuch: No module named 'nosuch'; allowed: a module in this" in done.stderr


def no_such_name(p, T, slope):
    return slope * p / growth, slope, 0.0  # noqa: F821


def two_numbers(p, T, slope):
    return slope * p, slope


@pytest.mark.parametrize(
    "law, reason",
    [(no_such_name, "NameError: name 'growth' is not defined"), (two_numbers, "wrong tuple length")],
)
def test_a_law_that_cannot_be_compiled_is_refused_with_its_place(law, reason):
    with pytest.raises(CaseError) as fault:
        address_of(law, 1, 2)
    place = f"law {law.__name__} (test_effects.py, line {law.__code__.co_firstlineno}): "
    assert is_line_with(str(fault.value), place, reason, "allowed: 3 arguments, 3 returned numbers")


def test_a_law_that_cannot_be_compiled_ends_all_ranks(folder):
    broken = (folder / "my_oil.py").read_text().replace("/ growth,", "/ grown,")
    (folder / "my_oil.py").write_text(broken)
    words = command("table1_smooth.toml", "--set", "fluid.law=saturating", ranks=2)
    done = called(words, folder, BARE | SCRIPT | {"EHLPETSC_OWN": "my_oil"})
    assert done.returncode == 2 and "law saturating (my_oil.py, line 5): cannot be compiled" in done.stderr


@pytest.mark.parametrize(
    "text, reason",
    [
        ("LAWS = (", "SyntaxError: '(' was never closed (mine.py, line 1)"),
        ("\nraise ValueError('x')", "ValueError: x, mine.py, line 2"),
        ("LAWS = 3", "TypeError: 'int' object is not iterable"),
    ],
)
def test_a_module_of_the_user_that_fails_is_refused_in_one_sentence(tmp_path, text, reason):
    (tmp_path / "mine.py").write_text(text)
    done = called([PYTHON, "-m", "ehlpetsc", "keys", "fluid"], tmp_path, SCRIPT | {"EHLPETSC_OWN": "mine"})
    assert done.returncode == 2
    assert is_line_with(done.stderr, f"EHLPETSC_OWN = mine: {reason}", "; allowed: ", "LAWS")
