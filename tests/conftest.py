"""What all tests share: the marker of tests under mpirun, and signals as a terminal has them."""

import signal
from pathlib import Path

import pytest

MPI_TESTS = Path(__file__).parent / "mpi"
# a shell lets what it starts in the background ignore Ctrl-C, and that would be handed on to every process
signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_collection_modifyitems(items):
    """Every test in tests/mpi runs under mpirun, and no other does."""
    for item in items:
        if MPI_TESTS in item.path.parents:
            item.add_marker(pytest.mark.mpi)
