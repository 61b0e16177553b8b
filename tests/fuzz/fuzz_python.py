"""Calls from Python with arguments drawn from lists of good and bad ones, one to three of them in a row."""

import os

import numpy as np
from sandbox import process
from support import CASES

import ehlpetsc
from ehlpetsc.run.simulation import Simulation

RIDGE = {"mesh.points_per_half_width": 15, "time.travel": 0.3}
PASS = {
    "mesh.points_per_half_width": 15,
    "time.travel": 0.2,
    "time.passes": 1,
    "contact.yield_pressure": 0.95e9,
}
LIMIT = 120  # s
REFUSED = (ehlpetsc.CaseError, ehlpetsc.OutputError, ehlpetsc.UsageError, ehlpetsc.NotConverged)
NUMBERS = (
    None,
    0,
    1,
    -1,
    2,
    3,
    7,
    0.5,
    1e-7,
    -1e-7,
    1e300,
    np.nan,
    np.inf,
    np.float64(1e-7),
    np.int64(3),
    True,
)
NAMES = ("r.h5", "a/b.h5", "", "/", ".", "a\0b", "\udcff.h5", "x" * 300, "notes.txt", "other.h5", "r.toml")
SETTINGS = (
    {},
    {"contact.load": 4e5},
    {"contact.load": -1.0},
    {"contact.load": np.float64(3e5)},
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
    {"contact.model": "mixed"},
    ["contact.load=4e5"],
    ["contact.load"],
    "contact.load=4e5",
    {5: 1},
    [5],
    5,
)
OPTIONS = (
    None,
    {},
    {"snes_max_it": 2},
    {"snes_rtol": "x"},
    {"": 1},
    {5: 1},
    ["-x"],
    {"ksp_type": "nosuch"},
    {"a\0": 1},
)
WINDOWS = (None, (-1, 1), (1, -1), (1,), "ab", 5, (np.nan, 1), (5, 6), (-1e300, 1e300), [0.0, 0.5])


def pick(rng, values):
    return values[int(rng.integers(len(values)))]


def a_case(rng):
    """A good case more often than not."""
    return ehlpetsc.load(
        CASES / "ridge.toml", RIDGE | (pick(rng, SETTINGS[:4]) if rng.random() < 0.8 else {})
    )


def load_one(rng):
    ehlpetsc.load(CASES / "ridge.toml", pick(rng, SETTINGS))


def solve_one(rng):
    output = pick(rng, NAMES) if rng.random() < 0.5 else None
    restart = pick(rng, NAMES) if rng.random() < 0.2 else None
    ehlpetsc.solve(a_case(rng), output, pick(rng, OPTIONS), restart=restart, progress=False)


def step_by_hand(rng):
    simulation = Simulation(a_case(rng), options=pick(rng, OPTIONS))
    before = 0.0
    for _ in range(int(rng.integers(1, 4))):
        state = simulation.advance(pick(rng, NUMBERS) if rng.random() < 0.5 else None)
        assert state.time >= before and np.isfinite(state.pressure).all()
        before = state.time


def pass_after_pass(rng):
    case = ehlpetsc.load(CASES / "running_in.toml", PASS)
    first = Simulation(case)
    for _ in range(pick(rng, (0, 1, 3, 100))):
        if first.finished:
            break
        first.advance()
    changed = pick(
        rng, ({}, {"mesh.points_per_half_width": 20}, {"contact.load": 4e5}, {"fluid.viscosity": 0.003})
    )
    number = pick(rng, NUMBERS) if rng.random() < 0.3 else None
    after = pick(rng, (first, first, first, None, "pass1.h5"))
    second = Simulation(
        ehlpetsc.load(CASES / "running_in.toml", PASS | changed), after=after, pass_number=number
    )
    state = second.advance()
    assert after is None or state.set_volume >= first.state.set_volume * (1 - 1e-9)


def read_one(rng):
    result = ehlpetsc.solve(a_case(rng))
    call = int(rng.integers(6))
    if call == 0:
        import matplotlib

        matplotlib.use("Agg")
        result.plot(step=pick(rng, (None, None, 0, 3, 999, -1)), window=pick(rng, WINDOWS))
    elif call == 1:
        result.nearest_frame(
            **pick(rng, ({}, {"step": 3}, {"time": 1e-6}, {"time": np.nan}, {"step": 1, "time": 1}))
        )
    elif call == 2:
        result.steps(pick(rng, ("h_min", "nosuch", "")))
    elif call == 3:
        result[pick(rng, ("pressure", "nosuch", "steps", "/", ""))]
    elif call == 4:
        result.to_xarray()
    else:
        ehlpetsc.read_result(pick(rng, (*NAMES, "cases", None, 5)))


def members_of(rng):
    for _, member in ehlpetsc.members(ehlpetsc.load(CASES / "ridge.toml", RIDGE | pick(rng, SETTINGS[:15]))):
        assert member.series is None and member.text


CALLS = (load_one, solve_one, step_by_hand, pass_after_pass, read_one, members_of)
FOREIGN = {"notes.txt": b"mine", "other.h5": b"\x89HDF\r\n\x1a\nmine", "r.toml": b"title = 'mine'"}


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
        if any((self.folder / name).read_bytes() != content for name, content in FOREIGN.items()):
            return "changed", what
        if list(self.folder.glob(".*.tmp*")) or list(self.folder.glob("*.lock")):
            return "changed", what
        words = {0: "done", 2: "refused", None: "hang"}
        return words.get(status, "signal" if status is not None and status < 0 else "traceback"), what

    def keep(self, place):
        """The number of the draw makes it again."""

    def _call(self, calls, rng):
        os.chdir(self.folder)
        refused = False
        for call in calls:
            try:
                call(rng)
            except REFUSED as error:
                assert str(error).strip()
                print(ascii(f"{type(error).__name__}: {error}"))
                refused = True
        return 2 if refused else 0
