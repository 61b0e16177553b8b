"""Commands that read results, some cut off, or no results at all."""

from sandbox import beside_others
from support.made_results import make_result, with_solids

from ehlpetsc.analysis import compare, ensemble, summary
from ehlpetsc.pictures import command as plot

LIMIT = 120  # s
SPEEDS = (10.0, 5.0, 1.0)
FOREIGN = {"foreign.csv": b"0,1\n1,2\n", "case.toml": b"title = 'a'", "foreign.restart.h5": b"a"}
WORDS = {
    ensemble: ("-o e.csv",),
    compare: ("--rtol 0", "--rtol -1", "--atol nan", "--rtol 1e300"),
    summary: ("--steps", "--frame 3", "--frame -1", "--frame x", "--steps --frame 3"),
    plot: (
        *("--stribeck", "--ensemble", "--map", "--report", "--step 3", "--time nan", "--around 0.2"),
        *("--around nan", "--width 0", "--running-in"),
    ),
}
OUTPUTS = (
    *("t.csv", "t.json", "p.png", "p.svg", "p.html", "p.gif", "t.txt", "", "none/t.csv", "foreign.csv"),
    *("r0.h5", "case.toml", "foreign.restart.h5", "x.series.json", "\udcff.csv"),
)


class Draw:
    """One command line after the other."""

    def __init__(self, folder):
        self.folder = folder
        paths = [
            with_solids(make_result(folder / f"s{k}.h5", nodes=81, steps=9, speed=speed, rough=k != 2))
            for k, speed in enumerate(SPEEDS)
        ]
        self.sound = [path.read_bytes() for path in paths]
        members = [f'{{"value": {v}, "file": "r{k}.h5"}}' for k, v in enumerate(SPEEDS)]
        self.index = f'{{"key": "motion.entrainment_speed", "members": [{", ".join(members)}], "case": ""}}'

    def __call__(self, rng):
        """Outcome and what was done."""
        inputs, damage = FOREIGN | {"x.series.json": self.index.encode()}, []
        for k, content in enumerate(self.sound):
            inputs[f"r{k}.h5"], what = self._damaged(rng, content)
            damage.append(what)
        command = list(WORDS)[int(rng.integers(len(WORDS)))]
        count = 2 if command is compare else int(rng.integers(1, 4))
        words = [f"r{k}.h5" for k in rng.permutation(3)[:count]]
        if rng.random() < 0.4 and command is not compare:
            words = ["x.series.json"]
        if rng.random() < 0.6:
            words += str(rng.choice(WORDS[command])).split()
        if command is not compare and rng.random() < 0.6:
            words += ["-o", OUTPUTS[int(rng.integers(len(OUTPUTS)))]]
        work = lambda: self._status(command, words)  # noqa: E731
        word, ended = beside_others(self.folder, inputs, work, LIMIT)
        return word, f"{damage} {command.__name__} {words}: {ended}"

    def keep(self, place):
        """Copy the files of the last draw."""
        place.mkdir()
        for path in self.folder.iterdir():
            (place / path.name).write_bytes(path.read_bytes())

    @staticmethod
    def _damaged(rng, content):
        kind = rng.random()
        if kind < 0.1:
            return content[: int(rng.integers(len(content)))], "cut"
        return (b"mine", "foreign") if kind < 0.2 else (content, "sound")

    @staticmethod
    def _status(command, words):
        status = int(command.main(words))
        return 0 if command is compare and status == 1 else status  # they differ
