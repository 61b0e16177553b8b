"""What all tests share: the marker of tests under mpirun, and signals as a terminal has them."""

import signal
from pathlib import Path

import pytest

MPI_TESTS = Path(__file__).parent / "mpi"
# what a shell starts in the background ignores Ctrl-C, nohup a hangup, and every process would inherit that
signal.signal(signal.SIGINT, signal.default_int_handler)
signal.signal(signal.SIGHUP, signal.SIG_DFL)


def pytest_collection_modifyitems(items):
    """Every test in tests/mpi runs under mpirun, and no other does."""
    for item in items:
        if MPI_TESTS in item.path.parents:
            item.add_marker(pytest.mark.mpi)
