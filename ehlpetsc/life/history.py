"""A life stored: one HDF5 file, a row for each solved pass, replaced whole after each."""

import io
from pathlib import Path

import h5py
import numpy as np

from ehlpetsc.errors import OutputError
from ehlpetsc.life.body import LifeBody
from ehlpetsc.results.atomic_write import atomic_write
from ehlpetsc.results.hdf5.opening import open_for_reading

FIXED = {"s": "m", "edges": "m", "height": "m"}  # of a body
CHANGING = {"wear": "m", "pit": "m", "damage": "1", "failed": "passes", "is_pitted": "1", "volume": "m^2"}
KIND = "surfaces over their life"


class LifeHistory:
    """All solved passes of a life.

    Attributes
    ----------
    case : str
        Its text.
    rows : list of dict
        Figures of each solved pass: "passes" done after its jump, "jump", "pits_1", "ra_1", "friction" ...
    bodies : list of pair of LifeBody
        After each jump.
    plastic : dict
        Record of the plastic deformation after the last one, flat; empty without.
    """

    def __init__(self, case, title):
        self.case, self.title = case, title
        self.rows, self.bodies, self.plastic = [], [], {}

    @property
    def done(self):
        """Passes done."""
        return int(self.rows[-1]["passes"]) if self.rows else 0

    def __call__(self, name):
        """A figure of all solved passes, shape (solved,)."""
        return np.array([row[name] for row in self.rows])

    def add(self, row, bodies, plastic):
        """Append a solved pass."""
        self.rows.append(row)
        self.bodies.append(bodies)
        self.plastic = plastic

    def save(self, path):
        """Write all of it in the place of `path`.

        Raises
        ------
        OutputError
        """
        image = io.BytesIO()
        with h5py.File(image, "w") as file:
            file.attrs.update({"format_version": 1, "kind": KIND, "case": self.case, "title": self.title})
            for name in self.rows[0] if self.rows else ():
                file[f"figures/{name}"] = self(name)
            for k in range(2) if self.bodies else ():
                group = file.create_group(f"surface/{k + 1}")
                for name, unit in FIXED.items():
                    group[name] = getattr(self.bodies[-1][k], name)
                    group[name].attrs["units"] = unit
                for name, unit in CHANGING.items():
                    group[name] = np.array([getattr(both[k], name) for both in self.bodies])
                    group[name].attrs["units"] = unit
            for name, value in self.plastic.items():
                file[f"records/{name}"] = value
        try:
            atomic_write(path, image.getvalue())
        except OSError as error:
            raise OutputError(f"{path}: not written, {error.strerror}") from error


def read_life(path):
    """A stored life.

    Parameters
    ----------
    path : path-like

    Returns
    -------
    LifeHistory

    Raises
    ------
    OutputError
        Missing, damaged or of another kind.
    """
    path = Path(path)
    with open_for_reading(path) as file:
        if file.attrs.get("kind") != KIND:
            raise OutputError(f"{path}: not a file of ehlpetsc.life")
        try:
            return _read(file)
        except (AttributeError, LookupError, ValueError, TypeError, OSError) as error:
            raise OutputError(f"{path}: damaged ({error})") from error


def _read(file):
    found = LifeHistory(file.attrs["case"], file.attrs["title"])
    figures = {name: dataset[:] for name, dataset in file.get("figures", {}).items()}
    count = len(next(iter(figures.values()), ()))
    found.rows = [{name: values[row].item() for name, values in figures.items()} for row in range(count)]
    groups = [file[f"surface/{k}"] for k in (1, 2)] if count else []
    fixed = [[group[name][:] for name in FIXED] for group in groups]
    changing = [[group[name][:] for name in CHANGING] for group in groups]
    for row in range(count):
        found.bodies.append(
            tuple(
                LifeBody(*one, *(values[row] for values in other))
                for one, other in zip(fixed, changing, strict=True)
            )
        )
    found.plastic = {name: dataset[()] for name, dataset in file.get("records", {}).items()}
    return found
