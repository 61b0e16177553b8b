"""Run the program as users do: in a process of its own, with or without mpirun."""

import importlib.util
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from ehlpetsc.base import environment
from support import ROOT
from support.prepared import Prepared

PYTHON = sys.executable
BESIDE = Path(PYTHON).with_name("mpirun")  # of a virtual environment with an MPI of its own
MPIRUN = str(BESIDE) if BESIDE.exists() else "mpirun"
MAIN = str(ROOT / "ehlpetsc" / "__main__.py")
TAMPERED = str(Path(__file__).with_name("tampered.py"))
environment.prepare()
PETSC = Path(importlib.util.find_spec("petsc4py").origin).parents[1]
TEMPORARY_FOLDER = tempfile.TemporaryDirectory(prefix="ehlpetsc.")
# set by run_mpi.sh, but for TMPDIR and one other; tests of a minimal environment omit some
SCRIPT = {
    "PYTHONPATH": f"{ROOT}:{PETSC}",
    "OMP_NUM_THREADS": "1",
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_btl": "^tcp,ofi,openib,uct",
    "OMPI_MCA_btl_vader_single_copy_mechanism": "none",
    "OMPI_MCA_smsc": "^cma",
    "OMPI_MCA_orte_execute_quiet": "1",
    # of Open MPI 4: without mpirun no daemon is started. Runs without one share a session folder in TMPDIR,
    # which one removes while another needs it: each worker of the tests has a TMPDIR of its own
    "OMPI_MCA_ess_singleton_isolated": "1",
    "TMPDIR": TEMPORARY_FOLDER.name,
    "EHLPETSC_CACHE": TEMPORARY_FOLDER.name,
    "OMPI_MCA_rmaps_base_oversubscribe": "1",
    "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe",
    "OMPI_MCA_hwloc_base_binding_policy": "none",
    "PRTE_MCA_hwloc_default_binding_policy": "none",
    "PMIX_MCA_psec": "native",
    "PMIX_MCA_gds": "hash",
}
BARE = {"PATH": "/usr/bin:/bin", "HOME": "/", "TERM": "dumb"}
ALONE = {"OMPI_MCA_pml": "ob1", "OMPI_MCA_btl": "self"}  # one rank: Open MPI opens no network
PREPARED = Prepared(PYTHON, BARE | SCRIPT | ALONE)
MPIRUNS_COMMENT = re.compile(  # what run_mpi.sh leaves out too
    r"^-{70,}\nprterun detected that one or more processes.*?^-{70,}\n"
    r"|^\[[^ ]*\] PMIX ERROR: PMIX_ERR_UNREACH.*?\n",
    re.S | re.M,
)

# the inlet near the contact, so that a few steps carry the roughness there; 40 steps on 113 nodes
SHORT = ["mesh.inlet=-1.5", "mesh.outlet=1.3", "mesh.points_per_half_width=40"]
SHORT += ["time.courant=0.445", "time.travel=0.5"]  # half a node of the faster surface a step


def settings(*overrides):
    """--set before each override."""
    return [word for override in overrides for word in ("--set", override)]


def command(*words, ranks=0, tampered=()):
    """The command line; with `ranks` under mpirun, with `tampered` words through tampered.py."""
    program = [TAMPERED, *map(str, tampered)] if tampered else ["-m", "ehlpetsc"]
    mpirun = [MPIRUN, "-n", str(ranks)] if ranks else []
    return [*mpirun, PYTHON, *program, *map(str, words)]


def called(words, cwd, environment=SCRIPT):
    """Run any command to its end; output and error output as text, without the comment of Open MPI 5."""
    pipes = {"capture_output": True, "text": True, "timeout": 600, "stdin": subprocess.DEVNULL}
    done = subprocess.run(list(map(str, words)), cwd=cwd, env=BARE | environment, **pipes)
    done.stderr = MPIRUNS_COMMENT.sub("", done.stderr)
    return done


def run(*words, cwd, ranks=0, tampered=(), **environment):
    """Run the program to its end."""
    if not ranks:
        return _run_prepared([*(tampered and (TAMPERED, *tampered) or (MAIN,)), *words], cwd, environment)
    return called(command(*words, ranks=ranks, tampered=tampered), cwd, SCRIPT | environment)


def _run_prepared(words, folder, environment):
    """Run on one rank without the time for imports."""
    with tempfile.TemporaryDirectory() as streams:
        out, err = Path(streams, "out"), Path(streams, "err")
        status = PREPARED.run(words, folder, environment, out, err)
        return subprocess.CompletedProcess(words, status, out.read_text(), err.read_text())


def whole_and_restarted(words, name, step, folder):
    """Result files of a run to its end, and of the same run stopped at a step and restarted."""
    whole, parts = folder / "whole", folder / "parts"
    for place in (whole, parts):
        place.mkdir()
    assert run(*words, cwd=whole).returncode == 0
    stopped = run(*words, cwd=parts, tampered=("SIGTERM", 0, step))
    assert stopped.returncode == 4, stopped.stderr
    done = run(*words, "--restart", f"{name}.restart.h5", cwd=parts)
    assert done.returncode == 0, done.stderr
    return whole / f"{name}.h5", parts / f"{name}.h5"


def wait_for(path, process):
    """Wait until the file exists or the process has ended, a minute at most."""
    for _ in range(1200):
        time.sleep(0.05)
        if path.exists() or process.poll() is not None:
            break


def summary(text):
    """Values of the last line of a run as text by name."""
    line = text.strip().splitlines()[-1]
    assert line.startswith("ehlpetsc: "), text
    return dict(re.findall(r"(\w+)=(\S+)", line))
