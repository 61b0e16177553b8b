"""Results that are lost while they are written; surface files that change between parts of a run."""

import os
import shutil
from types import SimpleNamespace

import numpy as np
import pytest
from support import CASES, COARSE_LIFE, ROOT

import ehlpetsc
from ehlpetsc.base.command_line import exit_status
from ehlpetsc.base.errors import CaseError, ExitStatus, OutputError, OutputLost
from ehlpetsc.case.loading import load, members
from ehlpetsc.life.history import LifeFile, LifeHistory, stored_or_new
from ehlpetsc.results.hdf5_file import open_for_reading
from ehlpetsc.results.reader import is_done
from ehlpetsc.results.writer import Layout, ResultWriter
from ehlpetsc.run.checkpoint import load_restart
from ehlpetsc.run.passes import Passes
from ehlpetsc.run.recorder import Recorder
from ehlpetsc.run.series import Series
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
    [(os.unlink, "deleted"), (rename_folder, "deleted")]
    + [(lose, "replaced") for lose in (move_another, overwrite, truncate)],
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


def test_life_is_written_again_where_it_was_deleted_and_its_loss_has_a_status(tmp_path, capsys):
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

    def lose():
        raise OutputLost("a.h5: deleted during the run")

    assert exit_status("life", lose) == ExitStatus.OUTPUT_LOST
    assert capsys.readouterr().err == "ehlpetsc life: a.h5: deleted during the run\n"


KEYS = {"mesh.inlet": -1.3, "mesh.outlet": 1.3, "mesh.points_per_half_width": 12, "time.travel": 0.3}
KEYS |= {"surface.2": None}
FILE = "profile.csv"


@pytest.fixture
def path(tmp_path):
    """A case with its profile beside it."""
    shutil.copy(CASES / "profiles" / "alicona_meander_profile.csv", tmp_path / FILE)
    shutil.copy(CASES / "table1_mixed.toml", tmp_path / "a.toml")
    return tmp_path / "a.toml"


def read(path, **more):
    return load(path, KEYS | {"surface.1": {"file": FILE}} | more)


def turn_over(path):
    """Another profile of the same points."""
    x, z = np.loadtxt(path.parent / FILE, delimiter=",", comments="#", unpack=True)
    np.savetxt(path.parent / FILE, np.column_stack([x, -z]), delimiter=",")


def stopped(case, output, steps=3):
    simulation = ehlpetsc.Simulation(case)
    with Recorder(simulation, output) as recorder:
        recorder.lock_output()
        for state in simulation:
            recorder.write(state)
            if state.step == steps:
                break
        recorder.close(ExitStatus.STOPPED)
    return recorder.restart


CHANGED = r"surface\.1\.file changed since it was written"


def test_stopped_run_is_not_continued_with_another_profile(path, tmp_path):
    output = tmp_path / "r.h5"
    restart = stopped(read(path), output)
    kept = output.read_bytes()
    turn_over(path)
    with pytest.raises(OutputError, match=rf"r\.restart\.h5: {CHANGED}.* --overwrite "):
        ehlpetsc.solve(read(path), output)
    with pytest.raises(OutputError, match=rf"r\.restart\.h5: {CHANGED}"):
        ehlpetsc.solve(read(path), tmp_path / "other.h5", restart=restart)
    assert output.read_bytes() == kept and not (tmp_path / "other.h5").exists()
    shutil.copy(CASES / "profiles" / "alicona_meander_profile.csv", tmp_path / FILE)
    assert ehlpetsc.solve(read(path), output).attrs["restarts"] == 1


def test_restart_does_not_continue_the_result_of_another_run(path, tmp_path):
    restart, output = stopped(read(path), tmp_path / "r.h5"), tmp_path / "other.h5"
    stopped(read(path, **{"fluid.viscosity": 0.004}), output).unlink()
    kept = output.read_bytes()
    with pytest.raises(OutputError, match=r"other\.h5: no earlier part of the run of .*r\.restart\.h5; "):
        ehlpetsc.solve(read(path), output, restart=restart)
    assert output.read_bytes() == kept
    steps = ehlpetsc.solve(read(path), output, restart=restart, overwrite=True).steps.step
    assert steps[0] == 4 and (np.diff(steps) == 1).all()
    changed = read(path, **{"fluid.viscosity": 0.004})
    steps = ehlpetsc.solve(changed, tmp_path / "r.h5", restart=restart).steps.step
    assert list(steps) == list(range(len(steps)))


def test_restart_reports_the_name_of_another_file_and_a_changed_one_is_refused(path, tmp_path):
    restart = stopped(read(path), tmp_path / "r.h5")
    shutil.copy(tmp_path / FILE, tmp_path / "copy.csv")
    turn_over(path)
    case = read(path, **{"surface.1": {"file": "copy.csv"}})
    simulation = ehlpetsc.Simulation(case)
    with Recorder(simulation, tmp_path / "o.h5") as recorder:
        _, *notes = recorder.resume(restart)
    assert notes == ['surface.1.file was "profile.csv", is "copy.csv"']
    case = read(path)
    assert list(case.digests) == ["surface.1.file"] and len(case.digests["surface.1.file"]) == 64
    turn_over(path)
    with pytest.raises(CaseError, match=r"a\.toml: surface\.1\.file: changed since the case was read"):
        ehlpetsc.Simulation(case)
    (path.parent / FILE).unlink()
    with pytest.raises(CaseError, match="changed since"):
        ehlpetsc.Simulation(case)


def test_complete_members_of_a_series_are_computed_again(path, tmp_path, capsys):
    varied = {"series": {"key": "fluid.viscosity", "values": [0.002, 0.003]}, "time.travel": 0.05}
    world = ehlpetsc.Simulation(read(path)).comm

    def run():
        status = Series(world, read(path, **varied), tmp_path / "r.h5", None).run()
        return status, capsys.readouterr().out.splitlines()[0]

    status, opening = run()
    assert status == 0 and " 2 of them to compute" in opening
    assert " 0 of them to compute" in run()[1]
    turn_over(path)
    status, opening = run()
    assert status == 0 and " 2 of them to compute" in opening
    for value, case in members(read(path, **varied)):
        assert is_done(tmp_path / f"r_viscosity_{value}.h5", case.text, case.digests)


def test_passes_are_not_continued_with_another_profile(path, tmp_path):
    keys = {"time.passes": 2, "contact.yield_pressure": 2e9, "time.travel": 0.05}
    comm, output = ehlpetsc.Simulation(read(path)).comm, tmp_path / "r.h5"
    assert Passes(comm, read(path, **keys), output).run() == ExitStatus.DONE
    (tmp_path / "r.pass2.h5").unlink()
    turn_over(path)
    with pytest.raises(OutputError, match=rf"r\.pass1\.restart\.h5: {CHANGED}"):
        Passes(comm, read(path, **keys), output).run()
    with pytest.raises(OutputError, match=rf"r\.pass1\.restart\.h5: {CHANGED}"):
        Passes(comm, read(path, **keys), output).run(tmp_path / "r.pass1.restart.h5")


def test_life_is_not_continued_with_another_profile(tmp_path):
    from support.made_results import save_life
    from test_life import body

    shutil.copy(CASES / "profiles" / "alicona_meander_profile.csv", tmp_path / FILE)
    text = COARSE_LIFE.read_text().replace('"../..', f'"{ROOT}')
    (tmp_path / "a.toml").write_text(text)
    path, keys = tmp_path / "a.life.h5", {"surface.2.file": str(tmp_path / FILE)}
    case = load(tmp_path / "a.toml", keys)
    life = LifeHistory(case.text, case.title, digests=case.digests)
    life.add({"passes": 10, "jump": 10}, (body(), body()), {})
    save_life(life, path)
    assert stored_or_new(load(tmp_path / "a.toml", keys), path, False).digests == case.digests
    turn_over(tmp_path / "a.toml")
    with pytest.raises(OutputError, match=r"a\.life\.h5: surface\.2\.file changed since it was written"):
        stored_or_new(load(tmp_path / "a.toml", keys), path, False)
    assert stored_or_new(load(tmp_path / "a.toml", keys), path, True).rows == []
