"""Points and strips: units, refusals, explain, templates, limits; contacts at an approach or tilted."""

import copy
import math
import re
import tomllib
from dataclasses import replace

import numpy as np
import pytest
from support import one_fault, self_affine
from support.points import R, point

import ehlpetsc
from ehlpetsc.case.keys import template
from ehlpetsc.case.loading import load, members, stored_case
from ehlpetsc.physics.contact.hertz import hertz_ellipse, hertz_load
from ehlpetsc.physics.flash_temperature import flash_temperature
from ehlpetsc.physics.scales import Scales
from ehlpetsc.run.forecast.cost import expected_work, file_size
from ehlpetsc.run.forecast.domain import domain_faults
from ehlpetsc.run.forecast.explain import explain
from ehlpetsc.run.forecast.limits import limits
from ehlpetsc.run.forecast.validity import heat_warnings, warnings
from ehlpetsc.run.recorder import Recorder
from ehlpetsc.run.simulation import Simulation
from ehlpetsc.surfaces.motion.roughness import Roughness

POINT, STRIP = (tomllib.loads(template(kind)) for kind in ("point", "strip"))
del POINT["contact"]["asperity_height"]  # a full film over waves that the mesh hardly resolves
POINT["motion"]["entrainment_speed"] = "1 m/s"
POINT["surface"]["1"]["synthetic"] |= {"sq": "0.03 um", "roll_off": "80 um", "short_cutoff": "25 um"}


def fault(tables, **overrides):
    changes = {key.replace("__", "."): value for key, value in overrides.items()}
    return one_fault(load, copy.deepcopy(tables), changes)


@pytest.mark.parametrize(
    "tables, load_text, message",
    [
        (POINT, "20 N/m", "allowed: a unit of N in a point contact, of two radii"),
        (STRIP, "20 N", "allowed: a unit of N/m in a line contact or a strip, of one radius"),
        (POINT, 1e-4, "allowed: a number >= 0.001 and <= 1e+10 [N]"),
    ],
)
def test_load_has_the_unit_of_its_contact(tables, load_text, message):
    assert message in fault(tables, contact__load=load_text)


def test_load_of_a_point_is_converted_and_xdmf_is_not_of_a_line():
    assert load(copy.deepcopy(POINT), {"contact.load": "2 kN"}).contact.load == 2000.0
    assert load(copy.deepcopy(STRIP), {"contact.load": "50 N/mm"}).contact.load == 5e4
    text = fault(tomllib.loads(template("line")), output__xdmf=True)
    assert "output.xdmf: of strip, point, roller and window contacts, and this is a line" in text


WAVE = {"kind": "sine", "amplitude": 1e-8, "wavelength": 5e-5}
MAP, PROFILE = {"z": np.eye(8) * 1e-9, "spacing": 1e-5}, {"z": [0.0, 1e-9] * 50, "spacing": 1e-5}
ACROSS = WAVE | {"wavelength_across": 7e-5}
REFUSED = {  # by key: tables, overrides, words of the message
    "[gears]": (POINT, {"gears": {"speed": 1}}, "leave the radius out (mesh.width: a strip)"),
    "[life]": (POINT, {"life": {"passes": 10}}, "of line and strip contacts, and this is a point"),
    "mesh.near_field": (POINT, {"mesh.near_field": 5}, "of line contacts, and this is a point"),
    "contact.load": (STRIP, {"contact.load": "20 N"}, "allowed: a unit of N/m"),
    "mesh": (POINT, {"mesh.width": 900}, "allowed: 1100000 in all"),
    "wavelength_across": (STRIP, {"surface.1": {"synthetic": ACROSS}}, "allowed: whole waves over the width"),
    "direction": (POINT, {"surface.1": {"synthetic": WAVE, "direction": 30.0}}, "of a map in a file or"),
    "spacing_across": (POINT, {"surface.1": PROFILE | {"spacing_across": 1e-5}}, "of a map, not of a"),
    "position_across": (POINT, {"surface.1": MAP | {"position_across": 1e-3}}, "allowed: on the map"),
    "x_unit": (POINT, {"surface.1": MAP | {"x_unit": "mm"}}, "of x, not of spacing"),
}


@pytest.mark.parametrize("key", REFUSED)
def test_what_points_and_strips_refuse(key):
    tables, overrides, words = REFUSED[key]
    text = fault(tables, **overrides)
    assert key in text and words in text


def test_a_measured_layer_has_the_height_that_the_filter_of_a_map_removes():
    x = 2e-6 * np.arange(200)
    wave = 1e-7 * np.sin(2 * np.pi * x / 5e-6) * np.ones((80, 1))
    surface = {"z": (wave + 1e-7 * np.cos(x / 5e-5)).tolist(), "spacing": 2e-6, "short_cutoff": 20e-6}
    given = {"surface.1": surface, "contact.model": "mixed", "contact.asperity_height": "measured"}
    case = load(copy.deepcopy(STRIP), given | {"contact.boundary_friction": 0.1})
    assert case.contact.asperity_height == pytest.approx(wave.std(), rel=0.05)


@pytest.mark.parametrize(
    "overrides, message",
    [
        ({"mesh.points_per_half_width": [24, 3]}, "mesh.points_per_half_width = [24, 3]: allowed:"),
        (
            {"operation": {"time": [0, 1], "load": ["2 N", "3 N/m"]}},
            "allowed: a unit of N in a point contact",
        ),
        ({"operation": {"time": [0, 1], "load": [2, -3]}}, "row 2: load = -3 N: allowed: above 0"),
    ],
)
def test_refused_values_of_a_point(overrides, message):
    assert message in fault(POINT, **overrides)


def test_explanation_of_points_strips_and_ridges():
    text = explain(load(copy.deepcopy(POINT)))
    assert "a point, radii 0.0095 m along, 0.0095 m across, load 20 N, reduced" in text
    assert "half-widths a = 0.107805 mm along, b = 0.107805 mm across" in text
    assert "Expected smooth film (fit of computed points to 10 %, of another oil to 13 %," in text
    assert "Mesh: 97 x 85 nodes from -2.5 to 1.5 a along, -1.75 to 1.75 b across" in text
    assert "Waves of surface 1: short_cutoff of 25 um: 5.6; " in text
    assert "Sa 0.02" in text and "memory: about" in text
    table = {"operation": {"time": [0, 1e-3], "load": ["12 N", "0.02 kN"]}}
    text = explain(load(copy.deepcopy(POINT), table))
    assert "Conditions of a table: load 12 to 20 N, radius 9.5 mm; above, those of the widest" in text
    text = explain(load(copy.deepcopy(STRIP)))
    assert "load 100000 N/m" in text and "Strip: 0.1058 mm of its length, periodic across" in text
    assert "129 x 32 nodes" not in text and "x 32 nodes from -4 to 1.5 a along, -0.5 to 0.5 a across" in text
    ridge = {"synthetic": {"kind": "ridge", "amplitude": 1e-7, "wavelength": 5e-5}}
    assert "a ridge across the width" in explain(load(POINT | {"surface": {"1": ridge}}))
    profile = {"z": [0.0, 1e-8, 0.0, -1e-8] * 50, "spacing": 1e-5}
    text = explain(load(POINT | {"surface": {"1": profile}}))
    assert "1.99 mm long, 200 points 10 um apart; a profile: a ridge across the width" in text


def test_tilted_or_rough_map_is_reported_with_the_points_needed_along_both_axes():
    z = 3e-8 * np.random.default_rng(1).standard_normal((60, 200)) + np.linspace(0, 3e-7, 60)[:, None]
    case = load(POINT | {"surface": {"1": {"z": z.tolist(), "spacing": 5e-6}}})
    notes = "\n".join(warnings(case, Scales.of(case)))
    assert "of the height variance is a plane (" in notes and "0.3 um over 0.295 mm" in notes
    assert "the mesh is too coarse for the map" in notes
    case = load(copy.deepcopy(POINT), {"mesh.points_per_half_width": [24, 12]})
    (note,) = (line for line in warnings(case, Scales.of(case)) if "too coarse for the map" in line)
    along, across = (int(n) for n in note.partition("= [")[2].partition("]")[0].split(", "))
    assert along == pytest.approx(2 * across, abs=1) and 12 < across < 30


def test_flash_temperature_of_a_long_ellipse_is_that_of_the_line():
    smooth = STRIP | {"surface": {}}
    line = Scales.of(load(copy.deepcopy(smooth), {"mesh.width": None}))
    contact = STRIP["contact"] | {"radius": [0.01, 10.0]}
    mesh = {"mesh.width": 4, "mesh.points_per_half_width": [24, 24]}

    def ellipse(force):
        return Scales.of(load(smooth | {"contact": contact | {"load": force}}, mesh))

    force = 1000.0 * (line.p0 / ellipse(1000.0).p0) ** 3  # of the same p0
    found = ellipse(force)
    assert found.p0 == pytest.approx(line.p0, rel=1e-9) and found.b > 50 * found.a
    assert flash_temperature(0.05, found) == pytest.approx(flash_temperature(0.05, line), rel=0.01)


def test_limits_of_a_point_and_the_rise_of_a_sliding_film_over_the_walls():
    case = load(copy.deepcopy(POINT), {"motion.slide_roll_ratio": 1.0})
    scales = Scales.of(case)
    totals = {"p_max": 6e9, "h_min": 1e-8, "oil_pressure": 1e9, "mass_error": 0.2, "nodes_below_1nm": 3}
    lines = limits(case, scales, Roughness.of(case, scales), totals | {"friction_coefficient": 0.05})
    found = [line.partition(":")[0] for line in lines]
    assert found == ["pressure", "heat", "oil balance", "film"]
    contact = {"radius": [9.525e-3, 9.525e-3], "load": 30.0, "material": "100Cr6"}
    motion = {"entrainment_speed": 2.0, "slide_roll_ratio": 0.6}
    mesh = {"inlet": -2.5, "outlet": 1.5, "width": 3.5, "points_per_half_width": 16}
    fluid = {"oil": "fva3", "temperature": 313.15}
    case = load({"title": "ball", "contact": contact, "fluid": fluid, "motion": motion, "mesh": mesh})
    (line,) = heat_warnings(case, Scales.of(case))
    flash, film = (float(word) for word in re.findall(r"(\d+) K", line))
    assert flash == pytest.approx(21.0, abs=3.0) and flash + film == pytest.approx(31.7, abs=4.0)
    slower = load(case._tables, {"motion.slide_roll_ratio": 0.2})
    assert heat_warnings(slower, Scales.of(slower)) == []
    heated = load(case._tables, {"heat.bulk_temperature": 313.15})
    totals = {"p_max": 1e9, "h_min": 1e-7, "oil_pressure": 1e9, "mass_error": 0.0, "nodes_below_1nm": 0}
    hot = totals | {"temperature_1_max": 500.0, "temperature_2_max": 6787.0, "film_temperature_max": 900.0}
    scales = Scales.of(heated)
    lines = [line for line in limits(heated, scales, None, hot) if line.startswith("temperature: ")]
    assert ["6787 K in the surfaces" in lines[0], "900 K in the film" in lines[1]] == [True, True]
    assert not any(line.startswith("temperature") for line in limits(heated, scales, None, totals))


def test_forecast_grows_with_the_nodes_and_the_precision():
    coarse, fine = (load(copy.deepcopy(POINT), {"mesh.points_per_half_width": n}) for n in (24, 48))
    single = load(copy.deepcopy(POINT), {"output.precision": "float32"})
    times = [expected_work(case, Scales.of(case), None) for case in (coarse, fine)]
    assert 2 * 3 < times[1] / times[0] < 2 * 4**1.15  # twice the steps
    sizes = [file_size(case, Scales.of(case)) for case in (single, coarse, fine)]
    assert sizes[0] < 0.55 * sizes[1] and 7 < sizes[2] / sizes[1] < 9


def test_heights_of_a_map_are_stored_as_their_digest():
    z = 1e-7 * np.random.default_rng(1).standard_normal((60, 80))
    maps = [{"z": heights, "spacing": 5e-6, "short_cutoff": 3e-5} for heights in (z, z, 2 * z)]
    one, same, other = (load(copy.deepcopy(POINT), {"surface.1": table}) for table in maps)
    assert one.text == same.text != other.text and len(one.text) < 2000
    assert stored_case(one.text).surface.body_1.short_cutoff == 3e-5
    varied = {"series": {"key": "contact.load", "values": [10.0, 20.0]}}
    both = members(load(POINT | varied, {"surface.1": maps[0]}))
    assert [len(member.surface.body_1.z) for _, member in both] == [60, 60]


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
        assert state.scalars["approach"] == pytest.approx(approach, rel=1e-9)
        assert state.load_error < 1e-9
    for radii in ((0.01, 0.01), (0.01, 0.08), (0.03, 0.004)):
        approach = hertz_ellipse(25.0, *radii, 2.2e11).approach
        assert hertz_load(approach, *radii, 2.2e11) == pytest.approx(25.0, rel=1e-12)


def test_approach_of_a_part_of_the_load_is_that_of_hertz():
    """Of an eighth a quarter, in the border's equation."""
    problem = Simulation(load(DRY, {"mesh.points_per_half_width": 4})).stepper.problem
    inputs = replace(problem.inputs(), load_share=0.125)
    approach = APPROACH / problem.scales.h
    residual = problem.balance.residual(np.array([-0.25 * approach]), np.zeros(1), inputs)
    assert abs(residual[0]) < 1e-12 * approach


def test_approach_that_balances_a_load_gives_this_load():
    """A thick film keeps the bodies further apart than in Hertz contact; on the same domain [m]."""
    balanced = Simulation(load(point(20.0, 10.0, 13)))
    state, given, mesh = balanced.advance(), balanced.scales.load, balanced.case.mesh
    approach = state.scalars["approach"]
    ratio = np.sqrt(approach / hertz_ellipse(given, R, R, balanced.scales.E).approach)
    assert ratio < 0.8
    changes = {f"mesh.{key}": getattr(mesh, key) / ratio for key in ("inlet", "outlet", "width")}
    changes |= {"contact.load": None, "contact.approach": approach}
    again = Simulation(load(point(20.0, 10.0, round(13 * ratio), changes)))
    assert again.advance().scalars["load"] == pytest.approx(given, rel=5e-3)
    assert again.scales.load < 0.6 * given


def test_mixed_contact_keeps_its_approach_while_the_load_varies_also_restarted(tmp_path):
    states = list(Simulation(mixed()))
    loads = np.array([state.scalars["load"] for state in states])
    for state in states:
        assert state.scalars["approach"] == pytest.approx(APPROACH, rel=1e-9)
        assert state.mass_error < 1e-6
    assert states[-1].scalars["contact_share"] > 0.02
    assert np.ptp(loads) > 1e-3 * loads.mean()
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
        ({"contact.radius": 0.01}, "contact.approach = 1.2e-06: of point contacts, and this is a strip"),
        ({"operation": {"time": [0, 1], "speed_1": [1, 2], "speed_2": [1, 2]}}, r"which \[operation\] would"),
        ({"gears": {"speed": 1}}, r"which \[gears\] would give; leave out one of both"),
        ({"contact.approach": 0.0}, "contact.approach = 0.0: allowed: a number >= 1e-09"),
        ({"contact.approach": 1e-9}, "approach = 1e-09: the load .* 0.000573 N, .*: 1.45e-09 m or more"),
        ({"contact.youngs_modulus": 1e18, "contact.approach": 1e-2}, "the load .* N, is not .* m or less"),
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


RY = 0.05
ROLLER = {
    "title": "A crowned roller on a plane",
    "contact": {"radius": [0.01, RY], "load": 100.0, "material": "16MnCr5"},
    "mesh": {"inlet": -1.3, "outlet": 1.3, "width": 3.0, "points_per_half_width": 16},
}


def test_given_tilt_moves_the_dry_ellipse_and_a_free_one_evens_out_a_wedge():
    shift = 0.2  # half-widths b
    hertz = hertz_ellipse(100.0, 0.01, RY, Simulation(load(ROLLER)).scales.E)
    tilt = -shift * hertz.b / RY
    simulation = Simulation(load(ROLLER, {"contact.tilt": tilt}))
    state, grid = simulation.advance(), simulation.scales.grid
    y, x = (axis.reshape(grid.shape) for axis in grid.coordinates)
    p, y = state.pressure, y * hertz.a / hertz.b
    inside = (distance := np.hypot(x, y - shift)) < 0.9
    expected = hertz.p0 * np.sqrt(1.0 - distance[inside] ** 2)
    np.testing.assert_allclose(p[inside], expected, rtol=0.0, atol=5e-3 * hertz.p0)
    assert (p * y).sum() / p.sum() == pytest.approx(shift, abs=1e-4)
    raised = 0.5 * tilt**2 * RY  # of the middle over the nearest points of the undeformed bodies
    assert state.scalars["approach"] == pytest.approx(hertz.approach - raised, rel=2e-3)
    assert state.scalars["tilt"] == pytest.approx(tilt, rel=1e-12)
    tight, slope = {"snes_atol": "1e-10"}, 2e-3
    simulation = Simulation(load(ROLLER, {"contact.self_aligning": True}), options=tight)
    state, solver = simulation.advance().dimensionless, simulation.stepper.solver
    problem, s = solver.problem, simulation.scales
    assert problem.balance.tilt(state.unknowns.border) == pytest.approx(0.0, abs=1e-9)
    wedge = slope * s.grid.coordinates[0] * s.a / s.h
    solution, _ = solver.solve(state.unknowns, problem.inputs(phi=wedge), max_it=60)
    assert problem.balance.tilt(solution.border) == pytest.approx(-slope, rel=1e-9)
    pressure = problem.model.state(solution.q, solution.w).pressure
    np.testing.assert_allclose(pressure, state.p, rtol=0.0, atol=1e-8)


@pytest.mark.parametrize("tilt", [0.1, -0.1, 0.0113])
@pytest.mark.parametrize("in_oil", [True, False])
def test_a_tilt_that_moves_the_contact_beside_the_mesh_is_refused_with_the_width_that_holds_it(tilt, in_oil):
    tables = point(50.0, 5.0, 8) if in_oil else ROLLER
    s = Scales.of(load(tables))
    limit = (0.5 * np.ptp(s.grid.axes[0]) - s.b / s.a) * s.a / load(tables).contact.radius_across
    case = load(tables, {"contact.tilt": math.copysign(max(abs(tilt), 1.05 * limit), tilt)})
    (fault,) = domain_faults(case, Scales.of(case))
    assert "moves the contact" in fault and "\n" not in fault
    wide = case.copy({"mesh": case.mesh.copy({"width": float(re.search("mesh.width = (\\d+)", fault)[1])})})
    assert domain_faults(wide, Scales.of(wide)) == []
    within = load(tables, {"contact.tilt": 0.95 * limit})
    assert domain_faults(within, Scales.of(within)) == []


def test_restart_continues_a_tilted_contact_whose_film_is_that_of_the_moved_one(tmp_path):
    tables = point(50.0, 5.0, 8) | {"time": {"travel": 0.4, "courant": 1.0}}
    straight = Simulation(load(tables))
    tilt = -0.25 * straight.scales.b / straight.case.contact.radius_across  # by two nodes
    states = list(Simulation(case := load(tables, {"contact.tilt": tilt})))
    assert states[0].film_central == pytest.approx(straight.advance().film_central, rel=1e-3)
    with Recorder(simulation := Simulation(case), tmp_path / "run.h5") as recorder:
        for _ in range(2):
            recorder.write(simulation.advance())
        recorder.checkpoint()
    rest = ehlpetsc.solve(case, tmp_path / "run.h5", restart=tmp_path / "run.restart.h5")
    np.testing.assert_allclose(rest.steps.film_central, [s.film_central for s in states], rtol=1e-9)
    np.testing.assert_allclose(rest.steps("tilt"), tilt, rtol=1e-12)


def test_moment_vanishes_in_mixed_contact():
    changes = {"contact.self_aligning": True, "contact.boundary_film": 10e-9, "motion.slide_roll_ratio": 0.3}
    changes |= {"surface": {"1": {"synthetic": self_affine(40e-9, 40e-6, 20e-6)}}}
    changes |= {"fluid.viscosity": 0.01, "time": {"travel": 0.1, "start": "rough", "courant": 1.0}}
    simulation = Simulation(load(point(50.0, 5.0, 8), changes))
    y = simulation.scales.grid.coordinates[0]
    states = list(simulation)
    for state in states:
        pressure = state.pressure.ravel()
        assert abs(pressure @ y) < 1e-6 * pressure.sum()
        assert state.load_error < 1e-6
    assert states[-1].scalars["contact_share"] > 0.02
    assert abs(states[-1].scalars["tilt"]) > 1e-7


@pytest.mark.parametrize(
    "changes, message",
    [
        ({"contact.radius": 0.01, "mesh.width": None}, "contact.tilt"),
        ({"contact.approach": 1e-6, "contact.load": None}, "contact.tilt.*approach"),
        ({"contact.self_aligning": True}, "contact.self_aligning.*tilt"),
        ({"contact.tilt": 0.2}, "contact.tilt = 0.2: allowed: "),
    ],
)
def test_refused_tilts_are_one_sentence(changes, message):
    assert re.search(message, fault := one_fault(load, ROLLER, {"contact.tilt": 1e-3} | changes)), fault
