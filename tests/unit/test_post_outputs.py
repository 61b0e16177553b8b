"""What is written and what never is: over other files, by two runs at once, half. Signals, crashes, hangs."""

import faulthandler
import gzip
import importlib.util
import os
import resource
import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import h5py
import numpy as np
import pytest
from support import ROOT, is_line_with, refused
from support.made_loads import Scene, write

from ehlpetsc.errors import ExitStatus
from ehlpetsc.post import subprocess_guard
from ehlpetsc.post.command import main
from ehlpetsc.post.run import Job, run
from ehlpetsc.post.subprocess_guard import SubprocessGuard
from ehlpetsc.results.hdf5.lazy_dataset import reading
from ehlpetsc.results.output_guard import Lock
from ehlpetsc.results.post_result import PostResult

pytestmark = pytest.mark.usefixtures("coarse_pictures")
COMMAND = [sys.executable, "-m", "ehlpetsc", "post"]


@pytest.fixture(scope="module")
def scene():
    return Scene(per_width=20, ratio=0.5, travel=9.0)


@pytest.fixture
def result(scene, tmp_path):
    return write(tmp_path / "run.h5", scene, depths=(0.0, 0.5))


def left_over(folder):
    """Names of what should not be there after a command."""
    return [path.name for path in folder.iterdir() if ".parts" in path.name or ".tmp" in path.name]


def test_input_is_never_the_post_output(result, tmp_path, capsys):
    before = result.read_bytes()
    assert is_line_with(refused(capsys, main, result, "-o", result), f"{result}: ", f"({result})", " -o")
    link = tmp_path / "link.h5"
    link.symlink_to(result)
    assert is_line_with(refused(capsys, main, result, "-o", link), f"{link}: ", f"({result})", " -o")
    assert result.read_bytes() == before and not left_over(tmp_path)


def test_output_of_one_file_is_never_another_input(result, scene, capsys):
    assert main([str(result)]) == 0
    output = result.with_name("run.post.h5")
    first, second = refused(capsys, main, result, output).splitlines()
    assert is_line_with(first, f"{result}: {output}: ", f"({output})", " -o")
    assert is_line_with(second, f"ehlpetsc.post: {output}: ", "post-processing")


def test_other_files_are_not_overwritten(result, scene, tmp_path, capsys):
    other = write(tmp_path / "other.h5", scene)
    text = tmp_path / "notes.txt"
    text.write_text("mine")
    before = other.read_bytes()
    for path in (other, text):
        assert is_line_with(refused(capsys, main, result, "-o", path), f" {path} exists ", " -o")
    assert "a folder, not a file" in refused(capsys, main, result, "-o", tmp_path)
    assert other.read_bytes() == before and text.read_text() == "mine"
    path = tmp_path / "none" / "a.h5"
    assert is_line_with(refused(capsys, main, result, "-o", path), f" {path} ", "folder")


def test_foreign_folder_is_kept(result, tmp_path, capsys):
    mine = tmp_path / "run.post.h5.parts" / "thesis.tex"
    mine.parent.mkdir()
    mine.write_text("mine")
    assert is_line_with(refused(capsys, main, result).splitlines()[-1], f"{mine.parent} ", "folder", "remove")
    assert mine.read_text() == "mine"


def test_earlier_post_result_is_replaced(result, tmp_path):
    output = tmp_path / "run.post.h5"
    assert main([str(result)]) == 0 == main([str(result), "--depths", "0.3"])
    assert PostResult(output).z.tolist() == [0.3] and not left_over(tmp_path)


def test_edit_with_the_same_size_and_time_is_detected(result, tmp_path, capsys):
    output, stamp = tmp_path / "run.post.h5", os.stat(result)
    assert main([str(result)]) == 0
    first = PostResult(output).damage["2"]
    with h5py.File(result, "r+") as file:
        file["shear_stress_2"][200] = file["shear_stress_2"][200] * 1.5
    os.utime(result, ns=(stamp.st_atime_ns, stamp.st_mtime_ns))
    assert os.stat(result).st_size == stamp.st_size
    capsys.readouterr()
    assert main([str(result)]) == 0 and "already there" not in capsys.readouterr().err
    assert np.nanmax(np.abs(PostResult(output).damage["2"] - first)) > 0
    assert main([str(result)]) == 0 and "already there" in capsys.readouterr().err


def test_output_is_locked_by_one_run(result, tmp_path, capsys):
    with Lock(tmp_path / "run.post.h5"):
        message = refused(capsys, main, result).splitlines()[-1]
        assert is_line_with(message, "run.post.h5: ", f" process {os.getpid()} ")
    assert main([str(result)]) == 0 and not left_over(tmp_path)


@pytest.mark.parametrize("room", [4096, 40_000], ids=["for no part", "for the parts"])
def test_full_disk(room, result, tmp_path):
    """A limit to the size of files ends a write as a full disk does."""

    def limit():
        resource.setrlimit(resource.RLIMIT_FSIZE, (room, room))

    size = 2 * 3 * 8 * (9 * 20 + 81)  # of a part, about
    assert 4096 < size < 40_000
    ended = subprocess.run([*COMMAND, result], cwd=ROOT, preexec_fn=limit, capture_output=True, text=True)
    assert ended.returncode == 2 and "Traceback" not in ended.stderr
    assert "run.post.h5: not written" in ended.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["run.h5"]


def catches(process, number):
    """Whether a process has a handler of that signal."""
    status = Path(f"/proc/{process.pid}/status").read_text()
    caught = next(line.split()[1] for line in status.splitlines() if line.startswith("SigCgt"))
    return bool(int(caught, 16) >> (number - 1) & 1)


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_signal_during_imports_of_post(number, result, tmp_path):
    process = subprocess.Popen([*COMMAND, result], cwd=ROOT, stderr=subprocess.PIPE, text=True)
    while not catches(process, signal.SIGTERM):
        time.sleep(0.001)
    process.send_signal(number)
    assert process.wait(30) == 4 and "Traceback" not in process.stderr.read()
    assert [path.name for path in tmp_path.iterdir()] == ["run.h5"]


@pytest.mark.slow
def test_sigterm_keeps_finished_depths(scene, tmp_path):
    depths = tuple(0.05 * k for k in range(10))
    path, output = write(tmp_path / "run.h5", scene, depths=depths), tmp_path / "run.post.h5"
    process = subprocess.Popen([*COMMAND, path], cwd=ROOT, stderr=subprocess.PIPE, text=True)
    while not list(tmp_path.glob("run.post.h5.parts/*.npy")):
        assert process.poll() is None
        time.sleep(0.001)
    process.terminate()
    assert process.wait(30) == 4 and "finished depths" in process.stderr.read()
    assert not output.exists() and list(tmp_path.glob("run.post.h5.parts/*.npy"))
    run(Job(str(path), str(output)))
    run(Job(str(path), str(tmp_path / "whole.h5")))
    ours, whole = PostResult(output), PostResult(tmp_path / "whole.h5")
    np.testing.assert_allclose(ours.damage["2"], whole.damage["2"], rtol=1e-9)
    assert not left_over(tmp_path)


def test_bad_file_does_not_stop_the_others(result, scene, tmp_path, capsys):
    bad = tmp_path / "bad.h5"
    bad.write_text("no HDF5")
    good = write(tmp_path / "good.h5", Scene(per_width=20, ratio=0.5, travel=9.0, seed=7))
    assert main([str(result), str(bad), str(good)]) == ExitStatus.BAD_INPUT
    captured = capsys.readouterr()
    assert f"ehlpetsc.post: {bad}: not an HDF5 file" in captured.err
    assert captured.out.count("ehlpetsc.post: done") == 2 and good.with_name("good.post.h5").exists()


def test_points_above_the_surface_are_refused(result, capsys):
    with pytest.raises(SystemExit) as ended:
        main([str(result), "--pictures", "--point", "-3", "-0.1"])
    assert ended.value.code == 2 and "0 or more" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["/", "", ".", "//"])
def test_invalid_result_name_is_refused(name, capsys):
    with pytest.raises(SystemExit) as ended:
        main([name])
    assert ended.value.code == ExitStatus.BAD_INPUT
    assert f": {str(Path(name))!r}: " in capsys.readouterr().err


def test_restart_file_and_folder_are_refused_as_results(tmp_path, capsys):
    packed = ROOT / "tests" / "data" / "older" / "direct.restart.h5.gz"
    (tmp_path / "r.restart.h5").write_bytes(gzip.decompress(packed.read_bytes()))
    assert "r.restart.h5: an HDF5" in refused(capsys, main, tmp_path / "r.restart.h5")
    assert f"ehlpetsc.post: {tmp_path}: " in refused(capsys, main, tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["r.restart.h5"]


@pytest.mark.parametrize("name", ["first", "passes.pass1"])
def test_results_of_earlier_versions_are_processed(name, tmp_path, capsys):
    """Or refused for their travel, not for their age."""
    for packed in (ROOT / "tests" / "data" / "older").glob(f"{name}.h5.gz"):
        (tmp_path / f"{name}.h5").write_bytes(gzip.decompress(packed.read_bytes()))
    status = main([str(tmp_path / f"{name}.h5"), "--depths", "0.05"])
    message = capsys.readouterr().err
    if name == "first":
        assert status == ExitStatus.BAD_INPUT and "raise time.travel" in message
    else:
        assert status == ExitStatus.DONE
        assert PostResult(tmp_path / f"{name}.post.h5").passed("2").max() == pytest.approx(2e-10, rel=0.1)


@pytest.mark.parametrize("title", ["lone \udc80 surrogate", np.bytes_(b"raw byte \xff")])
def test_title_that_is_not_utf_8(title, scene, tmp_path, capsys):
    def edit(file):
        raw = title if isinstance(title, bytes) else title.encode(errors="surrogateescape")
        file.attrs["title"] = np.bytes_(raw)

    path = write(tmp_path / "a.h5", scene, depths=(0.5,), edit=edit)
    assert main([str(path), "--pictures", str(tmp_path / "p")]) == ExitStatus.DONE
    assert "\ufffd" in PostResult(tmp_path / "a.post.h5").title
    capsys.readouterr().out.encode()


def test_contact_of_one_node_has_damage(tmp_path, capsys):
    """All of the load on one node that travels with surface 2: damage where it passes."""
    scene = Scene(per_width=20, ratio=0.5, travel=9.0)

    def pressure(k):
        p = 0 * scene.x
        p[(k * 3 // 8) % p.size] = 527e3 / scene.dx
        return p

    scene.pressures = np.array([pressure(k) for k in range(scene.time.size)])
    path = write(tmp_path / "a.h5", scene, depths=(0.0, 0.1))
    assert main([str(path), "--pictures", str(tmp_path / "p")]) == ExitStatus.DONE
    result = PostResult(tmp_path / "a.post.h5")
    assert np.isfinite(result.passed("2")).all() and result.passed("2").max() > 1e-3


@pytest.mark.slow
def test_full_disk_leaves_complete_pictures_only(result, tmp_path):
    """Pictures are written beside and renamed: what is there can be opened."""
    assert main([str(result)]) == 0
    limit = partial(resource.setrlimit, resource.RLIMIT_FSIZE, (150_000, 150_000))
    words = [*COMMAND, result, "--pictures", tmp_path / "p"]
    ended = subprocess.run(words, cwd=ROOT, preexec_fn=limit, capture_output=True, text=True)
    assert ended.returncode == 2 and "not written" in ended.stderr and "Traceback" not in ended.stderr
    for path in (tmp_path / "p").iterdir():
        assert path.suffix in (".png", ".svg") and path.stat().st_size < 150_000
        assert path.read_bytes().rstrip().endswith((b"IEND\xaeB`\x82", b"</svg>"))


@pytest.fixture
def supervisor():
    """A guard that collects its messages."""
    messages = []
    made = SubprocessGuard(messages.append)
    made.messages = messages
    return made


def test_crash_while_reading_names_the_dataset(supervisor):
    def crash():
        faulthandler.disable()  # pytest's, which would tell of it at length
        with reading("a.h5", "pressure"):
            os.kill(os.getpid(), signal.SIGSEGV)

    assert supervisor("a.h5", crash) == ExitStatus.BAD_INPUT
    (message,) = supervisor.messages
    assert is_line_with(message, "a.h5: pressure: ", "(SIGSEGV)")
    assert supervisor("b.h5", lambda: ExitStatus.DONE) == ExitStatus.DONE


def test_hanging_read_is_refused(supervisor, monkeypatch):
    monkeypatch.setattr(subprocess_guard, "MAX_READ_SECONDS", 1)

    def hang():
        with reading("a.h5", "time"):
            time.sleep(60)

    assert supervisor("a.h5", hang) == ExitStatus.BAD_INPUT
    assert supervisor.messages[0].startswith("a.h5: time: HDF5 ") and "SIG" not in supervisor.messages[0]


def test_crash_outside_reading_is_a_bug(supervisor):
    def crash():
        faulthandler.disable()
        os.kill(os.getpid(), signal.SIGFPE)

    assert supervisor("a.h5", crash) == ExitStatus.BUG


@pytest.mark.slow
def test_damaged_files_are_refused_or_read():
    """A few of `tests/fuzz/post.py`: every one is refused with its reason, or read."""
    spec = importlib.util.spec_from_file_location("fuzz_post", ROOT / "tests" / "fuzz" / "post.py")
    fuzz = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(fuzz)
    found = fuzz.fuzz(flips=25, structures=25, seed=3)
    for counts in found.values():
        assert {word: counts[word] for word in fuzz.BAD} == dict.fromkeys(fuzz.BAD, 0)
    assert found["flips"]["refused"] > 1 and found["structures"]["refused"] > 15
