"""Writing of result files on rank 0.

The file is written in HDF5's single-writer/multiple-reader mode: all datasets exist from the start, rows are
appended in batches, and ``time`` is written last, so that rows with a time are complete. The file of a
running job can be opened, and the file of a killed job is complete up to its last flush.
"""

from __future__ import annotations

import io
import math
import time as clock
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import h5py
import numpy as np

from ehlpetsc.base.declarations import Field
from ehlpetsc.base.errors import OutputError
from ehlpetsc.base.quantities import FIELDS, OTHERS, STEP_SCALARS, dims_in, of_every_case, unit_in
from ehlpetsc.results.hdf5_file import (
    LIBVER,
    GrowingFile,
    check_space,
    earlier_runs,
    extend,
    git_commit,
    open_hdf5,
    versions,
)
from ehlpetsc.results.means import means
from ehlpetsc.results.reader import FORMAT_VERSION, Result, read_result

if TYPE_CHECKING:
    from ehlpetsc.case.tables import Case

CHUNK_BYTES = 16384  # large enough to write fast; a compressed chunk leaves a hole when rows are added to it
CHUNK_STEPS = 512
FLUSH_SECONDS = 2.0  # between two flushes: a kill can lose the steps of this time and the current one
COMPRESSION: dict[str, Any] = {"compression": "gzip", "compression_opts": 1}  # which every reader knows
BLOCK_BYTES = 2**23  # copied at once


class StoredSurface(NamedTuple):
    """Surface of a body: points s, heights z (ns,), of a map (ny, ns) [m], speed; attributes; depths."""

    s: np.ndarray
    z: np.ndarray
    speed: float
    statistics: dict[str, float] = {}
    depths: Sequence[str] = ()


@dataclass(frozen=True)
class Layout:
    """Datasets of a result file: nodes x [m], fields of a frame, scalars of the steps, surfaces by side.

    `fields` are keys of `quantities.FIELDS`, `scalars` of `STEP_SCALARS`, by default those of every case;
    `precision` is the type of stored fields. `y` are the nodes across [m], None in a line contact; `kind` is
    the kind of contact.
    """

    x: np.ndarray
    fields: Sequence[str]
    scalars: Sequence[str] = field(default_factory=lambda: of_every_case(STEP_SCALARS))
    precision: str = "float64"
    surfaces: dict[str, StoredSurface] = field(default_factory=dict)
    y: np.ndarray | None = None
    kind: str = "line"

    @property
    def axes(self) -> dict[str, np.ndarray]:
        """Nodes [m] by the name of their axis, slowest first."""
        return {"x": self.x} if self.y is None else {"y": self.y, "x": self.x}

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of a frame."""
        return tuple(map(len, self.axes.values()))

    def create_in(self, file: h5py.File) -> None:
        """Create every dataset, empty along time."""
        for axis, nodes in self.axes.items():
            self._add(file, axis, OTHERS[axis], np.asarray(nodes, dtype=float))
        self._add(file, "time", OTHERS["time"], **_growing(CHUNK_STEPS))
        for name in FIELDS:
            if name in self.fields:
                dtype = np.dtype("u1" if FIELDS[name].dtype == "u1" else self.precision)
                rows = frames_of_chunk(self.shape, dtype.itemsize)
                options = _growing(rows, *self.shape) | COMPRESSION | {"shuffle": dtype != "u1"}
                self._add(file, name, FIELDS[name], dtype=dtype, **options)
        self._add(file, "step", OTHERS["step"], **_growing(CHUNK_STEPS))
        self._add(file, "contact_count", OTHERS["contact_count"], np.zeros(self.shape))
        for name in sorted(self.scalars, key="time".__ne__):  # first the dimension scale of the others
            self._add(file, f"steps/{name}", STEP_SCALARS[name], **_growing(CHUNK_STEPS))
        for side, surface in self.surfaces.items():
            group = f"surface/{side}"
            self._add(file, f"{group}/s", OTHERS["surface/s"], surface.s)
            self._add(file, f"{group}/z", OTHERS["surface/z"], surface.z)
            for name in surface.depths:
                self._add(file, f"{group}/{name}", OTHERS[f"surface/{name}"], np.zeros(surface.z.shape))
            file[group].attrs.update({"speed": surface.speed} | surface.statistics)

    def _add(
        self, file: h5py.File, name: str, quantity: Field, values: np.ndarray | None = None, **options: Any
    ) -> None:
        """Create a dataset with a checksum, unit, name and dimension scales."""
        options = {"dtype": quantity.dtype, "fletcher32": True} | options
        dataset = file.create_dataset(name, data=values, **options)
        dataset.attrs.update({"units": unit_in(quantity, self.kind), "long_name": quantity.long_name})
        own_name, dims = name.rpartition("/")[2], dims_in(quantity, tuple(self.axes))
        if dims == (own_name,):
            dataset.make_scale(own_name)
            return
        if len(dims) < dataset.ndim:  # heights of a map
            dims = ("y", *dims)
        for axis, dim in enumerate(dims):
            group = dataset.parent
            dataset.dims[axis].attach_scale(group[dim] if dim in group else file[dim])


def frames_of_chunk(shape: tuple[int, ...], itemsize: int) -> int:
    """Frames in a chunk of a field."""
    return max(1, CHUNK_BYTES // (math.prod(shape) * itemsize))


def _growing(rows: int, *width: int) -> dict[str, tuple]:
    """Arguments of h5py for a dataset that is empty along time, in chunks of some rows."""
    return {"shape": (0, *width), "maxshape": (None, *width), "chunks": (rows, *width)}


class ResultWriter(GrowingFile):
    """Result file of one run.

    Parameters
    ----------
    path
        None: in memory, for :meth:`to_bytes`.
    attributes
        Root attributes: title and case (its text), a, p0, h_scale, u1, u2, ranks, petsc_options ...;
        ``versions`` is an optional dict of further versions.
    resume_step, contact_count
        Continue the file at `path` after this step, up to which each node was in contact in so many steps;
        later steps are dropped. The file is copied, which also repairs a file left by a killed run, and
        replaced when the copy is complete. Without a file at `path` a new one begins after this step.

    Raises
    ------
    OutputError
        The file cannot be written, or the one to resume does not fit the run.
    OutputLost
        The file has been deleted or replaced since the last flush.
    """

    def __init__(
        self,
        path: Path | None,
        layout: Layout,
        attributes: dict[str, Any],
        *,
        resume_step: int | None = None,
        contact_count: np.ndarray | None = None,
    ) -> None:
        super().__init__(path)
        self._shape = layout.shape
        self.contact_count = np.zeros(self._shape, "i8")
        if contact_count is not None:
            self.contact_count += np.reshape(contact_count, self._shape)
        self._steps: list[dict] = []
        self._frames: list[dict] = []
        self._memory = io.BytesIO()

        def fill(file: h5py.File) -> None:
            if path is not None:
                check_space(path, sum(24 * np.size(surface.z) for surface in layout.surfaces.values()))
            self._create_in(file, layout, attributes)
            if resume_step is not None and path is not None and path.exists():
                self._copy_up_to(path, resume_step)

        with self._writing():
            if path is None:
                self._file = open_hdf5(self._memory, "w", libver=LIBVER)
                fill(self._file)
            else:
                self._begin(fill)
        self._flushed = clock.monotonic()
        self._fields = [name for name in FIELDS if name in self._file]

    def _create_in(self, file: h5py.File, layout: Layout, attributes: dict[str, Any]) -> None:
        provenance = {"versions": versions(attributes.get("versions", {})), "git_commit": git_commit()}
        common = {"format_version": FORMAT_VERSION, "restarts": 0, "history": "[]", "kind": layout.kind}
        # texts of fixed length, which may be overwritten while the file is read
        ending = {"status": np.array(b"running", "S16"), "limits": np.array(b"", "S2000")}
        file.attrs.update(attributes | provenance | common | ending)
        layout.create_in(file)

    def append(
        self,
        step: int,
        time: float,
        fields: dict[str, np.ndarray],
        scalars: dict[str, float],
        in_contact: np.ndarray,
        frame: bool = True,
    ) -> None:
        """Add an accepted time step to the buffer, with its fields if `frame`; write the buffer if it is due.

        Fields of a plane may be flat. Missing scalars become nan, missing counts 0.
        """
        self.contact_count += in_contact.reshape(self._shape)
        self._steps.append({**scalars, "step": step, "time": time})
        if frame:
            values = {**fields, "in_contact": in_contact}
            stored = {name: np.array(values[name]).reshape(self._shape) for name in self._fields}
            self._frames.append(stored | {"step": step, "time": time})
        if clock.monotonic() - self._flushed > FLUSH_SECONDS:
            self.flush()

    def flush(self) -> None:
        """Write all rows to the file; a killed process then does not lose them."""
        with self._writing():
            file, scalars = self._file, list(self._file["steps"])
            if self.path:
                frame_bytes = 8 * self.contact_count.size * len(self._fields)
                check_space(self.path, len(self._frames) * frame_bytes + 8 * len(self._steps) * len(scalars))
            for name in scalars:
                if name != "time":
                    missing = 0 if file[f"steps/{name}"].dtype.kind == "i" else np.nan
                    extend(file[f"steps/{name}"], [row.get(name, missing) for row in self._steps])
            for name in [*self._fields, "step"]:
                extend(file[name], [row[name] for row in self._frames])
            file["contact_count"][...] = self.contact_count
            file.flush()
            extend(file["steps/time"], [row["time"] for row in self._steps])
            extend(file["time"], [row["time"] for row in self._frames])
            file.flush()
        self._steps, self._frames = [], []
        self._flushed = clock.monotonic()

    def put_depth(self, side: str, name: str, depth: np.ndarray) -> None:
        """Store a depth [m] of a surface, "1" or "2", at the points s of its profile."""
        with self._writing():
            self._file[f"surface/{side}/{name}"][:] = depth

    def means(self, case: Case | None = None) -> dict[str, float]:
        """Means over the run, see :func:`ehlpetsc.results.means.means`; the case by default from its text."""
        self.flush()
        result = Result(self._file, self.path or Path())
        if case is not None:  # the text of one with a map takes seconds to read
            result.case = case
        return means(result)

    def close(self, status: str, limits: Sequence[str] = ()) -> None:
        """Write the remaining rows, the status of the run and its limits, and close."""
        if not self._file:
            return
        self.flush()
        with self._writing():
            self._file.attrs.modify("limits", np.bytes_("\n".join(limits).encode()))
            self._end(status)

    def to_bytes(self) -> bytes:
        """Content of a closed file in memory."""
        return self._memory.getvalue()

    def _copy_up_to(self, path: Path, step: int) -> None:
        """Copy all rows up to a step of an earlier part of the run."""
        file = self._file
        with read_result(path) as old:
            fault = _misfit(file, old, step)
            if fault:
                raise OutputError(f"{path}: cannot be continued, {fault}; give another -o")
            frames, count = int(np.sum(old.step <= step)), int(np.sum(old.steps("step") <= step))
            ends = dict.fromkeys([*old.fields, "step", "time"], frames)
            for name, end in (ends | {f"steps/{name}": count for name in old.scalars}).items():
                rows = max(1, BLOCK_BYTES // (8 * math.prod(old[name].shape[1:])))
                for begin in range(0, end, rows):
                    block = old[name][begin : min(begin + rows, end)]
                    check_space(path, block.nbytes)
                    extend(file[name], block)
            file["contact_count"][...] = self.contact_count
            restarts = int(old.attrs["restarts"]) + 1
            file.attrs.update({"restarts": restarts, "history": earlier_runs(old.attrs, step)})


def _misfit(file: h5py.File, old: Result, step: int) -> str | None:
    """Reason why a file is not an earlier part of the same run; None if it is one."""
    last = max(old.steps("step"), default=step)  # of a run that was stopped before its first step
    y = file["y"][:] if "y" in file else None
    if not np.array_equal(old.x, file["x"][:]) or not np.array_equal(old.y, y):
        return "it was computed on another mesh, or for another half-width"
    now = {name for name in FIELDS if name in file} | set(file["steps"])
    if others := now.symmetric_difference([*old.fields, *old.scalars]):
        return f"it stores other quantities ({', '.join(sorted(others))})"
    if last < step:
        return f"it ends at step {last}, before step {step} of the restart file"
    return None
