"""One program with subcommands: each starts, names itself as it was called, and old names stay."""

import csv
import io
import os
import subprocess
import sys

import numpy as np
import pytest
from support import ROOT, is_line_with
from support.made_results import make_result, with_solids

from ehlpetsc import command_parser, commands
from ehlpetsc.analysis import summary
from ehlpetsc.results.means import filled_from
from ehlpetsc.results.reader import read_result


def call(*words, cwd):
    paths = os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
    command = [sys.executable, "-m", "ehlpetsc", *map(str, words)]
    env = os.environ | {"PYTHONPATH": paths}
    return subprocess.run(command, cwd=cwd, env=env, capture_output=True, text=True, timeout=120)


@pytest.mark.parametrize("name", commands.SUBCOMMANDS)
@pytest.mark.parametrize("called", ["/usr/local/bin/ehlpetsc", "/work/ehlpetsc/__main__.py"])
def test_subcommand_help_has_its_name(monkeypatch, capsys, name, called):
    monkeypatch.setattr(sys, "argv", [called, name, "-h"])
    with pytest.raises(SystemExit) as end:
        commands.dispatch(lambda: pytest.fail("ran a case"))
    assert end.value.code == 0
    program = "ehlpetsc" if called.endswith("bin/ehlpetsc") else "python3 -m ehlpetsc"
    assert capsys.readouterr().out.startswith(f"usage: {program} {name} [-h]")


@pytest.mark.parametrize(
    ("words", "left"),
    [
        (["explain", "c.toml"], ["--explain", "c.toml"]),
        (["keys", "fluid"], ["--keys", "fluid"]),
        (["template"], ["--template"]),
        (["run", "c.toml", "-ksp_view"], ["c.toml", "-ksp_view"]),
        (["c.toml"], ["c.toml"]),
        ([], []),
    ],
)
def test_other_arguments_start_a_run(monkeypatch, words, left):
    monkeypatch.setattr(sys, "argv", ["ehlpetsc", *words])
    assert commands.dispatch(lambda: sys.argv[1:]) == left


def test_package_is_importable_from_any_folder(tmp_path):
    (tmp_path / "x.py").write_text("import sys, ehlpetsc; print(ehlpetsc.__version__, sys.argv[1:])")
    done = call("python", "x.py", "a", cwd=tmp_path)
    assert done.returncode == 0 and done.stdout.endswith("['a']\n"), done.stderr


def test_mistyped_subcommand_option_is_refused_in_one_line(tmp_path):
    done = call("plot", "a.h5", "--mpa", cwd=tmp_path)
    assert done.returncode == 2
    assert is_line_with(done.stderr, "--mpa", "ehlpetsc plot -h")


def test_completion_lists_every_subcommand(monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["ehlpetsc", "completion"])
    assert commands.dispatch(None) == 0
    script = capsys.readouterr().out
    assert all(f"{name}" in script for name in (*commands.SUBCOMMANDS, *commands.OF_A_CASE))
    assert subprocess.run(["bash", "-n"], input=script, text=True).returncode == 0


def test_run_script_has_every_subcommand():
    text = (ROOT / "run_mpi.sh").read_text()
    (line,) = [line for line in text.splitlines() if line.strip().startswith("plot | post |")]
    assert {*commands.SUBCOMMANDS, *commands.OF_A_CASE} <= {word.strip(" )") for word in line.split("|")}


def test_means_percentiles_and_extremes_of_a_run(tmp_path, capsys):
    paths = [make_result(tmp_path / f"{u:g}.h5", speed=u, rough=True) for u in (50.0, 40.0)]
    for path in paths:
        with_solids(path)
    assert summary.main([str(path) for path in paths]) == 0
    rows = list(csv.DictReader(io.StringIO(capsys.readouterr().out)))
    assert [row["result"] for row in rows if row["scalar"] == "p_max"] == ["40.h5", "50.h5"]  # sorted
    (row,) = [r for r in rows if r["scalar"] == "contact_share" and r["result"] == "50.h5"]
    assert row["case"] == "motion.entrainment_speed = 50" and row["unit"] == "1"
    with read_result(paths[0]) as result:
        filled = result.steps("time") >= filled_from(result)
        share = result.steps("contact_share")[filled]
    assert float(row["mean"]) == pytest.approx(share.mean(), rel=1e-5)
    assert [float(row["min"]), float(row["max"])] == pytest.approx([share.min(), share.max()], rel=1e-5)
    assert int(row["steps"]) == filled.sum() < 41
    assert summary.main([str(paths[0]), "-o", str(tmp_path / "s.csv")]) == 0
    assert (tmp_path / "s.csv").read_text().startswith("result,case,scalar,unit,mean,")
    assert summary.main([str(paths[0]), "-o", str(paths[1])]) == 2  # no table of its own


def test_weighted_percentiles_are_those_of_repeated_values():
    values, weights = np.array([3.0, 1.0, 2.0]), np.array([1000.0, 3000.0, 1000.0])
    repeated = np.repeat(values, weights.astype(int))
    found = summary.weighted_percentiles(values, weights, (30.0, 70.0, 90.0))
    assert found == pytest.approx(np.percentile(repeated, (30.0, 70.0, 90.0)), abs=0.3)


def test_program_name_is_that_of_the_call(monkeypatch):
    monkeypatch.setattr(sys, "argv", ["ehlpetsc post"])
    assert command_parser.program("ehlpetsc.post") == "ehlpetsc post"
    monkeypatch.setattr(sys, "argv", ["/home/my ehlpetsc dir/x"])
    assert command_parser.program("ehlpetsc.post") == "python3 -m ehlpetsc.post"


@pytest.mark.parametrize("name", commands.OF_A_CASE)
@pytest.mark.parametrize("option", ["-h", "--help"])
def test_options_as_commands_have_help(monkeypatch, capsys, name, option):
    monkeypatch.setattr(sys, "argv", ["ehlpetsc", name, option])
    assert commands.solver() == 0
    assert capsys.readouterr().out.startswith(f"usage: ehlpetsc {name}")
