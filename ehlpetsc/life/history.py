"""A life in memory, and read from its file."""

from pathlib import Path

import numpy as np

from ehlpetsc.errors import OutputError
from ehlpetsc.life.ageing.body import LifeBody
from ehlpetsc.life.life_file import BODY_DATASETS, COMMIT_DATASET, FORMAT, KIND, ROW_DATASETS, LifeFile
from ehlpetsc.results.hdf5.attributes import plain
from ehlpetsc.results.hdf5.opening import open_for_reading


class LifeHistory:
    """All solved rounds of a life.

    Attributes
    ----------
    case : str
        Its text.
    title : str
    rows : list of dict
        Figures of each round: "passes" done after its jump, "jump", "solved" passes of it, "pits_1", "ra_1",
        "friction" ...
    bodies : list of pair of LifeBody
        After each jump.
    plastic : list of dict
        Record of the plastic deformation after each jump, flat; empty without.
    """

    def __init__(self, case, title):
        self.case, self.title = case, title
        self.rows, self.bodies, self.plastic = [], [], []

    @property
    def done(self):
        """Passes done."""
        return int(self.rows[-1]["passes"]) if self.rows else 0

    @property
    def solved(self):
        """Passes solved."""
        return sum(row["solved"] for row in self.rows)

    @property
    def first_failure(self):
        """Passes after which the first cell failed; inf: none did."""
        return min(float(body.failed.min()) for body in self.bodies[-1])

    def __call__(self, name):
        """Values of a figure in all rows, shape (rows,)."""
        return np.array([row[name] for row in self.rows])

    def add(self, row, bodies, plastic):
        """Append a solved round."""
        self.rows.append(row)
        self.bodies.append(bodies)
        self.plastic.append(plastic)

    def up_to(self, count):
        """Copy of the life up to a row."""
        life = LifeHistory(self.case, self.title)
        for values in zip(self.rows[:count], self.bodies, self.plastic, strict=False):
            life.add(*values)
        return life

    def save(self, path):
        """Write all rows to `path`, replacing it; OutputError."""
        with LifeFile(Path(path)) as file:
            file.store(self)


def read_life(path):
    """Read a stored life, also while it is being written.

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
        if plain(file.attrs.get("kind")) != KIND:
            raise OutputError(f"{path}: not a file of ehlpetsc.life")
        version = file.attrs.get("format_version")
        if version != FORMAT:
            raise OutputError(f"{path}: format version {version}, this ehlpetsc reads {FORMAT}; --overwrite")
        try:
            return _read(file)
        except (AttributeError, LookupError, ValueError, TypeError, OSError) as error:
            raise OutputError(f"{path}: damaged ({error})") from error


def _read(file):
    life = LifeHistory(plain(file.attrs["case"]), plain(file.attrs["title"]))
    count = len(file[f"figures/{COMMIT_DATASET}"])
    figures = {name: dataset[:count] for name, dataset in file["figures"].items()}
    groups = [file[f"surface/{k}"] for k in (1, 2)]
    fixed = [[group[name][:] for name in BODY_DATASETS] for group in groups]
    changing = [[group[name][:count] for name in ROW_DATASETS] for group in groups]
    plastic = {name: _records(file, name, count) for name in file.get("records", {})}
    for row in range(count):
        bodies = tuple(
            LifeBody(*fixed_values, *(values[row] for values in row_values))
            for fixed_values, row_values in zip(fixed, changing, strict=True)
        )
        life.add(
            {name: values[row].item() for name, values in figures.items()},
            bodies,
            {name: values[row] for name, values in plastic.items()},
        )
    return life


def _records(file, name, count):
    """Values of a record's field in each row, of different lengths."""
    dataset, lengths = file[f"records/{name}"], file[f"lengths/{name}"][:count]
    ends = np.cumsum(lengths)
    values = np.split(dataset[: ends[-1] if count else 0], ends[:-1])
    return [value[0] for value in values] if dataset.attrs["is_number"] else values
