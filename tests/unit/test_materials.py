"""One material a case: published constants, the limit of pressure that follows, single keys instead."""

import math

import pytest

from ehlpetsc.base.errors import CaseError
from ehlpetsc.base.materials import STEELS, fatigue_constants, flow_pressure, steel_of_hardness
from ehlpetsc.case.checking import values_of
from ehlpetsc.case.loading import load, stored_case
from ehlpetsc.case.tables.outputs import POST
from ehlpetsc.post import Material
from ehlpetsc.post.loads import materials_of

RUNNING_IN = "cases/running_in.toml"


def yields_at(name):
    constants = fatigue_constants(STEELS[name], {})
    return flow_pressure(constants["cyclic_strength"], constants["cyclic_hardening"])


def test_constants_from_hardness():
    """Roessle and Fatemi (2000) at 400 HB and 200 GPa, worked out by hand."""
    steel = steel_of_hardness(400, 200e9)
    assert steel.fatigue_strength == pytest.approx(1925e6)
    assert steel.fatigue_ductility == pytest.approx(47_400 / 200_000)
    assert steel.cyclic_hardening == pytest.approx(steel.b / steel.c)
    with pytest.raises(ValueError, match="150 to 700"):
        steel_of_hardness(720, 200e9)
    steel = steel_of_hardness(151, 210e9)
    assert steel.fatigue_strength == pytest.approx(866.75e6, rel=1e-12)
    assert round(steel.fatigue_ductility, 4) == 0.5941
    assert (steel.b, steel.c) == (-0.09, -0.56)
    assert fatigue_constants(STEELS["SAE4340"], {})["cyclic_strength"] == pytest.approx(2.0e9 / 0.48**0.15)
    assert yields_at("SAE4340") == pytest.approx(2.61e9, rel=1e-3)
    assert flow_pressure(1e9, 0.0) == pytest.approx(1e9 * (2 + math.pi) / math.sqrt(3))


@pytest.mark.parametrize("name", STEELS)
def test_both_curves_of_every_steel_agree_and_fit_the_schema(name):
    """Where plastic strain amplitudes of both curves are equal, so are stress amplitudes; n' = b/c."""
    steel = STEELS[name]
    constants = fatigue_constants(steel, {})
    strength, hardening = constants["cyclic_strength"], steel.cyclic_hardening
    assert strength * steel.fatigue_ductility**hardening == pytest.approx(steel.fatigue_strength)
    assert hardening == pytest.approx(steel.b / steel.c, rel=0.02)
    assert 1.5e9 < yields_at(name) < 6e9
    values_of(POST, constants)


def with_material(**keys):
    keys = {"material": "16MnCr5", "youngs_modulus": None, "poisson_ratio": None, **keys}
    return load(RUNNING_IN, {f"contact.{key}": value for key, value in keys.items()})


def test_steel_sets_elastic_constants_and_yield_limit():
    case = with_material(yield_pressure="material")
    assert case.contact.youngs_modulus == (206e9, 206e9) and case.contact.poisson_ratio == (0.3, 0.3)
    assert case.contact.yield_pressure == pytest.approx([yields_at("16MnCr5")] * 2)
    case = with_material(material=["16MnCr5", "42CrMo4"], yield_pressure="material")
    assert case.contact.yield_pressure[1] == pytest.approx(yields_at("42CrMo4"))
    assert stored_case(case.text).contact == case.contact
    material = materials_of(load(RUNNING_IN))["1"]
    assert material == Material(207e9, 0.3, cyclic_strength=Material().hardening_coefficient)
    assert with_material(youngs_modulus=210e9).contact.youngs_modulus == (210e9, 210e9)
    assert with_material(yield_pressure=3e9).contact.yield_pressure == (3e9, 3e9)
    keys = {"contact.material": "100Cr6", "contact.yield_pressure": "material", "post.cyclic_strength": 2e9}
    case = load(RUNNING_IN, keys)
    assert case.contact.yield_pressure[0] == pytest.approx(flow_pressure(2e9, 0.09 / 0.56))
    assert materials_of(case)["2"].hardening_coefficient == 2e9
    strength = load(RUNNING_IN, {"contact.material": "100Cr6", "post.fatigue_strength": 1e9})
    cyclic = 1e9 / STEELS["100Cr6"].fatigue_ductility ** (0.09 / 0.56)
    assert materials_of(strength)["2"].hardening_coefficient == pytest.approx(cyclic)


@pytest.mark.parametrize(
    "keys, words",
    [
        ({"material": "16MnCr"}, 'contact.material = "16MnCr": .*"16MnCr5", "100Cr6"'),
        ({"material": None}, "contact.youngs_modulus .*missing"),
        ({"youngs_modulus": 2e11, "material": None, "yield_pressure": "material"}, "yield_pressure = "),
    ],
)
def test_unknown_and_missing_steels_are_refused(keys, words):
    with pytest.raises(CaseError, match=words):
        with_material(**keys)
