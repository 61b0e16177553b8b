"""Series from the command line: one result per member, failures named, reruns of missing members."""

import json
import re
import shutil

import pytest
from support import ROOT, is_line_with
from support.running import SHORT, run, settings, summary

from ehlpetsc.commands.plot import main as plot
from ehlpetsc.commands.summary import main as summary_table
from ehlpetsc.results.reader import read_result

CASE = ROOT / "cases" / "fig4.toml"
VALUES = (0.01, 0.006, 0.003)
QUICK = [*SHORT[:-1], "time.travel=0.3"]


def series(folder, *words, ranks=2, values=VALUES, key="fluid.viscosity", tampered=()):
    sets = [*QUICK, f"series.key='{key}'", f"series.values={json.dumps(list(values))}"]
    words = ["--output", "out.h5", *settings(*sets), *words]
    return run(CASE, *words, cwd=folder, ranks=ranks, tampered=tampered)


def states(folder):
    index = json.loads((folder / "out.series.json").read_text())
    assert index["key"] in index["case"]
    return {entry["file"]: entry["state"] for entry in index["members"]}


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """Three members on two ranks."""
    folder = tmp_path_factory.mktemp("series")
    done = series(folder)
    shutil.copytree(folder, kept(folder))  # unchanged copies: other tests modify the originals
    return folder, done


def kept(folder):
    return folder.with_name("kept")


@pytest.mark.slow
def test_every_series_member_has_a_result(finished):
    folder, done = finished
    assert done.returncode == 0, done.stderr
    assert states(folder) == {f"out_viscosity_{v:g}.h5": "done" for v in VALUES}
    one, whole = [], summary(done.stdout)
    for value in VALUES:
        with read_result(folder / f"out_viscosity_{value:g}.h5") as result:
            assert result.attrs["status"] == "done" and result.attrs["ranks"] == 1
            assert f"viscosity = {value}" in result.attrs["case"]
            newton, highest = result.steps("newton"), result.steps("p_max").max()
            one.append((len(newton) - 1, newton.sum(), highest))
        assert f"[viscosity={value:g}] ehlpetsc: done steps=" in done.stdout
    assert int(whole["steps"]) == sum(steps for steps, *_ in one)
    assert int(whole["newton"]) == sum(newton for _, newton, _ in one)
    assert float(whole["p_max"]) == pytest.approx(max(p for *_, p in one), rel=1e-8)


@pytest.mark.slow
def test_series_member_equals_a_single_run(finished, tmp_path):
    folder, _ = finished
    alone = run(
        ROOT / "cases" / "table1_rough.toml",
        "--output",
        "alone.h5",
        *settings(*QUICK, "fluid.viscosity=0.003"),
        cwd=tmp_path,
    )
    assert alone.returncode == 0, alone.stderr
    with read_result(tmp_path / "alone.h5") as a, read_result(folder / "out_viscosity_0.003.h5") as b:
        assert (a.steps("p_max") == b.steps("p_max")).all() and (a.steps("time") == b.steps("time")).all()


@pytest.mark.slow
def test_rerun_computes_missing_members_only(finished):
    folder, first = finished
    files = sorted(folder.glob("out_*.h5"))
    before = {file: file.stat().st_mtime_ns for file in files}
    files[0].unlink()
    again = series(folder, ranks=0)
    assert again.returncode == 0 and "3 members, 1 of " in again.stdout
    assert [file for file in files if before[file] != file.stat().st_mtime_ns] == files[:1]
    one, two = summary(first.stdout), summary(again.stdout)
    assert all(one[name] == two[name] for name in ("steps", "newton", "contacts", "h_min"))
    other = series(folder, "--set", "time.courant=1.0", ranks=0)
    assert other.returncode == 2 and "viscosity=0.006: bad input: out_viscosity_0.006.h5: " in other.stderr
    assert "another case" in other.stderr and before[files[1]] == files[1].stat().st_mtime_ns
    other = series(folder, "--set", "time.courant=1.0", "--overwrite", ranks=0)
    assert other.returncode == 0 and " 3 of " in other.stdout


@pytest.mark.parametrize("text", ["mine", '{"key": "mine"}'])
def test_foreign_index_is_refused_and_kept(tmp_path, text):
    (tmp_path / "out.series.json").write_text(text)
    refused = series(tmp_path, ranks=0)
    assert refused.returncode == 2 and is_line_with(refused.stderr, "out.series.json: ", "an index")
    assert [path.name for path in tmp_path.iterdir()] == ["out.series.json"]
    assert (tmp_path / "out.series.json").read_text() == text


def test_foreign_file_of_a_member_is_refused_and_kept(tmp_path):
    (tmp_path / "out_viscosity_0.006.h5").write_text("mine")
    refused = series(tmp_path, ranks=0, values=VALUES[:2])
    assert refused.returncode == 2 and is_line_with(refused.stderr, "0.006.h5: ", "a result", "--overwrite")
    assert list(states(tmp_path).values()) == ["done", "bad input"]
    assert (tmp_path / "out_viscosity_0.006.h5").read_text() == "mine"


def test_failed_member_is_named_and_does_not_stop_the_series(tmp_path):
    done = series(tmp_path, ranks=0, key="petsc.snes_max_it", values=("1", "30", "0"))
    assert done.returncode == 3
    assert list(states(tmp_path).values()) == ["not converged", "done", "not converged"]
    assert re.search("ehlpetsc: snes_max_it=1: .*steady start", done.stderr)
    assert "snes_max_it=0: " in done.stderr and "snes_max_it=30:" not in done.stderr
    assert done.stdout.strip().splitlines()[-1].startswith("ehlpetsc: not converged steps=")


def test_series_in_a_removed_folder_ends_on_every_rank(tmp_path):
    """Only the first rank writes the index: if it fails, the others must not wait forever."""
    (tmp_path / "out").mkdir()
    done = series(tmp_path, "--output", "out/out.h5", tampered=("lost", 0, 5))
    assert done.returncode == 5
    assert re.search(
        r"ehlpetsc: out/out\.series\.json: .*, No such file or directory: create the folder out first\n",
        done.stderr,
    )
    assert re.search(r"out_viscosity_\S+\.h5: .*No such file or directory", done.stderr)
    assert "Traceback" not in done.stderr and "index:" not in done.stdout
    assert done.stdout.strip().splitlines()[-1].startswith("ehlpetsc: output lost steps=")


@pytest.mark.slow
def test_stopped_series_continues(tmp_path, finished):
    stopped = series(tmp_path, tampered=("SIGUSR1", 0, 10))  # in the first rank's first member
    assert stopped.returncode == 4, stopped.stdout + stopped.stderr
    assert "the same command" in stopped.stdout
    assert sorted(states(tmp_path).values()) == ["done", "stopped", "waiting"]
    on = series(tmp_path, ranks=0)
    assert on.returncode == 0 and "[viscosity=0.003] restart: " in on.stdout and "step 10," in on.stdout
    assert set(states(tmp_path).values()) == {"done"}
    assert summary(on.stdout)["steps"] == summary(finished[1].stdout)["steps"]


def assert_as_finished(folder, finished):
    assert set(states(folder).values()) == {"done"}
    for name in states(folder):
        with read_result(folder / name) as one, read_result(kept(finished[0]) / name) as other:
            assert list(one.step) == list(other.step)
            assert abs(one.pressure - other.pressure).max() < 1e-9 * one.attrs["p0"]
    assert not [path.name for path in folder.iterdir() if path.suffix == ".lock" or path.name[0] == "."]


@pytest.mark.slow
@pytest.mark.parametrize("ranks, accident", [(2, ("SIGKILL", 1, 5)), (0, ("index", 0, 2))])
def test_killed_series_is_completed_by_the_same_command(tmp_path, finished, ranks, accident):
    killed = series(tmp_path, ranks=ranks, tampered=accident)
    assert killed.returncode not in (0, 4)
    assert set(states(tmp_path).values()) != {"done"}  # the index is whole, old or new
    on = series(tmp_path, ranks=0)
    assert on.returncode == 0, on.stderr
    assert_as_finished(tmp_path, finished)


@pytest.mark.parametrize(
    "words, fault",
    [
        (["--restart", "x.h5"], "--restart with a [series]: "),
        (["--set", "series.values=[0.01,0.010]"], "same name"),
        (["--set", "series.values=[0.01,-1]"], "series.values: -1"),
    ],
)
def test_invalid_series_are_refused(tmp_path, words, fault):
    done = series(tmp_path, *words, ranks=0)
    assert done.returncode == 2 and fault in done.stderr
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
def test_grid_of_keys_is_accepted_by_all_commands(tmp_path):
    keys = ["surface.2.synthetic.seed", "motion.entrainment_speed"]
    sets = [
        *SHORT[:2],
        "mesh.points_per_half_width=20",
        "time.travel=0.2",
        "surface.2={synthetic={kind='ground',ra=1e-7,correlation=3e-5,seed=1}}",
        "surface.1={synthetic={kind='ground',ra=1e-7,correlation=3e-5,seed=9}}",
        f"series={{keys={json.dumps(keys)},values=[[1,2],[5.0,2.0]]}}",
    ]
    done = run(CASE, "--output", "out.h5", *settings(*sets), cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    index = json.loads((tmp_path / "out.series.json").read_text())
    assert index["keys"] == keys and "key" not in index
    assert [entry["value"] for entry in index["members"]] == [[1, 5.0], [1, 2.0], [2, 5.0], [2, 2.0]]
    assert index["members"][1]["file"] == "out_seed_1_entrainment_speed_2.0.h5"
    assert {entry["state"] for entry in index["members"]} == {"done"}
    series_index = str(tmp_path / "out.series.json")
    assert plot([series_index]) == 0
    table = tmp_path / "out.ensemble.csv"
    assert summary_table(["--ensemble", series_index, "-o", str(table)]) == 0
    assert len(table.read_text().splitlines()) > 20
