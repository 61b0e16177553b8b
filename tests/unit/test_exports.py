"""Surfaces and fields as files of other programs; maps of one part: levelled by lines, masked, subtracted."""

import base64
import io
import re
import xml.etree.ElementTree as ET
import zipfile
from dataclasses import replace
from hashlib import md5

import h5py
import numpy as np
import pytest
from scipy.ndimage import gaussian_filter
from support import optional

from ehlpetsc.base.errors import CaseError, OutputError, ProfileError
from ehlpetsc.case.checking import values_of
from ehlpetsc.case.loading import load
from ehlpetsc.case.tables.surface import PROFILE
from ehlpetsc.commands.surface import main
from ehlpetsc.results.exports import GridField, gsf
from ehlpetsc.results.reader import Result
from ehlpetsc.surfaces.differences import difference, displacement, wear_of
from ehlpetsc.surfaces.files.areal import read_map
from ehlpetsc.surfaces.files.text import Layout
from ehlpetsc.surfaces.samples import areal_samples
from ehlpetsc.surfaces.topography import Topography

DX, DY = 2e-6, 3e-6
Z = 1e-7 * np.random.default_rng(1).standard_normal((40, 60))


def read_gsf(content):
    magic, _, rest = content.partition(b"\n")
    assert magic == b"Gwyddion Simple Field 1.0"
    text, _, _ = rest.partition(b"\0")
    header = dict(line.split(" = ") for line in text.decode().splitlines())
    begin = 4 * ((len(magic) + 1 + len(text)) // 4 + 1)
    nx, ny = int(header["XRes"]), int(header["YRes"])
    values = np.frombuffer(content[begin:], "<f4").reshape(ny, nx)
    return values, float(header["XReal"]) / nx, float(header["YReal"]) / ny


@pytest.mark.parametrize("name", ["a", "ab", "abc", "abcd"])
def test_header_of_a_gsf_ends_in_one_to_four_nuls_at_a_multiple_of_four_bytes(name):
    """Without a NUL a header of a multiple of four bytes has no end."""
    content = gsf(GridField(Z, DX, DY, name, origin=(1e-4, -5e-5)))
    header = content[: content.index(b"\0")]
    assert header.endswith(b"\n") and header.startswith(b"Gwyddion Simple Field 1.0\n")
    begin = len(content) - 4 * Z.size
    assert begin % 4 == 0 and content[len(header) : begin] in [b"\0" * n for n in (1, 2, 3, 4)]
    values = dict(line.split(" = ") for line in header.decode().splitlines()[1:])
    ends = float(values["XOffset"]), float(values["YOffset"])
    assert ends == pytest.approx((1e-4 - 0.5 * DX, -5e-5 - 0.5 * DY), rel=1e-12)  # of the cell of a point
    np.testing.assert_array_equal(read_gsf(content)[0], Z.astype("<f4"))


def read_x3p(content):
    archive = zipfile.ZipFile(io.BytesIO(content))
    main_xml, data = archive.read("main.xml"), archive.read("bindata/data.bin")
    assert archive.read("md5checksum.hex").decode().split()[0] == md5(main_xml).hexdigest()
    root = ET.fromstring(main_xml)
    assert root.find(".//MD5ChecksumPointData").text == md5(data).hexdigest().upper()
    shape = [int(root.find(f".//Size{axis}").text) for axis in "YX"]
    steps = [float(root.find(f".//C{axis}/Increment").text) for axis in "XY"]
    return np.frombuffer(data, "<f8").reshape(shape), *steps


def read_vti(content):
    image = ET.fromstring(content).find("ImageData")
    _, nx, _, ny, *_ = map(int, image.get("WholeExtent").split())
    data = base64.b64decode(image.find(".//DataArray").text)
    assert int(np.frombuffer(data[:8], "<u8")[0]) == len(data) - 8
    steps = map(float, image.get("Spacing").split()[:2])
    return np.frombuffer(data[8:], "<f8").reshape(ny + 1, nx + 1), *steps


READERS = {".gsf": read_gsf, ".x3p": read_x3p, ".vti": read_vti}


@pytest.mark.parametrize("ending", READERS)
def test_the_command_writes_the_map_as_used_and_a_profile_as_one_row(tmp_path, capsys, ending):
    np.save(tmp_path / "map.npy", Z + 1e-3 * DX * np.arange(60))
    target = tmp_path / f"out{ending}"
    keys = [f"spacing={DX}", f"spacing_across={DY}", "scale=2"]
    words = [word for key in keys for word in ("--set", key)]
    assert main([str(tmp_path / "map.npy"), "-o", str(target), *words]) == 0
    assert capsys.readouterr().out.splitlines()[-1] == str(target)
    z, dx, dy = READERS[ending](target.read_bytes())
    assert (dx, dy) == pytest.approx((DX, DY), rel=1e-12)
    assert np.corrcoef(z.ravel(), Z.ravel())[0, 1] > 0.99  # without the plane
    assert z.std() == pytest.approx(2 * Z.std(), rel=1e-2) and abs(z.mean()) < 1e-12
    target.write_text("measured")
    assert main([str(tmp_path / "map.npy"), "-o", str(target), *words]) == 2
    assert "exists; give another -o, or --overwrite" in capsys.readouterr().err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["map.npy", f"out{ending}"]
    assert target.read_text() == "measured"
    if ending == ".vti":
        assert main([str(target)]) == 2
        assert "format '.vti' is not read; allowed: " in capsys.readouterr().err
    np.savetxt(tmp_path / "p.csv", np.transpose([DX * np.arange(60), Z[0]]), delimiter=",")
    target = tmp_path / f"row{ending}"
    assert main([str(tmp_path / "p.csv"), "-o", str(target), "--set", "level=false"]) == 0
    z, dx, _ = READERS[ending](target.read_bytes())
    np.testing.assert_allclose(z, [Z[0] - Z[0].mean()], rtol=0, atol=1e-13)
    assert dx == pytest.approx(DX, rel=1e-9)


@pytest.mark.parametrize(("ending", "exact"), [(".x3p", 1e-20), (".gsf", 1e-13)])
def test_what_is_written_is_read(tmp_path, ending, exact):
    ending == ".gsf" or optional("SurfaceTopography")
    np.save(tmp_path / "map.npy", Z)
    words = ["--set", f"spacing={DX}", "--set", f"spacing_across={DY}", "--set", "level=false"]
    target = tmp_path / f"map{ending}"
    assert main([str(tmp_path / "map.npy"), "-o", str(target), *words]) == 0
    found = read_map(target)
    np.testing.assert_allclose(found.z, Z - Z.mean(), atol=exact)
    assert (found.dx, found.dy) == pytest.approx((DX, DY))
    assert main([str(target), "--no-picture"]) == 0


@pytest.mark.parametrize("title", ["a", "ab", "abc", "abcd"])
def test_a_gsf_is_read_whatever_the_length_of_its_header_in_any_unit_of_length(tmp_path, title):
    field = GridField(1e6 * np.where(Z > 2e-7, np.nan, Z), DX, DY, title, "um", (1e-3, 2e-3))
    (tmp_path / "map.gsf").write_bytes(gsf(field))
    found = read_map(tmp_path / "map.gsf", Layout(fill_gaps=1e-5))
    np.testing.assert_allclose(found.z[Z <= 2e-7], Z[Z <= 2e-7], atol=1e-13)
    assert (found.dx, found.dy) == pytest.approx((DX, DY)) and "missing heights filled" in found.notes[0]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (b"ZUnits = m", b"ZUnits = Pa", '^GSF: ZUnits = "Pa"; allowed: a unit of length, as m$'),
        (b"XRes = 60", b"XRes = 61", "^GSF: 2400 heights, XRes YRes = 2440 in its header; "),
        (b"YRes", b"Rows", "^GSF: YRes is missing; "),
        (b"Gwyddion", b"Gwiddion", r"^its first line is that of no format of '\.gsf'; "),
    ],
)
def test_a_faulty_gsf_is_refused(tmp_path, old, new, message):
    (tmp_path / "map.gsf").write_bytes(gsf(GridField(Z, DX, DY)).replace(old, new))
    with pytest.raises(ProfileError, match=message):
        read_map(tmp_path / "map.gsf")


def stored(tmp_path, is_plane=True):
    """Result with the datasets that are exported."""
    path, axes = tmp_path / "r.h5", (5, 7) if is_plane else (7,)
    with h5py.File(path, "w") as file:
        file["time"], file["step"], file["x"] = [0.0, 1.0], [0, 1], 1e-6 * np.arange(7) - 3e-6
        file["contact_count"] = np.zeros(axes)
        file["steps/time"] = [0.0, 1.0]
        if is_plane:
            file["y"] = 2e-6 * np.arange(5) - 4e-6
        file["pressure"] = np.arange(2 * np.prod(axes), dtype=float).reshape(2, *axes)
        file["pressure"].attrs["units"] = "Pa"
        file["surface/1/s"], file["surface/1/z"] = 3e-6 * np.arange(9), np.ones((*axes[:-1], 9)) * Z[0, :9]
    return Result(h5py.File(path), path)


@pytest.mark.parametrize("is_plane", [True, False])
def test_a_result_writes_fields_and_surfaces(tmp_path, is_plane):
    result = stored(tmp_path, is_plane)
    for ending in (".gsf", ".vti"):
        result.export(tmp_path / f"p{ending}", "pressure", 0)
        values, dx, dy = READERS[ending]((tmp_path / f"p{ending}").read_bytes())
        np.testing.assert_array_equal(values, np.atleast_2d(result.pressure[0]))
        assert dx == pytest.approx(1e-6) and (dy == pytest.approx(2e-6) or not is_plane)
    assert b'Origin="-3e-06 -4e-06 0"' in (tmp_path / "p.vti").read_bytes() or not is_plane
    (tmp_path / "s.x3p").write_text("measured")
    with pytest.raises(OutputError, match=r"s\.x3p: exists; give another name, or overwrite=True"):
        result.export(tmp_path / "s.x3p", "surface/1")
    result.export(tmp_path / "s.x3p", "surface/1", overwrite=True)
    values, dx, _ = read_x3p((tmp_path / "s.x3p").read_bytes())
    np.testing.assert_array_equal(values, np.tile(Z[0, :9], (len(values), 1)))
    assert dx == pytest.approx(3e-6)


@pytest.mark.parametrize(
    ("name", "field", "message"),
    [
        ("p.x3p", "pressure", r"^pressure: in Pa; X3P holds heights in m, \.gsf and \.vti any field$"),
        ("p.png", "pressure", r"allowed for export: a name that ends in \.gsf, \.x3p, \.vti$"),
        ("p.vti", "film", r"film: no field of a frame; allowed: pressure, surface/1$"),
        ("p.vti", "steps/time", "steps/time: no field of a frame; allowed: pressure, surface/1$"),
        ("p.gsf", "contact_count", "contact_count: no field of a frame"),
        ("p.gsf", "surface/2", "surface/2: no field"),
        ("p.gsf", "surface/1/s", "surface/1/s: no field"),
        ("r.h5", "pressure", "is read by this run"),
    ],
)
def test_a_field_that_cannot_be_exported_is_refused(tmp_path, name, field, message):
    result = stored(tmp_path)
    with pytest.raises(OutputError, match=message):
        result.export(tmp_path / name, field)
    assert [path.name for path in tmp_path.iterdir()] == ["r.h5"]


STEP = 2e-6
RANDOM = np.random.default_rng(4)
WAVES = 1e-7 * gaussian_filter(RANDOM.standard_normal((200, 240)), 3.0) / 0.09
KEYS, MASKED = ["--set", f"spacing={STEP}"], ["mask=mask.npy"]


def sampled(folder, **keys):
    return areal_samples(folder, values_of(PROFILE, {"file": "map.npy", "spacing": STEP} | keys), 0.0, False)


def test_rows_of_a_scanner_are_levelled_and_masked_heights_are_missing(tmp_path):
    lines = RANDOM.normal(0.0, 1e-6, (2, 200, 1))
    waves = 1e-7 * np.cos(2 * np.pi * np.arange(240) / 24) * np.ones((200, 1))
    np.save(tmp_path / "map.npy", waves + lines[0] + lines[1] * np.linspace(-1, 1, 240))
    assert sampled(tmp_path, level=True).sq > 8e-7
    assert sampled(tmp_path, level="rows").sq == pytest.approx(1e-7 / np.sqrt(2), rel=2e-2)
    z, mask = WAVES.copy(), np.zeros(WAVES.shape, bool)
    z[50:54, 20:25] += 5e-6  # dust
    mask[50:54, 20:25] = True
    mask[:, :10] = True  # an edge: cut off
    np.save(tmp_path / "map.npy", z)
    np.save(tmp_path / "mask.npy", mask)
    np.savetxt(tmp_path / "mask.txt", mask)
    for name in ("mask.npy", "mask.txt"):
        found = sampled(tmp_path, mask=name, fill_gaps=12e-6)
        assert found.z.shape == (200, 230)
        assert np.abs(found.z).max() < 1e-6 < np.abs(sampled(tmp_path).z).max()
        other = np.ones_like(mask[:, 10:])
        other[50:54, 10:15] = 0
        np.testing.assert_allclose((found.z - z[:, 10:])[other], found.z[0, 0] - z[0, 10], atol=1e-18)


@pytest.mark.parametrize(
    ("mask", "words", "message"),
    [
        (np.zeros((3, 4)), MASKED, "mask: mask.npy has 3 x 4 values; allowed: as many as heights, 200 x 240"),
        (None, MASKED, "mask: no such file: "),
        (np.eye(200, 240), MASKED, "200 heights missing, the widest gap "),
        (None, ["level=lines"], 'level = "lines": allowed: true or false or "rows" ('),
    ],
)
def test_faulty_masks_and_levels_are_refused_in_one_sentence(tmp_path, capsys, mask, words, message):
    np.save(tmp_path / "map.npy", WAVES)
    if mask is not None:
        np.save(tmp_path / "mask.npy", mask)
    words = [word for key in words for word in ("--set", key)]
    assert main([str(tmp_path / "map.npy"), "--no-picture", *KEYS, *words]) == 2
    printed = capsys.readouterr().err
    assert message in printed and printed.count("\n") == 1


def test_the_difference_is_what_was_worn(tmp_path, capsys):
    """The map after the test begins elsewhere, by 5 rows and -22/3 columns."""
    fine = gaussian_filter(RANDOM.standard_normal((220, 750)), (3.0, 9.0))
    fine *= 1e-7 / fine.std()
    before = fine[10:210, 24:744:3]
    after = fine[15:215, 2:722:3].copy()
    after[75:115, 108:137] -= 2e-7
    for name, z in (("before", before), ("after", after)):
        np.save(tmp_path / f"{name}.npy", z)
    words = [str(tmp_path / "before.npy"), "--minus", str(tmp_path / "after.npy"), *KEYS]
    target = tmp_path / "worn.gsf"
    assert main([*words, "--set", "level=false", "-o", str(target)]) == 0
    assert "\nsecond map moved by -14." in (printed := capsys.readouterr().out)
    lines = [line for line in printed.splitlines() if line.startswith("worn ")]
    volume, area, raised = map(
        float, re.match(r"worn volume (\S+) um\^3 on (\S+) um\^2, raised (\S+) um", lines[0]).groups()
    )
    assert volume == pytest.approx(40 * 29 * 4 * 0.2, rel=0.01)
    assert area == pytest.approx(40 * 29 * 4, rel=0.06), "the spline of the moved map rounds the edges"
    assert raised < 0.02 * volume and lines[1].startswith("worn depth 0.2")
    assert float(lines[1].split()[6]) == pytest.approx(0.2, rel=0.06)
    moved, correlation = displacement(before, after)
    assert moved == pytest.approx([5.0, -22 / 3], abs=0.05) and correlation > 0.9
    z = np.frombuffer(target.read_bytes()[-4 * 195 * 233 :], "<f4").reshape(195, 233)
    assert z[80:110, 104:125].mean() - z[10:60, 20:220].mean() == pytest.approx(2e-7, rel=1e-2)
    assert z[10:60, 20:220].std() < 2e-9
    assert main(words) == 0  # beside the picture of the first map, not in its place
    assert [file.name for file in tmp_path.glob("*.png")] == ["before.minus.png"]


def test_worn_volume_is_beyond_the_noise_and_beside_what_was_raised():
    noise = 5e-9 * RANDOM.standard_normal((100, 120))
    unchanged = Topography(DX * np.arange(120), DY * np.arange(100), noise - 4e-8)
    found = wear_of(unchanged)
    assert found.limit == pytest.approx(15e-9, rel=0.05) and found.volume < 0.01 * 12_000 * DX * DY * 15e-9
    assert wear_of(replace(unchanged, z=0.0 * noise)) == (0.0, 0.0, 0.0, 0.0, 0.0)
    z = unchanged.z.copy()
    z[20:60, 30:50] += 3e-7
    z[20:60, 50:54] -= 1e-7  # a ridge of displaced metal beside the groove
    found = wear_of(replace(unchanged, z=z))
    assert found.volume == pytest.approx(800 * DX * DY * 3e-7, rel=0.01)
    assert found.area == pytest.approx(800 * DX * DY, rel=0.03)
    assert found.raised == pytest.approx(160 * DX * DY * 1e-7, rel=0.05)
    assert 3e-7 < found.depth < 3.3e-7


def test_maps_of_other_places_have_no_difference_and_profiles_no_mask(tmp_path, capsys):
    np.save(tmp_path / "map.npy", WAVES)
    np.save(tmp_path / "b.npy", 1e-7 * RANDOM.standard_normal((200, 240)))
    assert main([str(tmp_path / "map.npy"), "--minus", str(tmp_path / "b.npy"), "--no-picture", *KEYS]) == 2
    printed = capsys.readouterr().err
    assert "b.npy: correlates with the first map by 0." in printed and printed.count("\n") == 1
    found = sampled(tmp_path)
    with pytest.raises(ProfileError, match="points 4 x 2 um apart; allowed for a difference: 2 x 2 um"):
        difference(found, replace(found, X=2 * found.X))
    ridge = replace(found, Y=found.Y[:1], z=found.z[:1])
    with pytest.raises(ProfileError, match="a profile; allowed for a difference: maps"):
        difference(found, ridge)
    (tmp_path / "p.csv").write_text("".join(f"{1e-6 * k}, {1e-7 * np.sin(k)}\n" for k in range(400)))
    tables = {
        "title": "mask",
        "motion": {"entrainment_speed": 1.0, "slide_roll_ratio": 0.0},
        "contact": {"radius": [0.01, 0.01], "load": 20.0, "youngs_modulus": 207e9, "poisson_ratio": 0.3},
        "mesh": {"inlet": -2.0, "outlet": 1.5, "points_per_half_width": 8, "width": 4.0},
        "surface": {"1": {"file": str(tmp_path / "p.csv"), "mask": "mask.npy"}},
    }
    with pytest.raises(CaseError, match="mask: of a map, not of a profile"):
        load(tables)
