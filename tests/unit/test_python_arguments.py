"""Arguments that Python callers may get wrong are refused by name before anything is computed; threads."""

from concurrent.futures import ThreadPoolExecutor

import pytest
from support import CASES

import ehlpetsc
from ehlpetsc import Simulation, UsageError

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


def test_a_time_step_is_a_number_within_the_time_left():
    case = ehlpetsc.load(CASES / "ridge.toml", COARSE)
    with pytest.raises(UsageError, match="^dt = 1e-07: .*steady start"):
        Simulation(case).advance(1e-7)
    simulation = Simulation(case)
    before = simulation.advance().solution
    for dt in (-1e-7, 0.0, float("nan"), float("inf"), 1.0):
        with pytest.raises(UsageError, match=r"^dt = .*: .* 1\.49e-15 to .* 5\.96767e-06 s "):
            simulation.advance(dt)
    assert simulation.solution is before
    assert simulation.advance(1e-6).time == pytest.approx(1e-6)
    list(simulation)
    with pytest.raises(UsageError, match="^advance: "):
        simulation.advance()


def test_pass_follows_a_complete_pass_of_the_same_contact():
    first = Simulation(running_in())
    for _ in range(2):  # before its start, and in its middle
        with pytest.raises(UsageError, match="^after: .* at its end"):
            Simulation(running_in(), after=first)
        first.advance()
    list(first)
    for changes in (
        {"mesh.points_per_half_width": 30},
        {"contact.load": 400e3},
        {"contact.model": "direct", **DIRECT},
    ):
        with pytest.raises(UsageError, match="^after: .*same nodes.*contact law"):
            Simulation(running_in(**changes), after=first)
    assert Simulation(running_in(**{"fluid.viscosity": 0.003}), after=first).pass_number == 2
