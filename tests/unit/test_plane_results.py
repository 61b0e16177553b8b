"""Results of points and strips: files, sections, comparison, restart, XDMF."""

from xml.etree import ElementTree

import h5py
import numpy as np
import pytest
from support import optional, self_affine

import ehlpetsc
from ehlpetsc.base.errors import ExitStatus, OutputError
from ehlpetsc.commands import compare, summary
from ehlpetsc.pictures.frames import line
from ehlpetsc.results.exports import write_xdmf
from ehlpetsc.run.recorder import Recorder

BALL = {
    "title": "ball",
    "contact": {"radius": [0.0125, 0.0125], "load": 20.0, "material": "100Cr6", "model": "mixed"},
    "fluid": {"viscosity": 0.04, "law": "roelands", "pressure_viscosity": 22e-9, "density": "incompressible"},
    "motion": {"entrainment_speed": 0.5, "slide_roll_ratio": 0.3},
    "mesh": {"inlet": -1.75, "outlet": 1.25, "points_per_half_width": 16, "width": 3.0},
    "surface": {"1": {"synthetic": {"kind": "sine", "amplitude": 2e-8, "wavelength": 8e-5}}},
    "time": {"travel": 0.1, "courant": 0.435},
}


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    path = tmp_path_factory.mktemp("plane") / "ball.h5"
    ehlpetsc.solve(BALL | {"output": {"xdmf": True}}, output=path)
    return path


def test_point_has_fields_over_time_y_and_x(path, capsys):
    with h5py.File(path) as file:
        shape = file["y"].size, file["x"].size
        assert file["pressure"].shape == (file["time"].size, *shape) == (5, 49, 49)
        assert [dim.keys()[0] for dim in file["pressure"].dims] == ["time", "y", "x"]
        assert [dim.keys()[0] for dim in file["contact_count"].dims] == ["y", "x"]
        assert file["surface/1/z"].shape == (49, file["surface/1/s"].size)
        assert file.attrs["kind"] == "point" and file.attrs["b"] == file.attrs["a"]
        pressure, cell = file["pressure"][-1], np.diff(file["x"][:2]) * np.diff(file["y"][:2])
        assert pressure.sum() * cell == pytest.approx(20.0, rel=1e-9)
        assert np.abs(pressure - pressure[::-1]).max() <= 1e-6 * pressure.max()  # symmetric about y = 0
        units = {name: file[f"steps/{name}"].attrs["units"] for name in ("load", "contact_area", "friction")}
        assert units == {"load": "N", "contact_area": "m^2", "friction": "N"}
        assert not any("length" in name for name in file["steps"])  # areas were called so
        assert (file["steps/gmres"][:] >= file["steps/newton"][:]).all()
        assert file["pressure"].id.get_storage_size() < 0.9 * file["pressure"].size * 8
    with ehlpetsc.read_result(path) as result:
        data = result.to_xarray()
    assert data.pressure.dims == ("time", "y", "x") and data.contact_count.dims == ("y", "x")
    peak = data.pressure.isel(time=-1).argmax(("y", "x"))
    last = data.pressure.isel(time=-1)
    beside = float(last[peak].y)  # two peaks beside the middle, as the ridges pass
    mirrored = last.sel(y=-beside, method="nearest").isel(x=int(peak["x"]))
    assert float(mirrored.y) == pytest.approx(-beside, abs=1e-12) and data.y.units == "m"
    assert float(mirrored) == pytest.approx(float(last.max()), rel=1e-6)
    assert summary.main([str(path), "--frame", "2"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("x [m],y [m],") and len(lines) == 1 + 49 * 49


def test_integrals_of_a_strip_are_per_metre_and_single_precision_halves_frames(path, tmp_path):
    mesh = BALL["mesh"] | {"width": 0.5}
    strip = {"radius": 0.0125, "load": 5e4}
    tables = {key: value for key, value in BALL.items() if key not in ("time", "surface")}
    result = ehlpetsc.solve(tables | {"mesh": mesh, "contact": BALL["contact"] | strip})
    assert result.attrs["kind"] == "strip" and np.isinf(result.attrs["b"])
    assert result.unit("steps/load") == "N/m"
    assert result.steps.load[0] == pytest.approx(5e4, rel=1e-9)
    small = ehlpetsc.solve(BALL | {"output": {"precision": "float32"}}, output=tmp_path / "s.h5")
    with ehlpetsc.read_result(path) as result:
        assert small.pressure == pytest.approx(result.pressure, rel=1e-6)
        sizes = [one["pressure"].id.get_storage_size() for one in (small, result)]
    assert sizes[0] < 0.6 * sizes[1]


def test_section_is_the_result_of_a_line(path):
    with ehlpetsc.read_result(path) as result:
        row = result.section(0.3 * result.attrs["b"])
        k = int(np.argmin(np.abs(result.y - row.place)))
        assert abs(row.place - 0.3 * result.attrs["b"]) <= 0.5 * (result.y[1] - result.y[0])
        assert row.y is None and row.attrs["kind"] == "line"
        assert np.array_equal(row.pressure, result.pressure[:, k])
        assert np.array_equal(row.frame("film_thickness", -1), result.film_thickness[-1, k])
        assert np.array_equal(row["pressure"][1:3, 5], result.pressure[1:3, k, 5])
        assert row.profile("1")[1].shape == row.profile("1")[0].shape
        assert row.to_xarray().pressure.dims == ("time", "x")
        labels = [axes.get_ylabel() for axes in row.plot().axes]
        assert labels == ["pressure [GPa]", "film thickness [µm]", "surfaces [µm]"]
        with pytest.raises(OutputError, match="section: y = 1 m; allowed: on the mesh"):
            result.section(1.0)
        with pytest.raises(OutputError, match="a line contact, which has no sections"):
            row.section()


def test_comparison_names_the_place_across_and_refuses_other_contacts(path, tmp_path, capsys):
    other = tmp_path / "other.h5"
    other.write_bytes(path.read_bytes())
    with h5py.File(other, "r+") as file:
        file["pressure"][2, 40, 30] += 1e7
        y = file["y"][40]
    with ehlpetsc.read_result(path) as one, ehlpetsc.read_result(other) as two:
        found = {d.name: d for d in compare.compare(one, two)}
    assert (found["pressure"].max, found["pressure"].y) == (pytest.approx(1e7), y)
    assert found["film_thickness"].max == 0.0
    assert compare.main([str(path), str(other)]) == 1
    assert "at y/a" in capsys.readouterr().out
    other = tmp_path / "other.h5"
    other.write_bytes(path.read_bytes())
    with h5py.File(other, "r+") as file:
        file.attrs["kind"] = "strip"
    assert compare.main([str(path), str(other)]) == 2
    assert "a point and a strip contact" in capsys.readouterr().err


def test_run_stopped_in_mixed_contact_continues_to_the_same_result_bit_for_bit(tmp_path):
    keys = {"surface.1.synthetic": self_affine(7e-8, 5e-5, 2.5e-5), "mesh.points_per_half_width": 12}
    keys |= {"fluid.viscosity": 0.01, "operation": {"time": [0.0, 1e-3], "load": ["20 N", "18 N"]}}
    keys |= {"time": {"travel": 0.5, "start": "rough", "courant": 0.86}, "output.xdmf": True}
    case = ehlpetsc.load(BALL, keys)
    whole, part = ehlpetsc.solve(case), tmp_path / "ball.h5"
    simulation = ehlpetsc.Simulation(case)
    with Recorder(simulation, part) as recorder:
        recorder.lock_output()
        for state in simulation:
            recorder.write(state)
            if state.step == 3:
                break
        recorder.close(ExitStatus.STOPPED)
    assert 3 < state.in_contact.sum() < whole.contact_count.sum()
    result = ehlpetsc.solve(case, output=part)  # the same call
    assert result.attrs["restarts"] == 1 and result.attrs["status"] == "done"
    assert len(result.time) == len(whole.time) == 8
    assert {d.max for d in compare.compare(whole, result)} == {0.0}
    courses = line.draw_courses([result], None).axes[0]
    assert courses.get_ylabel() == "load [N]" and 19.5 < courses.lines[0].get_ydata()[-1] < 20.0


def test_running_point_can_be_read_and_is_not_continued_on_another_width(tmp_path):
    case = ehlpetsc.load(BALL)
    simulation = ehlpetsc.Simulation(case)
    with Recorder(simulation, tmp_path / "a.h5") as recorder:
        recorder.write(simulation.advance())
        recorder.write(simulation.advance())
        recorder.checkpoint()  # which flushes the result
        with ehlpetsc.read_result(tmp_path / "a.h5") as result:
            assert result.attrs["status"] == "running"
            assert np.array_equal(result.pressure[-1], simulation.state.pressure)
        recorder.close(ExitStatus.STOPPED)
    wider = ehlpetsc.load(BALL, {"mesh.width": 3.5})
    with pytest.raises(OutputError, match=r"has 49 nodes across, the case 57; \[mesh\] must be as it was"):
        ehlpetsc.solve(wider, output=tmp_path / "b.h5", restart=tmp_path / "a.restart.h5")
    x, y = case.contact.radius, 1.7 * case.contact.radius_across
    longer = ehlpetsc.load(BALL, {"contact.radius": [x, y]})  # with other rows: it was [mesh] that differed
    with pytest.raises(OutputError, match=r"another load, radius or elasticity: contact\.radius was \["):
        ehlpetsc.solve(longer, output=tmp_path / "b.h5", restart=tmp_path / "a.restart.h5")


@pytest.mark.parametrize("name", ["a&b.h5", "a<b>'c'.h5", 'a"&amp;".h5'])
def test_xdmf_of_any_name_is_xml(path, tmp_path, name):
    (tmp_path / name).write_bytes(path.read_bytes())
    root = ElementTree.parse(write_xdmf(tmp_path / name))
    items = [item.text for item in root.iter("DataItem") if item.get("Format") == "HDF"]
    assert f"{name}:/pressure" in items and all(item.startswith(f"{name}:/") for item in items)


def test_result_with_the_name_of_its_xdmf_is_refused(tmp_path):
    with pytest.raises(OutputError, match=r"r\.xdmf: output\.xdmf = true writes this file too; "):
        ehlpetsc.solve(BALL | {"output": {"xdmf": True}}, output=tmp_path / "r.xdmf")
    assert list(tmp_path.iterdir()) == []


def test_xdmf_opens_in_vtk(path):
    xdmf = optional("vtkmodules.vtkIOXdmf2")
    convert = optional("vtkmodules.util.numpy_support")
    reader = xdmf.vtkXdmfReader()
    reader.SetFileName(str(path.with_suffix(".xdmf")))
    reader.UpdateInformation()
    key = reader.GetExecutive().TIME_STEPS()
    times = reader.GetOutputInformation(0).Get(key)
    with ehlpetsc.read_result(path) as result:
        assert times == pytest.approx(result.time, rel=1e-6)
        reader.UpdateTimeStep(times[-1])
        grid = reader.GetOutputDataObject(0)
        pressure = convert.vtk_to_numpy(grid.GetPointData().GetArray("pressure"))
        assert np.array_equal(pressure.reshape(49, 49), result.pressure[-1])
        assert grid.GetBounds()[:2] == pytest.approx((result.x[0], result.x[-1]), rel=1e-6)
        assert grid.GetBounds()[2:4] == pytest.approx((result.y[0], result.y[-1]), rel=1e-6)
