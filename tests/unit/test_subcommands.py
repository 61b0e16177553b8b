"""One program: its commands, help, version, bad command lines, processes of another launcher."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from support import CASES, ROOT, is_line_with

from ehlpetsc import __version__
from ehlpetsc.__main__ import COMMANDS, main
from ehlpetsc.base import environment
from ehlpetsc.base.environment import SIZE_VARIABLES, other_mpi
from ehlpetsc.base.errors import ExitStatus
from ehlpetsc.results.reader import read_result


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_has_help_and_version(capsys, name):
    for option, begin in (("-h", f"usage: ehlpetsc {name} [-h]"), ("--version", f"ehlpetsc {__version__}\n")):
        with pytest.raises(SystemExit) as end:
            main([name, option])
        printed = capsys.readouterr().out
        assert end.value.code == 0 and printed.startswith(begin)
        assert "``" not in printed


def test_help_lists_all_commands_and_words_with_line_breaks_are_refused(capsys):
    assert main(["-help"]) == 0
    printed = capsys.readouterr().out
    assert all(f"\n  {name} " in printed for name in COMMANDS)
    assert main(["--version"]) == 0 and capsys.readouterr().out == f"ehlpetsc {__version__}\n"
    assert main(["plot", "a\nb.h5"]) == main(["case.toml", "-o", "a\nb.h5"]) == 2
    assert capsys.readouterr().err.count("\n") == 2


@pytest.mark.parametrize(
    "words, message",
    [
        (["plt", "roller.h5"], "plt: unknown command; did you mean plot?"),
        (["rollr"], "rollr: unknown command; did you mean roller.toml?"),
        (["roller.toml", "plot"], "plot: neither an option nor a value; a command comes first: "),
        ([""], ": "),
        (["explain", "/dev/zero"], "/dev/zero: "),
        (["roller.toml", "--explain"], "--explain: unknown option; "),
        (["summary", "gone.h5", "--overwrite"], "gone.h5: "),
    ],
)
def test_mistyped_command_is_one_sentence(tmp_path, monkeypatch, capfd, words, message):
    monkeypatch.chdir(tmp_path)
    for name in ("roller", "run"):
        (tmp_path / f"{name}.toml").touch()
    assert main(words) == 2
    assert is_line_with(capfd.readouterr().err, message)


def test_text_goes_to_a_file_that_is_not_replaced(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for words, status in (([], 0), ([], 2), (["--overwrite"], 0)):
        assert main(["template", "-o", "my.toml", *words]) == status
    assert is_line_with(capsys.readouterr().err, "ehlpetsc template: my.toml: exists", "--overwrite")
    assert "[contact]" in (tmp_path / "my.toml").read_text()


@pytest.mark.parametrize("name", ["post", "plot", "summary", "compare", "gears", "explain"])
def test_mistyped_option_is_refused_in_one_line(name, capsys):
    with pytest.raises(SystemExit) as end:
        main([name, "a.h5", "b.h5", "--deph"])
    printed = capsys.readouterr()
    assert end.value.code == ExitStatus.BAD_INPUT and not printed.out
    assert is_line_with(printed.err, f"ehlpetsc {name}: ", " --deph;", f"; ehlpetsc {name} -h")


def test_texts_of_cases_need_neither_petsc_nor_mpi():
    code = "import sys; sys.modules.update(dict.fromkeys(['petsc4py', 'mpi4py']))\n"
    code += "from ehlpetsc.__main__ import main\n"
    code += "cases = 'explain cases/dry_hertz.toml', 'keys', 'template'\n"
    code += "print([int(main(line.split())) for line in cases])"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "[contact]" in done.stdout and done.stdout.endswith("[0, 0, 0]\n")


def test_ranks_are_started_by_the_script_of_a_clone(monkeypatch, capsys):
    started = []
    monkeypatch.setattr("os.execv", lambda program, words: started.append(words))
    for name in environment.MPIRUN_VARIABLES:
        monkeypatch.delenv(name, raising=False)
    main(["-n", "2", "a.toml", "-o", "a.h5"])
    assert started[0] == [str(ROOT / "run_mpi.sh"), "-n", "2", "a.toml", "-o", "a.h5"]
    monkeypatch.setattr(environment, "SCRIPT", ROOT / "none")
    words = ["-n", "3", sys.executable, "-m", "ehlpetsc", "a.toml"]
    monkeypatch.setattr("shutil.which", lambda name, path: f"{path.split(':')[0]}/{name}")
    monkeypatch.setenv("PATH", "/opt/bin:/bin")
    main(["-n", "3", "a.toml"])
    assert started[-1] == ["/opt/bin/mpirun", *words]
    monkeypatch.setattr("sys.prefix", "/a/virtual/environment")
    main(["-n", "3", "a.toml"])
    assert started[-1] == [f"{Path(sys.executable).parent}/mpirun", *words]
    assert main(["-n", "two", "a.toml"]) == 2 and "-n two: allowed: a whole number" in capsys.readouterr().err
    monkeypatch.setenv("PMIX_RANK", "0")
    assert main(["-n", "2", "a.toml"]) == 2 and "leave it out" in capsys.readouterr().err


def test_advice_of_an_installed_package_names_the_page(monkeypatch):
    monkeypatch.setattr(environment, "SCRIPT", ROOT / "none")
    assert "the section Install of the page README.md" in environment.advice(["petsc4py"], [])
    for suits, words in ((False, "petsc4py   (builds PETSc from source"), (True, "dolfinx-solver-real; ")):
        monkeypatch.setattr(environment, "_suits_wheel", lambda suits=suits: suits)
        assert f"-m pip install {words}" in environment.advice(["petsc4py"], [])
    advice = environment.advice(["matplotlib"], ["plot", "result.h5"])  # which needs no PETSc
    assert "PETSc" not in advice and "-m pip install matplotlib; " in advice


@pytest.mark.parametrize(
    ("variables", "ranks", "is_fault"),
    [
        ({}, 1, False),
        ({"PMI_SIZE": "1", "PMI_RANK": "0"}, 1, False),
        ({"PMI_SIZE": "4", "PMI_RANK": "0"}, 1, True),
        ({"PMI_SIZE": "4", "PMI_RANK": "0"}, 4, False),
        ({"OMPI_COMM_WORLD_SIZE": "2"}, 1, True),
        ({"SLURM_STEP_NUM_TASKS": "8", "SLURM_PROCID": "0"}, 1, True),
        ({"SLURM_NTASKS": "8", "SLURM_PROCID": "0"}, 1, False),  # a batch script without srun
        ({"SLURM_STEP_NUM_TASKS": "2", "PMI_SIZE": "1"}, 1, False),  # mpirun -n 1 of a job on two nodes
        ({"PMI_SIZE": "many"}, 1, False),
    ],
)
def test_processes_alone_are_noticed(monkeypatch, variables, ranks, is_fault):
    for name in SIZE_VARIABLES:
        monkeypatch.delenv(name, raising=False)
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    assert bool(other_mpi(ranks)) == is_fault


@pytest.mark.parametrize("case, rank", [("mixed.toml", "0"), ("mixed.toml", "1"), ("life life.toml", "0")])
def test_a_run_of_another_launcher_ends_before_the_case_in_one_sentence(case, rank, tmp_path):
    words, place = case.split(), os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
    alone = {name: value for name, value in os.environ.items() if name not in SIZE_VARIABLES}
    alone |= {"PYTHONPATH": place, "PMI_SIZE": "2", "PMI_RANK": rank}
    words = [sys.executable, "-m", "ehlpetsc", *words[:-1], CASES / words[-1]]
    done = subprocess.run(words, cwd=tmp_path, env=alone, capture_output=True, text=True)
    assert done.returncode == 2 and done.stdout == "" and not list(tmp_path.iterdir())
    if rank == "0":
        assert is_line_with(done.stderr, "2 processes were started together (PMI_SIZE)", "mpirun")
    else:
        assert done.stderr == ""


@pytest.mark.parametrize(
    "redirection, status, words",
    [
        (">&- 2>&-", 0, []),
        (">/dev/full", 2, ["standard output: not written, No space left on device"]),
        ("<&- >&- 2>&-", 0, []),
    ],
)
@pytest.mark.parametrize("command", ["keys contact", "cases/dry_hertz.toml -o {}"])
def test_output_that_is_closed_or_full_is_no_bug(tmp_path, command, redirection, status, words):
    program = f"{sys.executable} -m ehlpetsc {command.format(tmp_path / 'r.h5')} {redirection}"
    done = subprocess.run(["sh", "-c", program], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == status and done.stdout == ""
    assert is_line_with(done.stderr, *words)
    if status == 0 and "-o" in command:
        with read_result(tmp_path / "r.h5") as result:
            assert result.attrs["status"] == "done"


def test_letters_that_the_output_does_not_have_are_printed_as_numbers():
    words = [sys.executable, "-m", "ehlpetsc", "explain", "cases/dry_hertz.toml", "--set", "title=\u00d6l"]
    ascii_alone = os.environ | {"PYTHONIOENCODING": "ascii"}
    done = subprocess.run(words, cwd=ROOT, env=ascii_alone, capture_output=True, text=True)
    assert done.returncode == 0 and done.stdout.startswith("\\xd6l\n")


def run_script(folder, text, *words):
    """The end of ``ehlpetsc python mine.py``, with the package on no path."""
    (folder / "mine.py").write_text(text)
    code = (
        f"import sys; sys.path.insert(0, {str(ROOT)!r}); from ehlpetsc.__main__ import main; sys.exit(main())"
    )
    alone = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    words = [sys.executable, "-c", code, "python", "mine.py", *words]
    return subprocess.run(words, cwd=folder, env=alone, capture_output=True, text=True)


def test_a_script_runs_with_its_arguments_and_the_package_from_any_folder(tmp_path):
    text = "import sys, ehlpetsc\nprint(sys.argv[1:], ehlpetsc.__version__, __name__)\nsys.exit(3)\n"
    done = run_script(tmp_path, text, "-o", "a b", "--help")
    assert (done.returncode, done.stdout) == (3, f"['-o', 'a b', '--help'] {__version__} __main__\n")
    assert main(["python", str(tmp_path / "none.py")]) == ExitStatus.BAD_INPUT


IN_CALLBACK = "ctypes.CFUNCTYPE(None)(lambda: signal.raise_signal(signal.SIGINT))"


@pytest.mark.parametrize(
    "line, status, words",
    [
        (
            "os.kill(os.getpid(), signal.SIGINT)",
            130,
            ["ehlpetsc: stopped; files written before are complete"],
        ),
        ("os.kill(os.getpid(), signal.SIGTERM)", 130, ["ehlpetsc: stopped; "]),
        (f"{IN_CALLBACK}(); time.sleep(60)", 130, ["ehlpetsc: stopped; "]),
        (f"{IN_CALLBACK}(); raise RuntimeError('no code')", 130, ["ehlpetsc: stopped; "]),
        ("ehlpetsc.load('gone.toml')", 2, ["mine.py: gone.toml: cannot be read: "]),
        ("raise ehlpetsc.NotConverged('step 3')", 3, ["mine.py: not converged: step 3"]),
    ],
)
def test_a_stopped_or_refused_script_ends_in_one_sentence(tmp_path, line, status, words):
    done = run_script(tmp_path, f"import ctypes, ehlpetsc, os, signal, time\n{line}\n")
    assert done.returncode == status and done.stdout == ""
    assert is_line_with(done.stderr, *words)


def test_a_fault_of_a_script_has_a_traceback_of_the_script_alone(tmp_path):
    done = run_script(tmp_path, "def f():\n    return 1 / 0\n\nf()\n")
    assert done.returncode == 1 and done.stderr.count("  File ") == 2
    assert done.stderr.endswith("ZeroDivisionError: division by zero\n")
