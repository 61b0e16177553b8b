"""Writing of result files on rank 0.

The file is written in HDF5's single-writer/multiple-reader mode: all datasets exist from the start, rows are
appended in batches, and ``time`` is written last, so that rows with a time are complete. The file of a
running job can be opened, and the file of a killed job is complete up to its last flush.
"""

from __future__ import annotations

import contextlib
import io
import time as clock
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, BinaryIO

import h5py
import numpy as np

from ehlpetsc.base.declarations import Field
from ehlpetsc.base.errors import OutputError
from ehlpetsc.effects.quantities import FIELDS, OTHERS, STEP_SCALARS, of_every_case
from ehlpetsc.results.hdf5_file import change, check_space, create, extend, put_fixed
from ehlpetsc.results.means import means
from ehlpetsc.results.output_guard import os_reason, replacing
from ehlpetsc.results.provenance import earlier_runs, git_commit, versions
from ehlpetsc.results.reader import FORMAT_VERSION, Result, read_result

CHUNK_BYTES = 65536  # large enough to write fast, small enough that a steady result stays small
CHUNK_STEPS = 512
MAX_STEPS = 1024  # in the buffer
MAX_FIELD_BYTES = 2**20  # of each field in the buffer
STATUS_LENGTH, LIMITS_LENGTH = 16, 2000  # bytes reserved for these attributes
FLUSH_SECONDS = 2.0  # between two flushes: a kill can lose the steps of this time and the current one
ROWS_PER_BLOCK = 1024  # copied at once
SCALE_TOLERANCE = 1e-9  # relative: speeds and scales nearer than this are equal


@dataclass(frozen=True)
class Layout:
    """Datasets of a result file: nodes x [m], fields of a frame, scalars of the steps, surfaces.

    `fields` are keys of `quantities.FIELDS`, `scalars` of `STEP_SCALARS`, by default those of every case;
    `precision` is the type of stored fields. `profiles` is ``{"1": (s, z, speed) or None, "2": ...}``;
    an optional fourth item contains attributes (ra, rq, rsk), a fifth one names of depths to create, keys of
    `quantities.OTHERS` ("set").
    """

    x: np.ndarray
    fields: Sequence[str]
    scalars: Sequence[str] = field(default_factory=lambda: of_every_case(STEP_SCALARS))
    precision: str = "float64"
    profiles: dict[str, tuple | None] = field(default_factory=dict)

    def create_in(self, file: h5py.File) -> None:
        """Create every dataset, empty along time."""
        nodes, names = len(self.x), [name for name in FIELDS if name in self.fields]
        _fixed(file, "x", OTHERS["x"], np.asarray(self.x, dtype=float))
        _growing(file, "time", OTHERS["time"], CHUNK_STEPS)
        for name in names:
            flag = FIELDS[name].dtype == "u1"
            dtype = np.dtype("u1" if flag else self.precision)
            rows = max(1, CHUNK_BYTES // (nodes * dtype.itemsize))
            # contact is rare, so that flags compress to almost nothing; floats do not compress enough
            compression = {"compression": "gzip", "compression_opts": 1} if flag else {}
            _growing(file, name, FIELDS[name], rows, nodes, dtype=dtype, **compression)
        _growing(file, "step", OTHERS["step"], CHUNK_STEPS)
        _fixed(file, "contact_count", OTHERS["contact_count"], np.zeros(nodes, dtype="i8"))
        for name in sorted(self.scalars, key="time".__ne__):  # first the dimension scale of the others
            _growing(file, f"steps/{name}", STEP_SCALARS[name], CHUNK_STEPS)
        for surface, profile in self.profiles.items():
            if profile is not None:
                _surface(file, f"surface/{surface}", *profile)


def _surface(
    file: h5py.File,
    name: str,
    s: np.ndarray,
    z: np.ndarray,
    speed: float,
    statistics: dict[str, float] | None = None,
    depths: Sequence[str] = (),
) -> None:
    _fixed(file, f"{name}/s", OTHERS["surface/s"], s)
    _fixed(file, f"{name}/z", OTHERS["surface/z"], z)
    for depth in depths:
        _fixed(file, f"{name}/{depth}", OTHERS[f"surface/{depth}"], np.zeros(len(s)))
    file[name].attrs.update({"speed": speed} | (statistics or {}))


def _fixed(file: h5py.File, name: str, quantity: Field, values: np.ndarray) -> None:
    values = np.asarray(values)
    checked = {"chunks": values.shape, "fletcher32": True} if values.size else {}
    _describe(file.create_dataset(name, data=values, **checked), quantity)


def _growing(
    file: h5py.File, name: str, quantity: Field, rows: int, *width: int, dtype: Any = None, **compression: Any
) -> None:
    shapes = {"maxshape": (None, *width), "chunks": (rows, *width)}
    kind = dtype or quantity.dtype
    dataset = file.create_dataset(name, (0, *width), kind, fletcher32=True, **shapes, **compression)
    _describe(dataset, quantity)


def _describe(dataset: h5py.Dataset, quantity: Field) -> None:
    dataset.attrs.update({"units": quantity.units, "long_name": quantity.long_name})
    own_name = dataset.name.rsplit("/", 1)[1]
    if quantity.dims == (own_name,):
        dataset.make_scale(own_name)
        return
    for axis, dim in enumerate(quantity.dims):
        dataset.dims[axis].attach_scale(dataset.parent[dim])


class ResultWriter:
    """Result file of one run.

    A new file is created under a temporary name and renamed when all datasets exist, so that a run that fails
    at its start does not destroy an older result.

    `written`: last complete step in the file and its time [s]; None: no step.

    Parameters
    ----------
    path
        None: in memory, for :meth:`to_bytes`.
    attributes
        Root attributes: title and case (its text), a, p0, h_scale, u1, u2, ranks, petsc_options ...;
        ``versions`` is an optional dict of further versions.
    every
        Steps between stored frames.
    resume_step, contact_count
        Continue the file at `path` after this step, up to which each node was in contact in so many steps;
        later steps are dropped. The file is copied, which also repairs a file left by a killed run, and
        replaced when the copy is complete. Without a file at `path` a new one begins after this step.

    Raises
    ------
    OutputError
        The file cannot be written, or the one to resume does not fit the run.
    """

    _file: Any = None  # an h5py.File
    written: tuple[int, float] | None = None

    def __init__(
        self,
        path: Path | None,
        layout: Layout,
        attributes: dict[str, Any],
        every: int = 1,
        *,
        resume_step: int | None = None,
        contact_count: np.ndarray | None = None,
    ) -> None:
        self.path, self.every = None if path is None else Path(path), every
        self.contact_count = np.zeros(len(layout.x), dtype="i8")
        if contact_count is not None:
            self.contact_count[:] = contact_count
        self._steps: list[dict] = []
        self._frames: list[dict] = []
        with self._one_sentence("not created"):
            if self.path is None:
                self._memory = io.BytesIO()
                self._create(self._memory, layout, attributes)
            else:
                with replacing(self.path) as target:
                    check_space(self.path, sum(24 * len(p[0]) for p in layout.profiles.values() if p))
                    self._create(target, layout, attributes)
                    if resume_step is not None and self.path.exists():
                        self._copy_up_to(self.path, resume_step)
                    self._file.swmr_mode = True
                    self._file.flush()
        self._last, self._flushed = self.written, clock.monotonic()
        self._fields = [name for name in FIELDS if name in self._file]
        self._max_frames = max(1, MAX_FIELD_BYTES // (8 * len(layout.x)))

    def _create(self, target: Path | BinaryIO, layout: Layout, attributes: dict[str, Any]) -> None:
        file = self._file = create(target)
        provenance = {"versions": versions(attributes.get("versions", {})), "git_commit": git_commit()}
        common = {"format_version": FORMAT_VERSION, "restarts": 0, "history": "[]"}
        file.attrs.update(attributes | provenance | common)
        put_fixed(file, "status", "running", STATUS_LENGTH)
        put_fixed(file, "limits", "", LIMITS_LENGTH)
        layout.create_in(file)

    def append(
        self,
        step: int,
        time: float,
        fields: dict[str, np.ndarray],
        scalars: dict[str, float],
        in_contact: np.ndarray,
        frame: bool | None = None,
    ) -> None:
        """Add an accepted time step to the buffer; write the buffer if it is full.

        Missing scalars become nan, missing counts 0. The fields are stored if `frame`, by default if the
        step is a multiple of `every`.
        """
        self.contact_count += in_contact
        self._steps.append({**scalars, "step": step, "time": time})
        if step % self.every == 0 if frame is None else frame:
            values = {**fields, "in_contact": in_contact}
            stored = {name: np.array(values[name]) for name in self._fields}
            self._frames.append(stored | {"step": step, "time": time})
        self._last = (step, time)
        full = len(self._steps) == MAX_STEPS or len(self._frames) == self._max_frames
        if full or clock.monotonic() - self._flushed > FLUSH_SECONDS:
            self.flush()

    def flush(self) -> None:
        """Write all rows to the file; a killed process then does not lose them."""
        file, scalars = self._file, list(self._file["steps"])
        with self._one_sentence("not written on"):
            if self.path:
                frame_bytes = 8 * len(self.contact_count) * len(self._fields)
                check_space(self.path, len(self._frames) * frame_bytes + 8 * len(self._steps) * len(scalars))
            for name in scalars:
                if name != "time":
                    missing = 0 if file[f"steps/{name}"].dtype.kind == "i" else np.nan
                    extend(file[f"steps/{name}"], [row.get(name, missing) for row in self._steps])
            for name in [*self._fields, "step"]:
                extend(file[name], [row[name] for row in self._frames])
            file["contact_count"][:] = self.contact_count
            file.flush()
            extend(file["steps/time"], [row["time"] for row in self._steps])
            extend(file["time"], [row["time"] for row in self._frames])
            file.flush()
        self._steps, self._frames = [], []
        self.written, self._flushed = self._last, clock.monotonic()

    def put_depth(self, side: str, name: str, depth: np.ndarray) -> None:
        """Store a depth [m] of a surface, "1" or "2", at the points s of its profile."""
        with self._one_sentence("not written on"):
            self._file[f"surface/{side}/{name}"][:] = depth

    def means(self) -> dict[str, float]:
        """Means over the run, see :func:`ehlpetsc.results.means.means`."""
        self.flush()
        return means(Result(self._file, self.path or Path()))

    def close(self, status: str, limits: Sequence[str] = ()) -> None:
        """Write the remaining rows, the status of the run and its limits, and close."""
        if not self._file:
            return
        self.flush()
        with self._one_sentence("not closed"):
            self._end(status, "\n".join(limits))

    def to_bytes(self) -> bytes:
        """Content of a closed file in memory."""
        return self._memory.getvalue()

    def _end(self, status: str, limits: str = "") -> None:
        change(self._file, "status", status)
        change(self._file, "limits", limits)
        self._file.close()

    @contextlib.contextmanager
    def _one_sentence(self, failure: str) -> Iterator[None]:
        """After an error close the file; one of HDF5 or the system becomes an OutputError."""
        try:
            yield
        except OutputError:
            self._close_after_a_fault()
            raise
        except (OSError, RuntimeError) as error:
            self._close_after_a_fault()
            content = ""
            if failure != "not created":
                content = "; no step is in it yet"
                if self.written:
                    step, time = self.written
                    content = f"; the file is whole up to step {step} ({1e6 * time:.4f} us)"
            raise OutputError(f"{self.path}: result file {failure}, {os_reason(error)}{content}") from error

    def _close_after_a_fault(self) -> None:
        with contextlib.suppress(Exception):  # the first fault is reported
            self._end("stopped")

    def _copy_up_to(self, path: Path, step: int) -> None:
        """Copy all rows up to a step of an earlier part of the run."""
        file = self._file
        with read_result(path) as old:
            fault = _misfit(file, old, step)
            if fault:
                raise OutputError(f"{path}: cannot be continued, {fault}; give another -o")
            steps, numbers = file["steps"], old.steps("step")
            frames, count = int(np.sum(old.step <= step)), int(np.sum(numbers <= step))
            rows = {name: frames for name in (*old.fields, "step", "time")}
            for name, end in (rows | {f"steps/{name}": count for name in steps}).items():
                for begin in range(0, end, ROWS_PER_BLOCK):
                    block = old[name][begin : min(begin + ROWS_PER_BLOCK, end)]
                    check_space(path, block.nbytes)
                    extend(file[name], block)
            file["contact_count"][:] = self.contact_count
            restarts = int(old.attrs["restarts"]) + 1
            file.attrs.update({"restarts": restarts, "history": earlier_runs(old.attrs, step)})
        if count:
            self.written = int(steps["step"][-1]), float(steps["time"][-1])


def _misfit(file: h5py.File, old: Result, step: int) -> str | None:
    """Reason why a file is not an earlier part of the same run; None if it is one."""
    last = max(old.steps("step"), default=None)
    if not np.array_equal(old.x, file["x"][:]):
        return "it was computed on another mesh, or for another half-width"
    if {*old.fields, *old.scalars} != {name for name in FIELDS if name in file} | set(file["steps"]):
        return f"it stores other quantities ({', '.join([*old.fields, *old.scalars])})"
    if last is not None and last < step:  # None: stopped before its first step
        return f"it ends at step {last}, before step {step} of the restart file"
    for name in ("p0", "u1", "u2"):
        if not np.isclose(old.attrs[name], file.attrs[name], rtol=SCALE_TOLERANCE, atol=0.0):
            return f"it was computed for {name} = {old.attrs[name]:.6g}"
    return None
