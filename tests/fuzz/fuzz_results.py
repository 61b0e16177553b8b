"""Damaged result files, read whole, compared with the sound one, every tenth drawn."""

import hashlib

import numpy as np
from hdf5_damage import Flips, Structures
from sandbox import process, word_of
from support.made_results import make_result

from ehlpetsc.analysis import compare
from ehlpetsc.errors import OutputError
from ehlpetsc.results.reader import read_result

LIMIT = 240  # s
PICTURES = 25


class Draw:
    """One damaged file after the other, by turns of single bits and of structure."""

    def __init__(self, folder):
        self.folder, self.number = folder, 0
        self.sound = make_result(folder / "sound.h5", nodes=41, steps=9, rough=True)
        self.path = folder / "damaged.h5"
        self.spoil = [Flips(self.sound), Structures(self.sound)]
        self.content = content(self.sound)

    def __call__(self, rng):
        """Outcome and what was done."""
        flipped = self.number % 2 == 0
        what = self.spoil[not flipped](rng, self.number // 2, self.path)
        before, self.number = digest(self.path), self.number + 1
        drawn = self.number % PICTURES < 2
        status, report = process(lambda: self._use(flipped, drawn), self.folder / "report", LIMIT)
        word = "different" if "DIFFERENT CONTENT" in report else word_of(status, report)
        if digest(self.path) != before:
            word = "changed"
        return word, f"{what}: {status} {report[-1500:]}"

    def keep(self, place):
        """Copy the file of the last draw."""
        place.with_suffix(".h5").write_bytes(self.path.read_bytes())

    def _use(self, flipped, drawn):
        """Read a result in every way; a flipped bit is reported or lies outside the data read."""
        try:
            now = content(self.path)
        except OutputError as error:
            print(f"ehlpetsc: {error}")
            now = None
        if flipped and now is not None and now != self.content:
            print("DIFFERENT CONTENT", [name for name in now if now[name] != self.content.get(name)])
        statuses = [compare.main([str(self.sound), str(self.path)])]
        if drawn:
            from ehlpetsc.pictures import command as plot

            statuses.append(plot.main([str(self.path), "-o", str(self.folder / "picture.png")]))
        return 2 if now is None or 2 in statuses else 1 if set(statuses) - {0, 1} else 0


def content(path):
    """Everything a result gives, as bytes by name."""
    with read_result(path) as result:
        found = {f"attribute {name}": repr(value).encode() for name, value in result.attrs.items()}
        names = ["x", "time", "step", "contact_count", *result.fields]
        found |= {name: np.asarray(result[name][:]).tobytes() for name in names}
        found |= {f"steps/{name}": result.steps(name).tobytes() for name in result.scalars}
        for side in ("1", "2"):
            profile = result.profile(side)
            found[side] = repr(
                None if profile is None else [np.asarray(p).tobytes() for p in profile]
            ).encode()
        return found


def digest(path):
    """Of a file's bytes."""
    return hashlib.sha256(path.read_bytes()).hexdigest()
