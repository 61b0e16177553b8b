"""The batch script with a stand-in for Slurm: it stops in time, is requeued, continues and ends."""

import signal
import subprocess

import pytest
from support import ROOT
from support.running import BARE, SHORT, called, settings, wait_for

from ehlpetsc.results.reader import read_result

JOB = ["/bin/bash", ROOT / "cases" / "batch.slurm", ROOT / "cases" / "table1_rough.toml", *settings(*SHORT)]


def slurm(folder):
    """Environment of a job with a scontrol that records its arguments."""
    scontrol = folder / "bin" / "scontrol"
    scontrol.parent.mkdir(exist_ok=True)
    scontrol.write_text('#!/bin/sh\necho "$@" >>requeued\n')
    scontrol.chmod(0o755)
    path = f"{scontrol.parent}:{BARE['PATH']}"
    return BARE | {"PATH": path, "SLURM_JOB_ID": "17", "SLURM_NTASKS": "1", "SLURM_SUBMIT_DIR": str(ROOT)}


def job(folder, case, *keys):
    words = ["/bin/bash", ROOT / "cases" / "batch.slurm", ROOT / "cases" / case, *settings(*keys)]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
    return subprocess.Popen(words, cwd=folder, env=slurm(folder), start_new_session=True, **pipes)


def requeued(folder):
    return (folder / "requeued").read_text().splitlines() if (folder / "requeued").exists() else []


@pytest.mark.slow
def test_requeued_job_continues(tmp_path):
    """The second job is the same command: it ends, and nothing that was done is computed again.

    Of passes and a series that is the test of the same command, without the script.
    """
    words = ("table1_rough.toml", *SHORT, "time.travel=3.0")
    stopped = job(tmp_path, *words)
    wait_for(tmp_path / "table1_rough.h5", stopped)
    stopped.send_signal(signal.SIGUSR1)
    text, _ = stopped.communicate(timeout=120)
    assert stopped.returncode == 4, text
    assert requeued(tmp_path) == ["requeue 17"]
    with read_result(tmp_path / "table1_rough.h5") as begun:
        assert begun.attrs["status"] == "stopped"
        stopped_at = int(begun.steps("step")[-1])
    again = job(tmp_path, *words)
    text, _ = again.communicate(timeout=200)
    assert again.returncode == 0, text
    assert requeued(tmp_path) == ["requeue 17"]
    assert f"step {stopped_at}, " in text
    with read_result(tmp_path / "table1_rough.h5") as whole:
        assert (whole.attrs["status"], whole.attrs["restarts"]) == ("done", 1)
        assert list(whole.steps("step")) == list(range(len(whole.steps("step"))))


@pytest.mark.slow
def test_job_without_a_step_is_not_requeued(tmp_path):
    environment = slurm(tmp_path) | {"SLURM_RESTART_COUNT": "20"}
    words = [*JOB, "--time-limit", "1e-6"]
    done = called(words, tmp_path, environment)
    assert done.returncode == 4 and requeued(tmp_path) == []
    assert "queued 20 times" in done.stderr


def test_cluster_modules_are_loaded_before_the_run(tmp_path):
    environment = slurm(tmp_path) | {
        "MODULES": "petsc petsc4py",
        "BASH_FUNC_module%%": '() { echo "$@" >>loaded; }',
        "EHLPETSC": str(tmp_path),
    }
    (tmp_path / "run_mpi.sh").write_text("#!/bin/sh\ncat loaded\n")
    (tmp_path / "run_mpi.sh").chmod(0o755)
    job = called(JOB, tmp_path, environment)
    assert job.stdout == "load petsc petsc4py\n", job.stderr
    assert job.returncode == 0
