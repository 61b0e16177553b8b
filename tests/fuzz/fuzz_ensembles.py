"""Commands that read several results, with damaged ones among them."""

import os
from pathlib import Path

from hdf5_damage import Flips, Structures
from sandbox import process, word_of
from support.made_results import make_result, with_solids

from ehlpetsc.analysis import compare, ensemble
from ehlpetsc.pictures import command as plot

LIMIT = 120  # s
SPEEDS = (10.0, 5.0, 1.0)
OUTPUTS = (
    *(
        "t.csv",
        "t.json",
        "p.png",
        "p.svg",
        "p.html",
        "p.gif",
        "t.txt",
        "",
        "none/t.csv",
        "foreign.csv",
        "foreign.png",
    ),
    *("r0.h5", "case.toml", "foreign.restart.h5", "x.series.json", "\udcff.csv"),
)
FOREIGN = {
    "foreign.csv": b"0,1\n1,2\n",
    "foreign.png": b"mine",
    "case.toml": b"title = 'a'",
    "foreign.restart.h5": b"a",
}
WORDS = {
    ensemble: (
        ["--resamples", "0"],
        ["--resamples", "50"],
        ["--seed", "-1"],
        ["--seed", "3"],
        ["--resamples", "x"],
    ),
    compare: (["--rtol", "0"], ["--rtol", "-1"], ["--atol", "nan"], ["--rtol", "1e300"]),
    plot: (
        *(
            ["--stribeck"],
            ["--ensemble"],
        ),
        *(
            ["--map"],
            ["--report"],
            ["--step", "3"],
            ["--time", "nan"],
            ["--around", "0.2"],
            ["--around", "nan"],
        ),
        *(["--width", "0"], ["--running-in"]),
    ),
}


class Draw:
    """One command line after the other."""

    def __init__(self, folder):
        self.folder = folder
        self.sound = [
            with_solids(make_result(folder / f"s{k}.h5", nodes=81, steps=9, speed=speed, rough=k != 2))
            for k, speed in enumerate(SPEEDS)
        ]
        self.content = [path.read_bytes() for path in self.sound]
        self.empty = make_result(folder / "empty.h5", steps=0).read_bytes()
        self.spoil = [kind(path) for path in self.sound for kind in (Flips, Structures)]
        for path in folder.iterdir():
            path.unlink()
        self.number = 0

    def __call__(self, rng):
        """Outcome and what was done."""
        for path in self.folder.iterdir():
            path.unlink()
        for name, content in FOREIGN.items():
            (self.folder / name).write_bytes(content)
        actions = []
        for k, content in enumerate(self.content):
            path = self.folder / f"r{k}.h5"
            path.write_bytes(content)
            if rng.random() < 0.3:
                spoil = self.spoil[2 * k + int(rng.integers(2))]
                actions.append(f"r{k}: {spoil(rng, int(rng.integers(10**6)), path)}")
            elif rng.random() < 0.1:
                path.write_bytes(self.empty)
                actions.append(f"r{k}: no frame")
        members = ", ".join(
            f'{{"value": {v}, "file": "r{k}.h5", "state": "done"}}' for k, v in enumerate(SPEEDS)
        )
        index = f'{{"key": "motion.entrainment_speed", "members": [{members}], "case": ""}}'
        (self.folder / "x.series.json").write_text(index)
        before = {path.name: path.read_bytes() for path in self.folder.iterdir()}
        command = list(WORDS)[int(rng.integers(len(WORDS)))]
        words = (
            ["x.series.json"] if rng.random() < 0.4 and command is not compare else self._files(rng, command)
        )
        if rng.random() < 0.6:
            words += WORDS[command][int(rng.integers(len(WORDS[command])))]
        if command in (ensemble, plot) and rng.random() < 0.6:
            words += ["-o", OUTPUTS[int(rng.integers(len(OUTPUTS)))]]
        status, report = process(lambda: self._run(command, words), self.folder / "report", LIMIT)
        word = (
            "done"
            if status == 1 and command is compare and "Traceback" not in report
            else word_of(status, report)
        )
        after = {path.name: path.read_bytes() for path in self.folder.iterdir() if path.name in before}
        if after != before or list(self.folder.glob(".*.tmp*")):
            word = "changed"
        return word, f"{actions} {command.__name__} {words}: {status} {report[-1500:]}"

    def keep(self, place):
        """Copy the files of the last draw."""
        place.mkdir()
        for path in self.folder.iterdir():
            (Path(place) / path.name).write_bytes(path.read_bytes())

    @staticmethod
    def _files(rng, command):
        count = 2 if command is compare else int(rng.integers(1, 4))
        return [f"r{k}.h5" for k in rng.permutation(3)[:count]]

    def _run(self, command, words):
        os.chdir(self.folder)
        return int(command.main(words))
