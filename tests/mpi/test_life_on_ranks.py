"""A life on ranks: a position of surface 2 each, and all of them on one pass, with the result of one rank."""

from pathlib import Path

import pytest
from support import COARSE_LIFE

from ehlpetsc.case.loading import load
from ehlpetsc.life import run_life

CASE = COARSE_LIFE
SHORT = {
    "mesh.points_per_half_width": 8,
    "time.travel": 3.6,
    "surface.1.scale": 1.0,
    "surface.2.scale": 1.0,
    "wear.coefficient": 1e-17,
}


@pytest.mark.parametrize(
    "keys",
    [
        {"mesh.points_per_half_width": 20},
        {"time.pass_shift": 50e-6, "life.partners": 3},
        {"mesh.width": 1.5},  # a strip, with rows for three ranks
    ],
)
def test_life_is_independent_of_the_number_of_ranks(keys, tmp_path):
    from mpi4py import MPI

    world, case = MPI.COMM_WORLD, load(CASE, SHORT | keys)
    folder = Path(world.bcast(str(tmp_path)))
    # on each rank by itself
    alone = run_life(case, folder / f"alone{world.rank}.life.h5", most=2, unresolved=True)
    together = run_life(case, folder / "together.life.h5", most=2, comm=world, unresolved=True)
    assert together.rows[0]["solved"] == keys.get("life.partners", 1)
    assert together("passes").tolist() == alone("passes").tolist()
    for both, others in zip(together.bodies, alone.bodies, strict=True):
        for body, other in zip(both, others, strict=True):
            assert body.profile == pytest.approx(other.profile, rel=1e-9)
            assert body.damage == pytest.approx(other.damage, rel=1e-9)


def test_stop_in_one_position_ends_the_life_on_every_rank(tmp_path):
    from mpi4py import MPI

    from ehlpetsc.base.errors import Stopped

    world = MPI.COMM_WORLD
    case = load(CASE, SHORT | {"time.pass_shift": 50e-6, "life.partners": 3})
    folder = Path(world.bcast(str(tmp_path)))
    with pytest.raises(Stopped):
        run_life(case, folder / "a.life.h5", comm=world, stop=StopAtOnce(), unresolved=True)


class StopAtOnce:
    """A stop that was asked for before."""

    def __call__(self, comm):
        return True

    overdue = __call__
