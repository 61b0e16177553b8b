"""Areal maps as files: read, filled, levelled, filtered, turned, or refused with the key that settles it."""

import io
import os
import pickle
import re
import struct
import sys
import zipfile
from dataclasses import replace
from types import ModuleType

import numpy as np
import pytest
from support import CASES, one_fault, optional

from ehlpetsc.base.errors import CaseError, ProfileError
from ehlpetsc.case.checking import values_of
from ehlpetsc.case.loading import load
from ehlpetsc.case.tables.surface import PROFILE
from ehlpetsc.physics.scales import Scales
from ehlpetsc.results.exports import GridField, x3p
from ehlpetsc.run.forecast.validity import warnings
from ehlpetsc.surfaces.files.areal import gap_width, is_map, read_map
from ehlpetsc.surfaces.files.profiles import Layout
from ehlpetsc.surfaces.filters import smoothed, without_form
from ehlpetsc.surfaces.samples import areal_samples, inscribed, turned

DX, DY = 2e-6, 3e-6
X, Y = DX * np.arange(60), DY * np.arange(40)
Z = 1e-7 * np.cos(X / 9e-6) * np.sin(Y / 2e-5)[:, np.newaxis]
SPACED = Layout(spacing=DX, spacing_across=DY)


def as_text(z, separator="\t"):
    return "\n".join(separator.join(f"{v:.9e}" for v in row) for row in z)


def write_text(path, z):
    path.write_text("# heights\n" + as_text(z))


def write_x3p(path, z):
    optional("SurfaceTopography")  # by which it is read
    path.write_bytes(x3p(GridField(z, DX, DY)))


def write_sdf(path, z):
    """ASCII SDF of ISO 25178-71, heights in nm."""
    ny, nx = z.shape
    entries = {"NumPoints": nx, "NumProfiles": ny, "Xscale": DX, "Yscale": DY, "Zscale": 1e-9, "DataType": 7}
    head = "".join(f"{name} = {value}\n" for name, value in entries.items())
    heights = " ".join("BAD" if np.isnan(value) else f"{1e9 * value:.12g}" for value in z.ravel())
    path.write_text(f"aISO-1.0\n{head}*\n{heights}\n*\nmade up\n*\n")


def write_binary_sdf(path, z, kind=7, scale=1e-9, version=1):
    stored = np.dtype({3: "<f4", 5: "<i2", 6: "<i4", 7: "<f8"}[kind])
    lowest = np.iinfo(stored).min if stored.kind == "i" else np.finfo(stored).min
    count = "I" if version > 1 else "H"
    head = struct.pack(
        f"<8s34s{count}{count}4d3B",
        f"bISO-{version}.0".encode(),
        b"",
        *z.shape[::-1],
        DX,
        DY,
        scale,
        0,
        0,
        kind,
        0,
    )
    data = np.where(np.isnan(z), 0.0, z / scale)
    data = (np.rint(data) if stored.kind == "i" else data).astype(stored)
    path.write_bytes(head + np.where(np.isnan(z), lowest, data).astype(stored).tobytes())


FORMATS = {
    ".npy": (np.save, SPACED),
    ".txt": (write_text, SPACED),
    ".x3p": (write_x3p, Layout()),
    ".sdf": (write_sdf, Layout()),
    "b.sdf": (write_binary_sdf, Layout()),
}


@pytest.mark.parametrize(
    ("kind", "scale", "version", "exact"), [(3, 1e-9, 1, 1e-14), (5, 1e-11, 1, 1e-11), (6, 1e-13, 2, 1e-13)]
)
def test_a_binary_sdf_has_numbers_of_any_type(tmp_path, kind, scale, version, exact):
    write_binary_sdf(tmp_path / "map.sdf", Z, kind, scale, version)
    found = read_map(tmp_path / "map.sdf")
    np.testing.assert_allclose(found.z, Z, rtol=0, atol=exact)
    assert (found.dx, found.dy) == pytest.approx((DX, DY))
    content = (tmp_path / "map.sdf").read_bytes()
    for faulty, message in (
        (content[:-1], "^SDF: 2399 heights, NumPoints NumProfiles = 2400 "),
        (content[:40], "^SDF: its header is not complete"),
        (content.replace(bytes([0, kind, 0]), bytes([1, kind, 0]), 1), "^SDF: compression 1, data type "),
    ):
        (tmp_path / "faulty.sdf").write_bytes(faulty)
        with pytest.raises(ProfileError, match=message):
            read_map(tmp_path / "faulty.sdf")


@pytest.mark.parametrize("suffix", FORMATS)
def test_formats_give_the_same_map_with_missing_heights_filled(tmp_path, suffix):
    path, (write, layout) = tmp_path / f"map{suffix}", FORMATS[suffix]
    write(path, Z)
    z, dx, dy, notes = read_map(path, layout)
    np.testing.assert_allclose(z, Z, rtol=0, atol=1e-16)
    assert (dx, dy) == pytest.approx((DX, DY)) and notes == ()
    holed = Z.copy()
    holed[10:13, 20:24] = holed[30, 5] = holed[-2:] = np.nan
    write(path, holed)
    z, *_, notes = read_map(path, replace(layout, fill_gaps=8.1e-6))
    assert z.shape == (38, 60)  # the last two rows are missing altogether
    np.testing.assert_allclose(z, Z[:-2], rtol=0, atol=0.03e-7)
    assert notes == ("133 missing heights filled or, at the edges, cut off; widest gap 8 um",)
    with pytest.raises(ProfileError, match=r"^133 .*widest gap 8e-06 m; write fill_gaps = 8\.5e-06 "):
        read_map(path, layout)


class StoredByPackage:
    """What SurfaceTopography returns: heights over (x, y), in a unit of length."""

    dim, unit, pixel_size = 2, "um", (1e6 * DX, 1e6 * DY)

    def __init__(self, z, factor=1e6):
        self.z, self.factor = z, factor

    def to_unit(self, unit):
        assert unit == "m"
        found = type(self)(self.z, 1.0)
        found.pixel_size = DX, DY
        return found

    def heights(self):
        return np.ma.masked_invalid(self.factor * self.z.T)

    def positions_and_heights(self):
        return X, self.factor * self.z


def with_package(monkeypatch, found):
    package = ModuleType("SurfaceTopography")
    package.read_topography = lambda path: found
    monkeypatch.setitem(sys.modules, "SurfaceTopography", package)


@pytest.mark.parametrize("suffix", [".sur", ".al3d", ".plux", ".opd", ".xlsx"])
def test_surface_topography_reads_other_formats(tmp_path, monkeypatch, suffix):
    path = tmp_path / f"map{suffix}"
    path.touch()
    holed = Z.copy()
    holed[10:13, 20:24] = np.nan
    with_package(monkeypatch, StoredByPackage(holed))
    z, dx, dy, notes = read_map(path, Layout(fill_gaps=1e-5))
    np.testing.assert_allclose(z[~np.isnan(holed)], Z[~np.isnan(holed)], rtol=1e-12)
    assert (dx, dy) == pytest.approx((DX, DY)) and notes[0].startswith("12 missing heights filled")


def test_a_profile_of_a_roughness_meter_is_ridges_and_a_file_without_a_unit_refused(tmp_path, monkeypatch):
    path = tmp_path / "p.xlsx"
    path.touch()
    found = StoredByPackage(Z[3])
    found.dim = type(found).dim = 1
    monkeypatch.setattr(StoredByPackage, "dim", 1)
    with_package(monkeypatch, found)
    surface = areal_samples(tmp_path, spec(path), 1e-4, False)
    assert surface.is_ridge and not is_map(path, Layout())
    np.testing.assert_allclose(surface.z[0], Z[3] - Z[3].mean(), atol=1e-20)
    with pytest.raises(ProfileError, match="^a profile; allowed here: a map$"):
        read_map(path)
    found.unit = None
    os.utime(path, (1, 1))
    with pytest.raises(ProfileError, match="^no unit of length in it; allowed: "):
        read_map(path)


@pytest.mark.parametrize("suffix", [".x3p", ".plux", ".nms"])
def test_a_missing_package_is_named(tmp_path, monkeypatch, suffix):
    monkeypatch.setitem(sys.modules, "SurfaceTopography", None)
    path = tmp_path / f"map{suffix}"
    path.touch()
    with pytest.raises(ProfileError, match=r"pip install SurfaceTopography\).* \.npy or text, a matrix"):
        read_map(path)


@pytest.mark.parametrize("suffix", [".npz", ".mat", ".xls", ".jpg", ".vti"])
def test_a_format_without_a_reader_is_refused_whatever_is_stated(tmp_path, suffix):
    path = tmp_path / f"map{suffix}"
    path.touch()
    for layout in (Layout(), SPACED):
        with pytest.raises(ProfileError, match=rf"^format '\{suffix}' is not read; allowed: \.npy or text, "):
            read_map(path, layout)


def test_a_file_of_no_format_is_refused_in_one_sentence_whatever_readers_print(tmp_path, capsys):
    optional("SurfaceTopography")
    path = tmp_path / "map.x3p"
    path.write_bytes(b"\x01\x02 nothing")
    with pytest.raises(ProfileError, match="^of no format that the installed SurfaceTopography"):
        read_map(path)
    assert capsys.readouterr().out == ""


def keyence(files):
    """Keyence's archive: a mark, the size of a picture, which is empty here, and a ZIP archive."""
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w") as archive:
        for name, data in files.items():
            archive.writestr(name, data)
    return b"KPK0" + bytes(4) + content.getvalue()


@pytest.mark.parametrize("count", [1, 2])
def test_a_container_of_one_measurement_is_read(tmp_path, count):
    optional("SurfaceTopography")
    heights = np.rint(Z / 1e-10).astype("<i4")
    units = (
        f"<C><XYCalibration><MeterPerPixel>{DX}</MeterPerPixel></XYCalibration>"
        "<ZCalibration><MeterPerUnit>1e-10</MeterPerUnit></ZCalibration></C>"
    )
    map_file = keyence(
        {
            "686613b8-27b5-4a29-8ffc-438c2780873e": units,
            "4cdb0c75-5706-48cc-a9a1-adf395d609ae": np.array([60, 40, 4, 240], "<i4").tobytes()
            + heights.tobytes(),
        }
    )
    data = "<MeasurementData><Path>map</Path></MeasurementData>"
    path = tmp_path / "lot.zag"
    path.write_bytes(
        keyence(
            {
                "f1724dc6-686c-4502-9227-2a594bc8ed33": (
                    "<DeserializeDataMap><Item><Path>d/list</Path></Item></DeserializeDataMap>"
                ),
                "d/list": f"<MeasurementDataMap>{count * data}</MeasurementDataMap>",
                "d/map/84b648d7-e44f-4909-ac11-0476720a67ff": map_file,
            }
        )
    )
    if count > 1:
        with pytest.raises(ProfileError, match="^2 measurements in it; allowed: one; "):
            read_map(path)
        return
    z, dx, dy, _ = read_map(path)
    np.testing.assert_allclose(z, Z, rtol=0, atol=0.51e-10)
    assert dx == pytest.approx(DX) and dy == pytest.approx(DX)


def test_a_damaged_file_is_refused(tmp_path, monkeypatch):
    def fail(path):
        raise IndexError("list index out of range")

    package = ModuleType("SurfaceTopography")
    package.read_topography = fail
    monkeypatch.setitem(sys.modules, "SurfaceTopography", package)
    path = tmp_path / "map.nms"
    path.write_bytes(b"\x01\x02 nothing")
    with pytest.raises(ProfileError, match="^SurfaceTopography cannot read it: list index out of range"):
        read_map(path)


def test_units_named_in_a_header_are_asked_for_and_profiles_refused(tmp_path):
    (tmp_path / "map.txt").write_text("scan [um]\n" + as_text(1e6 * Z))
    with pytest.raises(ProfileError, match="^its header names um; write unit "):
        read_map(tmp_path / "map.txt", SPACED)
    np.testing.assert_allclose(read_map(tmp_path / "map.txt", replace(SPACED, unit="um")).z, Z, atol=1e-15)
    path = tmp_path / "p.x3p"
    path.touch()
    with pytest.raises(
        ProfileError, match=r"^spacing: for text files alone, '\.x3p' includes it; leave it out$"
    ):
        read_map(path, SPACED)


INFINITE, HOLES = Z.copy(), np.where(np.random.default_rng(1).random(Z.shape) < 0.6, np.nan, Z)
INFINITE[4, 6] = np.inf
SMALL = "^[0-9 x]* heights; allowed: a matrix of 4 x 4 or more$"
REFUSED = {
    "without spacing": (Z, Layout(), "^a matrix of heights needs spacing = "),
    "infinite": (INFINITE, SPACED, "^row 5, column 7 is not a height below "),
    "three rows": (Z[:3], SPACED, SMALL),
    "one dimension": (Z[0], SPACED, SMALL),
    "three dimensions": (Z[np.newaxis], SPACED, SMALL),
    "words": (np.full((5, 5), "a"), SPACED, "^numbers of type <U1; allowed: "),
    "mostly missing": (HOLES, replace(SPACED, fill_gaps=1.0), "missing; allowed: no more than half "),
}


@pytest.mark.parametrize(("z", "layout", "message"), REFUSED.values(), ids=REFUSED)
def test_a_faulty_matrix_is_refused(tmp_path, z, layout, message):
    np.save(tmp_path / "map.npy", z)
    with pytest.raises(ProfileError, match=message):
        read_map(tmp_path / "map.npy", layout)


def npy_bytes(z=Z, save=np.save):
    file = io.BytesIO()
    save(file, z)
    return file.getvalue()


NO_MATRIX = "^not a matrix as numpy.save writes it; allowed under .npy: one of real numbers$"
DAMAGED = {
    "archive": (npy_bytes(save=np.savez), NO_MATRIX),
    "damaged archive": (npy_bytes(save=np.savez)[:900], NO_MATRIX),
    "empty": (b"", NO_MATRIX),
    "pickle": (pickle.dumps(Z.tolist()), NO_MATRIX),
    "no header": (npy_bytes()[:9], "^numpy cannot read it: "),
    "half of a header": (npy_bytes().replace(b"fortran_order", b"f(rtran_order"), "^numpy cannot read it: "),
    "half of the heights": (npy_bytes()[:9000], "^numpy cannot read it: "),
    "no memory": (npy_bytes().replace(b"(40, 60), }      ", b"(40, 60000000000)"), "^numpy cannot read it: "),
    "objects": (npy_bytes(np.array([[{}] * 4] * 4)), "^numpy cannot read it: "),
}


@pytest.mark.parametrize(("content", "message"), DAMAGED.values(), ids=DAMAGED)
def test_a_file_that_is_no_npy_matrix_is_refused_in_one_sentence(tmp_path, content, message):
    (tmp_path / "map.npy").write_bytes(content)
    with pytest.raises(ProfileError, match=message) as caught:
        read_map(tmp_path / "map.npy", SPACED)
    assert "\n" not in str(caught.value)


def test_a_value_far_from_all_others_is_no_height_and_gaps_are_as_wide_as_a_circle(tmp_path):
    z = Z + 1e-9 * np.random.default_rng(2).standard_normal(Z.shape)
    z[10:13, 20:24] = z[30, 5] = 9.999e-3
    np.save(tmp_path / "map.npy", z)
    with pytest.raises(ProfileError, match=r"^13 heights missing, 13 of them the value 0\.009999 far from "):
        read_map(tmp_path / "map.npy", SPACED)
    found = read_map(tmp_path / "map.npy", replace(SPACED, fill_gaps=9e-6))
    np.testing.assert_allclose(found.z, Z, rtol=0, atol=0.05e-7)
    z[10, 20:24], z[11, 20:24] = 9.998e-3, 9.997e-3
    np.save(tmp_path / "map.npy", z)
    several = r"^13 heights missing, 13 of them of 3 values, 0\.009997 to 0\.009999, far from all others"
    with pytest.raises(ProfileError, match=several):
        read_map(tmp_path / "map.npy", SPACED)
    missing = np.zeros((40, 60), bool)
    missing[10:13] = True  # a scratch: four rows apart are present
    assert gap_width(missing, DX, DY) == pytest.approx(2 * 2 * DY)


@pytest.mark.parametrize("across", [1.5, 6.0, 0.2])  # spacing over that along
def test_spikes_of_a_map_are_bridged_and_ridges_are_not(tmp_path, across):
    axes, noise = (DX * np.arange(120), DX * np.arange(150)), np.random.default_rng(2)
    z = smoothed(axes, noise.standard_normal((120, 150)), 9 * DX, "short_cutoff")
    z = 1e-7 * (z / z.std() + 0.01 * np.random.default_rng(3).standard_normal(z.shape))
    z[40] += 2e-6  # a scratch along a row
    spoilt = z.copy()
    spoilt[70:73, 20:23] += 3e-6
    spoilt[100, 140] -= 3e-6
    np.save(tmp_path / "map.npy", spoilt)
    layout = replace(SPACED, spacing_across=across * DX, bridge_spikes=True)
    found = read_map(tmp_path / "map.npy", layout)
    assert found.notes[0] == "spikes: 10 points in all, bridged"
    np.testing.assert_allclose(found.z, z, rtol=0, atol=2e-7)
    # two side by side are wider than one along the finer spacing, but not along the coarser one
    first, second = ((slice(70, 75), slice(k, k + 4)) for k in (20, 24))
    if across < 1.0:
        first, second = ((slice(k, k + 4), slice(20, 25)) for k in (70, 74))
    spoilt = z.copy()
    spoilt[first] += 3e-6
    spoilt[second] -= 3e-6
    np.save(tmp_path / "map.npy", spoilt)
    assert read_map(tmp_path / "map.npy", layout).notes[0] == "spikes: 40 points in all, bridged"


def test_gaps_of_an_inclined_map_are_filled_exactly_and_equal_heights_at_its_edges_kept(tmp_path):
    plane = 1e-3 * X + 2e-3 * Y[:, np.newaxis]
    holed = plane.copy()
    holed[10:20, 20:40] = np.nan
    np.save(tmp_path / "map.npy", holed)
    z = read_map(tmp_path / "map.npy", replace(SPACED, fill_gaps=1e-3)).z
    np.testing.assert_allclose(z, plane, rtol=0, atol=1e-16)
    tilted = np.repeat(Z[::4], 4, axis=0) + 1e-2 * X
    np.save(tmp_path / "map.npy", tilted)
    np.testing.assert_array_equal(read_map(tmp_path / "map.npy", SPACED).z, tilted)


@pytest.mark.parametrize("degree", [1, 2, 4])
def test_form_of_its_degree_is_subtracted_exactly(degree):
    x, y = X / X[-1], (Y / Y[-1])[:, np.newaxis]
    form = 1e-6 * (x + 3 * y) ** degree - 2e-6 * y
    np.testing.assert_allclose(without_form((Y, X), form, degree), 0.0, atol=1e-18)
    rough = without_form((Y, X), Z, degree)
    np.testing.assert_allclose(without_form((Y, X), Z + form, degree), rough, atol=1e-18)
    if degree > 1:
        assert np.abs(without_form((Y, X), form, degree - 1)).max() > 1e-8


@pytest.mark.parametrize("waves", [(6, 0), (0, 5), (6, 5)])
def test_the_areal_filter_has_the_transmission_of_iso_16610_61(waves):
    kx, ky = np.pi * waves[0] / X[-1], np.pi * waves[1] / Y[-1]
    wave = np.cos(kx * X) * np.cos(ky * Y)[:, np.newaxis]  # mirrored at its edges it goes on as a wave
    cutoff = 30e-6
    left = 2.0 ** -((cutoff * np.hypot(kx, ky) / (2 * np.pi)) ** 2)
    np.testing.assert_allclose(smoothed((Y, X), wave, cutoff, "cutoff"), left * wave, atol=1e-12)


def test_a_cutoff_above_the_width_is_refused():
    with pytest.raises(ProfileError, match=r"^cutoff = 0\.000118 m; allowed: at most .* 0\.000117 m"):
        smoothed((Y, X), Z, 118e-6, "cutoff")


@pytest.mark.parametrize(("angle", "turns"), [(0, 0), (90, 1), (180, 2), (270, 3), (-90, 3), (360, 0)])
def test_quarters_of_a_turn_are_exact(angle, turns):
    z, dx, dy = turned(Z, DX, DY, angle)
    assert (dx, dy) == ((DY, DX) if turns % 2 else (DX, DY))
    np.testing.assert_array_equal(z, np.rot90(Z, -turns))


@pytest.mark.parametrize("angle", [30.0, 90.0, 135.0, -20.0, 250.0])
def test_rows_of_a_turned_map_lie_in_their_direction(angle):
    fine = 0.5e-6
    z = np.broadcast_to(np.sin(fine * np.arange(300) / 9e-6), (200, 300))  # waves that run along the rows
    z, dx, dy = turned(z, fine, fine, angle)
    k = np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))]) / 9e-6
    along_y, along_x = np.gradient(z, dy, dx)
    inner = slice(5, -5), slice(5, -5)
    cross = along_x * k[1] - along_y * k[0]
    size = np.hypot(along_x, along_y).max() * np.hypot(*k)
    np.testing.assert_allclose(cross[inner], 0.0, atol=2e-3 * size)


def test_the_inscribed_rectangle_touches_the_turned_map():
    for length, width in ((3.0, 1.0), (1.0, 3.0), (2.0, 1.9)):
        for angle in np.radians([0.1, 20.0, 45.0, 70.0, 89.9]):
            c, s = np.cos(angle), np.sin(angle)
            sides = np.array(inscribed(length, width, c, s))
            reach = np.array([[c, s], [s, c]]) @ sides  # of its corners in the map
            assert (reach <= np.array([length, width]) * (1 + 1e-9)).all()
            assert (reach >= np.array([length, width]) * (1 - 1e-9)).any()


def spec(path, **keys):
    return values_of(PROFILE, {"file": path.name} | keys)


def test_keys_of_a_map_are_applied_in_order_and_a_strip_has_its_period(tmp_path):
    path = tmp_path / "map.npy"
    np.save(path, Z + 1e-3 * X + 5e-6)
    keys = {"spacing": DX, "spacing_across": DY}
    raw = areal_samples(tmp_path, spec(path, **keys), 1e-4, False)
    assert raw.notes[-1].startswith("mean height of 5.0") and abs(raw.z.mean()) < 1e-18
    level = areal_samples(tmp_path, spec(path, **keys, level=True), 1e-4, False)
    np.testing.assert_allclose(level.z, without_form((Y, X), Z, 1), atol=1e-17)
    assert level.middle == pytest.approx(0.5 * Y[-1]) and level.measured
    flipped = areal_samples(tmp_path, spec(path, **keys, level=True, flip=True, scale=-2), 1e-4, False)
    np.testing.assert_allclose(flipped.z, -2 * level.z[::-1, ::-1], atol=1e-17)
    smoothed = areal_samples(tmp_path, spec(path, **keys, form=2, short_cutoff=40e-6), 1e-4, False)
    assert 0.65 < smoothed.sq / level.sq < 0.75 and smoothed.notes[0].startswith("short_cutoff: Sa 0.0")
    np.save(tmp_path / "map.npy", Z)
    keys = {"spacing": DX, "spacing_across": DY}
    strip = areal_samples(tmp_path, spec(tmp_path / "map.npy", **keys), 90e-6, True)
    assert strip.Y[-1] - strip.Y[0] == pytest.approx(45e-6)
    beside = spec(tmp_path / "map.npy", spacing=DX, position_across=1e-3)
    message = r"^position_across = 0\.001 m; allowed: on the map, from 0 to 7\.8e-05 m"
    with pytest.raises(ProfileError, match=message):
        areal_samples(tmp_path, beside, 1e-4, False)


def test_a_profile_in_a_file_is_a_ridge_and_a_matrix_in_the_case_a_map(tmp_path):
    path = tmp_path / "p.csv"
    np.savetxt(path, np.transpose([X, Z[7] - Z[7].mean()]), delimiter=",")
    ridge = areal_samples(tmp_path, spec(path), 1e-4, False)
    assert ridge.is_ridge
    np.testing.assert_allclose(ridge.z[0], Z[7] - Z[7].mean(), atol=1e-22)
    with pytest.raises(ProfileError, match="^direction: of a map, not of a profile$"):
        areal_samples(tmp_path, spec(path, direction=10.0), 1e-4, False)
    keys = {"z": (1e6 * Z).tolist(), "unit": "um", "level": True}
    by_axes = values_of(PROFILE, keys | {"x": (1e6 * X).tolist(), "y": (1e6 * Y).tolist()})
    by_spacing = values_of(PROFILE, keys | {"spacing": DX, "spacing_across": DY})
    first, second = (areal_samples(None, found, 1e-4, False) for found in (by_axes, by_spacing))
    np.testing.assert_allclose(first.z, without_form((Y, X), Z, 1), atol=1e-18)
    np.testing.assert_allclose(second.z, first.z, atol=1e-18)
    assert (first.dx, first.dy) == pytest.approx((DX, DY))
    keys = {"z": Z[:4].tolist(), "x": (X**1.1).tolist(), "y": [0.0, 1.0, 2.0, 3.0]}
    with pytest.raises(ProfileError, match="^x: allowed for a map: equally spaced, increasing$"):
        areal_samples(None, values_of(PROFILE, keys), 1e-4, False)


ROWS, AXES = [[0.0, 1.0, 0.0, 1.0]] * 4, {"x": [0, 1, 2, 3], "y": [0, 1, 2, 3], "spacing": None}
REFUSED_MATRICES = {
    "rows of different lengths": ({"z": [*ROWS[:3], [0.0] * 5]}, "z = .* allowed: "),
    "three rows": ({"z": ROWS[:3]}, "z = .* allowed: "),
    "words": ({"z": [["a"] * 4] * 4}, "z = .* allowed: "),
    "two forms": ({"z": ROWS, "level": True, "form": 2}, "level is the form of degree 1: write one "),
    "x alone": ({"z": ROWS, "x": [0, 1, 2, 3], "spacing": None}, "x and y are both for "),
    "y of another length": ({"z": ROWS} | AXES | {"y": [0, 1, 2, 3, 4]}, "y has 5 values, z 4 rows; "),
    "x of another length": ({"z": ROWS} | AXES | {"x": [0, 1, 2, 3, 4]}, "x has 5 values, z 4; "),
}


@pytest.mark.parametrize(("keys", "message"), REFUSED_MATRICES.values(), ids=REFUSED_MATRICES)
def test_a_faulty_matrix_in_the_case_is_refused(keys, message):
    with pytest.raises(CaseError, match=message):
        load(CASES / "table1_smooth.toml", {"surface.2": {"spacing": 1e-6} | keys})


POINT = {
    "title": "a map in a contact",
    "contact": {"radius": [0.01, 0.01], "load": 12.0, "youngs_modulus": 206e9, "poisson_ratio": 0.3},
    "fluid": {"viscosity": 0.02, "law": "roelands", "pressure_viscosity": 18e-9, "density": "incompressible"},
    "motion": {"entrainment_speed": 1.0},
    "mesh": {"inlet": -2.0, "outlet": 1.5, "width": 3.0, "points_per_half_width": 8},
}
STRIP = {"contact": POINT["contact"] | {"radius": 0.01, "load": 8e4}}
LINE = STRIP | {"mesh": {"inlet": -2.0, "outlet": 1.5, "points_per_half_width": 8}}
FINE = np.random.default_rng(1).standard_normal((60, 80)) * 5e-8
RIDGE = np.transpose([2e-6 * np.arange(200), np.tile(FINE[0], 3)[:200]])
IMPLAUSIBLE = {
    "spacing a hundred times too wide": ({"spacing": 8e-4}, "points 800 um apart beside a half-width of "),
    "spacing across": ({"spacing": 2e-6, "spacing_across": 2e-4}, "points 200 um apart beside "),
    "unit of the heights": ({"spacing": 2e-6, "unit": "mm"}, None),
    "heights a thousand times too high": ({"spacing": 2e-6, "scale": 1e3}, r"Rq 50 um beside "),
    "slopes": ({"spacing": 2e-8}, r"slopes of 3\.\d* in the root mean square: "),
    "as it is": ({"spacing": 2e-6}, None),
}


def judge(more, message):
    """The case is refused by the one message, or accepted."""
    if message is None:
        surface = load(POINT | more).surface
        assert (surface.body_1 or surface.body_2) is not None
    else:
        assert re.search(message, one_fault(load, POINT | more))


@pytest.mark.parametrize("more", [{}, STRIP], ids=["point", "strip"])
@pytest.mark.parametrize("source", ["file", "z"])
@pytest.mark.parametrize(("keys", "message"), IMPLAUSIBLE.values(), ids=IMPLAUSIBLE)
def test_an_implausible_map_is_refused(tmp_path, monkeypatch, more, source, keys, message):
    monkeypatch.chdir(tmp_path)
    np.save("map.npy", FINE)
    heights = {"file": "map.npy"} if source == "file" else {"z": FINE}
    judge(more | {"surface": {"1": heights | keys}}, message and f"surface.1.*: {message}.* in another unit")


@pytest.mark.parametrize("more", [{}, STRIP, LINE], ids=["point", "strip", "line"])
@pytest.mark.parametrize(
    ("factors", "message"),
    [((1e3, 1e6), "points 2e.03 um apart"), ((1, 1e6), "Rq 4.* um beside"), ((1, 1), None)],
)
def test_an_implausible_ridge_is_refused(tmp_path, monkeypatch, more, factors, message):
    monkeypatch.chdir(tmp_path)
    np.savetxt("p.csv", RIDGE * factors, delimiter=",")
    message = message and f"surface.2.*: {message}.* in another unit"
    judge(more | {"surface": {"2": {"file": "p.csv"}}}, message)


@pytest.mark.parametrize("more", [{}, STRIP, LINE], ids=["point", "strip", "line"])
@pytest.mark.parametrize(("factor", "is_warned"), [(1.0, False), (1e-3, True)])
def test_heights_a_thousand_times_too_low_are_warned_of(tmp_path, monkeypatch, more, factor, is_warned):
    """A profile in um that is read in nm is far smoother than the finest polish; lambda would be 1000."""
    monkeypatch.chdir(tmp_path)
    np.savetxt("p.csv", RIDGE * (1.0, factor), delimiter=",")
    case = load(POINT | more | {"surface": {"2": {"file": "p.csv"}}})
    found = [line for line in warnings(case, Scales.of(case)) if "hardly roughness" in line]
    start = "surface.2: Rq 4.3e-05 um, hardly roughness: are the heights in another unit, "
    assert len(found) == is_warned and all(line.startswith(start) for line in found)


@pytest.mark.parametrize("more", [STRIP, LINE], ids=["strip", "line"])
@pytest.mark.parametrize(("factor", "height"), [(1e4, "379"), (1e-9, "3.79e-11")])
def test_heights_of_a_measured_layer_that_are_not_allowed_are_those_of_the_file(
    tmp_path, monkeypatch, more, factor, height
):
    monkeypatch.chdir(tmp_path)
    np.savetxt("p.csv", RIDGE * (1.0, factor), delimiter=",")
    layer = {"model": "mixed", "asperity_height": "measured", "boundary_friction": 0.1}
    given = POINT | more | {"surface": {"2": {"file": "p.csv", "short_cutoff": 20e-6}}}
    fault = one_fault(load, given | {"contact": given["contact"] | layer})
    found = f"short_cutoff removes waves of an rms height of {height} um; allowed: 1e-05 to 1 um; "
    assert fault.startswith(
        f'case: contact.asperity_height = "measured": {found}are the heights in another unit'
    )


DOUBTFUL = {
    "mm and um": ((1e3, 1e6), [], "warning: points 2e+03 um apart, hardly roughness: is x in another unit"),
    "um": ((4e5, 1e6), [], "warning: points 8e+05 um apart, hardly roughness: "),
    "heights in um": ((1, 1e6), [], "warning: Rq "),
    "heights in um, few": ((1, 1e2), [], "warning: slopes of "),
    "m as mm": ((1, 1), ["--set", "unit=mm", "--set", "x_unit=m"], "warning: Rq "),
    "nm for um": ((1, 1e-3), [], "warning: Rq "),
    "m": ((1, 1), [], None),
}


@pytest.mark.parametrize(("factors", "words", "warning"), DOUBTFUL.values(), ids=DOUBTFUL)
def test_the_command_doubts_heights_that_are_hardly_roughness(tmp_path, capsys, factors, words, warning):
    from ehlpetsc.commands.surface import main

    np.savetxt(tmp_path / "p.csv", RIDGE * factors, delimiter=",")
    np.save(tmp_path / "m.npy", FINE * factors[1])
    spacing = [f"spacing={2e-6 * factors[0]!r}"] + [word for word in words if word == "unit=mm"]
    of_map = [word for value in spacing for word in ("--set", value)]
    for name, keys in (("p.csv", words), ("m.npy", of_map)):
        assert main([str(tmp_path / name), "--no-picture", *keys]) == 0
        doubts = [line for line in capsys.readouterr().out.splitlines() if line.startswith("warning: ")]
        assert len(doubts) == (warning is not None)
        assert not doubts or doubts[0].startswith(warning)


def test_map_that_may_not_be_read_is_refused(tmp_path, monkeypatch):
    def denied(path):
        raise PermissionError(13, "Permission denied", str(path))

    (tmp_path / "map.txt").write_text("1 2 3\n")
    monkeypatch.setattr("ehlpetsc.surfaces.files.areal.read_softgauge", denied)
    assert is_map(tmp_path / "map.txt", Layout())
    with pytest.raises(ProfileError, match="cannot be read: Permission denied$"):
        read_map(tmp_path / "map.txt", Layout())
