"""The command life, given keys good and bad, lives to continue that are damaged, and files of others."""

import os

from hdf5_damage import Flips, Strange
from sandbox import beside_others, process
from support import CASES

from ehlpetsc.life.command import main

LIMIT = 120  # s
USUAL, COARSE = "points_per_half_width = 16", "points_per_half_width = 8"
ONCE = ["--set", "life.max_solved=1"]  # passes solved by a command at most
STORED = ("a.life.h5", "a.life.pass.h5")
FOREIGN = {"foreign.h5": b"a", "foreign.png": b"mine", "b.life.png": b"mine", "c.life.pass.h5": b"a"}
SETS = (
    *("life.passes=1", "life.passes=0", "life.passes=1e300", "life.wear_jump=1e-9", "life.wear_jump=nan"),
    *("life.damage_jump=1", "life.pits=false", "life.pits=3", "life.x=1", "life={}", "output.every=2"),
    *("wear.coefficient=0", "wear.coefficient=1e-9", "wear.coefficient=-1", "time.travel=0.5", "x", ""),
    *(
        "contact.load=1e300",
        "motion.slide_roll_ratio=0",
        "post.depths=[0.0]",
        "surface={}",
        "contact.model='direct'",
    ),
)
WORDS = (
    *(
        ["--no-picture"],
        ["--overwrite"],
        ["-o", "b.life.h5"],
        ["-o", "c.life.h5"],
        ["-o", "foreign.h5"],
        ["-o", ""],
    ),
    *(["-o", "none/x.life.h5"], ["-o", "case.toml"], ["-o", "x.txt"], ["-o", "."], ["-h"], ["--x"]),
)


class Draw:
    """One command line after the other."""

    def __init__(self, folder):
        self.folder, self.case = folder, (CASES / "life.toml").read_text()
        assert USUAL in self.case
        self.case = self.case.replace(USUAL, COARSE).replace('"profiles/', f'"{CASES}/profiles/')
        (folder / "case.toml").write_text(self.case)

        def begin():
            os.chdir(folder)
            return main(["case.toml", *ONCE, "-o", STORED[0], "--no-picture"])

        status, report = process(begin, folder / "report", LIMIT)
        assert status == 0, report
        self.content = {name: (folder / name).read_bytes() for name in STORED}
        self.spoil = {name: [kind(folder / name) for kind in (Flips, Strange)] for name in STORED}

    def __call__(self, rng):
        """Outcome and what was done."""
        inputs, damage = FOREIGN | self.content | {"case.toml": self.case.encode()}, []
        for name, kinds in self.spoil.items():
            if rng.random() < 0.4:
                spoil = kinds[int(rng.integers(2))]
                damage.append(f"{name}: {spoil(rng, int(rng.integers(10**6)), self.folder / name)}")
                inputs[name] = (self.folder / name).read_bytes()
        words = ["a.life.h5"] if rng.random() < 0.4 else ["case.toml", *ONCE]
        if rng.random() < 0.5:
            words += ["-o", "a.life.h5"]
        for _ in range(int(rng.integers(3))):
            words += WORDS[int(rng.integers(len(WORDS)))]
        if rng.random() < 0.5:
            words += ["--set", SETS[int(rng.integers(len(SETS)))]]
        word, ended = beside_others(self.folder, inputs, lambda: main(words), LIMIT, may_change=STORED)
        return word, f"{damage} life {words}: {ended}"

    def keep(self, place):
        """Copy the files of the last draw."""
        place.mkdir()
        for path in self.folder.iterdir():
            (place / path.name).write_bytes(path.read_bytes())
