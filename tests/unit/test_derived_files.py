"""Files made from results: what lies in their place, and a disk that is full."""

import shutil

import pytest
from support import ROOT, is_line_with
from support.made_results import make_result
from test_output import file_size_limit

from ehlpetsc.analysis import ensemble
from ehlpetsc.pictures.command import main as plot
from ehlpetsc.results.atomic_write import replacing
from ehlpetsc.results.restart_file import save_restart

CASE = ROOT / "cases" / "dry_hertz.toml"
PROFILE = "0.0,1e-7\n1e-6,2e-7\n"


def foreign(folder, name):
    """A file that no command may replace, by its ending."""
    path = folder / name
    if name.endswith(".restart.h5"):
        save_restart(path, {}, {"case": "a"})
    elif name.endswith((".h5", ".png", ".html", ".gif")):
        make_result(path)
    elif name.endswith(".toml"):
        shutil.copyfile(CASE, path)
    else:
        path.write_text('{"members": []}' if name.endswith(".json") else PROFILE)
    return path


@pytest.mark.parametrize(
    "name", ["other.h5", "other.restart.h5", "case.toml", "r.series.json", "r.passes.json", "profile.csv"]
)
def test_ensemble_overwrites_its_own_tables_only(tmp_path, capsys, name):
    result, other = make_result(tmp_path / "one.h5"), foreign(tmp_path, name)
    before = other.read_bytes()
    assert ensemble.main([str(result), "-o", str(other)]) == 2
    (message,) = capsys.readouterr().err.splitlines()
    assert f"{other}: " in message and "-o" in message
    assert other.read_bytes() == before


@pytest.mark.parametrize(
    "words, name",
    [
        ([], "other.h5"),
        ([], "case.toml"),
        (["--report"], "case.toml"),
        (["--movie"], "other.restart.h5"),
    ],
)
def test_picture_of_another_ending_is_refused(tmp_path, capsys, words, name):
    result, other = make_result(tmp_path / "one.h5"), foreign(tmp_path, name)
    before = other.read_bytes()
    assert plot([str(result), *words, "-o", str(other)]) == 2
    (message,) = capsys.readouterr().err.splitlines()
    assert f"{other}: " in message
    assert other.read_bytes() == before


@pytest.mark.parametrize(
    "words, name", [([], "one.png"), (["--report"], "one.html"), (["--movie"], "one.gif")]
)
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


def test_temporary_file_is_removed_after_an_error(tmp_path):
    (tmp_path / "a.png").write_text("older")
    with pytest.raises(OSError) as failed, replacing(tmp_path / "a.png", keep_ending=True) as beside:
        assert beside.suffix == ".png" and beside.parent == tmp_path
        raise OSError(28, "No space left on device")
    assert failed.value.filename == str(tmp_path / "a.png")
    assert [path.name for path in tmp_path.iterdir()] == ["a.png"]
