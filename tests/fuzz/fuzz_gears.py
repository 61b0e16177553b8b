"""The command gears, given case files with mutations and the result of a gear pair."""

import random

import h5py
import numpy as np
from sandbox import beside_others
from support import CASES
from support.made_results import make_result, with_solids
from test_case_fuzz import corrupted

from ehlpetsc.gears.command import main

LIMIT = 120  # s
FOREIGN = {"foreign.csv": b"0,1\n", "foreign.png": b"mine", "foreign.toml": b"title = 'a'"}
WORDS = (
    *(
        ["--no-picture"],
        ["--csv", "path.csv"],
        ["--csv", "path.txt"],
        ["--csv", "foreign.csv"],
        ["--csv", ""],
    ),
    *(["--csv", "pair.toml"], ["--csv", "none/path.csv"], ["-o", "p.svg"], ["-o", "p.xyz"], ["-o", ""]),
    *(["-o", "foreign.png"], ["-o", "run.h5"], ["-o", "pair.toml"], ["-o", "\udcff.png"], ["-h"], ["--x"]),
)
KEYS = (
    "module",
    "teeth",
    "pressure_angle",
    "centre_distance",
    "tip_diameter",
    "face_width",
    "torque",
    "speed",
)
VALUES = ("0", "-1", "nan", "1e300", "1e-300", "[16, 24]", "[1, 1]", "[1000, 2]", "[0.08, 0.12]", "'x'", "1")


class Draw:
    """One command line after the other."""

    def __init__(self, folder):
        self.folder, self.case = folder, (CASES / "fzg.toml").read_text()
        run, post = with_solids(make_result(folder / "run.h5", nodes=81, steps=9)), folder / "run.post.h5"
        with h5py.File(run, "r+", libver="latest") as file:
            file.attrs["case"] = self.case
            file["steps/speed_1"] = np.linspace(1.0, 4.0, 9)
        with h5py.File(post, "w") as file:
            file.attrs["a"] = 0.25e-3
            file["damage/s"], file["damage/z_over_a"] = np.linspace(-8e-3, 0.0, 21), [0.0, 0.1]
            for side in "12":
                file[f"damage/{side}"] = np.full((2, 21), 1e-3)
        self.content = {path.name: path.read_bytes() for path in (run, post)}

    def __call__(self, rng):
        """Outcome and what was done."""
        inputs = FOREIGN | self.content
        inputs["pair.toml"] = self._case(rng).encode("utf-8", "surrogateescape")
        words = [("pair.toml", "run.h5")[int(rng.integers(2))]]
        for _ in range(int(rng.integers(3))):
            words += WORDS[int(rng.integers(len(WORDS)))]
        word, ended = beside_others(self.folder, inputs, lambda: main(words), LIMIT)
        return word, f"gears {words}: {ended}"

    def _case(self, rng):
        """The case as it is, with another value of a key of its pair, or with mutations."""
        draw = random.Random(int(rng.integers(2**62)))
        if rng.random() < 0.5:
            return corrupted(self.case, draw)
        lines = self.case.splitlines()
        key = draw.choice(KEYS)
        return "\n".join(
            f"{key} = {draw.choice(VALUES)}" if line.startswith(f"{key} =") else line for line in lines
        )

    def keep(self, place):
        """Copy the files of the last draw."""
        place.mkdir()
        for path in self.folder.iterdir():
            (place / path.name).write_bytes(path.read_bytes())
