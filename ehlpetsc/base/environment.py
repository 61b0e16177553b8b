"""Environment of a run, set before imports: PETSc on the path, its MPI, one thread per rank, needed packages.

``run_mpi.sh`` runs this file as a script, also in a Python that is too old or has no packages::

    environment.py own MODULE ...      status 0: this Python, not Debian's, has all modules and can load PETSc
    environment.py missing MODULE ...  prints the missing modules
"""

from __future__ import annotations

import contextlib
import ctypes
import importlib
import importlib.util
import os
import re
import sys
from collections.abc import Iterable
from pathlib import Path

SCRIPT = Path(__file__).parents[2] / "run_mpi.sh"  # in a clone
DEBIAN = Path("/usr/lib/petscdir")
NUMERICS = ("numpy", "scipy", "h5py")
READING = ("numpy", "scipy", "numba")  # of a case file
SOLVER = ("mpi4py", "petsc4py")
NEEDED = (*NUMERICS, "numba", *SOLVER)
MPIRUN_VARIABLES = ("OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK")
RANK_VARIABLES = (*MPIRUN_VARIABLES, "SLURM_PROCID")  # the last one also in the script of a batch job
# of Open MPI, of MPICH and Intel MPI, of MVAPICH, of srun; not SLURM_NTASKS, which a batch script has too
SIZE_VARIABLES = ("OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "MV2_COMM_WORLD_SIZE", "SLURM_STEP_NUM_TASKS")
OLDEST_PYTHON = (3, 11)
MPI_LIBRARY = rb"libmpi(?:ch)?\.so\.\d+"  # name by which a module asks for MPI, .12 of MPICH
OPEN_MPI = "libmpi.so.40"
WHEEL = "dolfinx-solver-real"  # PETSc with MPICH and mpi4py, of the extra wheel


def prepare() -> list[str]:
    """Prepare the imports of a run.

    The petsc4py of Debian or of a PETSc built from source is not on Python's path: that of ``PETSC_DIR`` is
    added, by default Debian's newest one with real scalars. BLAS uses one thread unless the user sets another
    number, because ranks and threads would compete for the cores. UCX, which Open MPI 5 starts, must not
    handle SIGHUP.

    Returns the missing packages.
    """
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    os.environ.setdefault("UCX_DEBUG_SIGNO", "0")
    if not has("petsc4py"):
        sys.path += map(str, _petsc4py_folders()[:1])
    return missing(NEEDED)


def load_mpi() -> str:
    """Load the MPI library that petsc4py needs, where mpi4py leaves the choice, before anything compiled.

    mpi4py as a wheel has modules for MPICH and for Open MPI and takes the library that is loaded. That of the
    wheel mpich, which petsc4py's wheel needs, is on no path that is searched.

    Returns the fault of two MPIs, in one process or of process and launcher, of which one would end it; ""
    without one.
    """
    needed, offered = _mpi_libraries("petsc4py", "lib/**/PETSc.*.so"), _mpi_libraries("mpi4py", "MPI.*.so")
    is_loaded = "mpi4py.MPI" in sys.modules
    used = set(filter(_is_loaded, offered)) if is_loaded else offered
    if not (needed and used):  # linked by other names
        return ""
    needs = f"petsc4py in {_folder('petsc4py')} needs {', '.join(needed)}"
    if not needed & used:
        order = "import ehlpetsc before mpi4py, or " if is_loaded else ""
        return (
            f"{needs}, mpi4py in {_folder('mpi4py')} uses {', '.join(used)}: {order}unset PYTHONPATH and "
            "PETSC_DIR, and install both from one source in an environment of its own"
        )
    if "OMPI_COMM_WORLD_SIZE" in os.environ and OPEN_MPI not in needed:
        return f"{needs}, not the Open MPI whose mpirun has started it; type: ehlpetsc -n RANKS CASE.toml"
    if not is_loaded and len(offered) > 1 and not any(map(_load, needed)):
        return f"{needs}, which is not installed; type: {sys.executable} -m pip install mpich"
    return ""


def _mpi_libraries(package: str, modules: str) -> set[str]:
    """MPI libraries that compiled modules of a package ask for; of several modules it loads one."""
    names = set()
    for path in _folder(package).glob(modules):
        if found := re.search(MPI_LIBRARY, path.read_bytes()):
            names.add(found.group().decode())
    return names


def _folder(package: str) -> Path:
    return Path(importlib.util.find_spec(package).origin).parent


def _is_loaded(library: str) -> bool:
    try:
        ctypes.CDLL(library, mode=os.RTLD_NOLOAD)
    except OSError:
        return False
    return True


def _load(library: str) -> bool:
    """Load a library of the wheel mpich or of the system; whether it is there."""
    from importlib import metadata  # slow, and needed here alone

    with contextlib.suppress(metadata.PackageNotFoundError):
        files = metadata.files("mpich") or []
        library = next((str(file.locate()) for file in files if file.name == library), library)
    try:
        ctypes.CDLL(library, mode=ctypes.RTLD_GLOBAL)
    except OSError:
        return False
    return True


def has(name: str) -> bool:
    """Whether a package can be imported; a folder of its name without a package does not count."""
    spec = importlib.util.find_spec(name)
    return spec is not None and spec.origin is not None


def missing(names: Iterable[str]) -> list[str]:
    """Missing packages of a list."""
    return [name for name in names if not has(name)]


def _petsc4py_folders() -> list[Path]:
    """Folders of the petsc4py of ``PETSC_DIR``, then of Debian's for this release of Python, newest first."""
    home, arch = Path(os.environ.get("PETSC_DIR", os.devnull)), os.environ.get("PETSC_ARCH", "")
    folders = (home / arch / "lib", home / "lib", home / "lib/python3/dist-packages")
    built = f"petsc4py/lib/PETSc.{sys.implementation.cache_tag}-*.so"
    debians = [p for p in DEBIAN.glob("petsc*/*-real/lib/python3/dist-packages") if list(p.glob(built))]
    debians.sort(key=lambda path: [int(n) for n in re.findall(r"\d+", path.parts[4])], reverse=True)
    return [folder for folder in folders if (folder / "petsc4py").is_dir()] + debians


def advice(lacks: list[str], arguments: list[str]) -> str:
    """Advice on missing packages: one line with the reason and one with a command.

    `arguments`: arguments of the command.
    """
    command = " ".join(arguments) or "CASE.toml"
    reason = f"ehlpetsc: this Python ({sys.executable}) does not have {', '.join(lacks)}\n"
    if SCRIPT.exists():
        return (
            f"{reason}type: ./run_mpi.sh {command}   (installs what is missing on Debian 12 and newer and "
            f"runs Debian's Python), or, once installed: /usr/bin/python3 -m ehlpetsc {command}"
        )
    of_petsc = ""
    if set(lacks) & set(SOLVER) and _suits_wheel():
        lacks = [*(name for name in lacks if name not in SOLVER), WHEEL]
    elif set(lacks) & set(SOLVER):
        of_petsc = (
            "   (builds PETSc from source if that is missing), or take Debian's packages and a virtual "
            "environment with --system-site-packages"
        )
    return (
        f"{reason}type: {sys.executable} -m pip install {' '.join(lacks)}{of_petsc}; "
        "the section Install of the page README.md lists all ways"
    )


def _suits_wheel() -> bool:
    return sys.version_info >= (3, 12) and sys.platform == "linux" and os.uname().machine == "x86_64"


def need_solver() -> None:
    """Find PETSc and its MPI; ImportError with advice if a package is missing or is on another MPI."""
    if lacks := prepare():
        raise ImportError(advice(lacks, []))
    if fault := load_mpi():
        raise ImportError(fault)


def first_rank() -> bool:
    """Whether this process is rank 0 of mpirun, or alone; also before MPI is initialised."""
    return next((os.environ[name] for name in RANK_VARIABLES if name in os.environ), "0") == "0"


def other_mpi(ranks: int) -> str:
    """Fault of processes that a launcher started together and that are alone in this MPI; "" without one.

    `ranks`: number of ranks of MPI's world.
    """
    name = next((name for name in SIZE_VARIABLES if name in os.environ), "")
    started = os.environ.get(name, "")
    if ranks > 1 or not started.isdecimal() or int(started) < 2:
        return ""
    return (
        f"{started} processes were started together ({name}) and each of them is alone, so that all would "
        "compute the same: the launcher is not that of mpi4py's MPI; start that one's mpirun, or, where each "
        f"process has its own case, unset {name}"
    )


def _is_own_python(names: Iterable[str]) -> bool:
    """Whether this Python has all packages without Debian's PETSc, whose environment run_mpi.sh sets."""
    if sys.version_info < OLDEST_PYTHON:
        return False
    prepare()
    if missing(names) or DEBIAN in _folder("petsc4py").parents:
        return False
    if load_mpi():
        return False
    # loaded, not initialised: under a batch system MPI cannot be initialised here
    importlib.import_module("mpi4py").rc.initialize = False
    importlib.import_module("mpi4py.MPI")
    petsc = importlib.import_module("petsc4py.lib").ImportPETSc()
    return petsc.ScalarType.__name__ in ("float", "float64")


def _answer(question: str, *names: str) -> int:
    sys.path.pop(0)  # this file's folder, whose modules are part of a package
    if question == "own":
        return 0 if _is_own_python(names) else 1
    prepare()
    print("\n".join(missing(names)))
    return 0


if __name__ == "__main__":
    sys.exit(_answer(*sys.argv[1:]))
