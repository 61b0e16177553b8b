"""What must be there before anything is imported: Debian's PETSc on the path, one thread a rank."""

import importlib.util
import os
import shlex
import sys
from pathlib import Path

DEBIAN = Path("/usr/lib/petscdir")
NUMERICS = ("numpy", "scipy", "h5py")
NEEDED = (*NUMERICS, "numba", "pydantic", "tomlkit", "mpi4py", "petsc4py")
RANK = ("OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK", "SLURM_PROCID")


def prepare():
    """Make ready for the imports of a run.

    Debian keeps petsc4py beside its PETSc and not on Python's path; without it set, the newest real one is
    taken. Threads of BLAS would fight the ranks for the cores: one, unless the user says otherwise.

    Returns
    -------
    list of str
        Packages that this Python does not have.
    """
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    if importlib.util.find_spec("petsc4py") is None:
        found = sorted(DEBIAN.glob("petsc*/*-real/lib/python3/dist-packages"))
        sys.path += map(str, found[-1:])
    return [name for name in NEEDED if importlib.util.find_spec(name) is None]


def require_numerics():
    """End a command (exit 2) that this Python cannot import, saying which one can."""
    missing = [name for name in NUMERICS if importlib.util.find_spec(name) is None]
    if missing and "ehlpetsc" not in sys.orig_argv:  # a run itself says more: all that it needs
        command = shlex.join(sys.orig_argv[1:])
        print(
            f"ehlpetsc: this Python ({sys.executable}) does not have {', '.join(missing)}\n"
            f"type: /usr/bin/python3 {command}   (./run_mpi.sh installs on Debian 12 what is missing)",
            file=sys.stderr,
        )
        sys.exit(2)


def advice(missing, arguments):
    """What to do about missing packages: one line of why and one to type.

    Parameters
    ----------
    missing : list of str
    arguments : list of str
        Of the command as it was typed.
    """
    words = " ".join(arguments) or "CASE.toml"
    return (
        f"ehlpetsc: this Python ({sys.executable}) does not have {', '.join(missing)}\n"
        f"type: ./run_mpi.sh {words}   (installs what is missing on Debian 12 and runs Debian's Python), "
        f"or, once installed: /usr/bin/python3 -m ehlpetsc {words}"
    )


def first_rank():
    """Whether this process is rank 0 of mpirun, or alone; known before MPI is."""
    return next((os.environ[name] for name in RANK if name in os.environ), "0") == "0"
