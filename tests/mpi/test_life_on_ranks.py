"""A life on ranks: a position of surface 2 each, and all of them on one pass, with the result of one rank."""

from pathlib import Path

import pytest
from mpi4py import MPI
from support import COARSE_LIFE
from support.work_shares import shared_out

from ehlpetsc.base.errors import Stopped
from ehlpetsc.case.loading import load
from ehlpetsc.life import run_life
from ehlpetsc.life.ensemble import read_lives, run_lives

CASE = COARSE_LIFE
SHORT = {
    "mesh.points_per_half_width": 8,
    "time.travel": 3.6,
    "surface.1.scale": 1.0,
    "surface.2.scale": 1.0,
    "wear.coefficient": 1e-17,
}
WAVES = {
    "kind": "self-affine",
    "sq": 0.1e-6,
    "hurst": 0.8,
    "roll_off": 250e-6,
    "short_cutoff": 120e-6,
    "seed": 1,
}
LIVES = {
    "line": {"mesh.points_per_half_width": 20},
    "positions": {"time.pass_shift": 50e-6, "life.partners": 3, "time.travel": 4.6},
    "strip": {  # with rows for three ranks, which differ; damage is a high power of the pressure
        "mesh.width": 1.5,
        "mesh.inlet": -1.4,
        "mesh.outlet": 1.4,
        "time.travel": 4.0,
        "surface.1.file": None,
        "surface.1.scale": None,
        "surface.1.synthetic": WAVES,
        "petsc.snes_atol": "1e-11",
    },
}


def lived(name, folder, **ranks):
    """Passes of a life of two rounds, positions solved in the first, profiles and damage of its bodies."""
    case, path = load(CASE, SHORT | LIVES[name]), folder / f"{name}.life.h5"
    life = run_life(case, path, most=2, unresolved=True, **ranks)
    bodies = [(body.profile, body.damage) for both in life.bodies for body in both]
    return life("passes").tolist(), life.rows[0]["solved"], bodies


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    """Lives on one rank, by name."""
    folder = tmp_path_factory.mktemp("alone")
    return shared_out(lambda name: lived(name, folder), LIVES)


@pytest.mark.several_ranks
@pytest.mark.parametrize("name", LIVES)
def test_life_is_independent_of_the_number_of_ranks(name, alone, tmp_path):
    world = MPI.COMM_WORLD
    passes, solved, bodies = lived(name, Path(world.bcast(str(tmp_path))), comm=world)
    assert solved == LIVES[name].get("life.partners", 1)
    assert passes == alone[name][0]
    for (profile, damage), (profile_alone, damage_alone) in zip(bodies, alone[name][2], strict=True):
        assert profile == pytest.approx(profile_alone, rel=1e-9)
        assert damage == pytest.approx(damage_alone, rel=1e-9)


def test_lives_of_a_series_are_those_of_one_rank(tmp_path):
    """Each is computed by one of the ranks, and listed; a second call computes none again."""
    from mpi4py import MPI

    world, shown = MPI.COMM_WORLD, []
    keys = SHORT | {
        "life.max_solved": 1,
        "series.key": "wear.coefficient",
        "series.values": [1e-18, 1e-17],
    }
    case, folder = load(CASE, keys), Path(world.bcast(str(tmp_path)))
    options = {"unresolved": True, "show": shown.append}
    index = run_lives(case, folder / "together.life.h5", world, **options)
    assert sum(world.allgather(len(shown))) == 2 and min(world.allgather(len(shown))) < 3
    together, written = (
        read_lives(index),
        [path.stat().st_mtime_ns for path in sorted(folder.glob("*.life.h5"))],
    )
    run_lives(case, folder / "together.life.h5", world, **options)
    assert written == [path.stat().st_mtime_ns for path in sorted(folder.glob("together*.life.h5"))]
    alone = read_lives(run_lives(case, folder / f"alone{world.rank}.life.h5", MPI.COMM_SELF, unresolved=True))
    assert len(together) == 2 and together.keys() == alone.keys()
    for (one,), (other,) in zip(together.values(), alone.values(), strict=True):
        assert one("damage_1") == pytest.approx(other("damage_1"), rel=1e-12)
        assert one("wear_volume_2") == pytest.approx(other("wear_volume_2"), rel=1e-12)


def test_stop_in_one_position_ends_the_life_on_every_rank(tmp_path):
    world = MPI.COMM_WORLD
    case = load(CASE, SHORT | LIVES["positions"])
    folder = Path(world.bcast(str(tmp_path)))
    with pytest.raises(Stopped):
        run_life(case, folder / "a.life.h5", comm=world, stop=StopAtOnce(), unresolved=True)


class StopAtOnce:
    """A stop that was asked for before."""

    def __call__(self, comm):
        return True

    overdue = __call__
