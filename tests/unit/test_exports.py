"""Surfaces and fields of results as files of other programs, read back by their formats."""

import base64
import io
import xml.etree.ElementTree as ET
import zipfile
from hashlib import md5

import h5py
import numpy as np
import pytest
from support import optional

from ehlpetsc.base.errors import OutputError
from ehlpetsc.pictures.surface import main
from ehlpetsc.results.reader import Result
from ehlpetsc.surfaces.files.areal import read_map

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
def test_the_command_writes_the_map_as_used(tmp_path, capsys, ending):
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
    if ending != ".x3p":
        assert main([str(target)]) == 2
        assert f"format '{ending}' is written, not read; allowed: " in capsys.readouterr().err


@pytest.mark.parametrize("ending", READERS)
def test_the_command_writes_a_profile_as_one_row(tmp_path, ending):
    np.savetxt(tmp_path / "p.csv", np.transpose([DX * np.arange(60), Z[0]]), delimiter=",")
    target = tmp_path / f"out{ending}"
    assert main([str(tmp_path / "p.csv"), "-o", str(target), "--set", "level=false"]) == 0
    z, dx, _ = READERS[ending](target.read_bytes())
    np.testing.assert_allclose(z, [Z[0] - Z[0].mean()], rtol=0, atol=1e-13)
    assert dx == pytest.approx(DX, rel=1e-9)


def test_x3pio_reads_what_is_written(tmp_path):
    optional("x3pio")
    np.save(tmp_path / "map.npy", Z)
    words = ["--set", f"spacing={DX}", "--set", f"spacing_across={DY}", "--set", "level=false"]
    assert main([str(tmp_path / "map.npy"), "-o", str(tmp_path / "map.x3p"), *words]) == 0
    found = read_map(tmp_path / "map.x3p")
    np.testing.assert_allclose(found.z, Z - Z.mean(), atol=1e-20)
    assert (found.dx, found.dy) == pytest.approx((DX, DY))


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
    result.export(tmp_path / "s.x3p", "surface/1")
    values, dx, _ = read_x3p((tmp_path / "s.x3p").read_bytes())
    np.testing.assert_array_equal(values, np.tile(Z[0, :9], (len(values), 1)))
    assert dx == pytest.approx(3e-6)


@pytest.mark.parametrize(
    ("name", "field", "message"),
    [
        ("p.x3p", "pressure", r"^pressure: in Pa; X3P holds heights in m, \.gsf and \.vti any field$"),
        ("p.png", "pressure", r"allowed for export: a name that ends in \.gsf, \.x3p, \.vti$"),
        ("p.vti", "film", "does not store film$"),
        ("r.h5", "pressure", "is read by this run"),
    ],
)
def test_a_field_that_cannot_be_exported_is_refused(tmp_path, name, field, message):
    result = stored(tmp_path)
    with pytest.raises(OutputError, match=message):
        result.export(tmp_path / name, field)
    assert [path.name for path in tmp_path.iterdir()] == ["r.h5"]
