"""Files made from results by every command: what lies in their place, and a disk that is full."""

import contextlib
import os
import re
import resource
import shutil
import signal
import socket

import h5py
import numpy as np
import pytest
from support import CASES, COARSE_LIFE, ROOT, is_line_with, refused
from support.made_loads import Scene, write
from support.made_results import make_result

from ehlpetsc.__main__ import main as program
from ehlpetsc.base.errors import OutputError
from ehlpetsc.commands.explain import main as explain
from ehlpetsc.commands.gears import main as gears
from ehlpetsc.commands.life import main as life
from ehlpetsc.commands.plot import main as plot
from ehlpetsc.commands.post import main as post
from ehlpetsc.commands.summary import main as summary
from ehlpetsc.commands.surface import main as surface
from ehlpetsc.results.output_guard import Lock, replacing
from ehlpetsc.run.checkpoint import save_restart

CASE = ROOT / "cases" / "dry_hertz.toml"
PROFILE = "0.0,1e-7\n1e-6,2e-7\n"


@contextlib.contextmanager
def file_size_limit(size):
    """Writing beyond `size` bytes gives the errors of a full disk."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def foreign(folder, name):
    """A file that no command may replace, by its ending."""
    path = folder / name
    if name.endswith(".restart.h5"):
        save_restart(path, {"case": "a"})
    elif name.endswith((".h5", ".png", ".html", ".gif")):
        make_result(path)
    elif name.endswith(".toml"):
        shutil.copyfile(CASE, path)
    else:
        path.write_text('{"members": []}' if name.endswith(".json") else PROFILE)
    return path


@pytest.mark.parametrize("words, name", [([], "one.png"), (["--report"], "one.html")])
def test_full_disk_keeps_the_older_picture(tmp_path, capsys, words, name):
    result = make_result(tmp_path / "one.h5", steps=3)
    assert plot([str(result), *words]) == 0
    before = (tmp_path / name).read_bytes()
    capsys.readouterr()
    with file_size_limit(4096):
        assert plot([str(result), *words]) == 2
    (message,) = capsys.readouterr().err.splitlines()
    assert is_line_with(message, f"{tmp_path / name}: ", "File too large")
    assert (tmp_path / name).read_bytes() == before
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(["one.h5", name])


def test_temporary_file_exists_while_it_has_content_and_is_removed_after_an_error(tmp_path):
    """A kill cannot be answered: what it leaves is at least not an empty file."""
    with replacing(tmp_path / "a.png") as beside:
        assert list(tmp_path.iterdir()) == []
        beside.write_text("new")
    assert [path.name for path in tmp_path.iterdir()] == ["a.png"]
    with (
        pytest.raises(OutputError, match="none/a.png: not written, No such"),
        replacing(tmp_path / "none" / "a.png"),
    ):
        raise AssertionError("the folder is checked first")
    (tmp_path / "a.png").write_text("older")
    fails = pytest.raises(OutputError, match=r"a\.png: not written, No space")
    with fails, replacing(tmp_path / "a.png") as beside:
        assert beside.suffix == ".png" and beside.parent == tmp_path
        raise OSError(28, "No space left on device")
    assert [path.name for path in tmp_path.iterdir()] == ["a.png"]


def test_two_processes_write_the_same_file_one_after_the_other(tmp_path, monkeypatch):
    """Each a whole one; what a killed one left is removed, but not what another machine may be writing."""
    killed, beside = (f".tmp.99999999@{machine}.a.csv" for machine in (socket.gethostname(), "other.host"))
    for name in (killed, beside):
        (tmp_path / name).write_text("begun")
    with replacing(tmp_path / "a.csv") as first:
        first.write_text("first")
        monkeypatch.setattr(os, "getpid", os.getppid)
        with replacing(tmp_path / "a.csv") as second:
            second.write_text("second")
        assert (tmp_path / "a.csv").read_text() == "second"
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == {"a.csv": "first", beside: "begun"}


def test_disk_too_full_for_a_name_in_the_lock_is_locked(tmp_path, monkeypatch):
    lock, other = Lock(tmp_path / "a.h5"), Lock(tmp_path / "a.h5")
    with monkeypatch.context() as patch:
        patch.setattr(os, "write", lambda *_: (_ for _ in ()).throw(OSError(28, "No space left on device")))
        lock.acquire()
    with pytest.raises(OutputError, match=r"a\.h5: is being written by another process; wait for it"):
        other.acquire()
    lock.release()
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP, signal.SIGINT])
@pytest.mark.parametrize("command", ["post", "plot", "plot --report"])
def test_interrupted_command_leaves_no_temporary_file(tmp_path, monkeypatch, capsys, number, command):
    result, replace, (name, *words) = tmp_path / "one.h5", os.replace, command.split()
    write(result, Scene(per_width=10, travel=11.0)) if name == "post" else make_result(result, steps=3)

    def interrupted(*paths):
        os.kill(os.getpid(), number)
        return replace(*paths)

    monkeypatch.setattr(os, "replace", interrupted)  # when the new file is complete
    assert program([name, str(result), *words]) == 4
    assert capsys.readouterr().err.splitlines()[-1] == "ehlpetsc: stopped; files written before are complete"
    assert [path.name for path in tmp_path.iterdir()] == ["one.h5"]


def test_ctrl_c_to_which_a_library_adds_an_error_of_its_own_is_no_bug(tmp_path, monkeypatch, capsys):
    """Of a movie matplotlib saves the frames then, of which there are none; Python wraps it in a class."""
    from matplotlib.animation import PillowWriter

    def in_a_class(*_):
        raise RuntimeError("Error calling __set_name__") from KeyboardInterrupt()

    result = make_result(tmp_path / "one.h5", steps=3)
    monkeypatch.setattr(PillowWriter, "grab_frame", lambda *_, **__: signal.raise_signal(signal.SIGINT))
    assert program(["plot", str(result), "--movie"]) == 4
    for chain, status in ((in_a_class, 4), (lambda *_: 1 / 0, 1)):
        monkeypatch.setattr("ehlpetsc.commands.surface.run", chain)
        assert program(["surface", str(tmp_path / "z.csv")]) == status
    printed = capsys.readouterr().err
    assert printed.count("ehlpetsc: stopped; files written") == 2
    assert printed.count("Traceback") == printed.count("ZeroDivisionError") == 1
    assert [path.name for path in tmp_path.iterdir()] == ["one.h5"]


def sentence(capsys, command, *words):
    """The one sentence that a command ends with, after notes."""
    *notes, message = refused(capsys, command, *words).splitlines()
    assert all(re.search("note: |warning: |already there", line) for line in notes), notes
    return message


@pytest.mark.parametrize(
    "command, option, name",
    [
        *((command, "-o", "other.h5") for command in (plot, summary, gears)),
        *((command, "-o", "case.toml") for command in (plot, summary)),
        (summary, "-o", "a.series.json"),
        (summary, "--ensemble -o", "a.series.json"),
        (plot, "--report -o", "case.toml"),
        (gears, "--csv", "other.toml"),
    ],
)
def test_commands_write_files_of_their_endings_only(tmp_path, monkeypatch, capsys, command, option, name):
    monkeypatch.chdir(tmp_path)
    result, other = make_result(tmp_path / "one.h5"), foreign(tmp_path, name)
    before = other.read_bytes()
    read = CASES / "fzg.toml" if command is gears else result
    assert f"{other}: " in sentence(capsys, command, read, *option.split(), other)
    assert other.read_bytes() == before


def table_words(folder, command):
    """Words of a command that writes a table, without the option and name of its file."""
    if command is gears:
        return [CASES / "fzg.toml", "--no-picture"], "--csv"
    if command is surface:
        shutil.copy(CASES / "profiles" / "alicona_meander_profile.csv", folder / "other.csv")
        return [folder / "other.csv", "--no-picture"], "--csv"
    return [make_result(folder / "one.h5"), "--steps"], "-o"


@pytest.mark.parametrize("command", [summary, gears, surface])
def test_a_table_replaces_a_table_of_its_kind_alone_without_overwrite(tmp_path, monkeypatch, capsys, command):
    monkeypatch.chdir(tmp_path)
    words, option = table_words(tmp_path, command)
    measured = tmp_path / "p.csv"
    for content in (PROFILE, "X [m], z [m]\n" + PROFILE, "", "\xff\xfe"):
        measured.write_text(content, encoding="latin-1")
        message = sentence(capsys, command, *words, option, measured)
        assert is_line_with(message, f"{measured}: exists", f"another {option}, or --overwrite")
        assert measured.read_text(encoding="latin-1") == content
    assert command([*map(str, [*words, option, measured]), "--overwrite"]) == 0
    table = measured.read_bytes()
    assert b"[" in table.splitlines()[0] or command is gears
    assert command([*map(str, [*words, option, measured])]) == 0, "a table of this kind"
    assert measured.read_bytes() == table


@pytest.mark.parametrize("place", ["beside the result", "in the working folder"])
@pytest.mark.parametrize("key", ["file", "mask"])
def test_a_file_that_the_case_of_a_result_names_is_kept(tmp_path, monkeypatch, capsys, place, key):
    """Its first line may be that of a table, as a case can read the frame of another result."""
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere" if place == "beside the result" else tmp_path)
    names = {"file": "sub/p.csv"} if key == "file" else {"file": "sub/q.csv", "mask": "p.csv"}
    (tmp_path / "sub").mkdir()
    measured = tmp_path / "sub" / "p.csv"
    folder = tmp_path if place == "beside the result" else tmp_path / "elsewhere"
    keys = "\n".join(f'{name} = "{value}"' for name, value in names.items())
    result = make_result(folder / "one.h5")
    with h5py.File(result, "r+", libver="latest") as file:
        file.attrs["case"] += f"[surface.2]\n{keys}\n"
    assert summary([str(result), "--steps", "-o", str(measured)]) == 0
    before = measured.read_bytes()
    assert f"{measured}: is read by" in sentence(
        capsys, summary, result, "--steps", "-o", measured, "--overwrite"
    )
    assert measured.read_bytes() == before


def test_surface_and_case_are_kept_under_any_option(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    heights = 1e-7 * np.random.default_rng(1).standard_normal((12, 12))
    np.savetxt("map.csv", heights, delimiter=",")
    np.savetxt("mask.csv", heights > 1e-7, delimiter=",")
    case = shutil.copy(CASE, tmp_path)
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    words = ["map.csv", "--no-picture", "--set", "spacing=1e-6", "--set", "mask=mask.csv"]
    for name in ("map.csv", "mask.csv"):
        assert "is read by" in sentence(capsys, surface, *words, "--csv", name, "--overwrite")
    assert "is read by" in sentence(capsys, explain, case, "-o", case, "--overwrite")
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before


NO_INPUTS = "", "sub", "a.png", "a.restart.h5", "none.h5", "/dev/zero"


@pytest.mark.parametrize(
    "command, name",
    [
        *((command, name) for command in (gears, life, summary, surface) for name in NO_INPUTS),
        *((post, name) for name in NO_INPUTS[1:]),
    ],
)
def test_invalid_input_is_refused_in_one_line(tmp_path, monkeypatch, capsys, command, name):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "sub").mkdir()
    (tmp_path / "a.png").write_bytes(b"\x89PNG\r\n\x1a\n\0\0")
    save_restart(tmp_path / "a.restart.h5", {"case": "a"})
    message = sentence(capsys, command, name)
    assert not message.startswith(" "), "an empty name is shown as such"
    assert len(os.listdir(tmp_path)) == 3


@pytest.mark.parametrize("name", ["", "case.toml", "p.csv", "a.png", "sub"])
def test_life_does_not_overwrite_another_file(tmp_path, monkeypatch, capsys, name):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "sub").mkdir()
    if "." in name:
        foreign(tmp_path, name)
    before = {path: path.read_bytes() for path in tmp_path.iterdir() if path.is_file()}
    assert sentence(capsys, life, COARSE_LIFE, "-o", name, "--overwrite")
    assert {path: path.read_bytes() for path in tmp_path.iterdir() if path.is_file()} == before
