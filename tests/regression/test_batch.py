"""The batch script, with a stand-in for Slurm: stopped in time, queued again, it goes on and ends."""

import os
import signal
import subprocess

import pytest
from running import BARE, ROOT, SHORT, settings, wait_for

from ehlpetsc.results.reader import read_result

JOB = ["/bin/bash", ROOT / "cases" / "batch.slurm", ROOT / "cases" / "table1_rough.toml", *settings(*SHORT)]


def slurm(folder):
    """The environment of a job, and a scontrol that notes what it is told."""
    scontrol = folder / "bin" / "scontrol"
    scontrol.parent.mkdir()
    scontrol.write_text('#!/bin/sh\necho "$@" >>requeued\n')
    scontrol.chmod(0o755)
    path = f"{scontrol.parent}:{BARE['PATH']}"
    return BARE | {"PATH": path, "SLURM_JOB_ID": "17", "SLURM_NTASKS": "1", "SLURM_SUBMIT_DIR": str(ROOT)}


@pytest.mark.slow
def test_a_job_stopped_before_its_time_is_over_goes_on_when_queued_again(tmp_path):
    result, restart = tmp_path / "table1_rough.h5", tmp_path / "table1_rough.restart.h5"
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
    environment = slurm(tmp_path)
    job = subprocess.Popen(
        [*JOB, *settings("time.travel=30.0")], cwd=tmp_path, env=environment, start_new_session=True, **pipes
    )
    wait_for(result, job)
    job.send_signal(signal.SIGUSR1)
    text, _ = job.communicate(timeout=120)
    assert job.returncode == 4, text
    assert (tmp_path / "requeued").read_text() == "requeue 17\n"
    assert restart.exists()
    with read_result(result) as first:
        stopped_at = int(first.steps("step")[-1])
    assert 0 <= stopped_at < 2400
    shorter = [*JOB, *settings("time.travel=0.5")]
    again = subprocess.run(shorter, cwd=tmp_path, env=environment, timeout=120, **pipes)
    assert again.returncode == 0, again.stdout
    assert f"step {stopped_at}, " in again.stdout
    assert not restart.exists()
    with read_result(result) as whole:
        assert whole.attrs["restarts"] == 1
        assert whole.attrs["status"] == "done"
        assert int(whole.steps("step")[-1]) == max(40, stopped_at)
    assert os.path.getsize(tmp_path / "requeued") == len("requeue 17\n")


def test_the_modules_of_a_cluster_are_loaded_before_the_run(tmp_path):
    environment = slurm(tmp_path) | {
        "MODULES": "petsc petsc4py",
        "BASH_FUNC_module%%": '() { echo "$@" >>loaded; }',
        "EHLPETSC": str(tmp_path),
    }
    (tmp_path / "run_mpi.sh").write_text("#!/bin/sh\ncat loaded\n")
    (tmp_path / "run_mpi.sh").chmod(0o755)
    job = subprocess.run(JOB, cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=60)
    assert job.stdout == "load petsc petsc4py\n", job.stderr
    assert job.returncode == 0
