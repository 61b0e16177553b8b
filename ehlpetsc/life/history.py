"""A life in memory and in its file: HDF5, extended by a row for each solved round.

As result files it is written in single-writer/multiple-reader mode. ``figures/passes`` is extended last and
thus commits the row: a killed run loses only the round in progress. A continued life is copied once, up to
its last complete row.
"""

from __future__ import annotations

import contextlib
import json
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

import h5py
import numpy as np

from ehlpetsc.base.case import changed_files
from ehlpetsc.base.errors import OutputError
from ehlpetsc.case.tables import Case
from ehlpetsc.life.body import LifeBody
from ehlpetsc.results.hdf5_file import GrowingFile, attribute_value, check_space, extend, open_for_reading

BODY_DATASETS = {"s": "m", "y": "m", "edges": "m", "height": "m", "smooth_rate": "1"}  # of a body
ROW_DATASETS = {"wear": "m", "pit": "m", "damage": "1", "failed": "passes", "is_pitted": "1", "volume": "m^2"}
ROW_DATASETS |= {"wear_rate": "m", "damage_rate": "1", "volume_rate": "m^2"}  # of a pass
KIND = "surfaces over their life"
FORMAT = 5
COMMIT_DATASET = "passes"  # of the figures, written last
ROWS, CHUNK = 64, 4096  # in a chunk of a dataset: rows, numbers


class LifeFile(GrowingFile):
    """File of a life that grows; created with its first row."""

    def store(self, history: LifeHistory) -> None:
        """Append the last row of a life, or write all rows if the file is not open yet, or deleted.

        Raises `OutputError`, and `OutputLost` where another file is in its place.
        """
        if not self.path.exists():
            self._size = None
        with self._writing():
            if self._size is None:
                self._begin(partial(self._fill, history))
            else:
                self._append(history, [len(history.rows) - 1])

    def close(self, status: str) -> None:
        """Store the final status and close the file.

        `status`: "done", "stopped", "not converged".
        """
        if self._file:
            with contextlib.suppress(OutputError), self._writing():  # its rows are complete
                self._end(status)

    def _fill(self, history: LifeHistory, file: h5py.File) -> None:
        attributes = {"kind": KIND, "case": history.case, "title": history.title}
        attributes |= {"digests": json.dumps(history.digests)}
        status = np.array(b"running", "S16")  # of fixed length, to be overwritten at the end
        file.attrs.update(attributes | {"format_version": FORMAT, "status": status})
        _lay_out(file, history)
        self._append(history, range(len(history.rows)))

    def _append(self, history: LifeHistory, numbers: list[int] | range) -> None:
        for number in numbers:
            values = dict(_values_of(history, number))
            commit = values.pop(f"figures/{COMMIT_DATASET}")
            check_space(self.path, sum(value.nbytes for value in values.values()))
            for name, value in values.items():
                extend(self._file[name], value)
            self._file.flush()
            extend(self._file[f"figures/{COMMIT_DATASET}"], commit)
            self._file.flush()


def _values_of(history: LifeHistory, number: int) -> Iterator:
    """Names of the datasets and the values that a row appends to each."""
    for name, value in history.rows[number].items():
        yield f"figures/{name}", np.array([value])
    for k, body in enumerate(history.bodies[number], 1):
        for name in ROW_DATASETS:
            yield f"surface/{k}/{name}", np.asarray(getattr(body, name))[None]
    for name, value in history.plastic[number].items():
        cells = np.moveaxis(np.atleast_1d(value), -1, 0)  # rows of a strip do not change in number
        yield f"records/{name}", cells
        yield f"lengths/{name}", np.array([len(cells)])


def _lay_out(file: h5py.File, history: LifeHistory) -> None:
    for name, value in _values_of(history, 0):
        shape = value.shape[1:]
        rows = CHUNK if name.startswith("records/") else ROWS  # of which a row adds many
        chunk = max(1, min(rows, CHUNK // max(int(np.prod(shape)), 1)))
        file.create_dataset(
            name, (0, *shape), value.dtype, maxshape=(None, *shape), chunks=(chunk, *shape), fletcher32=True
        )
    for k, body in enumerate(history.bodies[0], 1):
        for name in BODY_DATASETS:
            file[f"surface/{k}/{name}"] = getattr(body, name)
        for name, unit in (BODY_DATASETS | ROW_DATASETS).items():
            file[f"surface/{k}/{name}"].attrs["units"] = unit
    for name, value in history.plastic[0].items():
        file[f"records/{name}"].attrs["is_number"] = int(not np.ndim(value))


@dataclass
class LifeHistory:
    """All solved rounds of a life.

    `case`: its text. `digests`: of its surface files. `rows`: figures of each round: "passes" done after its
    jump, "jump", "solved" passes of it, "pits_1", "ra_1", "friction" ... `bodies`: after each jump.
    `plastic`: record of the plastic deformation after each jump, flat; empty without.
    """

    case: str
    title: str
    rows: list[dict] = field(default_factory=list)
    bodies: list[tuple[LifeBody, ...]] = field(default_factory=list)
    plastic: list[dict] = field(default_factory=list)
    digests: dict[str, str] = field(default_factory=dict)

    @property
    def done(self) -> int:
        """Passes done."""
        return int(self.rows[-1]["passes"]) if self.rows else 0

    @property
    def solved(self) -> int:
        """Passes solved."""
        return sum(row["solved"] for row in self.rows)

    @property
    def first_failure(self) -> float:
        """Passes after which the first cell failed; inf: none did."""
        return min(float(body.failed.min()) for body in self.bodies[-1])

    def __call__(self, name: str) -> np.ndarray:
        """Values of a figure, or of "damaged_share_1" and "_2", in all rows, shape (rows,)."""
        name, k = name.rsplit("_", 1) if name.startswith("damaged_share") else (name, "")
        if k:
            rows = zip(self.rows, self.bodies, strict=True)
            return np.array([bodies[int(k) - 1].damaged_share(row["passes"]) for row, bodies in rows])
        return np.array([row[name] for row in self.rows])

    def limiting_wear(self, surface: int) -> float:
        """Least wear rate, over that of the life, which keeps cells of a surface from failing.

        Without break-outs wear and damage are proportional to the passes, so that a life serves every rate k,
        :math:`D(N;k)=F(kN)/k`: at this rate the largest D of cells that are left is 1 at its maximum. It is a
        lower bound while D still rises.

        `surface`: 1 or 2.
        """
        return float(self(f"damage_{surface}").max())

    def add(self, row: dict, bodies: tuple[LifeBody, ...], plastic: dict[str, np.ndarray]) -> None:
        """Append a solved round."""
        self.rows.append(row)
        self.bodies.append(bodies)
        self.plastic.append(plastic)


def read_life(path: str | Path) -> LifeHistory:
    """Read a stored life, also while it is being written.

    Raises
    ------
    OutputError
        Missing, damaged or of another kind.
    """
    path = Path(path)
    with open_for_reading(path) as file:
        if attribute_value(file.attrs.get("kind")) != KIND:
            raise OutputError(f"{path}: not a file of ehlpetsc.life")
        version = file.attrs.get("format_version")
        if version != FORMAT:
            raise OutputError(f"{path}: format version {version}, this ehlpetsc reads {FORMAT}; --overwrite")
        try:
            return _read(file)
        except (AttributeError, LookupError, ValueError, TypeError, OSError) as error:
            raise OutputError(f"{path}: damaged ({error})") from error


def _read(file: h5py.File) -> LifeHistory:
    digests = json.loads(attribute_value(file.attrs.get("digests", "{}")))
    case, title = (attribute_value(file.attrs[name]) for name in ("case", "title"))
    life = LifeHistory(case, title, digests=digests)
    count = len(file[f"figures/{COMMIT_DATASET}"])
    figures = {name: dataset[:count] for name, dataset in file["figures"].items()}
    groups = [file[f"surface/{k}"] for k in (1, 2)]
    fixed = [[group[name][:] for name in BODY_DATASETS] for group in groups]
    changing = [[group[name][:count] for name in ROW_DATASETS] for group in groups]
    for k, values in enumerate(changing, 1):
        for name, rows in zip(ROW_DATASETS, values, strict=True):
            if np.isnan(rows).any():
                raise ValueError(f"surface/{k}/{name} contains nan")
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


def _records(file: h5py.File, name: str, count: int) -> list:
    """Values of a record's field in each row, of different lengths."""
    dataset, lengths = file[f"records/{name}"], file[f"lengths/{name}"][:count]
    ends = np.cumsum(lengths)
    values = np.split(dataset[: ends[-1] if count else 0], ends[:-1])
    if dataset.attrs["is_number"]:
        return [value[0] for value in values]
    return [np.moveaxis(value, 0, -1) for value in values]


ENDS = ("passes", "max_solved")  # keys of [life] that may change between calls


def _tables_of_surfaces(text: str) -> dict:
    """Tables of a case on which its surfaces depend: without the title and the end of the life."""
    tables = tomllib.loads(text)
    tables.pop("title", None)
    tables["life"] = {name: value for name, value in tables["life"].items() if name not in ENDS}
    return tables


def stored_or_new(case: Case, path: Path, overwrite: bool) -> LifeHistory:
    """Life stored at `path`, or a new one; OutputError if it is the life of another case."""
    if overwrite or not path.exists():
        return LifeHistory(case.text, case.title, digests=case.digests)
    history = read_life(path)
    if _tables_of_surfaces(history.case) != _tables_of_surfaces(case.text):
        raise OutputError(f"{path}: the life of another case; give another -o, or --overwrite to lose it")
    if changed := changed_files(history.digests, case.digests):
        reason = f"{changed} changed since it was written"
        raise OutputError(f"{path}: {reason}; give another -o, or --overwrite to lose it")
    return replace(history, case=case.text)  # which may extend the life
