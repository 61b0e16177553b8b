"""Results that are deleted or replaced while they are written."""

import os
from types import SimpleNamespace

import numpy as np
import pytest
from support import CASES

import ehlpetsc
from ehlpetsc.base.command_line import exit_status
from ehlpetsc.base.errors import ExitStatus, OutputLost
from ehlpetsc.life.history import LifeFile, LifeHistory
from ehlpetsc.results.hdf5_file import open_for_reading
from ehlpetsc.results.writer import Layout, ResultWriter
from ehlpetsc.run.checkpoint import load_restart
from ehlpetsc.run.solve import Run

RIDGE = {"mesh.inlet": -1.3, "mesh.points_per_half_width": 20, "time.travel": 0.3, "time.courant": 0.445}
STEPS = 12


def overwrite(path):
    path.write_bytes(b"another file" * 1000)


def move_another(path):
    overwrite(path.with_name("other"))
    os.replace(path.with_name("other"), path)


def truncate(path):
    path.write_bytes(b"")


def rename_folder(path):
    path.parent.rename(path.parent.with_name("elsewhere"))


def content(path):
    return path.read_bytes() if path.exists() else None


@pytest.mark.parametrize("ending", ["flush", "close"])
@pytest.mark.parametrize(
    "lose, word",
    [
        (os.unlink, "deleted"),
        (rename_folder, "deleted"),
        (move_another, "replaced"),
        (overwrite, "replaced"),
        (truncate, "replaced"),
    ],
)
def test_loss_is_noticed_and_another_file_kept(tmp_path, lose, word, ending):
    path = tmp_path / "out" / "r.h5"
    path.parent.mkdir()
    writer = ResultWriter(path, Layout(np.arange(4.0), ["pressure"]), {})

    def put(steps):
        for step in steps:
            writer.append(step, 1.0 * step, {"pressure": np.zeros(4)}, {}, np.zeros(4, bool))

    put(range(3))
    writer.flush()
    lose(path)
    found = content(path)
    put(range(3, 40))
    with pytest.raises(OutputLost, match=rf"r\.h5: {word} .*during the run"):
        writer.flush() if ending == "flush" else writer.close("done")
    assert content(path) == found


@pytest.mark.parametrize("lose", [os.unlink, move_another, overwrite])
@pytest.mark.parametrize("last", [3, STEPS])
def test_run_ends_with_a_status_of_its_own_and_can_be_continued(tmp_path, monkeypatch, capsys, lose, last):
    monkeypatch.setattr("ehlpetsc.results.writer.FLUSH_SECONDS", 0.0)
    case, path, restart = ehlpetsc.load(CASES / "ridge.toml", RIDGE), tmp_path / "r.h5", "r.restart.h5"

    def lose_at_last(state):
        if state.step == last:
            lose(path)

    progress = SimpleNamespace(write=lose_at_last, close=lambda status: None)
    status, failure = Run(ehlpetsc.Simulation(case), path, progress=progress).run()
    assert status is ExitStatus.OUTPUT_LOST == 5 and isinstance(failure, OutputLost)
    printed, step = capsys.readouterr(), min(last + 1, STEPS)  # of the next flush
    assert f"--restart {tmp_path / restart} -o OTHER.h5 continues" in printed.err
    assert printed.out.splitlines()[-1].startswith(f"ehlpetsc: output lost steps={step} ")
    assert load_restart(tmp_path / restart)["step"] == step
    whole = ehlpetsc.solve(case)
    with ehlpetsc.solve(case, tmp_path / "other.h5", restart=tmp_path / restart) as rest:
        assert rest.steps("step").tolist() == list(range(step + 1, STEPS + 1))
        assert np.array_equal(rest.contact_count, whole.contact_count)
        assert step == STEPS or np.array_equal(rest.pressure[-1], whole.pressure[-1])


def test_life_is_written_again_where_it_was_deleted_and_keeps_another_file(tmp_path):
    path, life, file = tmp_path / "a.life.h5", LifeHistory("", ""), LifeFile(tmp_path / "a.life.h5")
    for passes in (10, 20):
        life.add({"passes": passes}, (), {})
        file.store(life)
        path.unlink()
    life.add({"passes": 30}, (), {})
    file.store(life)
    with open_for_reading(path) as stored:
        assert stored["figures/passes"][:].tolist() == [10, 20, 30]
    move_another(path)
    found = content(path)
    with pytest.raises(OutputLost, match=r"a\.life\.h5: replaced by another file during the run$"):
        file.store(life)
    file.close("stopped")
    assert content(path) == found


def test_commands_end_with_the_status_of_the_loss(capsys):
    def lose():
        raise OutputLost("a.h5: deleted during the run")

    assert exit_status("life", lose) == ExitStatus.OUTPUT_LOST
    assert capsys.readouterr().err == "ehlpetsc life: a.h5: deleted during the run\n"
