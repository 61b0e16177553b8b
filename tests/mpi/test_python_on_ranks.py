"""The package from Python on several ranks: every rank gets the same result, that of one rank."""

from pathlib import Path

import numpy as np

import ehlpetsc

CASE = Path(__file__).parents[2] / "cases" / "table1_smooth.toml"
COARSE = {"mesh.points_per_half_width": 20}


def test_every_rank_gets_the_single_rank_result():
    alone = ehlpetsc.solve(ehlpetsc.load(CASE, COARSE))  # on each rank by itself
    from mpi4py import MPI

    together = ehlpetsc.solve(ehlpetsc.load(CASE, COARSE), comm=MPI.COMM_WORLD)
    assert together.attrs["ranks"] == MPI.COMM_WORLD.size and alone.attrs["ranks"] == 1
    np.testing.assert_allclose(together.pressure, alone.pressure, rtol=0, atol=1e-9 * alone.attrs["p0"])
