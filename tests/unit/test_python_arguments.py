"""Arguments that Python callers may get wrong: refused by name before anything is computed."""

import threading

import matplotlib
import pytest

import ehlpetsc
from ehlpetsc import Simulation, UsageError

matplotlib.use("Agg")
RIDGE = {"mesh.points_per_half_width": 20, "time.travel": 0.1}
PASS = {
    "mesh.points_per_half_width": 20,
    "time.travel": 0.1,
    "time.passes": 1,
    "contact.yield_pressure": 0.95e9,
}


@pytest.fixture(autouse=True)
def at_the_root(monkeypatch, request):
    monkeypatch.chdir(request.config.rootpath)


@pytest.fixture(scope="module")
def case(request):
    return ehlpetsc.load(request.config.rootpath / "cases" / "ridge.toml", RIDGE)


def running_in(**changes):
    return ehlpetsc.load(
        "cases/running_in.toml", PASS | {k.replace("__", "."): v for k, v in changes.items()}
    )


@pytest.fixture(scope="module")
def first(request):
    simulation = Simulation(ehlpetsc.load(request.config.rootpath / "cases" / "running_in.toml", PASS))
    list(simulation)
    return simulation


def test_threads_may_solve_in_memory_at_once():
    found = []

    def work(load):
        found.append(ehlpetsc.solve(ehlpetsc.load("cases/dry_hertz.toml", load)))

    loads = [{"contact.load": load} for load in (200e3, 300e3, 400e3, 500e3)]
    threads = [threading.Thread(target=work, args=(load,)) for load in loads]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 4
    for one in found:
        assert one.pressure.max() == pytest.approx(one.attrs["p0"], rel=2e-4)
    assert len({round(one.attrs["p0"]) for one in found}) == 4


@pytest.mark.parametrize("dt", [-1e-7, 0.0, float("nan"), float("inf"), 1.0])
def test_a_time_step_is_a_number_within_the_time_left(case, dt):
    simulation = Simulation(case)
    simulation.advance()
    before = simulation.solution
    with pytest.raises(UsageError, match=r"^dt = .*: .* 1\.49e-15 to .* 5\.96767e-06 s "):
        simulation.advance(dt)
    assert simulation.solution is before
    assert simulation.advance(1e-6).time == pytest.approx(1e-6)


def test_no_step_after_the_end(case):
    simulation = Simulation(case)
    list(simulation)
    with pytest.raises(UsageError, match="^advance: "):
        simulation.advance()
    with pytest.raises(UsageError, match="^dt = 1e-07: .*steady start"):
        Simulation(case).advance(1e-7)


@pytest.mark.parametrize(
    "changes, message",
    [
        ({"mesh__points_per_half_width": 30}, r"^after: .*nodes.* \[mesh\] "),
        ({"contact__load": 400e3}, r"^after: .*nodes.* \[mesh\] "),
        (
            {"contact__model": "direct", "contact__yield_pressure": None}
            | {f"contact__asperity_{key}": None for key in ("height", "stiffness")},
            "^after: contact.law .*direct, .* compliant$",
        ),
    ],
)
def test_pass_follows_a_pass_of_the_same_contact(first, changes, message):
    with pytest.raises(UsageError, match=message):
        Simulation(running_in(**changes), after=first)
    assert Simulation(running_in(fluid__viscosity=0.003), after=first).pass_number == 2


def test_pass_follows_a_complete_pass(first):
    half = Simulation(running_in())
    with pytest.raises(UsageError, match="^after: .* end; .*states"):
        Simulation(running_in(), after=half)
    half.advance()
    with pytest.raises(UsageError, match="^after: .* end; .*states"):
        Simulation(running_in(), after=half)
