"""What all tests share: the marker of tests under mpirun."""

from pathlib import Path

import pytest

MPI_TESTS = Path(__file__).parent / "mpi"


def pytest_collection_modifyitems(items):
    """Every test in tests/mpi runs under mpirun, and no other does."""
    for item in items:
        if MPI_TESTS in item.path.parents:
            item.add_marker(pytest.mark.mpi)
