"""Rollers of finite length: profiles, nodes, dry contact against conjugate gradients, what is said before."""

import copy
import re
from types import SimpleNamespace

import h5py
import numpy as np
import pytest
from support import roelands_oil
from support.dry_half_space import HalfSpaces, dry_pressure

import ehlpetsc
from ehlpetsc.base.errors import CaseError
from ehlpetsc.case.loading import load, stored_case
from ehlpetsc.elasticity.terms.free_ends import image_factor
from ehlpetsc.physics.contact.profiles import Design, drop_of
from ehlpetsc.physics.contact.roller import gap_across
from ehlpetsc.physics.scales import Scales
from ehlpetsc.post.loads import _warnings
from ehlpetsc.post.run import Job, run
from ehlpetsc.run.forecast.explain import explain
from ehlpetsc.run.simulation import Simulation

L, R, W, D = 12e-3, 6e-3, 2400.0, 12e-3
STEEL = {"youngs_modulus": 207e9, "poisson_ratio": 0.3}
DRY = {
    "title": "a roller",
    "contact": {"radius": R, "length": L, "load": W, **STEEL},
    "mesh": {"inlet": -1.6, "outlet": 1.6, "points_per_half_width": [10, 30]},
}
OIL = {
    "fluid": roelands_oil(0.02, 2e-8),
    "motion": {"entrainment_speed": 3.0},
    "mesh": {"inlet": -2.5, "outlet": 1.5, "points_per_half_width": [20, 100]},
}
ISO = {"kind": "iso", "diameter": D}
BLEND = {"kind": "circular", "radius": 0.02, "straight": 0.011}


def roller(profile=None, **contact):
    tables = copy.deepcopy(DRY)
    tables["contact"] |= ({"profile": profile} if profile else {}) | contact
    return tables


def drop_at(y, profile, length=L):
    case = load(roller(profile, length=length))
    design = Design(length, W, R, Scales.of(case).E)
    return drop_of(np.array([y]), case.contact.profile, design)[0]


LOG = 4.2e-6 * -np.log1p(-0.25)  # of the height 4.2 um, half way to the end
HEIGHT = 0.5597334e-6  # of Lundberg, 2 w/(pi E')


@pytest.mark.parametrize(
    ("profile", "y", "expected"),
    [
        ({"kind": "logarithmic", "height": 4.2e-6}, 3e-3, LOG),
        ({"kind": "logarithmic", "height": 4.2e-6, "straight": 4e-3}, 4e-3, LOG),
        ({"kind": "logarithmic", "height": 4.2e-6, "drop": 20e-6}, 6e-3, 20e-6),
        (ISO, 3e-3, LOG),
        ({"kind": "iso", "diameter": D, "tapered": True}, 3e-3, LOG * 45 / 35),
        ({"kind": "iso", "diameter": 2e-3}, 3.4e-3, 0.0),
        ({"kind": "iso", "diameter": 2e-3}, 4.75e-3, 1e-6 * -np.log1p(-0.25)),
        ({"kind": "lundberg"}, 3e-3, HEIGHT * -np.log1p(-0.25)),
        ({"kind": "lundberg", "load": 2 * W}, 3e-3, 2 * HEIGHT * -np.log1p(-0.25)),
        ({"kind": "johns-gohar"}, 6e-3, 2.877e-6),
        ({"kind": "ntn", "k1": 2.0, "k2": 0.5, "drop": 8e-6}, 6e-3, 8e-6),
        ({"kind": "ntn", "k1": 2.0, "k2": 0.5, "drop": 1e-3}, 4.5e-3, 2 * HEIGHT * -np.log1p(-0.25)),
        (BLEND, 6e-3, 6.25e-6),
        (BLEND, 5.4e-3, 0.0),
        ({"kind": "circular", "drop": 8e-6}, -3e-3, 2e-6),
        ({"kind": "two-radii", "radius": [8.0, 0.1], "middle": 8e-3}, 6e-3, 1e-6 + 1e-6 + 20e-6),
        ({"y": [0, 3e-3, 6e-3], "z": [0, 1e-6, 5e-6]}, -3e-3, 1e-6),
        ({"y": [-6e-3, 0, 6e-3], "z": [3e-6, 0, 5e-6]}, -6e-3, 3e-6),
    ],
)
def test_drop_of_profiles(profile, y, expected):
    assert drop_at(y, profile) == pytest.approx(expected, rel=2e-4, abs=1e-12)


def test_round_ends_begin_at_the_ends_of_the_roller():
    case = load(roller(BLEND, end_radius=0.3e-3))
    y = np.array([-6e-3, 6e-3, 6.1e-3, 7e-3])
    found = gap_across(y, case.contact, Design(L, W, R, 2e11))
    round_end = 0.3e-3 - np.sqrt(0.3e-3**2 - 0.1e-3**2)
    np.testing.assert_allclose(found, [6.25e-6, 6.25e-6, 6.25e-6 + round_end, 200e-6], rtol=1e-9)


def test_profile_of_a_file_is_stored_with_its_points(tmp_path):
    (tmp_path / "crown.csv").write_text("y [mm]; z [um]\n-6; 8\n0; 0\n6; 4\n")
    text = "\n".join(
        [
            'title = "a roller"',
            f"contact = {{ radius = {R}, length = {L}, load = {W}, material = '100Cr6', profile = "
            '{ file = "crown.csv" } }',
            "mesh = { inlet = -1.6, outlet = 1.6, points_per_half_width = [10, 30] }",
        ]
    )
    (tmp_path / "case.toml").write_text(text)
    case = load(tmp_path / "case.toml")
    assert (case.contact.profile.y, case.contact.profile.z) == ([-6e-3, 0.0, 6e-3], [8e-6, 0.0, 4e-6])
    assert stored_case(case.text).contact.profile == case.contact.profile


@pytest.mark.parametrize(
    ("contact", "message"),
    [
        ({"radius": [R, R]}, "contact.length: of roller and window contacts, and this is a point"),
        ({"length": None, "profile": ISO}, "contact.profile: needs contact.length"),
        ({"profile": {"kind": "circular"}}, "contact.profile: needs either radius or drop"),
        ({"profile": BLEND | {"straight": 13e-3}}, "profile"),
        ({"profile": {"y": [0, 5e-3], "z": [0, 1e-6]}}, "y from 0 to 0.005 m; allowed: to half of"),
        ({"profile": {"y": [0, 0], "z": [0, 1e-6]}}, "increasing distances"),
        ({"profile": {"y": [0, 6e-3], "z": [0]}}, "contact.profile.z"),
        ({"profile": {"file": "no.csv"}}, 'contact.profile.file = "no.csv": cannot be read'),
        ({"profile": {"file": "no.csv", "y": [0, 1]}}, "contact.profile: y; allowed: file, its name"),
        ({"profile": {"kind": "crowned"}}, "contact.profile"),
        ({"load": None, "approach": 1e-6}, "contact.approach"),
        ({"load": "20 N/mm"}, "allowed: a unit of N in a roller, of one radius and a length"),
    ],
)
def test_faults_of_a_roller_are_named(contact, message):
    tables = roller()
    tables["contact"] = {k: v for k, v in (tables["contact"] | contact).items() if v is not None}
    with pytest.raises(CaseError, match="(?s).*") as error:
        load(tables)
    assert message in str(error.value)


def test_scales_and_nodes_of_a_roller():
    scales = Scales.of(load(roller(ISO)))
    assert (scales.a, scales.b, scales.p0) == pytest.approx((0.115903e-3, 6e-3, 1.098535e9), rel=1e-5)
    y, step = scales.grid.axes[0] * scales.a, scales.grid.spacings[0]
    assert len(y) == 60 and step == pytest.approx(0.2e-3)
    assert (y[0] - 0.5 * step, y[-1] + 0.5 * step) == pytest.approx((-6e-3, 6e-3))
    assert scales.grid.load * scales.p0 * scales.a**2 == pytest.approx(W)
    assert set(scales.grid.edges()) == {"inlet", "outlet"}
    rounded = Scales.of(load(roller(ISO, end_radius=0.3e-3))).grid
    assert set(rounded.edges()) == {"inlet", "outlet", "width"}
    assert len(rounded.axes[0]) == 62  # 110 um beyond each end


HELD, FREE = (False,), (True, 0.5, lambda q: image_factor(q, 0.3), 1.0)  # half the compliance: the roller's


@pytest.mark.parametrize(
    ("profile", "more", "ends"),
    [
        (ISO, {}, HELD),
        (ISO, {"tilt": 0.5e-3}, HELD),
        (BLEND, {"tilt": 0.5e-3}, HELD),
        (BLEND, {"tilt": 0.5e-3}, FREE),
        (None, {}, FREE),
    ],
    ids=["iso", "iso tilted", "blend tilted", "blend with free ends", "straight with free ends"],
)
def test_dry_pressure_equals_that_of_conjugate_gradients(profile, more, ends):
    free_ends, *images = ends
    case = load(roller(profile, free_ends=free_ends, **more))
    state, scales = Simulation(case).advance(), Scales.of(case)
    grid = scales.grid
    y, x = (c.reshape(grid.shape) * scales.a for c in grid.coordinates)
    gap = x**2 / (2 * R) + gap_across(y, case.contact, Design(L, W, R, scales.E))
    gap += more.get("tilt", 0.0) * y
    half_spaces = HalfSpaces(grid.shape, grid.spacings, scales.E, *images)
    expected = dry_pressure(gap, W, np.prod(grid.spacings), half_spaces)
    np.testing.assert_allclose(state.pressure / scales.p0, expected / scales.p0, atol=1e-4)
    moments = [(p * y).sum() * np.prod(grid.spacings) for p in (state.pressure, expected)]
    assert moments[0] == pytest.approx(moments[1], rel=1e-4, abs=1e-4)


def test_dry_roller_of_many_rows_starts_from_a_coarser_mesh():
    """Without it the edge of the contact moves by a ring of nodes an iteration: 33 iterations."""
    tables = roller(BLEND)
    tables["mesh"]["points_per_half_width"] = [10, 320]
    assert Simulation(load(tables)).advance().newton < 10


@pytest.mark.parametrize("oil", [{}, OIL | {"mesh": OIL["mesh"] | {"points_per_half_width": [12, 30]}}])
def test_self_aligning_roller_finds_the_slope_hidden_in_its_profile(oil):
    y = np.linspace(-6e-3, 6e-3, 61)
    hidden = {"y": y.tolist(), "z": (5e-6 * (y / 6e-3) ** 2 + 1e-3 * y).tolist()}
    state = Simulation(load(roller(hidden, self_aligning=True) | oil)).advance()
    assert state.tilt == pytest.approx(-1e-3, rel=1e-6)
    assert state.newton < 10  # from the slope of the slices; in oil 17 from none
    assert state.moment == pytest.approx(0.0, abs=1e-6)


def test_film_of_the_middle_is_weighted_by_the_load_of_its_rows():
    grid = Scales.of(load(roller(ISO))).grid
    y, x = grid.coordinates
    film, pressure = np.where(y < 0.0, 1.0, 5.0), np.where(y < 0.0, 3.0, 1.0) * (np.abs(x) < 1.0)
    assert grid.mean_inside(film, 0.5, pressure) == pytest.approx((3.0 * 1.0 + 1.0 * 5.0) / 4.0)
    film[np.maximum(np.abs(y) / grid.half_widths[0], np.abs(x)) > 0.51] = 1e9  # beyond the middle half
    assert grid.mean_inside(film, 0.5, pressure) == pytest.approx(2.0)


def test_slices_under_another_load_and_radius_keep_the_profile():
    grid = Scales.of(load(roller(BLEND))).grid
    whole = np.pi * grid.half_widths[0]  # integral of the pressure, of which slices give the square root
    for share, radius in ((1.0, 1.0), (0.3, 1.0), (1.0, 0.5)):
        room = grid.rows(grid.room(share, radius))
        widest = room.max(axis=1) / radius  # load of each row over the mean
        assert widest[widest > 0.0].sum() == pytest.approx(60.0 * share, rel=2e-2)
    assert whole == pytest.approx(grid.load)
    narrow, wide = ((grid.room(share, 1.0) > 0.0).sum() for share in (0.3, 1.0))
    assert narrow < wide


def said(profile, **contact):
    tables = roller(profile, **contact) | OIL
    return explain(load(tables))


def test_ends_and_highest_load_are_said_before_the_run():
    text = said(ISO)
    assert "a roller, radius 0.006 m, length 12 mm, load 2400 N" in text
    assert "contact from y = -5.3" in text and "highest load per length 1.4" in text
    assert "reaches the end" not in text and "rows are too far apart" not in text
    text = said(BLEND)
    assert "beside it the gap opens by 1.6 films from one row to the next" in text
    assert "try mesh.points_per_half_width = [20, 338], 17.8 um" in text
    assert "one row to the next, the film there is too thin; try" in text
    text = said({"kind": "circular", "radius": 0.005, "straight": 0.0115})
    assert "films from one row to the next, which leaves no film there; try" in text
    text = said({"kind": "lundberg"})
    assert "the contact reaches the end of the roller, y = -6 mm and y = 6 mm" in text
    assert "rows are too far apart" not in text
    text = said(BLEND, tilt=0.5e-3)
    assert "mesh.outlet = 1.5 is near the highest load" in text
    near, words = copy.deepcopy(OIL), r"mesh.inlet = -1.6 is too near: .* it leaves (\d+) % of the film"
    near["mesh"]["inlet"] = -1.6  # of the mean load; 1.32 local half-widths at the highest one
    left = [int(re.search(words, explain(load(roller(one) | near)))[1]) for one in (ISO, None)]
    assert left == [74, 84]
    finer = copy.deepcopy(OIL) | {"mesh": OIL["mesh"] | {"points_per_half_width": [20, 400]}}
    assert "rows are too far apart" not in explain(load(roller(BLEND) | finer))


@pytest.mark.parametrize(
    ("contact", "mesh", "message"),
    [
        ({}, {"width": 2.1}, "mesh.width = 2.1: of a roller, in halves of its length; allowed: 2, as sharp"),
        ({"end_radius": 0.3e-3}, {"width": 1.9}, "mesh.width = 1.9: of a roller, .*; allowed: from 2 to 2.1"),
        ({"end_radius": 0.3e-3}, {"width": 2.2}, "mesh.width = 2.2"),
        ({"tilt": 2e-3}, {}, "mesh.inlet = -1.3: the dry contact is 1.5. a wide at the highest load"),
        ({"tilt": 2e-3}, {"inlet": -2.0}, "mesh.outlet = 1.3: the dry contact is"),
    ],
)
def test_meshes_that_do_not_fit_a_roller_are_refused(contact, mesh, message):
    tables = roller(ISO, **contact)
    tables["mesh"] |= {"inlet": -1.3, "outlet": 1.3} | mesh
    with pytest.raises(CaseError, match=message):
        Simulation(load(tables))


def test_rows_reach_as_far_beyond_round_ends_as_the_mesh():
    tables = roller(ISO, end_radius=0.3e-3)
    tables["mesh"]["width"] = 2.1
    assert len(Scales.of(load(tables)).grid.axes[0]) == 64  # two of 0.2 mm beyond each end, for 0.3 mm


def test_post_says_that_stresses_near_free_ends_are_those_of_half_spaces():
    def warnings_of(**contact):
        loads = SimpleNamespace(attrs={"status": "done"}, case=load(roller(ISO, **contact)))
        return list(_warnings(SimpleNamespace(loads=loads, motions={})))

    [text] = warnings_of()
    assert text.startswith("stresses near the ends: assumes half-spaces, and this case has free end faces")
    assert warnings_of(free_ends=False) == []


@pytest.mark.slow
def test_damage_is_computed_along_a_roller_with_a_rough_surface(tmp_path):
    wave = {"kind": "sine", "amplitude": 5e-8, "wavelength": 1e-4}
    contact = {"length": 4e-3, "load": 800.0, "material": "100Cr6", "profile": ISO, "tilt": 5e-4}
    case = DRY | OIL | {"fluid": OIL["fluid"] | {"eyring_stress": 5e6}, "time": {"travel": 4.5}}
    case |= {"contact": {"radius": R} | contact, "surface": {"1": {"synthetic": wave}}}
    case |= {"motion": {"entrainment_speed": 3.0, "slide_roll_ratio": 0.1}}
    case |= {"mesh": {"inlet": -2.0, "outlet": 1.8, "points_per_half_width": [8, 12]}}
    with ehlpetsc.solve(case, output=tmp_path / "roller.h5", options={}) as result:
        w = result.load_per_length(frame=-1)
    warned: list[str] = []
    paths = [str(tmp_path / name) for name in ("roller.h5", "roller.post.h5")]
    run(Job(*paths, ("1",), settings=("post.depths=[0.3]",)), warned.append)
    with h5py.File(tmp_path / "roller.post.h5") as file:
        ranges = np.nanmax(file["damage/1_peak_range"][0], axis=1)
    assert ranges.shape == (24,) and any("free end faces" in line for line in warned)
    middle, lower, upper = ranges[11], ranges[3], ranges[20]
    assert middle > 1.1 * max(lower, upper) and lower > upper  # as the load of a tilted roller
    assert w[11] > w[3] > w[20] > 0.0
