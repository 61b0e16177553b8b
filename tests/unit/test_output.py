"""Result and restart files: their content, and that faults leave them readable."""

import errno
import json
import os
import signal
import subprocess
import sys
import textwrap
from pathlib import Path
from types import SimpleNamespace

import h5py
import numpy as np
import pytest
from support import CASES, ROOT

import ehlpetsc
from ehlpetsc.base import quantities
from ehlpetsc.base.declarations import Field, StepScalar
from ehlpetsc.base.errors import OutputError
from ehlpetsc.base.quantities import FIELDS, of_every_case
from ehlpetsc.results.output_guard import inputs_of
from ehlpetsc.results.reader import read_result
from ehlpetsc.results.writer import Layout, ResultWriter, StoredSurface
from ehlpetsc.run.checkpoint import load_restart, save_restart

STORED = [*of_every_case(FIELDS), "void_fraction"]
STEP_SCALARS = of_every_case(quantities.STEP_SCALARS)
NX = 40
X = np.linspace(-2.5, 1.5, NX) * 3.3e-4
SCALES = dict(a=3.3e-4, p0=1e9, h_scale=5.7e-6, u1=5.6, u2=4.4, ranks=2, petsc_options="-x 1")
SCALARS = dict.fromkeys(STEP_SCALARS, 1)


def make_writer(path, attributes=SCALES, resume_step=None, contact_count=None, **changes):
    surface = StoredSurface(np.arange(5.0), np.ones(5), 5.6, {"ra": 0.4e-6})
    layout = dict(x=X, fields=STORED, scalars=list(STEP_SCALARS), surfaces={"1": surface})
    attributes = {"title": "ä", "case": 'title = "ä"\n'} | attributes
    going_on = dict(resume_step=resume_step, contact_count=contact_count)
    return ResultWriter(path, Layout(**(layout | changes)), attributes, **going_on)


def put(writer, steps, every=1):
    """Steps whose every value tells its step and node; node k is in contact in steps that k divides."""
    for step in steps:
        values = {name: step + np.arange(NX) / 100 for name in STORED}
        contact = step % (np.arange(NX) + 1) == 0
        writer.append(step, step * 1e-7, values, SCALARS | {"newton": step}, contact, step % every == 0)


def written(path, steps, every=1, **changes):
    writer = make_writer(path, **changes)
    put(writer, steps, every)
    writer.close("done")
    return path


def content(path):
    """Content that must agree between an interrupted and an uninterrupted run."""
    with read_result(path) as result:
        data = {name: result[name][:] for name in [*result.fields, "time", "step", "contact_count"]}
        return data | {f"steps/{n}": result.steps(n) for n in STEP_SCALARS}


def assert_same_content(one, other):
    one, other = content(one), content(other)
    assert one.keys() == other.keys()
    for name in one:
        np.testing.assert_array_equal(one[name], other[name], err_msg=name)


def test_every_dataset_names_unit_and_dimensions_and_provenance_is_complete(tmp_path):
    with h5py.File(written(tmp_path / "r.h5", range(3)), "r") as file:
        datasets = []
        file.visititems(lambda _, item: datasets.append(item) if isinstance(item, h5py.Dataset) else None)
        assert len(datasets) == len(STORED) + len(STEP_SCALARS) + 6
        for dataset in datasets:
            assert dataset.attrs["units"] and dataset.attrs["long_name"], dataset.name
            assert h5py.h5ds.is_scale(dataset.id) or all(dim.keys() for dim in dataset.dims), dataset.name
        for name in STORED:
            assert [dim.keys()[0] for dim in file[name].dims] == ["time", "x"]
        assert file["in_contact"].dtype == np.uint8
        assert file["surface/1"].attrs["speed"] == 5.6
        assert file["surface/1"].attrs["ra"] == 0.4e-6
        assert "2" not in file["surface"]
    path = written(tmp_path / "r.h5", range(3), attributes={"versions": {"petsc": "3.18.5"}})
    with read_result(path) as r:
        assert r.attrs["format_version"] == 1
        assert (r.attrs["title"], r.attrs["case"], r.attrs["status"]) == ("ä", 'title = "ä"\n', "done")
        assert r.attrs["restarts"] == 0
        assert {"ehlpetsc", "numpy", "petsc"} <= {item.split()[0] for item in r.attrs["versions"].split(", ")}


@pytest.mark.parametrize("in_memory", [True, False])
def test_case_text_of_any_length_is_stored(tmp_path, in_memory):
    """Profiles of a case from Python are in its text; the header of an HDF5 object has 64 KB at most."""
    path = tmp_path / "r.h5"
    writer = make_writer(None if in_memory else path, attributes=SCALES | {"case": "c" * 500_000})
    put(writer, range(3))
    writer.close("done")
    if in_memory:
        path.write_bytes(writer.to_bytes())
    with read_result(path) as result:
        assert result.attrs["case"] == "c" * 500_000 and result.attrs["status"] == "done"


def test_damaged_field_is_not_read(tmp_path):
    path = written(tmp_path / "r.h5", range(3))
    with h5py.File(path) as file:
        chunk = file["pressure"].id.get_chunk_info(0)
    raw = bytearray(path.read_bytes())
    raw[chunk.byte_offset + chunk.size // 2] ^= 4
    (tmp_path / "r.h5").write_bytes(raw)
    with read_result(tmp_path / "r.h5") as result:
        with pytest.raises(OSError, match="read"):
            result.frame("pressure", 1)
        assert result.frame("film_thickness", 1)[3] == 1.03


def test_xarray_reads_coordinates_and_units(tmp_path):
    import xarray

    path = written(tmp_path / "r.h5", range(5), every=2)
    with xarray.open_dataset(path, engine="h5netcdf") as data:
        assert data["pressure"].dims == ("time", "x")
        assert data["pressure"].attrs["units"] == "Pa"
        assert data["contact_count"].dims == ("x",)
        np.testing.assert_allclose(data["time"], [0.0, 2e-7, 4e-7])
        np.testing.assert_array_equal(data["x"], X)
        assert data["pressure"].sel(time=2e-7).values[1] == 2.01
    with xarray.open_dataset(path, engine="h5netcdf", group="steps") as steps:
        assert steps["newton"].dims == ("time",)
        np.testing.assert_array_equal(steps["newton"], range(5))
    with xarray.open_dataset(path, engine="h5netcdf", group="surface/1") as fast:
        assert fast["z"].dims == ("s",)


def test_frames_are_thinned_and_steps_are_not(tmp_path):
    with read_result(written(tmp_path / "r.h5", range(1, 101), every=10)) as result:
        np.testing.assert_array_equal(result.step, range(10, 101, 10))
        np.testing.assert_array_equal(result.steps("step"), range(1, 101))
        np.testing.assert_array_equal(result.contact_count, [100 // (k + 1) for k in range(NX)])
        assert result.frame("pressure", -1)[3] == 100.03
        assert result.nearest_frame(step=44) == 3
        assert result.nearest_frame(time=0.0) == 0
        assert result.profile("2") is None
        assert result.profile("1")[2] == 5.6
    path = written(tmp_path / "r.h5", range(3), fields=["pressure"], precision="float32")
    with read_result(path) as result:
        assert result.fields == ["pressure"]
        assert result["pressure"].dtype == np.float32
        np.testing.assert_allclose(result.frame("pressure", 2), 2 + np.arange(NX) / 100, rtol=1e-7)


def test_file_size_of_long_runs_is_that_of_their_data(tmp_path):
    path = written(tmp_path / "r.h5", range(5000))
    assert path.stat().st_size < 1.15 * 5000 * NX * 8 * 6 + 1_000_000


@pytest.fixture
def disk(monkeypatch):
    """Free bytes of the disk, to be changed."""
    free = [2**40]
    monkeypatch.setattr("shutil.disk_usage", lambda path: SimpleNamespace(free=free[0]))
    return free


@pytest.mark.parametrize("resumed", [{}, {"resume_step": 1999, "contact_count": np.zeros(NX, int)}])
def test_older_result_is_kept_if_the_start_fails(tmp_path, disk, resumed):
    path = written(tmp_path / "r.h5", range(2000))
    before, disk[0] = path.read_bytes(), 100_000
    with pytest.raises(OutputError, match=r"r\.h5: .*written, No space left on device$"):
        make_writer(path, **resumed)
    assert path.read_bytes() == before and [p.name for p in tmp_path.iterdir()] == ["r.h5"]


KILLED = """
    import os, signal, sys
    sys.path[:0] = {paths!r}
    from pathlib import Path
    import test_output
    writer = test_output.make_writer(Path({path!r}))
    test_output.put(writer, range({flushed}))
    writer.flush()
    test_output.put(writer, range({flushed}, {flushed} + {lost}))
    os.kill(os.getpid(), signal.SIGKILL)
"""


def killed(path, flushed, lost):
    """A file as left by a killed run."""
    paths = [os.path.dirname(__file__), *sys.path]
    script = textwrap.dedent(KILLED).format(paths=paths, path=str(path), flushed=flushed, lost=lost)
    assert subprocess.run([sys.executable, "-c", script], check=False).returncode == -signal.SIGKILL
    return path


@pytest.mark.parametrize("length", [300, 254, 245])
def test_name_too_long_for_the_result_or_the_files_beside_it_is_refused(tmp_path, length):
    case = ehlpetsc.load(CASES / "table1_smooth.toml", {"mesh.points_per_half_width": 10})
    with pytest.raises(OutputError, match=": not written, File name too long$"):
        ehlpetsc.solve(case, output=tmp_path / f"{'a' * (length - 3)}.h5")


def test_masks_and_load_files_are_inputs():
    gears = SimpleNamespace(load_file="load.csv")
    sides = SimpleNamespace(body_1=SimpleNamespace(file="maps/z.npy", mask="mask.npy"), body_2=None)
    case = SimpleNamespace(surface=sides, operation=None, gears=gears, path=Path("cases/c.toml"))
    names = "cases/c.toml", "cases/maps/z.npy", "cases/load.csv", "cases/maps/mask.npy"
    assert inputs_of(case) == list(map(Path, names))


@pytest.mark.parametrize("lost", [3, 900])
def test_killed_run_is_readable_up_to_its_last_flush(tmp_path, lost):
    path = killed(tmp_path / "r.h5", 50, lost)
    with read_result(path) as result:
        assert result.attrs["status"] == "running"
        assert len(result.time) == 50
        np.testing.assert_array_equal(result.steps("newton"), range(50))
        for k in range(50):
            assert result.frame("film_thickness", k)[2] == k + 0.02


def test_other_readers_open_a_killed_run_as_the_page_of_results_says(tmp_path):
    page = (ROOT / "ehlpetsc" / "results" / "README.md").read_text()
    path = killed(tmp_path / "mixed.h5", 50, 3)
    with pytest.raises(OSError, match="already open for write"):
        h5py.File(path, "r")
    assert '`h5py.File("mixed.h5", "r", swmr=True)`' in page
    with h5py.File(path, "r", swmr=True) as file:
        assert len(file["time"]) == 50 <= len(file["pressure"])
    with read_result(path) as result:
        assert result.to_xarray().sizes["time"] == 50 and ").to_xarray()`" in page


@pytest.mark.parametrize("pace, steps", [(0.1, 45), (0.7, 15), (5.0, 6)])
def test_kill_loses_two_seconds_of_steps_at_most(tmp_path, monkeypatch, pace, steps):
    """The content read by another process after each step is that left by a kill in the next step."""
    now = [0.0]
    monkeypatch.setattr("ehlpetsc.results.writer.clock.monotonic", lambda: now[0])
    writer = make_writer(tmp_path / "r.h5")
    for step in range(steps):
        now[0] += pace
        put(writer, [step])
        with read_result(tmp_path / "r.h5") as left:
            kept = len(left.time)
            assert left.attrs["status"] == "running"
            assert kept == 0 or left.frame("pressure", -1)[1] == pytest.approx(kept - 1 + 0.01)
        assert pace * (step + 1 - kept) <= 2.0


def count_after(steps):
    return [sum(step % (k + 1) == 0 for step in range(steps)) for k in range(NX)]


@pytest.mark.parametrize("every", [1, 3])
def test_resumed_run_equals_an_uninterrupted_one(tmp_path, every):
    first = written(tmp_path / "first.h5", range(60), every=every)
    writer = make_writer(first, resume_step=59, contact_count=count_after(60))
    put(writer, range(60, 130), every)
    writer.close("done")
    assert_same_content(first, written(tmp_path / "whole.h5", range(130), every=every))
    with read_result(first) as result:
        assert result.attrs["restarts"] == 1
        (earlier,) = json.loads(result.attrs["history"])
        assert earlier["up_to_step"] == 59
        assert earlier["petsc_options"] == "-x 1"
        assert earlier["ranks"] == 2


def test_killed_run_is_resumed_from_an_earlier_step(tmp_path):
    path = killed(tmp_path / "r.h5", 50, 900)
    writer = make_writer(path, resume_step=40, contact_count=count_after(41))
    put(writer, range(41, 70))
    writer.close("done")
    assert_same_content(path, written(tmp_path / "whole.h5", range(70)))
    h5py.File(path, "r").close()  # no mark of the killed writer is left


@pytest.mark.parametrize(
    "changes, message",
    [
        ({"x": X * 2, "resume_step": 9}, "mesh"),
        ({"fields": ["pressure"], "resume_step": 9}, r"quantities \(film_thickness, in_contact, "),
        ({"resume_step": 12}, "at step 9, before step 12 "),
    ],
)
def test_result_of_another_run_is_refused_and_kept(tmp_path, changes, message):
    path = written(tmp_path / "r.h5", range(10))
    before = path.read_bytes()
    with pytest.raises(OutputError, match=message):
        make_writer(path, **changes)
    assert path.read_bytes() == before
    assert [p.name for p in tmp_path.iterdir()] == ["r.h5"]


def test_full_disk_is_reported_and_the_file_stays_readable(tmp_path, disk):
    writer = make_writer(tmp_path / "r.h5")
    put(writer, range(1024))
    writer.flush()
    disk[0] = 1_000_000
    with pytest.raises(OutputError, match=r"r\.h5: .* No space left on device$"):
        put(writer, range(1024, 20_000))
        writer.flush()
    with h5py.File(tmp_path / "r.h5", "r"):
        pass  # closed cleanly
    with read_result(tmp_path / "r.h5") as result:
        last = result.step[-1]
        assert result.attrs["status"] == "stopped" and last >= 1023
        np.testing.assert_array_equal(result.step, range(last + 1))
        np.testing.assert_array_equal(result.steps("newton"), range(last + 1))
        assert result.frame("pressure", -1)[1] == pytest.approx(last + 0.01)


@pytest.mark.parametrize(
    "make, message",
    [
        (lambda path: None, "such file$"),
        (lambda path: path.mkdir(), "r.h5: a folder"),
        (lambda path: path.write_text("x" * 3000), "r.h5: not an HDF5"),
        (lambda path: h5py.File(path, "w").close(), "r.h5: an HDF5 .*not a result"),
        (lambda path: save_restart(path, {"p": X}), "r.h5: an HDF5 .*not a result"),
        (lambda path: later_version(path), r"version 2, .* 1$"),
    ],
)
def test_foreign_result_files_are_refused(tmp_path, make, message):
    path = tmp_path / "r.h5"
    make(path)
    with pytest.raises(OutputError, match=message):
        read_result(path)


def test_file_that_may_not_be_read_is_not_called_damaged(tmp_path, monkeypatch):
    def denied(*_, **options):
        raise PermissionError(errno.EACCES, "Unable to open file")

    (tmp_path / "r.h5").touch()
    monkeypatch.setattr(h5py, "File", denied)
    with pytest.raises(OutputError, match=r"r\.h5: cannot be read: Permission denied$"):
        read_result(tmp_path / "r.h5")


def later_version(path):
    written(path, range(2))
    with h5py.File(path, "r+") as file:
        file.attrs["format_version"] = 2


def test_restart_content_round_trip(tmp_path):
    path = tmp_path / "r.restart.h5"
    for step in (4, 5):  # the second replaces the first
        save_restart(path, {"p": X, "h": 2 * X, "step": step, "case": "text", "time": 0.1})
    values = load_restart(path)
    assert values.keys() == {"p", "h", "step", "case", "time"}
    np.testing.assert_array_equal(values["h"], 2 * X)
    assert (values["step"], values["case"], values["time"]) == (5, "text", 0.1)
    assert [p.name for p in tmp_path.iterdir()] == [path.name]


@pytest.mark.parametrize("number", [errno.ENOLCK, errno.EOPNOTSUPP, errno.ENOSYS])
def test_file_system_without_locks_is_written_and_read(tmp_path, monkeypatch, number):
    real = h5py.File

    def without_locks(path, *arguments, locking=True, **options):
        if locking:
            raise OSError(number, "unable to lock file")
        return real(path, *arguments, locking=False, **options)

    monkeypatch.setattr(h5py, "File", without_locks)
    assert content(written(tmp_path / "a.h5", range(3)))["step"].tolist() == [0, 1, 2]


def test_file_that_another_process_has_locked_is_not_called_damaged(tmp_path):
    code = f"import h5py; file = h5py.File({str(tmp_path / 'a.h5')!r}, 'w', libver='earliest'); input()"
    code = code.replace("; input()", "; print(flush=True); input()")
    with subprocess.Popen([sys.executable, "-c", code], stdin=-1, stdout=-1, text=True) as other:
        other.stdout.readline()
        with pytest.raises(OutputError, match="a.h5: another process has it open for writing; wait for it"):
            read_result(tmp_path / "a.h5")
        other.communicate("\n")


def test_a_new_scalar_of_the_steps_is_one_entry_of_the_table(monkeypatch):
    def pressed(o):
        return o.node_size * o.pressure[3]

    weight = StepScalar("N", "pressure by film", integrated=True, of=pressed)
    monkeypatch.setitem(quantities.STEP_SCALARS, "weight", weight)
    case = ehlpetsc.load(CASES / "dry_hertz.toml", {"mesh.points_per_half_width": 20})
    with ehlpetsc.solve(case) as result:
        expected = result.pressure[0, 3] * (result.x[1] - result.x[0])
        assert result.steps.weight[0] == pytest.approx(expected) and result.unit("steps/weight") == "N/m"


@pytest.mark.parametrize("contact, unit", [("line", "m^2"), ("strip", "m^2"), ("point", "m^3")])
def test_unit_of_an_integral_is_per_metre_but_in_a_point_contact(contact, unit):
    volume = Field("m^3", "volume", integrated=True)
    assert quantities.unit_in(volume, contact) == unit
