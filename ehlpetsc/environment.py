"""Environment of a run, before anything is imported: PETSc on the path, one thread a rank, packages.

``run_mpi.sh`` runs this file by itself, in a Python that may have none of them and may be too old::

    environment.py own MODULE ...      status 0: this Python, not Debian's, has all and can load PETSc
    environment.py missing MODULE ...  prints those that it does not have
    environment.py found MODULE ...    prints what it is and what it lacks
"""

import importlib
import importlib.util
import os
import re
import shlex
import sys
from pathlib import Path

DEBIAN = Path("/usr/lib/petscdir")
NUMERICS = ("numpy", "scipy", "h5py")
SOLVER = ("mpi4py", "petsc4py")
NEEDED = (*NUMERICS, "numba", "pydantic", "tomlkit", *SOLVER)
RANK = ("OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK", "SLURM_PROCID")
OLDEST_PYTHON = (3, 11)


def prepare():
    """Make ready for the imports of a run.

    Debian keeps petsc4py beside its PETSc and not on Python's path, and so does a PETSc built by hand: that
    of ``PETSC_DIR`` is taken, without it Debian's newest real one. Threads of BLAS would fight the ranks for
    the cores: one, unless the user says otherwise. UCX, which Open MPI 5 starts, would take SIGHUP.

    Returns
    -------
    list of str
        Packages that this Python does not have.
    """
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    os.environ.setdefault("UCX_DEBUG_SIGNO", "0")
    if not has("petsc4py"):
        sys.path += map(str, [*_of_petsc_dir(), *_debians()][:1])
    return missing(NEEDED)


def has(name):
    """Whether a package can be imported; a folder of its name without a package in it cannot."""
    spec = importlib.util.find_spec(name)
    return spec is not None and spec.origin is not None


def missing(names):
    """Packages among the given ones that this Python does not have.

    Parameters
    ----------
    names : iterable of str

    Returns
    -------
    list of str
    """
    return [name for name in names if not has(name)]


def _of_petsc_dir():
    """Folders of the petsc4py that the PETSc of the environment was built with."""
    if "PETSC_DIR" not in os.environ:
        return []
    home, arch = Path(os.environ["PETSC_DIR"]), os.environ.get("PETSC_ARCH", "")
    folders = (home / arch / "lib", home / "lib", home / "lib/python3/dist-packages")
    return [folder for folder in folders if (folder / "petsc4py").is_dir()]


def _debians():
    """Folders of Debian's petsc4py of this release of Python, newest first."""
    built = f"petsc4py/lib/PETSc.{sys.implementation.cache_tag}-*.so"
    found = [p for p in DEBIAN.glob("petsc*/*-real/lib/python3/dist-packages") if list(p.glob(built))]
    return sorted(found, key=lambda path: [int(n) for n in re.findall(r"\d+", path.parts[4])], reverse=True)


def require_numerics():
    """End a command (exit 2) whose packages this Python lacks, with advice."""
    lacks = missing(NUMERICS)
    if lacks and "ehlpetsc" not in sys.orig_argv:  # a run itself says more: all that it needs
        command = shlex.join(sys.orig_argv[1:])
        print(
            f"ehlpetsc: this Python ({sys.executable}) does not have {', '.join(lacks)}\n"
            f"type: /usr/bin/python3 {command}   "
            "(./run_mpi.sh installs on Debian 12 and newer what is missing)",
            file=sys.stderr,
        )
        sys.exit(2)


def advice(lacks, arguments):
    """Advice on missing packages: one line with the reason and one to type.

    Parameters
    ----------
    lacks : list of str
    arguments : list of str
        Of the command as it was typed.
    """
    words = " ".join(arguments) or "CASE.toml"
    said = f"ehlpetsc: this Python ({sys.executable}) does not have {', '.join(lacks)}\n"
    if Path(__file__).parents[1].joinpath("run_mpi.sh").exists():
        return (
            f"{said}type: ./run_mpi.sh {words}   (installs what is missing on Debian 12 and newer and runs "
            f"Debian's Python), or, once installed: /usr/bin/python3 -m ehlpetsc {words}"
        )
    return (
        f"{said}type: {sys.executable} -m pip install {' '.join(lacks)}   (builds PETSc from source if "
        "that is missing), or take Debian's packages and a virtual environment with --system-site-packages"
    )


def startup_problem():
    """Reason why a run cannot be started here; None: there is none."""
    try:
        os.getcwd()
    except OSError:
        return "the working folder has been removed; change to one that is there"
    if any(name in os.environ for name in RANK):
        return None  # mpirun has found its own
    names = ("OMPI_MCA_orte_tmpdir_base", "TMPDIR", "TEMP", "TMP")
    folder = next((os.environ[name] for name in names if os.environ.get(name)), "/tmp")
    if not os.access(folder, os.W_OK | os.X_OK):
        return f"{folder}: cannot be written, and MPI needs it; set TMPDIR to a folder that can"
    return None


def first_rank():
    """Whether this process is rank 0 of mpirun, or alone; known before MPI is."""
    return next((os.environ[name] for name in RANK if name in os.environ), "0") == "0"


def _own(names):
    """Whether this Python is complete without Debian's PETSc, whose environment run_mpi.sh sets itself."""
    if sys.version_info < OLDEST_PYTHON:
        return False
    prepare()
    if missing(names) or DEBIAN in Path(importlib.util.find_spec("petsc4py").origin).parents:
        return False
    # loaded, not started: where a batch system starts the ranks, there can be none here
    importlib.import_module("mpi4py").rc.initialize = False
    importlib.import_module("mpi4py.MPI")
    petsc = importlib.import_module("petsc4py.lib").ImportPETSc()
    return petsc.ScalarType.__name__ in ("float", "float64")


def _found(names):
    lacks = f"without {', '.join(missing(names))}" if missing(names) else "with all packages"
    return f"{sys.executable} is Python {sys.version.split()[0]}, {lacks}"


def _answer(question, *names):
    sys.path.pop(0)  # this file's folder, whose modules are part of a package
    if question == "own":
        return 0 if _own(names) else 1
    prepare()
    print(_found(names) if question == "found" else "\n".join(missing(names)))
    return 0


if __name__ == "__main__":
    sys.exit(_answer(*sys.argv[1:]))
