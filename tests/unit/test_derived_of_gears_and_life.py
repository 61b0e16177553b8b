"""Files that gears, life and post --pictures write: what lies in their place, what is no input."""

import os
import re
import shutil

import h5py
import numpy as np
import pytest
from support import CASES, COARSE_LIFE, refused
from support.made_loads import Scene, write
from support.made_results import make_result
from test_derived_files import foreign
from test_output import file_size_limit

from ehlpetsc.analysis.summary import main as summary
from ehlpetsc.case.loading import load
from ehlpetsc.errors import OutputError
from ehlpetsc.gears.command import main as gears
from ehlpetsc.life.body import LifeBody
from ehlpetsc.life.command import main as life
from ehlpetsc.life.driver import run_life
from ehlpetsc.life.history import LifeHistory
from ehlpetsc.post import run as post_run
from ehlpetsc.post.command import main as post
from ehlpetsc.results.restart_file import save_restart


@pytest.fixture
def pair(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return shutil.copyfile(CASES / "fzg.toml", tmp_path / "pair.toml")


@pytest.fixture
def lived(tmp_path):
    """A life of one pass."""
    edges = np.array([0.0, 1e-6, 2e-6])
    body = LifeBody.new(np.linspace(0.0, 1e-5, 11), np.zeros(11), edges)
    figures = dict.fromkeys(["pitted_share", "wear_volume", "ra"], 0.1)
    row = {"passes": 10, "jump": 10, "friction": 0.1}
    found = LifeHistory("text", "title")
    found.add(row | {f"{name}_{k}": v for name, v in figures.items() for k in (1, 2)}, (body, body), {})
    found.save(tmp_path / "a.life.h5")
    return tmp_path / "a.life.h5"


def sentence(capsys, command, *words):
    """The one sentence that a command ends with, after notes."""
    *notes, message = refused(capsys, command, *words).splitlines()
    assert all(re.search("note: |warning: |already there", line) for line in notes), notes
    return message


@pytest.mark.parametrize("option, ending", [("--csv", ".csv"), ("--csv", ".toml"), ("-o", ".h5")])
def test_gears_overwrites_its_own_files_only(pair, tmp_path, capsys, option, ending):
    other = foreign(tmp_path, f"other{ending}")
    before = other.read_bytes()
    message = sentence(capsys, gears, pair, option, other)
    assert f"{other}: " in message and option in message
    assert other.read_bytes() == before


@pytest.mark.parametrize("option", ["-o", "--csv"])
@pytest.mark.parametrize("name", ["", "/", ".", "sub", "x.xyz", "pair.toml", "none/x.png"])
def test_gears_refuses_invalid_file_names(pair, tmp_path, capsys, option, name):
    (tmp_path / "sub").mkdir()
    before = pair.read_bytes()
    assert sentence(capsys, gears, pair, option, name)
    assert pair.read_bytes() == before
    assert sorted(os.listdir(tmp_path)) == ["pair.toml", "sub"]


def test_gears_replaces_its_files_and_a_full_disk_keeps_them(pair, tmp_path, capsys):
    words = [str(pair), "--csv", "mesh.csv"]
    assert gears(words) == 0 and gears(words) == 0
    files = [tmp_path / "mesh.csv", tmp_path / "pair.gears.png"]
    before = [path.read_bytes() for path in files]
    for name, words in (
        ("mesh.csv", (pair, "--csv", "mesh.csv", "--no-picture")),
        ("pair.gears.png", (pair,)),
    ):
        with file_size_limit(1024):
            message = sentence(capsys, gears, *words)
            assert f"{name}: " in message and message.endswith(", File too large")
    assert [path.read_bytes() for path in files] == before
    assert len(os.listdir(tmp_path)) == 3


@pytest.mark.parametrize("command", [gears, life, summary])
@pytest.mark.parametrize("name", ["", "/", "sub", "sub.h5", "a.png", "a.restart.h5", "none.h5", "/dev/zero"])
def test_invalid_input_is_refused_in_one_line(tmp_path, monkeypatch, capsys, command, name):
    monkeypatch.chdir(tmp_path)
    for folder in ("sub", "sub.h5"):
        (tmp_path / folder).mkdir()
    (tmp_path / "a.png").write_bytes(b"\x89PNG\r\n\x1a\n\0\0")
    save_restart(tmp_path / "a.restart.h5", {}, {"case": "a"})
    message = sentence(capsys, command, name)
    assert not message.startswith(" "), "an empty name is shown as such"
    assert len(os.listdir(tmp_path)) == 4


@pytest.mark.parametrize("name", ["other.h5", "other.restart.h5", "case.toml", "profile.csv", "a.png"])
def test_summary_overwrites_its_own_tables_only(tmp_path, capsys, name):
    result, other = make_result(tmp_path / "one.h5"), foreign(tmp_path, name)
    before = other.read_bytes()
    assert f"{other}: " in sentence(capsys, summary, result, "-o", other)
    assert other.read_bytes() == before


def test_life_picture_is_replaced_and_kept_on_a_full_disk(lived, tmp_path, capsys):
    assert life([str(lived)]) == 0 and life([str(lived)]) == 0
    picture = tmp_path / "a.life.png"
    before = picture.read_bytes()
    with file_size_limit(4096):
        message = sentence(capsys, life, lived)
    assert message.startswith(f"ehlpetsc life: {picture}: ") and message.endswith(", File too large")
    assert picture.read_bytes() == before
    assert sorted(os.listdir(tmp_path)) == ["a.life.h5", "a.life.png"]


def test_damaged_life_is_refused_in_one_line(lived, capsys):
    with h5py.File(lived, "a") as file:
        del file["figures"]
        file["figures"] = 1.0
    assert "damaged" in sentence(capsys, life, lived)


@pytest.mark.parametrize("name", ["", "case.toml", "profile.csv", "a.png", "sub", "sub.h5"])
def test_life_does_not_overwrite_another_file(tmp_path, monkeypatch, capsys, name):
    monkeypatch.chdir(tmp_path)
    for folder in ("sub", "sub.h5"):
        (tmp_path / folder).mkdir()
    if name in ("case.toml", "profile.csv", "a.png"):
        foreign(tmp_path, name)
    before = {path: path.read_bytes() for path in tmp_path.iterdir() if path.is_file()}
    assert sentence(capsys, life, COARSE_LIFE, "-o", name, "--overwrite")
    assert {path: path.read_bytes() for path in tmp_path.iterdir() if path.is_file()} == before


def test_life_keeps_a_result_named_as_its_pass(tmp_path):
    other = make_result(tmp_path / "x.life.pass.h5")
    before = other.read_bytes()
    with pytest.raises(OutputError, match=r"x\.life\.pass\.h5: exists"):
        run_life(load(COARSE_LIFE), tmp_path / "x.life.h5", most=1, unresolved=True)
    assert other.read_bytes() == before


def test_life_overwrites_its_own_passes_only(tmp_path):
    case, path = load(COARSE_LIFE), tmp_path / "x.life.h5"
    first = run_life(case, path, most=1, unresolved=True).done
    assert run_life(case, path, most=1, unresolved=True).done > first  # continued
    assert run_life(case, path, most=1, overwrite=True, unresolved=True).done == first
    one_pass = tmp_path / "x.life.pass.h5"
    one_pass.write_bytes(one_pass.read_bytes()[:4096])  # as of a run killed while it writes
    assert run_life(case, path, most=1, overwrite=True, unresolved=True).done == first


@pytest.fixture
def crossing(tmp_path):
    return write(tmp_path / "run.h5", Scene(per_width=20, ratio=0.5, travel=9.0), depths=(0.0, 0.5))


@pytest.mark.parametrize("folder", ["/proc", "file"])
def test_post_reports_an_unwritable_folder(crossing, tmp_path, capsys, folder):
    (tmp_path / "file").write_text("")
    folder = tmp_path / folder  # /proc: of its own
    assert f"{folder}" in sentence(capsys, post, crossing, "-o", folder / "x.post.h5")
    assert f"{folder}" in sentence(capsys, post, crossing, "--pictures", folder)
    assert (tmp_path / "file").read_text() == ""


@pytest.mark.parametrize("left", [None, "a file"])
def test_post_reports_a_folder_removed_during_the_run(crossing, tmp_path, capsys, monkeypatch, left):
    out, solve = tmp_path / "out", post_run.solve
    out.mkdir()

    def go(*arguments):
        values = solve(*arguments)
        shutil.rmtree(out, ignore_errors=True)
        if left and not out.exists():
            out.write_text(left)
        return values

    monkeypatch.setattr(post_run, "solve", go)
    assert "not written" in sentence(capsys, post, crossing, "-o", out / "x.post.h5")
    assert (out.read_text() == left) if left else not out.exists()
