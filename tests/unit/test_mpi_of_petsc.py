"""PETSc and mpi4py agree on one MPI before either is loaded, or are refused; ranks end together."""

import gc
import os
import signal
import sys
import weakref
from types import SimpleNamespace

import numpy as np
import pytest
from support import CASES

import ehlpetsc
from ehlpetsc.__main__ import main
from ehlpetsc.base import environment

MPICH, OPEN_MPI = b"\0libmpi.so.12\0", b"\0libmpi.so.40\0"  # as compiled modules name what they need
WHEEL = {"MPI.mpich.so": MPICH, "MPI.openmpi.so": OPEN_MPI}  # of mpi4py, which leaves the choice


@pytest.fixture
def installed(tmp_path, monkeypatch):
    """Call that installs stand-ins for petsc4py and mpi4py; returns the libraries that are then loaded."""
    loaded = []
    for name in [*environment.SOLVER, "mpi4py.MPI"]:
        monkeypatch.delitem(sys.modules, name, raising=False)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delenv("OMPI_COMM_WORLD_SIZE", raising=False)

    def install(petsc, mpi, libraries=(), in_use=None):
        files = {
            "petsc4py/lib/PETSc.abi3.so": petsc,
            **{f"mpi4py/{name}": text for name, text in mpi.items()},
        }
        files |= {"petsc4py/__init__.py": b"", "mpi4py/__init__.py": b""}
        if libraries:
            record = "".join(f"mpich/{name},,\n" for name in libraries).encode()
            files |= {f"mpich/{name}": b"" for name in libraries}
            files |= {"mpich-5.dist-info/METADATA": b"Name: mpich\n", "mpich-5.dist-info/RECORD": record}
        for name, text in files.items():
            (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
            (tmp_path / name).write_bytes(text)

        def load(name, mode):
            if mode & os.RTLD_NOLOAD and name != in_use or not (mode & os.RTLD_NOLOAD or "/mpich/" in name):
                raise OSError(name)
            loaded.append(name)

        monkeypatch.setattr("ctypes.CDLL", load)
        if in_use:
            mpi = SimpleNamespace(COMM_WORLD=SimpleNamespace(size=1))
            monkeypatch.setitem(sys.modules, "mpi4py.MPI", mpi)
        return loaded

    return install


def test_the_library_of_the_wheel_mpich_is_loaded(installed, tmp_path):
    loaded = installed(MPICH, WHEEL, ["libmpi.so", "libmpi.so.12"])
    assert environment.load_mpi() == "" and loaded == [str(tmp_path / "mpich/libmpi.so.12")]


def test_what_mpi4py_has_loaded_stays(installed):
    loaded = installed(MPICH, WHEEL, ["libmpi.so.12"], in_use="libmpi.so.12")
    assert environment.load_mpi() == "" and "/mpich/" not in "".join(loaded)


def test_modules_of_one_build_find_their_library_themselves(installed):
    assert installed(OPEN_MPI, {"MPI.cpython-311.so": OPEN_MPI}) == [] and environment.load_mpi() == ""


@pytest.mark.parametrize(
    ("mpi", "in_use", "words"),
    [
        (
            {"MPI.cpython-311.so": OPEN_MPI},
            None,
            "uses libmpi.so.40: unset PYTHONPATH and PETSC_DIR, and install",
        ),
        (WHEEL, "libmpi.so.40", "uses libmpi.so.40: import ehlpetsc before mpi4py, or unset PYTHONPATH"),
        (WHEEL, None, "needs libmpi.so.12, which is not installed; type: "),
    ],
)
def test_two_mpis_are_refused_in_one_sentence(installed, capsys, mpi, in_use, words):
    installed(MPICH, mpi, in_use=in_use)
    assert main([str(CASES / "mixed.toml")]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("ehlpetsc: petsc4py in ") and "needs libmpi.so.12, " in line and words in line
    with pytest.raises(ImportError, match=words.split(":")[0]):
        environment.need_solver()


def test_another_launcher_is_refused_before_mpi_ends_the_process(installed, monkeypatch, capsys):
    installed(MPICH, WHEEL, ["libmpi.so.12"])
    monkeypatch.setenv("OMPI_COMM_WORLD_SIZE", "2")
    assert main([str(CASES / "mixed.toml")]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    words = (
        "needs libmpi.so.12, not the Open MPI whose mpirun has started it; type: ehlpetsc -n RANKS CASE.toml"
    )
    assert line.startswith("ehlpetsc: petsc4py in ") and line.endswith(words)


@pytest.mark.parametrize("ranks", [1, 2])
def test_ranks_leave_no_garbage_to_the_end_of_petsc(monkeypatch, ranks):
    monkeypatch.setitem(sys.modules, "mpi4py.MPI", SimpleNamespace(COMM_WORLD=SimpleNamespace(size=ranks)))
    monkeypatch.setattr(signal, "signal", lambda *_: None)
    gc.disable()
    try:
        cycle = type("Cycle", (), {})()
        cycle.itself, left = cycle, weakref.ref(cycle)
        del cycle
        assert main(["--version"]) == 0
        assert (left() is None) == (ranks > 1)
    finally:
        gc.enable()


def test_petsc_of_complex_numbers_is_refused(monkeypatch):
    from petsc4py import PETSc

    monkeypatch.setattr(PETSc, "ScalarType", np.complex128)
    with pytest.raises(
        ehlpetsc.UsageError, match=r"PETSc in /.* computes with complex128; needed: real numbers"
    ):
        ehlpetsc.Simulation(CASES / "table1_smooth.toml")
