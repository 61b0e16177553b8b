"""Surface files that change between the parts of a run: refused, or computed again."""

import shutil

import numpy as np
import pytest
from support import CASES, COARSE_LIFE, ROOT

import ehlpetsc
from ehlpetsc.base.errors import CaseError, ExitStatus, OutputError
from ehlpetsc.case.loading import load, members
from ehlpetsc.life.history import LifeHistory, stored_or_new
from ehlpetsc.results.reader import is_done
from ehlpetsc.run.passes import Passes
from ehlpetsc.run.recorder import Recorder
from ehlpetsc.run.series import Series

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
    with simulation.options, Recorder(simulation, output) as recorder:
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


def test_restart_reports_the_name_of_another_file(path, tmp_path):
    restart = stopped(read(path), tmp_path / "r.h5")
    shutil.copy(tmp_path / FILE, tmp_path / "copy.csv")
    turn_over(path)
    case = read(path, **{"surface.1": {"file": "copy.csv"}})
    simulation = ehlpetsc.Simulation(case)
    with simulation.options, Recorder(simulation, tmp_path / "o.h5") as recorder:
        _, *notes = recorder.resume(restart)
    assert notes == ["surface.1.file was profile.csv, is copy.csv"]


def test_simulation_refuses_a_file_that_changed_since_the_case_was_read(path):
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
