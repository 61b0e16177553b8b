"""Cases of points and strips: units, refusals, explain, templates, limits."""

import copy
import tomllib

import numpy as np
import pytest

import ehlpetsc
from ehlpetsc.base.errors import CaseError, UsageError
from ehlpetsc.case.keys import keys, template
from ehlpetsc.case.loading import load
from ehlpetsc.physics.flash_temperature import flash_temperature
from ehlpetsc.physics.scales import Scales
from ehlpetsc.run.explain import explain
from ehlpetsc.run.forecast import file_size, work_time
from ehlpetsc.run.validity import limits, warnings
from ehlpetsc.surfaces import roughness_of

POINT, STRIP = (tomllib.loads(template(kind)) for kind in ("point", "strip"))


def fault(tables, **overrides):
    with pytest.raises(CaseError) as error:
        load(copy.deepcopy(tables), {key.replace("__", "."): value for key, value in overrides.items()})
    (text,) = error.value.faults
    return text


@pytest.mark.parametrize(
    "tables, load_text, message",
    [
        (POINT, "20 N/m", "allowed: one of N in a point contact, of two radii"),
        (STRIP, "20 N", "allowed: one of N/m in a line contact or a strip, of one radius"),
        (POINT, 1e-4, "allowed: a number >= 0.001 and <= 1e+10 [N]"),
    ],
)
def test_load_has_the_unit_of_its_contact(tables, load_text, message):
    assert message in fault(tables, contact__load=load_text)


def test_load_of_a_point_is_converted():
    assert load(copy.deepcopy(POINT), {"contact.load": "2 kN"}).contact.load == 2000.0
    assert load(copy.deepcopy(STRIP), {"contact.load": "50 N/mm"}).contact.load == 5e4


def test_wrong_unit_of_the_load_is_one_sentence_in_a_line_contact(tmp_path):
    assert "contact.load" in fault(tomllib.loads(template("roller")), contact__load="20 N")


@pytest.mark.parametrize(
    "overrides, message",
    [
        ({"mesh__near_field": 5}, "mesh.near_field = 5: of line contacts, not of a point; leave it out"),
        ({"gears": {"speed": 1}}, "contact.radius = [0.0095, 0.0095]: a point contact has no [gears]"),
        ({"operation": {"time": [0, 1], "load": ["2 N", "3 N/m"]}}, "allowed: one of N in a point contact"),
        ({"operation": {"time": [0, 1], "load": [2, -3]}}, "row 2: load = -3 N: allowed: above 0"),
        ({"life": {"passes": 10}}, "[life]: of line contacts, not of a point; leave it out"),
        ({"mesh__width": 900}, "mesh: 97 x 21601 nodes; allowed: 1000000 in all; a smaller mesh.width"),
        ({"mesh__points_per_half_width": [24, 3]}, "mesh.points_per_half_width = [24, 3]: allowed:"),
    ],
)
def test_what_a_point_does_not_have_is_refused(overrides, message):
    assert message in fault(POINT, **overrides)


def test_xdmf_is_not_of_a_line_contact():
    text = fault(tomllib.loads(template("roller")), output__xdmf=True)
    assert "output.xdmf = true: of points and strips" in text


def test_sweeps_are_not_of_a_point():
    case = load(copy.deepcopy(POINT), {"contact.model": "direct"})
    with pytest.raises(UsageError, match="the paper's sweeps solve line contacts, not a point"):
        ehlpetsc.Simulation(case, options={"ehl_scheme": "sweep"})


def test_explanation_of_a_point():
    text = explain(load(copy.deepcopy(POINT)))
    assert "a point, radii 0.0095 m along, 0.0095 m across, load 20 N, reduced" in text
    assert "half-widths a = 0.107805 mm along, b = 0.107805 mm across" in text
    assert "Expected smooth film (Nijenbanning, Venner and Moes; Hamrock and Dowson," in text
    assert "Mesh: 97 x 85 nodes from -2.5 to 1.5 a along, -1.75 to 1.75 b across" in text
    assert "nodes a wave: short_cutoff of 25 um: 5.6" in text
    assert "Sa 0.02" in text and "memory: about" in text


def test_explanation_of_a_strip_states_its_width():
    text = explain(load(copy.deepcopy(STRIP)))
    assert "load 100000 N/m" in text and "Strip: 0.1058 mm of its length, periodic across" in text
    assert "129 x 32 nodes" not in text and "x 32 nodes from -4 to 1.5 a along, -0.5 to 0.5 a across" in text


def test_profile_on_a_plane_is_a_ridge():
    ridge = {"synthetic": {"kind": "ridge", "amplitude": 1e-7, "wavelength": 5e-5}}
    assert "a ridge across the width" in explain(load(POINT | {"surface": {"1": ridge}}))
    profile = {"z": [0.0, 1e-8, 0.0, -1e-8] * 50, "spacing": 1e-5}
    text = explain(load(POINT | {"surface": {"1": profile}}))
    assert "1.99 mm long, 200 points 10 um apart; a profile: a ridge across the width" in text


def test_tilted_or_rough_map_is_reported():
    z = 3e-8 * np.random.default_rng(1).standard_normal((60, 200)) + np.linspace(0, 3e-7, 60)[:, None]
    case = load(POINT | {"surface": {"1": {"z": z.tolist(), "spacing": 5e-6}}})
    notes = "\n".join(warnings(case, Scales.of(case)))
    assert "of the height variance is a plane (" in notes and "0.3 um over 0.295 mm" in notes
    assert "the mesh is too coarse for the map" in notes


def test_needed_points_are_two_where_the_spacings_differ():
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


def test_limits_of_a_point():
    case = load(copy.deepcopy(POINT), {"motion.slide_roll_ratio": 1.0})
    scales = Scales.of(case)
    totals = {"p_max": 6e9, "h_min": 1e-8, "oil_pressure": 1e9, "mass_error": 0.2, "nodes_below_1nm": 3}
    lines = limits(case, scales, roughness_of(case, scales), totals | {"friction_coefficient": 0.05})
    found = [line.partition(":")[0] for line in lines]
    assert found == ["pressure", "heat", "oil balance", "film"]


def test_forecast_grows_with_the_nodes_and_the_precision():
    coarse, fine = (load(copy.deepcopy(POINT), {"mesh.points_per_half_width": n}) for n in (24, 48))
    single = load(copy.deepcopy(POINT), {"output.precision": "float32"})
    times = [work_time(case, Scales.of(case), None) for case in (coarse, fine)]
    assert 2 * 3 < times[1] / times[0] < 2 * 4**1.15  # twice the steps
    sizes = [file_size(case, Scales.of(case)) for case in (single, coarse, fine)]
    assert sizes[0] < 0.55 * sizes[1] and 7 < sizes[2] / sizes[1] < 9


def test_keys_state_the_unit_of_a_point():
    assert "of a point contact its load [N]" in keys("contact.load")
    assert "RESULT.xdmf" in keys("output")
