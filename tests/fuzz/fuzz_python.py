"""The door of Python: calls with arguments drawn from lists of good and bad ones, one to three in a row."""

import os

import numpy as np
from sandbox import process
from support import CASES

import ehlpetsc
from ehlpetsc.run.simulation import Simulation

RIDGE = {"mesh.points_per_half_width": 15, "time.travel": 0.3}
PASS = RIDGE | {"time.travel": 0.2, "time.passes": 1, "contact.yield_pressure": 0.95e9}
LIMIT = 120  # s
REFUSED = (ehlpetsc.CaseError, ehlpetsc.OutputError, ehlpetsc.UsageError, ehlpetsc.NotConverged)
STEPS = (None, 0.0, 1e-7, -1e-7, 1e300, np.nan, np.inf, np.float64(1e-7))
NAMES = ("r.h5", "a/b.h5", "/", ".", "x" * 300, "notes.txt", "other.h5", "r.toml")
SETTINGS = (
    {},
    {"contact.load": 4e5},
    {"contact.load": np.float64(3e5)},
    {"contact.model": "mixed"},
    {"contact.load": -1.0},
    {"contact.load": "4e5"},
    {"nosuch.key": 1},
    {"title": "\udcff"},
    {"surface.1": {"x": np.arange(8) * 1e-5, "z": 1e-8 * np.arange(8) ** 2}},
    {"surface.1": {"x": np.arange(8), "z": np.zeros(7)}},
    {"time": None},
    {"fluid": None},
    {"series": {"key": "contact.load", "values": [3e5, 4e5]}},
    {"series": {"key": "contact.load", "values": []}},
    {"mesh.points_per_half_width": 8.5},
    ["contact.load=4e5"],
    ["contact.load"],
)
OPTIONS = (None, {}, {"snes_max_it": 2}, {"snes_rtol": "x"}, {"ksp_type": "nosuch"}, {"snes_view": "5"})
FOREIGN = {"notes.txt": b"mine", "other.h5": b"\x89HDF\r\n\x1a\nmine", "r.toml": b"title = 'mine'"}


def pick(rng, values):
    return values[int(rng.integers(len(values)))]


def a_case(rng):
    """A good case, more often than not."""
    changes = pick(rng, SETTINGS[:4] if rng.random() < 0.8 else SETTINGS[:15])
    return ehlpetsc.load(CASES / "ridge.toml", RIDGE | changes)


def load_one(rng):
    ehlpetsc.load(CASES / "ridge.toml", pick(rng, SETTINGS))


def solve_one(rng):
    output, restart = (pick(rng, NAMES) if rng.random() < share else None for share in (0.5, 0.2))
    ehlpetsc.solve(a_case(rng), output, pick(rng, OPTIONS), restart=restart, progress=False)


def step_by_hand(rng):
    simulation, before = Simulation(a_case(rng), options=pick(rng, OPTIONS)), 0.0
    for _ in range(int(rng.integers(1, 4))):
        state = simulation.advance(pick(rng, STEPS) if rng.random() < 0.5 else None)
        assert state.time >= before and np.isfinite(state.pressure).all()
        before = state.time


def pass_after_pass(rng):
    first = Simulation(ehlpetsc.load(CASES / "running_in.toml", PASS))
    for _ in range(pick(rng, (0, 1, 3, 100))):
        if not first.finished:
            first.advance()
    changed = pick(rng, ({}, {"mesh.points_per_half_width": 20}, {"contact.load": 4e5}))
    case, number = ehlpetsc.load(CASES / "running_in.toml", PASS | changed), pick(rng, (None, None, -1, 2, 7))
    state = Simulation(case, after=first, pass_number=number).advance()
    assert state.set_volume >= first.state.set_volume * (1 - 1e-9)


def members_of(rng):
    for _, member in ehlpetsc.members(ehlpetsc.load(CASES / "ridge.toml", RIDGE | pick(rng, SETTINGS[:15]))):
        assert member.series is None and member.text


CALLS = (load_one, solve_one, step_by_hand, pass_after_pass, members_of)


class Draw:
    """One row of calls after the other."""

    def __init__(self, folder):
        self.folder = folder

    def __call__(self, rng):
        """Outcome and what was done."""
        for left in self.folder.iterdir():
            left.unlink()
        for name, content in FOREIGN.items():
            (self.folder / name).write_bytes(content)
        calls = [pick(rng, CALLS) for _ in range(int(rng.integers(1, 4)))]
        status, report = process(lambda: self._call(calls, rng), self.folder / "report", LIMIT)
        what = f"{[call.__name__ for call in calls]}: {status} {report[-1500:]}"
        changed = any((self.folder / name).read_bytes() != content for name, content in FOREIGN.items())
        if changed or list(self.folder.glob(".*.tmp*")) or list(self.folder.glob("*.lock")):
            return "changed", what
        words = {0: "done", 2: "refused", None: "hang"}
        return words.get(status, "signal" if status is not None and status < 0 else "traceback"), what

    def keep(self, place):
        """The number of the draw makes it again."""

    def _call(self, calls, rng):
        os.chdir(self.folder)
        refused = 0
        for call in calls:
            try:
                call(rng)
            except REFUSED as error:
                assert str(error).strip()
                print(ascii(f"{type(error).__name__}: {error}"))
                refused = 2
        return refused
