"""Signals and lost outputs: a documented exit status, one line, no traceback."""

import os
import shutil
import signal
import subprocess
import sys
import textwrap
import time

import pytest
from support import ROOT
from support.running import BARE, SCRIPT, SHORT, command, run, settings, wait_for

from ehlpetsc.results.reader import read_result

COARSE = ["mesh.inlet=-1.5", "mesh.points_per_half_width=20"]
STEADY = [ROOT / "cases" / "table1_smooth.toml", *settings(*COARSE)]
LONG = [ROOT / "cases" / "table1_rough.toml", *settings(*SHORT[:3], "time.travel=500"), "--output", "r.h5"]


def start(*words, cwd, ranks=0, **more):
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True} | more
    return subprocess.Popen(command(*words, ranks=ranks), cwd=cwd, env=BARE | SCRIPT, **pipes)


def ended(process):
    """Status, output and error output."""
    try:
        return process.returncode, *process.communicate(timeout=60)
    finally:
        process.kill()


def assert_stopped_whole(folder):
    with read_result(folder / "r.h5") as result:
        assert result.attrs["status"] == "stopped"
        last = result.steps("step")[-1]
    done = run(*LONG, *settings("time.travel=0.01"), "--restart", "r.restart.h5", cwd=folder)
    assert done.returncode == 0 and f"step {last}, " in done.stdout


def test_signal_to_mpirun_writes_a_restart_file(tmp_path):
    """Open MPI then ends with status 1; version 5 drops the remaining output of its ranks."""
    version = subprocess.run(["mpirun", "--version"], capture_output=True, text=True, env=BARE).stdout
    process = start(*LONG, cwd=tmp_path, ranks=2)
    wait_for(tmp_path / "r.h5", process)
    process.send_signal(signal.SIGTERM)
    _, output, errors = ended(process)
    assert process.returncode in (1, 4)
    assert " --restart r.restart.h5" in output or "(Open MPI) 5." in version
    assert "Traceback" not in errors and "PETSC ERROR" not in errors
    assert_stopped_whole(tmp_path)


@pytest.mark.slow
def test_signal_interrupts_a_long_step(tmp_path):
    """mpirun kills one second after the signal: the state before the current step is saved by then."""
    never = ["-snes_max_it", 100000, "-snes_atol", "1e-30", "-snes_convergence_test", "skip", "-snes_monitor"]
    assert run(*LONG, cwd=tmp_path, tampered=("SIGTERM", 0, 2)).returncode == 4
    process = start(*LONG, "--restart", "r.restart.h5", *never, cwd=tmp_path)
    within = (line for line in process.stdout if line.lstrip().startswith("30 SNES "))
    assert next(within, None), process.stderr.read()
    asked = time.monotonic()
    process.send_signal(signal.SIGTERM)
    ended(process)
    assert process.returncode == 4 and time.monotonic() - asked < 3.0


# on a fast machine the run has started by then and stops too
def test_signal_during_imports_prints_one_line_at_most(tmp_path):
    endless = [*STEADY, *settings("time.courant=1.0", "time.travel=500"), "--overwrite"]
    process = start(*endless, cwd=tmp_path)
    time.sleep(0.5)
    process.send_signal(signal.SIGINT)
    _, _, errors = ended(process)
    assert process.returncode == 4, errors
    assert "Traceback" not in errors and "PETSC ERROR" not in errors
    assert len(errors.splitlines()) <= 1


def test_folder_removed_during_a_run_is_a_lost_output(tmp_path):
    folder = tmp_path / "out"
    folder.mkdir()
    soon = settings("output.checkpoint=0.005")  # minutes, after which the file must be there
    process = start(*LONG, *soon, "--output", folder / "r.h5", cwd=tmp_path)
    wait_for(folder / "r.h5", process)
    shutil.rmtree(folder)
    _, output, errors = ended(process)
    assert process.returncode == 5
    assert f"{folder}/r.h5: deleted" in errors and "No such file or directory" in errors
    assert not os.path.exists(folder)


@pytest.mark.parametrize("module", ["ehlpetsc.base.environment", "difflib"])
def test_ctrl_c_during_the_first_imports_ends_without_a_traceback(tmp_path, module):
    """Of the package, and of its program."""
    hook = f"""
        import os, signal, sys

        class Interrupting:
            def find_spec(name, *_):
                if name == {module!r}:
                    os.kill(os.getpid(), signal.SIGINT)

        sys.meta_path.insert(0, Interrupting)
    """
    (tmp_path / "sitecustomize.py").write_text(textwrap.dedent(hook))
    path = os.pathsep.join([str(tmp_path), str(ROOT)])
    words = [sys.executable, "-m", "ehlpetsc", "--version"]
    done = subprocess.run(words, env=os.environ | {"PYTHONPATH": path}, capture_output=True, text=True)
    assert done.returncode == -signal.SIGINT and done.stdout == done.stderr == ""
