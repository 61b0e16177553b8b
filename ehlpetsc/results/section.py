"""Row of a result in the plane, along the direction of motion, with the interface of a line result."""

from __future__ import annotations

from typing import Any

import h5py
import numpy as np

from ehlpetsc.base.errors import OutputError
from ehlpetsc.results.reader import Result


class Row:
    """Row of a dataset whose last but one dimension is y, indexed as a dataset without it."""

    def __init__(self, dataset: h5py.Dataset, row: int) -> None:
        self._dataset, self._row = dataset, row
        self.attrs, self.dtype = dataset.attrs, dataset.dtype
        self.shape = (*dataset.shape[:-2], dataset.shape[-1])
        self.ndim = len(self.shape)

    def __len__(self) -> int:
        return self.shape[0]

    def __getitem__(self, key: Any) -> np.ndarray:
        keys = key if isinstance(key, tuple) else (key,)
        before = self.ndim - 1  # dimensions before y
        return self._dataset[(*keys[:before], self._row, *keys[before:])]


class Section(Result):
    """Section of a result at the row nearest to `at` [m], of the kind "line".

    It reads from the file of the result, which stays open. `place`: y of the row [m].
    """

    def __init__(self, result: Result, at: float) -> None:
        if result.y is None:
            raise OutputError(f"{result.path}: a line contact, which has no sections; leave section out")
        ends, half = result.y[[0, -1]], 0.5 * (result.y[1] - result.y[0])
        if not ends[0] - half <= at <= ends[1] + half:
            raise OutputError(f"section: y = {at:g} m; allowed: on the mesh, {ends[0]:g} to {ends[1]:g} m")
        self._row = int(np.argmin(np.abs(result.y - at)))
        super().__init__(result._file, result.path)
        self.place, self.y = float(result.y[self._row]), None
        self.contact_count = self.contact_count[self._row]
        self.attrs = self.attrs | {"kind": "line"}

    def __getitem__(self, name: str) -> Any:
        dataset = super().__getitem__(name)
        return Row(dataset, self._row) if dataset.ndim > 1 + (name in self.fields) else dataset

    def close(self) -> None:
        """Do nothing: the file is that of the result."""
