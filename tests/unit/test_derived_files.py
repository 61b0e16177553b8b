"""Files made from results: what lies in their place, and a disk that is full."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from support import ROOT, is_line_with
from support.made_results import make_result
from test_output import file_size_limit

from ehlpetsc.analysis import ensemble
from ehlpetsc.errors import OutputError
from ehlpetsc.pictures.command import main as plot
from ehlpetsc.results.atomic_write import replacing
from ehlpetsc.results.output_guard import PICTURES, check_derived
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


@pytest.mark.parametrize("ending", [".csv", ".json"])
def test_ensemble_table_is_replaced(tmp_path, ending):
    words = [str(make_result(tmp_path / "one.h5")), "-o", str(tmp_path / f"t{ending}")]
    assert ensemble.main(words) == 0
    first = Path(words[-1]).read_bytes()
    assert ensemble.main([*words, "--seed", "2"]) == 0
    assert Path(words[-1]).read_bytes() == first  # one run: no interval that the seed could change


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


def test_picture_is_replaced(tmp_path):
    words = [str(make_result(tmp_path / "one.h5"))]
    assert plot(words) == 0 and plot(words) == 0
    assert (tmp_path / "one.png").read_bytes().startswith(b"\x89PNG")


def test_picture_name_without_a_format_is_refused(tmp_path):
    with pytest.raises(OutputError, match=r"x\.xyz: .*-o: .* \.png, "):
        check_derived(tmp_path / "x.xyz", (), PICTURES)


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


@pytest.mark.parametrize("name", ["t.csv", "t.json"])
def test_full_disk_keeps_the_older_table(tmp_path, capsys, name):
    words = [str(make_result(tmp_path / "one.h5")), "-o", str(tmp_path / name)]
    assert ensemble.main(words) == 0
    before = (tmp_path / name).read_bytes()
    with file_size_limit(100):
        assert ensemble.main(words) == 2
    assert is_line_with(capsys.readouterr().err, f"{tmp_path / name}: ", "File too large")
    assert (tmp_path / name).read_bytes() == before
    assert sorted(path.name for path in tmp_path.iterdir()) == ["one.h5", name]


def test_failed_movie_encoder_is_reported_in_one_line(tmp_path):
    result = make_result(tmp_path / "one.h5", steps=3)
    (tmp_path / "bin").mkdir()
    encoder = tmp_path / "bin" / "ffmpeg"
    encoder.write_text("#!/bin/sh\ncat >/dev/null\necho 'No space left on device' >&2\nexit 1\n")
    encoder.chmod(0o755)
    done = subprocess.run(
        [sys.executable, "-m", "ehlpetsc", "plot", result, "--movie", "-o", tmp_path / "m.mp4"],
        cwd=ROOT,
        env={"PATH": f"{tmp_path / 'bin'}:/usr/bin:/bin", "HOME": str(tmp_path)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 2, done.stderr
    assert f"{tmp_path / 'm.mp4'}: not written" in done.stderr and "Traceback" not in done.stderr
    assert not list(tmp_path.glob("*.mp4")) and not list(tmp_path.glob(".m.mp4*"))


def test_temporary_file_is_removed_after_an_error(tmp_path):
    (tmp_path / "a.png").write_text("older")
    with pytest.raises(OSError) as failed, replacing(tmp_path / "a.png", keep_ending=True) as beside:
        assert beside.suffix == ".png" and beside.parent == tmp_path
        raise OSError(28, "No space left on device")
    assert failed.value.filename == str(tmp_path / "a.png")
    assert [path.name for path in tmp_path.iterdir()] == ["a.png"]
