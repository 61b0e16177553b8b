"""Involute geometry, load sharing and losses of spur gears against published figures and closed forms."""

import math
from types import SimpleNamespace

import h5py
import numpy as np
import pytest
from support import is_line_with

from ehlpetsc.analysis.gear_run import FlankDamage, GearRun
from ehlpetsc.base.errors import CaseError, OutputError
from ehlpetsc.case.loading import load
from ehlpetsc.gears import GearPair, path_of_contact
from ehlpetsc.gears.command import main
from ehlpetsc.gears.load_sharing import relief_ratio
from ehlpetsc.gears.path import gear_loss_factor, loss, mean_friction, ohlendorf_loss_factor
from ehlpetsc.physics.scales import hertz_line, reduced_modulus
from ehlpetsc.pictures.gears import draw_damage
from ehlpetsc.post.stresses.body_points import body_points, passage

FZG = {  # type C
    "module": 4.5e-3,
    "teeth": [16, 24],
    "pressure_angle": 20.0,
    "centre_distance": 91.5e-3,
    "tip_diameter": [82.5e-3, 118.4e-3],
    "face_width": 14e-3,
    "torque": 302.0,
    "speed": 2250.0,
}
STEEL = reduced_modulus((206e9, 206e9), (0.3, 0.3))
CONTACT = """
[contact]
radius = 0.01
load = 1e5
youngs_modulus = [206e9, 206e9]
poisson_ratio = [0.3, 0.3]
[mesh]
inlet = -2.5
outlet = 1.5
points_per_half_width = 50
"""


@pytest.fixture
def case(tmp_path):
    """A case file with a [gears] table, its keys changed."""

    def write(**changes):
        given = {key: value for key, value in (FZG | changes).items() if value is not None}
        table = "".join(f"{key} = {value!r}\n" for key, value in given.items())
        path = tmp_path / "pair.toml"
        path.write_text('title = "FZG C"\n' + CONTACT + "[gears]\n" + table)
        return path

    return write


def at(path, name, values):
    return float(np.interp(path.time_at(name), path.time, values))


def test_command_takes_units_as_a_run_does(case, capsys):
    with_units = {
        "module": "4.5 mm",
        "tip_diameter": ["82.5 mm", 0.1184],
        "torque": "302 Nm",
        "speed": "2250 rpm",
    }
    printed = []
    for path in (case(), case(**with_units)):
        assert main([str(path), "--no-picture"]) == 0
        printed.append(capsys.readouterr().out)
    assert printed[0] == printed[1]
    assert main([str(case(module="4.5 kg")), "--no-picture"]) == 2
    assert 'gears.module = "4.5 kg": not a unit' in capsys.readouterr().err


@pytest.mark.parametrize(
    ("point", "radius", "speed", "sliding"),
    [
        ("A", 3.871, 2.917, -1.284),
        ("B", 7.270, 3.148, -0.455),
        ("C", 8.382, 3.292, 0.0),
        ("D", 8.729, 3.439, 0.428),
        ("E", 7.651, 3.670, 1.031),
    ],
)
def test_fzg_type_c_has_the_published_path(point, radius, speed, sliding):
    path = path_of_contact(FZG)
    assert 1e3 * at(path, point, path.radius) == pytest.approx(radius, rel=1e-3)
    assert at(path, point, path.entrainment) == pytest.approx(speed, rel=1e-3)
    assert at(path, point, path.slide_roll_ratio) == pytest.approx(sliding, rel=1e-3, abs=1e-12)


def test_fzg_type_c_has_the_published_angle_ratio_and_load():
    path = path_of_contact(FZG)
    assert path.pressure_angle == pytest.approx(22.439, abs=5e-4)
    assert path.contact_ratio == pytest.approx(1.443, abs=5e-4)
    assert at(path, "C", path.load) == pytest.approx(637.7e3, rel=1e-4)
    a, p0 = hertz_line(at(path, "C", path.load), at(path, "C", path.radius), STEEL)
    assert a == pytest.approx(0.2452e-3, rel=1e-3) and p0 == pytest.approx(1.656e9, rel=1e-3)


@pytest.mark.parametrize(
    ("torque", "pressure"),
    [(70.0, 0.795), (98.9, 0.945), (132.5, 1.093), (171.6, 1.245), (215.6, 1.395), (265.1, 1.547)],
)
def test_fva_54_7_load_stages_have_published_pressures(torque, pressure):
    path = path_of_contact(FZG | {"torque": torque})
    p0 = hertz_line(at(path, "C", path.load), at(path, "C", path.radius), STEEL)[1]
    assert 1e-9 * p0 == pytest.approx(pressure, rel=1e-2)


def test_speeds_are_the_derivatives_of_the_arcs_on_both_flanks():
    path = path_of_contact(FZG)
    for speed, arc in zip((path.speed_1, path.speed_2), path.pair.flank_arcs(path.rho), strict=True):
        # speeds are linear in time: the trapezoidal rule is exact
        swept = np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(path.time))
        np.testing.assert_allclose(arc[1:], swept, rtol=1e-9)


def test_no_sliding_at_the_pitch_point():
    pair = path_of_contact(FZG).pair
    u_1, u_2 = pair.speeds(pair.points["C"])
    omega_1, pitch_radius = pair.angular_speeds[0], 91.5e-3 * 16 / 40
    assert u_1 == pytest.approx(u_2, rel=1e-14)
    assert u_1 == pytest.approx(omega_1 * pitch_radius * math.sin(pair.working_angle), rel=1e-14)


def test_without_relief_the_shared_load_rises_from_one_third_to_two_thirds():
    path = path_of_contact(FZG)
    load = path.load / path.pair.normal_load
    assert load[0] == pytest.approx(1 / 3) and load[-1] == pytest.approx(1 / 3)
    points = path.pair.points
    alone = (path.rho >= points["B"]) & (path.rho <= points["D"])
    assert (load[alone] == 1.0).all() and (load[~alone] < 1.0).all()
    middle = 0.5 * (path.time_at("A") + path.time_at("B"))
    assert np.interp(middle, path.time, load) == pytest.approx(0.5, rel=1e-12)


@pytest.mark.parametrize("relief", [1e-6, 20e-6, 45.5e-6, 80e-6])
def test_tip_relief_starts_the_load_at_zero(relief):
    path = path_of_contact(FZG | {"tip_relief": relief})
    pair = path.pair
    load = path.load / pair.normal_load
    assert load[0] == load[-1] == 0.0 and load.max() == 1.0
    both = path.rho <= pair.points["B"]
    behind = np.interp(path.rho[both] + pair.base_pitch, path.rho, load)
    np.testing.assert_allclose(load[both] + behind, 1.0, atol=1e-12)
    steepest = np.abs(np.diff(load) / np.diff(path.rho)).max() * (pair.points["B"] - pair.points["A"])
    ratio = max(relief_ratio(pair), 0.05)
    assert steepest == pytest.approx(max(ratio, 1.0 / ratio), rel=1e-6)


def test_relief_of_a_third_of_the_deflection_shares_in_thirds():
    """c' C_a/w' = 1/3 is the elastic line from one third to two thirds."""
    pair = path_of_contact(FZG).pair
    relieved = path_of_contact(FZG | {"tip_relief": pair.normal_load / pair.mesh_stiffness / 3.0})
    plain = path_of_contact(FZG)
    for share in (0.3, 0.5, 0.7):
        rho = (1 - share) * pair.points["A"] + share * pair.points["B"]
        assert np.interp(rho, relieved.rho, relieved.load) == pytest.approx(
            np.interp(rho, plain.rho, plain.load), rel=1e-12
        )


def test_loss_factors():
    plain = path_of_contact(FZG)
    assert ohlendorf_loss_factor(plain.pair) == pytest.approx(0.1958, abs=5e-5)
    # relief equal to the deflection: the share is linear from A to B, and sliding from C on
    path = path_of_contact(FZG | {"tip_relief": plain.pair.normal_load / plain.pair.mesh_stiffness})
    points = path.pair.points
    rho = np.linspace(points["A"], points["E"], 200_001)
    incoming = (rho - points["A"]) / (points["B"] - points["A"])
    leaving = (points["E"] - rho) / (points["E"] - points["D"])
    share = np.minimum(np.minimum(incoming, leaving), 1.0)
    sliding = np.abs(rho - points["C"]) * sum(path.pair.angular_speeds) / path.pair.base_speed
    expected = (share * sliding).mean() * path.contact_ratio
    assert gear_loss_factor(path) == pytest.approx(expected, rel=1e-4)
    friction = 0.04 + 0.01 * path.rho / path.rho[-1]
    assert 0.04 < mean_friction(path, friction) < 0.05
    assert loss(path, 0.05) == pytest.approx(0.05 * gear_loss_factor(path), rel=1e-12)


@pytest.mark.parametrize(("teeth", "partners"), [((16, 24), 3), ((17, 24), 24), ((20, 20), 1)])
def test_hunting_teeth(teeth, partners):
    pair = GearPair(**(FZG | {"teeth": teeth}))
    assert pair.partners == partners
    if teeth == (16, 24):
        assert pair.hunting_shift == pytest.approx(pair.flank_arcs(pair.points["E"])[1], rel=1e-14)
    if partners == 1:
        assert pair.hunting_shift == 0.0


@pytest.mark.parametrize(
    ("change", "parts"),
    [
        ({"tip_diameter": [72e-3, 108e-3]}, ["tip_diameter = [0.072, 0.108]: ", " 0.0915 m"]),
        (
            {"tip_diameter": [78e-3, 114e-3]},
            ["tip_diameter = [0.078, 0.114]: contact ratio 0.786, ", " 1 to 2"],
        ),
        ({"tip_diameter": [60e-3, 118.4e-3]}, ["tip_diameter = 0.06 of the pinion: ", " 0.067658 m"]),
        ({"tip_diameter": [82.5e-3, 130e-3]}, ["tip_diameter: ", "(interference)", " wheel: below 0.1232 m"]),
        ({"centre_distance": 80e-3}, ["centre_distance = 0.08: ", " 0.084572 m"]),
        ({"load_sharing": "tip-relief"}, ["tip_relief ", "missing"]),
    ],
)
def test_impossible_geometry_is_refused_in_one_line(change, parts, case, capsys):
    with pytest.raises(CaseError) as error:
        path_of_contact(FZG | change)
    assert len(error.value.faults) == 1 and is_line_with(error.value.faults[0], *parts)
    assert main([str(case(**change))]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_one_modulus_for_both_flanks_gives_the_whole_path(case):
    """The run was one half width long."""
    alike = {"contact.youngs_modulus": 206e9, "contact.poisson_ratio": 0.3}
    assert load(case(), alike).time.travel == load(case()).time.travel > 10.0


def test_gears_prints_the_table_and_writes_picture_and_csv(case, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = case(tip_relief=20e-6)
    assert main([str(path), "--csv", "mesh.csv"]) == 0
    printed = capsys.readouterr().out
    assert "contact ratio 1.443" in printed
    (line,) = (line for line in printed.splitlines() if line.startswith("R, mm"))
    assert [float(word) for word in line.split()[2:]] == pytest.approx(
        [3.871, 7.270, 8.382, 8.729, 7.651], rel=1e-3
    )
    assert (tmp_path / "pair.path.png").read_bytes().startswith(b"\x89PNG")
    assert not (tmp_path / "pair.gears.png").exists()  # the name of the picture of its result
    rows = np.loadtxt(tmp_path / "mesh.csv", delimiter=",", skiprows=1)
    assert rows[0, 0] == 0.0 and (np.diff(rows[:, 0]) > 0).all() and (rows[:, 1] > 0).all()
    assert main(["no.toml"]) == 2
    assert is_line_with(capsys.readouterr().err, "no.toml: ", "No such file")


def test_scalars_are_averaged_over_a_fiftieth_of_the_path():
    k = np.arange(301.0)
    found = GearRun.averaged(SimpleNamespace(rho=k), k**2)[3:-3]  # over three steps either side
    np.testing.assert_allclose(found, k[3:-3] ** 2 + 4.0)


def test_flank_damage_is_indexed_by_arc_length_and_depth(tmp_path):
    path = path_of_contact(FZG)
    with h5py.File(tmp_path / "run.post.h5", "w") as file:
        file.attrs["a"] = 0.25e-3
        s = np.linspace(-8e-3, 0.0, 81)
        file["damage/s"], file["damage/z_over_a"] = s, [0.0, 0.1]
        damage = np.full((2, 81), np.nan)
        damage[1, 20] = 2e-3  # s = -6 mm
        damage[0, 60] = 1e-3
        file["damage/1"], file["damage/2"] = damage, 0.5 * damage
    found = FlankDamage(tmp_path / "run.post.h5", (1e-5, 5e-5))
    assert found.arcs[0][0] == pytest.approx(1e-5) and (np.diff(found.arcs[1]) > 0).all()
    pinion, wheel = found.lines()
    assert is_line_with(pinion, "pinion: 0.002 ", " 6.010 mm from A, 25.0 um ")
    assert is_line_with(wheel, "wheel: 0.001 ", " 6.050 mm from A, 25.0 um ")
    draw_damage(found, path.pair, tmp_path / "flanks.png", "made")
    assert (tmp_path / "flanks.png").stat().st_size > 10_000
    (tmp_path / "bad.post.h5").write_bytes(b"no HDF5")
    with pytest.raises(OutputError, match="bad.post.h5"):
        FlankDamage(tmp_path / "bad.post.h5", (0.0, 0.0))


def test_flank_points_pass_the_contact_over_the_whole_path():
    x, moved = np.linspace(-3.0, 1.5, 46), np.linspace(0.0, 20.0, 100)
    s = body_points(x, 0.1, [moved])
    through = s[passage(s, x, 0.1, moved).complete]
    assert (through[0], through[-1]) == pytest.approx((-18.5, -3.0))
    flank = s[passage(s, x, 0.1, moved, (-20.0, 0.0)).complete]
    assert (flank[0], flank[-1]) == pytest.approx((-20.0, 0.0))
