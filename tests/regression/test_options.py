"""The command line: precedence of options, refused options, output of -help and -options_left."""

import re

import pytest
from support import ROOT
from support.running import PYTHON, SCRIPT, called, run, settings, summary

from ehlpetsc.base.errors import UsageError
from ehlpetsc.commands.run import parse
from ehlpetsc.results.reader import read_result

SMOOTH = (ROOT / "cases" / "table1_smooth.toml").read_text()
MESH = ["mesh.inlet=-2.5", "mesh.points_per_half_width=20"]


@pytest.fixture
def case(tmp_path):
    """A fast steady case in a file of its own."""
    path = tmp_path / "case.toml"
    path.write_text(SMOOTH.replace("inlet = -4.0", "inlet = -2.5").replace("= 200", "= 20"))
    return path


def max_it(done):
    """-snes_max_it as reported by SNES."""
    assert done.returncode == 0, done.stderr
    line = next(line for line in done.stdout.splitlines() if "maximum iterations" in line)
    return int(line.split("=")[1].split(",")[0])


def with_petsc_table(case, line):
    case.write_text(f"{case.read_text()}\n[petsc]\n{line}\n")
    return case


def test_precedence_of_options(case, tmp_path):
    """Defaults, then the case, then PETSC_OPTIONS, then the command line."""
    assert max_it(run(case, "-snes_view", cwd=tmp_path)) == 30
    with_petsc_table(case, "snes_max_it = 31")
    assert max_it(run(case, "-snes_view", "--overwrite", cwd=tmp_path)) == 31
    variable = {"PETSC_OPTIONS": "-snes_max_it 32 -snes_view"}
    assert max_it(run(case, cwd=tmp_path, **variable)) == 32
    with read_result(tmp_path / "case.h5") as result:
        assert "-snes_max_it 32" in result.attrs["petsc_options"]
    assert max_it(run(case, "-snes_max_it", 33, cwd=tmp_path, **variable)) == 33


def test_options_file_has_the_precedence_of_its_position(case, tmp_path):
    (tmp_path / "opts").write_text("-snes_max_it 34\n-snes_view\n")
    words = ["-options_file", "opts", "--overwrite"]
    assert max_it(run(case, "-snes_max_it", 33, *words, cwd=tmp_path)) == 34
    assert max_it(run(case, *words, "-snes_max_it", 33, cwd=tmp_path)) == 33


def test_options_of_the_program_have_long_names_and_those_of_petsc_style():
    words = "x.toml -o a--b.h5 --overwrite --time-limit=5 --set a.b=1 -snes_rtol 1 --set=c.d=-2 -ksp_view -h"
    chosen = parse(words.split())
    assert (chosen.case, chosen.output, chosen.time_limit) == ("x.toml", "a--b.h5", 5.0)
    assert chosen.overwrite and chosen.set == ["a.b=1", "c.d=-2"]
    assert chosen.petsc == "-snes_rtol 1 -ksp_view -help".split()
    styled = "-ehl_output a--b.h5 -ehl_overwrite -ehl_time_limit 5 -ehl_set a.b=1 -ehl_set c.d=-2"
    again = parse(["-snes_rtol", "1", "x.toml", *styled.split(), "-ksp_view", "--help"])
    assert vars(again) == vars(chosen)


def test_output_that_is_a_link_stays_one(case, tmp_path):
    (tmp_path / "disk").mkdir()
    (tmp_path / "link.h5").symlink_to("disk/target.h5")
    for _ in range(2):  # the target is created, then replaced
        done = run(case, "--output", "link.h5", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
    assert (tmp_path / "link.h5").is_symlink() and not (tmp_path / "disk" / "target.h5").is_symlink()
    with read_result(tmp_path / "disk" / "target.h5") as result:
        assert result.attrs["status"] == "done"
    assert sorted(p.name for p in tmp_path.rglob("*")) == ["case.toml", "disk", "link.h5", "target.h5"]


@pytest.mark.parametrize(
    "arguments, message",
    [
        ([], "which case?"),
        (["-snes_monitor"], "which case?"),
        (["a.toml", "b.toml"], "one case file"),
        (["a.toml", "-options_file", "nofile"], "-options_file nofile: "),
    ],
)
def test_exactly_one_case_file_is_required(arguments, message):
    with pytest.raises(UsageError, match=message):
        parse(arguments)


@pytest.mark.parametrize(
    "words, message",
    [
        (["-o"], "^ehlpetsc: --output: expected one argument; "),
        (["--time-limit", "0"], "--time-limit: 0: .* > 0"),
        (
            ["--output", "nowhere/f.h5"],
            "nowhere/f.h5: .*, No such .*: create the folder nowhere first",
        ),
        (["--restart", "none.h5"], r"none\.h5: .*steady"),
        (["-snes_type", "vinewtonssls"], "-snes_type vinewtonssls "),
        (["-pc_type", "nosuch"], "PETSc .*-pc_type nosuch: "),
        (["-ksp_rtol", "abc"], "PETSc .*-ksp_rtol abc: "),
        (["-snes_max_it", "-7"], "PETSc .*-snes_max_it -7: "),
        (["-snes_mf"], "-snes_mf: .*finite differences"),
        (["-ksp_monitor", "ascii:/no/such/f"], "PETSc .*-ksp_monitor ascii:/no/such/f: "),
        (["-snes_atol", "nan"], "-snes_atol nan: "),
        (["--set", "mesh.inlet", "-2"], "-2: neither an option nor a value"),
        (["-restart", "x.h5"], r"^ehlpetsc: -restart: .* --restart\?"),
        (["--outptu", "x.h5"], r"^ehlpetsc: --outptu: .* --output\?"),
        (["-ehl_gibberish"], "^ehlpetsc: --gibberish: unknown option; "),
        (["-n", "2"], "-n RANKS comes before the case"),
    ],
)
def test_bad_option_values_are_refused_in_one_line(case, tmp_path, words, message):
    done = run(case, *words, cwd=tmp_path)
    assert done.returncode == 2
    assert re.search(message, done.stderr)
    assert len(done.stderr.splitlines()) == 1


def test_pc_type_python_selects_the_built_in_preconditioner(case, tmp_path):
    own, message = (
        summary(run(case, *words, cwd=tmp_path).stdout)
        for words in ((), ("-pc_type", "python", "--overwrite"))
    )
    assert {**own, "wall": 0} == {**message, "wall": 0}


def test_zero_pivot_of_petscs_lu_is_shifted_by_default(case, tmp_path):
    words = ["-pc_type", "lu", "--overwrite", "-snes_max_it", 8]  # twice what the shifted one takes
    words += [*settings("mesh.points_per_half_width=40", "mesh.inlet=-4.0", "mesh.near_field=7")]
    done = run(case, *words, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert run(case, *words, "-pc_factor_shift_type", "none", cwd=tmp_path).returncode == 3


def test_looser_tolerance_is_used_with_a_note(case, tmp_path):
    exact, loose = run(case, cwd=tmp_path), run(case, "-snes_rtol", 0.5, "--output", "l.h5", cwd=tmp_path)
    assert "note: " not in exact.stdout and loose.returncode == 0
    assert "note: -snes_rtol 0.5 " in loose.stdout
    films = [float(summary(done.stdout)["h_min"]) for done in (exact, loose)]
    assert int(summary(loose.stdout)["newton"]) < int(summary(exact.stdout)["newton"])
    assert abs(films[1] / films[0] - 1.0) > 0.01


def test_linear_iterations_of_a_step_are_limited(case, tmp_path):
    """-ksp_max_it limits one linear solve; all of a step are limited by 100 per Newton iteration."""
    words = ["-ksp_max_it", 100000, "-pc_type", "none", "-ksp_rtol", "1e-30", "-snes_max_it", 4]
    done = run(case, *words, "-ksp_converged_reason", cwd=tmp_path)
    limited = r"Linear ehl\d+_ solve did not converge due to DIVERGED_ITS iterations (\d+)"
    taken = [int(number) for number in re.findall(limited, done.stdout)]
    assert done.returncode == 3 and max(taken) == 400
    assert sum(taken[:4]) <= 403


def test_solver_without_bounds_solves_full_films_only(case, tmp_path):
    bounded, free = (run(case, "-snes_type", kind, cwd=tmp_path) for kind in ("vinewtonrsls", "newtonls"))
    films = [float(summary(done.stdout)["h_min"]) for done in (bounded, free)]
    assert films[1] == pytest.approx(films[0], rel=1e-6)
    dry = [ROOT / "cases/dry_hertz.toml", *settings(MESH[1])]
    done = run(*dry, "-snes_type", "newtonls", cwd=tmp_path)
    assert done.returncode == 3
    assert "steady start: " in done.stderr


def test_unused_options_are_listed_before_the_first_step(case, tmp_path):
    with_petsc_table(case, "ksp_rtoll = 1e-7\nksp_atol = 1e-12")
    words = ["-snes_monitr", "-snes_rtol", "1e-12", "-log_view", ":log", "-snes_view", "-options_left", "no"]
    done = run(case, *words, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    notes = [line for line in done.stdout.splitlines() if line.startswith("note: unused")]
    assert [line.endswith(": -ksp_rtoll, -snes_monitr") for line in notes] == [True]
    done = run(case, "-snes_monitr", "--set", "time.travel=0.2", "--overwrite", cwd=tmp_path)
    assert 0 < done.stdout.find("-snes_monitr") < done.stdout.find("    step ")  # not after hours of steps
    assert "note: unused" not in run(case, "--set", "petsc={}", "--overwrite", cwd=tmp_path).stdout


def test_help_lists_own_options_and_runs_nothing(case, tmp_path):
    done = run(case, "-help", cwd=tmp_path, ranks=2)
    assert done.returncode == 0
    assert all(f"--{name} " in done.stdout for name in ("output", "overwrite", "restart", "time-limit"))
    assert done.stdout.count("usage: ehlpetsc") == 1
    for petscs in ("-snes_linesearch_type", "-ksp_rtol", "-pc_type"):
        assert petscs in done.stdout
    assert not (tmp_path / "case.h5").exists()


@pytest.mark.slow
def test_runs_in_a_minimal_environment(case, tmp_path):
    bare = {name: value for name, value in SCRIPT.items() if name not in ("PETSC_DIR", "OMP_NUM_THREADS")}
    words = ["mpirun", "-n", "2", PYTHON, "-m", "ehlpetsc", case]
    done = called(words, tmp_path, bare | {"PYTHONPATH": str(ROOT)})
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    assert float(summary(done.stdout)["load_error"]) < 1e-8


def test_missing_packages_print_the_command_to_type(case, tmp_path):
    words = ["mpirun", "-n", "2", PYTHON, "-S", "-m", "ehlpetsc", "case.toml", "-snes_monitor"]
    done = called(words, tmp_path, SCRIPT | {"PYTHONPATH": str(ROOT)})
    assert done.returncode == 2
    lines = done.stderr.splitlines()
    assert len(lines) == 2
    assert " numpy, scipy" in lines[0]
    assert "type: ./run_mpi.sh case.toml -snes_monitor " in lines[1]


@pytest.mark.parametrize(
    "words, reason",
    [
        (["-snes_error_if_not_converged", "-snes_max_it", 2], "SNES DIVERGED_MAX_IT"),
        (["-ksp_error_if_not_converged", "-ksp_max_it", 1], "SNES DIVERGED_LINEAR_SOLVE"),
    ],
)
def test_errors_of_petsc_if_not_converged_are_failed_solves(case, tmp_path, words, reason):
    done = run(case, *words, cwd=tmp_path)
    assert done.returncode == 3 and f"not converged: steady start: {reason}" in done.stderr
