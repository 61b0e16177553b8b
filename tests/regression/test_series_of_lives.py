"""A series of lives distributed over ranks."""

import json

from support import COARSE_LIFE
from support.running import PYTHON, called

KEYS = (
    "mesh.points_per_half_width=8",
    "time.travel=3.6",
    "life.max_solved=1",
    "series={key='wear.coefficient',values=[1e-19,1e-18]}",
)


def test_series_of_lives_ends_on_two_ranks(tmp_path):
    """PETSc starts on all ranks together: one that met it alone in its first life waited for ever."""
    words = [word for key in KEYS for word in ("--set", key)]
    life = [PYTHON, "-m", "ehlpetsc", "life", COARSE_LIFE, "--unresolved", "--no-picture", *words]
    done = called(["mpirun", "-n", "2", *life], tmp_path)
    assert done.returncode == 0, done.stderr
    members = json.loads((tmp_path / "coarse_life.life.series.json").read_text())["members"]
    assert [member["state"] for member in members] == ["done", "done"]
    assert [member["solved"] for member in members] == [1, 1]
