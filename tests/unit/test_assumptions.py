"""All features over all bodies, shapes and motions: each combination is allowed, or refused in a sentence."""

import itertools

import numpy as np
import pytest

import ehlpetsc
from ehlpetsc.base.case import KINDS
from ehlpetsc.case.assumptions import COMMANDS, DEPARTURES, FEATURES, STRESSES, refusal
from ehlpetsc.case.loading import load
from ehlpetsc.case.tables import TABLES
from ehlpetsc.effects import EFFECTS

LAYER = {"thickness": 2e-6, "youngs_modulus": 1e11, "poisson_ratio": 0.2}
SHAPES = {
    "line": ({"radius": 0.01, "load": 2e5}, {}),
    "strip": ({"radius": 0.01, "load": 2e5}, {"width": 0.5}),
    "point": ({"radius": [0.01, 0.01], "load": 20.0}, {"width": 3.2}),
    "roller": ({"radius": 0.01, "load": 200.0, "length": 1e-3}, {}),
    "window": ({"radius": 0.01, "load": 200.0, "length": 1e-3}, {"points_per_half_width": [8, 16]}),
}
SHAPES["window"][1]["window"] = {"from": 1e-4, "to": 5e-4, "coarsening": [1, 2]}
BODIES = {"homogeneous": {}, "coated": {"coating": LAYER}}
OIL = {"viscosity": 0.02, "law": "barus", "pressure_viscosity": 1.5e-8, "density": "incompressible"}
MOVING = {"fluid": OIL, "motion": {"entrainment_speed": 1.0, "slide_roll_ratio": 0.1}}
MIXED = {"contact": {"model": "mixed"}}
COURSE = {"time": [0.0, 1e-4], "speed_1": [1.0, -1.0], "speed_2": [1.0, -1.0]}
GIVEN = {  # tables of a feature, and of nothing else
    "contact.yield_pressure": {"contact": {"model": "mixed", "yield_pressure": 2e9}},
    "contact.asperity_height": {"contact": {"model": "mixed", "asperity_height": 2e-8}},
    "fluid.inlet_film": MOVING | {"fluid": OIL | {"inlet_film": 1e-7}},
    "[heat]": MOVING
    | {"heat": {"bulk_temperature": 333.0, "conductivity": 0.14, "reference_temperature": 333.0}},
    "[life]": MOVING | MIXED | {"time": {"travel": 1.0}, "life": {}},
    "tilt": {"contact": {"tilt": 1e-4}},
    "approach": {"contact": {"approach": 1e-6, "load": None}},
    "oil": MOVING,
    "rough": {"surface": {"1": {"synthetic": {"kind": "sine", "amplitude": 1e-8, "wavelength": 2e-4}}}},
}
NOT_COATED = {"contact.yield_pressure", "contact.asperity_height", "[heat]", "[life]"}


def tables(shape, body, feature):
    contact, mesh = SHAPES[shape]
    case = {
        "title": "walk",
        "contact": {"youngs_modulus": 2.1e11, "poisson_ratio": 0.3} | contact | BODIES[body],
        "mesh": {"points_per_half_width": 8, "inlet": -1.6, "outlet": 1.6} | mesh,
    }
    for name, given in GIVEN.get(feature, {}).items():
        case[name] = case.get(name, {}) | given
    case["contact"] = {key: value for key, value in case["contact"].items() if value is not None}
    return case


def faults(case):
    try:
        load(case)
    except ehlpetsc.CaseError as error:
        return error.args[0] if isinstance(error.args[0], list) else str(error).splitlines()
    return []


@pytest.mark.parametrize("feature", [name for name in GIVEN])
def test_features_of_coated_bodies_are_refused_where_they_assume_homogeneous_ones(feature):
    for shape in SHAPES:
        bare, coated = (faults(tables(shape, body, feature)) for body in BODIES)
        if bare:  # of another kind of contact
            continue
        names_both = [line for line in coated if feature in line and "contact.coating" in line]
        assert len(names_both) == (feature in NOT_COATED), (shape, coated)
        assert len(coated) == (shape in ("line", "roller", "window")) + len(names_both), (shape, coated)


def test_a_coated_line_is_told_of_strips_and_a_coated_roller_of_its_ends():
    (line,), (roller,) = (faults(tables(shape, "coated", "")) for shape in ("line", "roller"))
    assert "take a strip of few rows, mesh.width = 0.5" in line
    assert "contact.free_ends = false" in roller
    case = tables("roller", "coated", "")
    case["contact"]["free_ends"] = False
    assert faults(case) == []


def test_oil_of_an_inlet_needs_one_direction_of_entrainment():
    case = tables("line", "homogeneous", "fluid.inlet_film")
    contact = {key: value for key, value in case["contact"].items() if key not in ("radius", "load")}
    operation = COURSE | {"radius": [0.01, 0.01], "load": [2e5, 2e5]}
    case |= {"contact": contact, "operation": operation, "time": {"courant": 0.5}}
    case["mesh"] = {"points_per_half_width": 8, "inlet": -2.0, "outlet": 2.0}
    (fault,) = faults({key: value for key, value in case.items() if key != "motion"})
    assert "fluid.inlet_film" in fault and "becomes negative" in fault


SPINNING = {
    "spin": {"motion": {"entrainment_speed": 1.0, "spin": 5.0}},
    "groove": {"contact": {"groove_radius": 0.02}},
}
NEED_ONE_SPEED = {
    "contact.yield_pressure": "contact.yield_pressure",
    "[surface]": "rough",
    "[wear]": "wear",
}
GIVEN["wear"] = MOVING | MIXED | {"time": {"travel": 1.0}, "wear": {"coefficient": 1e-18}}


@pytest.mark.parametrize("motion", SPINNING)
def test_features_that_need_one_speed_across_are_refused_where_rows_differ(motion):
    for name, feature in NEED_ONE_SPEED.items():
        case = tables("point", "homogeneous", feature)
        assert faults(case) == []
        for key, values in SPINNING[motion].items():
            case[key] = case.get(key, {}) | values
        (fault,) = faults(case)
        assert name in fault and "one speed across" in fault
    for feature in ("tilt", "approach", "oil", "[heat]", "fluid.inlet_film", "contact.asperity_height"):
        case = tables("point", "homogeneous", feature)
        for key, values in SPINNING[motion].items():
            case[key] = case.get(key, {}) | values
        assert faults(case) == []


def test_rows_that_differ_are_of_points_and_rollers_and_of_one_direction():
    for shape in ("line", "strip"):
        case = tables(shape, "homogeneous", "oil")
        case["motion"] = {"entrainment_speed": 1.0, "spin": 5.0}
        (fault,) = faults(case)
        assert f"motion.spin: of point and roller contacts, and this is a {shape}; leave it out" in fault
    case = tables("roller", "homogeneous", "oil")
    case["motion"] = {"entrainment_speed": 1.0, "spin": [0.0, 5.0]}
    assert faults(case) == []
    case["motion"]["spin"] = [0.0, 5000.0]  # 1 - 2500 x 0.438e-3 m/s in the first row
    (fault,) = faults(case)
    assert "an entrainment speed of -0.0938 m/s at y = -0.438 mm" in fault


def test_every_effect_and_assumption_has_its_line():
    tables = {f"[{effect.table.name}]" for effect in EFFECTS if effect.table}
    assert tables <= FEATURES.keys()
    used = {assumed for feature in FEATURES.values() for assumed in feature.assumes}
    keys = [key for table in TABLES for key in table.keys.values()]
    used |= {assumed for key in keys for assumed in key.assumes}
    assert {key.departs for key in keys} - {""} < DEPARTURES.keys()
    assert used | set(itertools.chain(*COMMANDS.values())) == DEPARTURES.keys()
    assert SHAPES.keys() == KINDS.keys()


def test_stresses_below_a_coating_are_refused():
    assert refusal(load(tables("point", "homogeneous", "")), STRESSES, COMMANDS[STRESSES]) == ""
    text = refusal(load(tables("point", "coated", "")), STRESSES, COMMANDS[STRESSES])
    assert text.startswith(
        "stresses below the surface: assumes homogeneous bodies, and this case has contact"
    )


ALLOWED = [(shape, feature) for shape in ("strip", "point", "roller") for feature in ("", "oil")]
ALLOWED += [("point", "tilt"), ("point", "approach"), ("roller", "tilt"), ("window", "oil")]


@pytest.mark.parametrize(("shape", "feature"), ALLOWED)
def test_allowed_features_of_coated_bodies_run(shape, feature):
    case = tables(shape, "coated", feature)
    if shape in ("roller", "window"):
        case["contact"]["free_ends"] = False
    with ehlpetsc.solve(load(case), options={}) as result:
        assert np.isfinite(result.pressure[-1]).all() and np.isfinite(result.film_thickness[-1]).all()
        assert abs(result.steps("load_error")).max() < 1e-6


SLIDING = {"fluid": OIL | {"eyring_stress": 5e6, "limiting_shear": 0.05}}
MOVING_ROUGHNESS = GIVEN["rough"] | {"time": {"travel": 0.4}}
LAYERED = {"contact": {"model": "mixed", "asperity_height": 2e-8}}
VARYING = {"operation": {"time": [0.0, 1e-4], "radius": [0.01, 0.008]}}
FOUR = (GIVEN["[heat]"], SLIDING, LAYERED, MOVING_ROUGHNESS)


@pytest.mark.parametrize(
    ("shape", "features"),
    [
        *(("roller", (one,)) for one in (SLIDING, LAYERED, MOVING_ROUGHNESS, VARYING)),
        ("roller", FOUR),
        ("window", FOUR[1:]),
    ],
    ids=["limiting shear", "layer", "moving roughness", "operation", "four with heat", "three in a window"],
)
def test_features_of_rollers_in_oil_run(shape, features):
    case = tables(shape, "homogeneous", "oil")
    for given in features:
        case |= {name: case.get(name, {}) | table for name, table in given.items()}
    case["contact"] |= {"tilt": 1e-4, "profile": {"kind": "iso", "diameter": 0.02}}
    case["mesh"] |= {"inlet": -2.4, "outlet": 2.0, "points_per_half_width": [8, 16]}
    case["motion"] = {"entrainment_speed": 4.0, "slide_roll_ratio": 0.1}  # no false contact on few nodes
    if "operation" in case:
        del case["contact"]["radius"]
    simulation = ehlpetsc.Simulation(load(case))
    states = list(simulation)
    assert simulation.finished and len(states) > (1 if "time" in case or "operation" in case else 0)
    assert max(state.load_error for state in states) < 1e-6
    assert max(state.mass_error for state in states) < 1e-4
    assert all(np.isfinite(field).all() for field in states[-1].fields.values())
    if "surface" in case:
        assert abs(states[-1].film_thickness - states[0].film_thickness).max() > 5e-9


@pytest.mark.parametrize("feature", ["[heat]", "contact.yield_pressure", "[operation]"])
def test_features_of_whole_contacts_are_refused_in_a_window(feature):
    case = tables("window", "homogeneous", feature)
    if feature == "[operation]":
        case |= VARYING | MOVING
        del case["contact"]["radius"]
    assert f"{feature}: assumes a whole contact, and this case has mesh.window" in "; ".join(faults(case))
