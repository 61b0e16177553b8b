"""The package from Python: cases, results in memory, options given back, refused arguments, threads."""

import doctest
import importlib
import re
import signal
import tomllib
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from support import CASES, ROOT
from support.running import PYTHON, called

import ehlpetsc
from ehlpetsc import Simulation, UsageError
from ehlpetsc.base.errors import OutputError

QUICK = {"mesh.inlet": -1.5, "mesh.outlet": 1.3, "mesh.points_per_half_width": 40}
QUICK |= {"time.travel": 0.05, "time.courant": 0.445}


@pytest.fixture(scope="module")
def case():
    return ehlpetsc.load(CASES / "table1_rough.toml", QUICK)


@pytest.fixture(scope="module")
def result(case):
    return ehlpetsc.solve(case)


def table():
    from petsc4py import PETSc

    return PETSc.Options().getAll()


def test_case_from_a_dict_equals_the_file_and_profiles_may_be_arrays():
    path = CASES / "table1_smooth.toml"
    data = tomllib.loads(path.read_text())
    one = ehlpetsc.load(data, {"fluid.viscosity": np.float64(0.003)})
    assert one == ehlpetsc.load(path, ["fluid.viscosity=0.003"])
    assert ehlpetsc.load(tomllib.loads(one.text)) == one  # the text of the result runs the same case
    assert ehlpetsc.load(CASES / "table1_rough.toml", {"time": None, "surface": None}).time is None
    x = np.linspace(0.0, 1e-3, 501)
    z = 1e-7 * np.cos(x / 20e-6)
    in_metres = {"x": x, "z": z}
    in_um = {"z": 1e6 * z, "spacing": x[1], "unit": "um"}
    for given in (in_metres, in_um):
        case = ehlpetsc.load(CASES / "table1_rough.toml", {"surface.1": given, "surface.2": None})
        profile = ehlpetsc.Simulation(case).roughness.surface_1
        assert profile.statistics["ra"] == pytest.approx(np.abs(z - z.mean()).mean(), rel=1e-9)


@pytest.mark.parametrize(
    "surface, fault",
    [
        ({"z": [0.0] * 5}, " z .*x or spacing"),
        ({"z": [0.0] * 5, "x": [0.0, 1.0, 2.0, 3.0]}, "x has 4 values, z 5"),
        ({"z": [0.0] * 5, "spacing": 1e-6, "columns": [1]}, "columns: "),
        ({"z": [0.0, 1e-7, np.nan, 0.0], "spacing": 1e-6}, r"surface\.1\.z = \[0\.0, 1e-07, NaN, 0\.0\]: "),
        ({"x": [0.0, 2e-6, 1e-6, 3e-6], "z": [0.0] * 4}, "x = 1e-06 follows x = 2e-06"),
    ],
)
def test_invalid_profile_arrays_are_refused(surface, fault):
    with pytest.raises(ehlpetsc.CaseError) as caught:
        ehlpetsc.load(CASES / "table1_rough.toml", {"surface.1": surface})
    assert re.search(fault, str(caught.value))


def test_result_in_memory_has_fields_scalars_and_attributes_as_that_on_disk(case, result, tmp_path):
    assert result.pressure.shape == result.film_thickness.shape == (len(result.time), len(result.x))
    assert len(result.time) == len(result.steps.h_min) == 5
    assert result.steps.h_min[-1] == result.film_thickness[-1].min()
    assert result.attrs["status"] == "done" and result.attrs["case"] == case.text
    assert "film_thickness" in dir(result) and "p_max" in dir(result.steps)
    with pytest.raises(AttributeError, match="^presure: "):
        result.presure  # noqa: B018
    assert not list(tmp_path.iterdir())
    stored = ehlpetsc.solve(case, output=tmp_path / "run.h5")
    assert [p.name for p in tmp_path.iterdir()] == ["run.h5"]
    np.testing.assert_array_equal(stored.pressure, result.pressure)
    again = ehlpetsc.read_result(tmp_path / "run.h5")
    np.testing.assert_array_equal(again.steps.p_max, result.steps.p_max)


def test_iteration_over_states_can_be_resumed_and_interleaved(case, result):
    simulation = ehlpetsc.Simulation(case)
    for state in simulation:
        if state.step == 2:
            break
    assert state.time == result.time[2] and not simulation.finished
    np.testing.assert_array_equal(state.pressure, result.pressure[2])
    rest = list(simulation)
    assert [state.step for state in rest] == [3, 4] and simulation.finished
    np.testing.assert_array_equal(rest[-1].film_thickness, result.film_thickness[-1])
    assert rest[-1].scalars["h_min"] == rest[-1].h_min == result.steps.h_min[-1]
    thick = ehlpetsc.load(CASES / "table1_rough.toml", QUICK | {"fluid.viscosity": 0.01})
    alone = [state.h_min for state in ehlpetsc.Simulation(thick)]
    pairs = list(zip(ehlpetsc.Simulation(case), ehlpetsc.Simulation(thick), strict=True))
    np.testing.assert_array_equal([one.h_min for one, _ in pairs], result.steps.h_min)
    np.testing.assert_array_equal([other.h_min for _, other in pairs], alone)


def test_petsc_options_are_restored(case, capfd):
    from petsc4py import PETSc

    options = PETSc.Options()
    options["snes_rtol"] = "1e-30"
    before = table()
    try:
        ehlpetsc.solve(case, options={"snes_rtol": 1e-20, "snes_converged_reason": None})
        assert table() == before
    finally:
        options.delValue("snes_rtol")
    out = capfd.readouterr().out
    assert len(re.findall(r"Nonlinear ehl\d+_ solve converged", out)) == 5
    assert "step 4 from" in out


def test_divergence_raises_with_the_last_good_state(case, result, tmp_path, monkeypatch):
    from ehlpetsc.base.errors import SolveFailed

    def fail(*_, **__):
        raise SolveFailed("SNES", "MADE_UP", 1)

    simulation = ehlpetsc.Simulation(case)
    simulation.advance()
    monkeypatch.setattr(simulation.stepper.solver, "solve", fail)
    before = table()
    with pytest.raises(ehlpetsc.NotConverged, match="^step 1, .*MADE_UP after 1 .*time.courant") as caught:
        simulation.advance()
    assert caught.value.state.step == 0 and table() == before
    np.testing.assert_array_equal(caught.value.state.pressure, result.pressure[0])
    with pytest.raises(ehlpetsc.NotConverged, match="^steady start: .*DIVERGED_MAX_IT after 1 ") as caught:
        ehlpetsc.solve(case, tmp_path / "r.h5", options={"snes_max_it": 1, "snes_atol": 1e-30})
    assert caught.value.state is None and not list(tmp_path.iterdir())


def test_series_is_solved_member_by_member_and_post_is_an_attribute():
    case = ehlpetsc.load(CASES / "fig4.toml")
    with pytest.raises(ehlpetsc.CaseError, match=r"fig4\.toml: .*\[series\]: .*ehlpetsc\.members\(case\)"):
        ehlpetsc.solve(case)
    assert [value for value, _ in ehlpetsc.members(case)][0] == 0.01
    assert ehlpetsc.post.weibull_fit.__module__.startswith("ehlpetsc.post.") and "post" in dir(ehlpetsc)


def test_interrupted_call_continues(case, result, tmp_path, monkeypatch):
    advance, before = ehlpetsc.Simulation.advance, signal.getsignal(signal.SIGINT)

    def interrupted(self, **given):
        if self.dimensionless and self.dimensionless.step == 2:
            signal.raise_signal(signal.SIGINT)
        return advance(self, **given)

    with monkeypatch.context() as patch, pytest.raises(KeyboardInterrupt, match="step 3; .*r.restart.h5"):
        patch.setattr(ehlpetsc.Simulation, "advance", interrupted)
        ehlpetsc.solve(case, output=tmp_path / "r.h5")
    assert signal.getsignal(signal.SIGINT) is before
    begun = ehlpetsc.read_result(tmp_path / "r.h5")
    assert begun.attrs["status"] == "stopped" and list(begun.step) == [0, 1, 2, 3]
    begun.close()
    whole = ehlpetsc.solve(case, output=tmp_path / "r.h5")
    assert list(whole.step) == list(result.step)
    np.testing.assert_allclose(whole.pressure, result.pressure, rtol=0.0, atol=1e-9 * result.attrs["p0"])


def test_picture_is_written_to_a_file_of_its_name(result, tmp_path):
    for name, begin in (("film.png", b"\x89PNG"), ("film.pdf", b"%PDF")):
        result.plot(tmp_path / name, step=1)
        assert (tmp_path / name).read_bytes().startswith(begin)
    with pytest.raises(OutputError, match=r"film\.txt: allowed for plot: a name that ends in \.png"):
        result.plot(str(tmp_path / "film.txt"))
    with pytest.raises(OutputError, match=r"none/film\.png: not written, No such file"):
        result.plot(tmp_path / "none" / "film.png")
    with pytest.raises(UsageError, match="path = 3: allowed: the name of a picture; a step is step=3"):
        result.plot(3)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["film.pdf", "film.png"]


LIGHT = """
import sys, ehlpetsc
assert not {"numpy", "petsc4py", "mpi4py", "h5py"} & sys.modules.keys(), "import"
ehlpetsc.read_result
assert not {"petsc4py", "mpi4py", "matplotlib", "numba"} & sys.modules.keys(), "read_result"
ehlpetsc.Simulation
assert "petsc4py" in sys.modules and "matplotlib" not in sys.modules
"""


def test_import_is_light_and_finds_petsc(tmp_path):
    done = called([PYTHON, "-c", LIGHT], tmp_path, {"PYTHONPATH": str(ROOT)})
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    "module", ["ehlpetsc.api", "ehlpetsc.case.loading", "ehlpetsc.run.simulation", "ehlpetsc.results.reader"]
)
def test_docstring_examples_run(module, monkeypatch):
    monkeypatch.chdir(ROOT)
    failed, tried = doctest.testmod(importlib.import_module(module))
    assert tried >= 3 and failed == 0


@pytest.mark.slow
def test_examples_of_the_python_page_run(monkeypatch, capsys):
    monkeypatch.chdir(ROOT)
    page = (ROOT / "ehlpetsc" / "run" / "README.md").read_text(encoding="utf-8")
    code, printed = re.search(r"```python\n(.*?)```\n\nprints\n\n```\n(.*?)```", page, re.DOTALL).groups()
    exec(compile(code, "README.md", "exec"), {})
    assert capsys.readouterr().out == printed


COARSE = {"mesh.points_per_half_width": 20, "time.travel": 0.1}
PASS = COARSE | {"time.passes": 1, "contact.yield_pressure": 0.95e9}
DIRECT = dict.fromkeys(("contact.yield_pressure", "contact.asperity_height", "contact.asperity_stiffness"))


def running_in(**changes):
    return ehlpetsc.load(CASES / "running_in.toml", PASS | changes)


def test_threads_may_solve_in_memory_at_once():
    def solved(load):
        return ehlpetsc.solve(ehlpetsc.load(CASES / "dry_hertz.toml", {"contact.load": load}))

    with ThreadPoolExecutor(4) as threads:
        found = list(threads.map(solved, (200e3, 300e3, 400e3, 500e3)))
    for one in found:
        assert one.pressure.max() == pytest.approx(one.attrs["p0"], rel=2e-4)
    assert len({round(one.attrs["p0"]) for one in found}) == 4


def test_a_time_step_is_within_the_time_left_and_a_pass_follows_a_complete_one():
    case = ehlpetsc.load(CASES / "ridge.toml", COARSE)
    with pytest.raises(UsageError, match="^dt = 1e-07: .*steady start"):
        Simulation(case).advance(1e-7)
    simulation = Simulation(case)
    before = simulation.advance().dimensionless
    for dt in (-1e-7, 0.0, float("nan"), float("inf"), 1.0):
        with pytest.raises(UsageError, match=r"^dt = .*: .* 3\.36e-15 to .* 5\.96767e-06 s "):
            simulation.advance(dt)
    assert simulation.dimensionless is before
    assert simulation.advance(1e-6).time == pytest.approx(1e-6)
    list(simulation)
    with pytest.raises(UsageError, match="^advance: "):
        simulation.advance()
    first = Simulation(running_in())
    for _ in range(2):  # before its start, and in its middle
        with pytest.raises(UsageError, match="^after: .* at its end"):
            Simulation(running_in(), after=first)
        first.advance()
    list(first)
    direct = {"contact.model": "direct", **DIRECT}
    for changes in ({"mesh.points_per_half_width": 30}, {"contact.load": 400e3}, direct):
        with pytest.raises(UsageError, match="^after: .*same nodes.*contact law"):
            Simulation(running_in(**changes), after=first)
    assert Simulation(running_in(**{"fluid.viscosity": 0.003}), after=first).pass_number == 2


@pytest.mark.parametrize("case", [5, True, None, 1.5])
def test_a_number_is_no_case(case):
    """As a path it would be a file descriptor, which reading closes."""
    with pytest.raises(ehlpetsc.CaseError, match=f"^{case!r}: not a case; allowed: the path of a case file"):
        ehlpetsc.load(case)


@pytest.mark.parametrize(
    "given, words",
    [(ehlpetsc.load(CASES / "moes.toml"), "a Case, which is loaded already; for other values load its file")]
    + [([1.0] * 500, r"\[1.0, 1.0, .*\.\.\.: not a case"), ({1, 2}, r"\{1, 2\}: not a case")],
)
def test_other_objects_than_a_path_or_tables_are_refused_in_a_short_line(given, words):
    with pytest.raises(ehlpetsc.CaseError, match=f"^{words}.*; allowed: the path") as refusal:
        ehlpetsc.load(given, {"fluid.viscosity": 0.1})
    assert len(str(refusal.value)) < 200


@pytest.mark.parametrize("output", ["", ".", "/"])
def test_output_without_a_name_is_refused(output):
    with pytest.raises(ehlpetsc.OutputError, match="a folder, not a file .*give the name of a file"):
        ehlpetsc.solve(CASES / "dry_hertz.toml", output=output)
