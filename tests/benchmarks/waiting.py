"""Processor time of a rank without that inside of MPI, where it waits for others: the same on a busy machine.

`mpi_time.c`, compiled by ``cc`` and loaded ahead of MPI, adds up the time in MPI; without a compiler there is
none, and figures are nan.
"""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from pathlib import Path

SOURCE = Path(__file__).with_name("mpi_time.c")


def preload(folder: Path) -> dict[str, str]:
    """Variables of the environment of processes whose time is measured; compiles into a folder."""
    compiler, library = shutil.which("cc"), folder / "mpi_time.so"
    if compiler is None:
        return {}
    subprocess.run([compiler, "-O1", "-shared", "-fPIC", "-o", library, SOURCE], check=True)
    return {"LD_PRELOAD": str(library)}


def follow_lines() -> None:
    """Have the exchange of lines, which calls MPI by its address, call it where the time is measured."""
    from ehlpetsc.nonlinear.line import exchange

    if hasattr(ctypes.CDLL(None), "seconds_outside_mpi"):
        exchange.ALLGATHER = ctypes.cast(ctypes.CDLL(None).MPI_Allgather, ctypes.c_void_p).value


def seconds_outside_mpi() -> float:
    """Processor time of this process so far without that in MPI [s]; nan: not measured."""
    measure = getattr(ctypes.CDLL(None), "seconds_outside_mpi", None)
    if measure is None:
        return float("nan")
    measure.restype = ctypes.c_double
    return measure()
