"""Processes that the launcher of another MPI started together, each of them alone in its own world."""

import os
import subprocess
import sys

import pytest
from support import CASES, ROOT, is_line_with

from ehlpetsc.base.environment import SIZE_VARIABLES, other_mpi


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


@pytest.mark.parametrize("case", [["mixed.toml"], ["life", "life.toml"]], ids=["run", "life"])
def test_a_run_of_another_launcher_ends_before_the_case_in_one_sentence(case, tmp_path):
    environment = {name: value for name, value in os.environ.items() if name not in SIZE_VARIABLES}
    words = [sys.executable, "-m", "ehlpetsc", *case[:-1], CASES / case[-1]]
    environment |= {"PYTHONPATH": os.pathsep.join([str(ROOT), environment.get("PYTHONPATH", "")])}
    for rank in ("0", "1"):
        alone = environment | {"PMI_SIZE": "2", "PMI_RANK": rank}
        done = subprocess.run(words, cwd=tmp_path, env=alone, capture_output=True, text=True)
        assert done.returncode == 2 and done.stdout == "" and not list(tmp_path.iterdir())
        if rank == "0":
            assert is_line_with(done.stderr, "2 processes were started together (PMI_SIZE)", "mpirun")
        else:
            assert done.stderr == ""
