"""Reading of result files, complete or left by a killed run: fields and scalars by name."""

from __future__ import annotations

import contextlib
import json
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np

from ehlpetsc.base.case import changed_files
from ehlpetsc.base.errors import CaseError, OutputError
from ehlpetsc.results.hdf5_file import attributes, open_for_reading
from ehlpetsc.results.output_guard import atomic_write, check_derived, file_path, inputs_of_result

if TYPE_CHECKING:
    from xarray import Dataset, Variable

    from ehlpetsc.case.loading import Case
    from ehlpetsc.physics.contact.roller_loads import RollerLoads

FORMAT_VERSION = 1  # of the layout


def read_result(path: Path, **options: Any) -> Result:
    """Open a result file as `Result`, to be closed or used in a ``with`` statement.

    Options are those of `h5py.File`. An OutputError if the file is missing, damaged or not a result.
    """
    return Result(open_result(path, **options), path)


def open_result(path: Path, **options: Any) -> h5py.File:
    """Open a result file for `Result`; options and errors as for :func:`read_result`."""
    file, fault = open_for_reading(path, **options), None
    version = file.attrs.get("format_version")
    if version is not None and "damage/s" in file:
        fault = "a result of post-processing; give the file it was made from"
    elif version is None or "x" not in file or "steps" not in file:
        fault = "an HDF5 file, but not a result of ehlpetsc"
    elif version != FORMAT_VERSION:
        fault = f"format version {version}, this ehlpetsc reads {FORMAT_VERSION}"
    if fault:
        file.close()
        raise OutputError(f"{path}: {fault}")
    return file


def is_done(path: Path, case_text: str, digests: dict[str, str] | None = None) -> bool:
    """Whether a file is the complete result of a case, of surface files with these digests."""
    with contextlib.suppress(OutputError, OSError), read_result(path) as result:
        same = (result.attrs["case"], result.attrs["status"]) == (case_text, "done")
        return same and not changed_files(json.loads(result.attrs.get("digests", "{}")), digests or {})
    return False


class Steps:
    """Scalars of every step by name: ``steps.h_min``, ``steps("h_min")``; arrays of shape (nsteps,).

    ``print(result.steps)`` lists their names, units and meanings.
    """

    def __init__(self, group: h5py.Group, path: Path) -> None:
        self._group, self._path, self.names = group, path, list(group)
        # time is written last: a killed writer may have extended only some of the others
        self._count = len(group["time"])

    def __call__(self, name: str) -> np.ndarray:
        if name not in self.names:
            raise OutputError(f"{self._path}: has no scalar {name} of its steps")
        return self._group[name][: self._count]

    def __getattr__(self, name: str) -> np.ndarray:
        if name in self.__dict__.get("names", ()):
            return self(name)
        raise AttributeError(f"{name}: no scalar of the steps; there are {', '.join(self.names)}")

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self.names]

    def __repr__(self) -> str:
        own = {name: self._group[name].attrs for name in self.names}
        lines = [f"{name:22} {attrs['units']:6} {attrs['long_name']}" for name, attrs in own.items()]
        return "\n".join([f"<Steps: {len(self.names)} scalars of shape ({self._count},)>", *lines])


class Result:
    """Result file, read lazily; each of the `fields` is also an attribute, shape (nt, nx) or (nt, ny, nx).

    Attributes
    ----------
    attrs : dict
        Root attributes: case text, provenance, kind ("line", "strip", "point"), a, b, p0, speeds, status.
    x, y : ndarray, shapes (nx,), (ny,)
        Nodes [m]; y is None for a line contact.
    time, step : ndarray, shape (nt,)
        Times [s] and step numbers of the stored frames.
    fields, scalars : list of str
        Names of the fields stored in every frame, and of the scalars of every step.
    steps : Steps
        Scalars of every step, stored or not.
    contact_count : ndarray, shape (nx,) or (ny, nx)
        Time steps in contact over the whole run.
    """

    def __init__(self, file: h5py.File, path: Path) -> None:
        self._file, self.path = file, Path(path)
        self.attrs = attributes(file)
        self.time = file["time"][:]  # written last, as in Steps
        self._frames = len(self.time)
        self.step = file["step"][: self._frames]
        self.steps = Steps(file["steps"], path)
        self.scalars = self.steps.names
        datasets = {name: item for name, item in file.items() if isinstance(item, h5py.Dataset)}
        self.fields = [n for n, d in datasets.items() if d.ndim > 1 and n != "contact_count"]
        self.x, self.contact_count = file["x"][:], file["contact_count"][:]
        self.y = file["y"][:] if "y" in file else None

    def __enter__(self) -> Result:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def __getitem__(self, name: str) -> h5py.Dataset:
        """Dataset `name`, read on demand; after a killed run it may have rows beyond `time`."""
        if name not in self._file:
            raise OutputError(f"{self.path}: does not store {name}")
        return self._file[name]

    def __contains__(self, name: str) -> bool:
        return name in self._file

    def __getattr__(self, name: str) -> np.ndarray:
        if name not in self.__dict__.get("fields", ()):
            raise AttributeError(f"{name}: no field of this result")
        self.__dict__[name] = values = self[name][: self._frames]
        return values

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self.fields]

    def __repr__(self) -> str:
        nodes = " x ".join(str(len(axis)) for axis in (self.x, self.y) if axis is not None)
        size = f"{nodes} nodes, {len(self.time)} frames"
        return f"<Result {self.attrs['title']!r}: {size}, {self.attrs['status']}; {', '.join(self.fields)}>"

    @cached_property
    def case(self) -> Case:
        """Case as run, without its profile files."""
        from ehlpetsc.case.loading import stored_case

        try:
            return stored_case(self.attrs["case"])
        except CaseError as error:
            raise OutputError(f"{self.path}: {error.faults[0]}") from None

    def unit(self, name: str) -> str:
        """Unit of a dataset."""
        return self[name].attrs.get("units", "1")

    def to_xarray(self) -> Dataset:
        """Fields over (time, x) or (time, y, x), scalars over (step), with units, names, root attributes.

        The time at the end of each step is ``step_time``, the step of each frame ``frame_step``.

        Examples
        --------
        >>> import ehlpetsc
        >>> result = ehlpetsc.solve("cases/dry_hertz.toml", options={})
        >>> data = result.to_xarray()
        >>> data.pressure.dims, data.pressure.units, data.h_min.dims
        (('time', 'x'), 'Pa', ('step',))
        """
        import xarray

        def variable(dims: str | tuple, name: str, values: np.ndarray) -> Variable:
            attributes = {key: self[name].attrs[key] for key in ("units", "long_name")}
            return xarray.Variable(dims, values, attributes)

        axes = ("x",) if self.y is None else ("y", "x")
        fields = {name: variable(("time", *axes), name, getattr(self, name)) for name in self.fields}
        names = set(self.scalars) - {"step", "time"}
        scalars = {name: variable("step", f"steps/{name}", self.steps(name)) for name in names}
        return xarray.Dataset(
            fields | scalars | {"contact_count": variable(axes, "contact_count", self.contact_count)},
            {
                **{axis: variable(axis, axis, getattr(self, axis)) for axis in axes},
                "time": variable("time", "time", self.time),
                "frame_step": variable("time", "step", self.step),
                "step": variable("step", "steps/step", self.steps.step),
                "step_time": variable("step", "steps/time", self.steps.time),
            },
            dict(self.attrs),
        )

    def frame(self, name: str, index: int) -> np.ndarray:
        """Field `name` of one stored frame as float64; negative indices count from the end."""
        return self[name][range(len(self.time))[index]].astype(float)

    def roller(self, frame: int = -1) -> RollerLoads:
        """Loads along a roller in a stored frame; an OutputError for another contact."""
        from ehlpetsc.base.case import KINDS
        from ehlpetsc.physics.contact.roller_loads import RollerLoads
        from ehlpetsc.physics.scales import Scales

        if not KINDS[self.case.kind].has_ends or self.y is None:
            raise OutputError(f"{self.path}: no load along a roller, as this is a {self.attrs['kind']}")
        step = int(np.searchsorted(self.steps("step"), self.step[frame]))
        radius, tilt = (
            self.steps(name)[step] if name in self.scalars else None for name in ("radius", "tilt")
        )
        fields = self.frame("pressure", frame), self.frame("film_thickness", frame)
        return RollerLoads.of(Scales.of(self.case), radius or self.case.contact.radius, tilt or 0.0, *fields)

    def load_per_length(self, y: float | np.ndarray | None = None, frame: int = -1) -> np.ndarray:
        """Load per length of a roller [N/m] at y [m], linear between the rows; None: of all rows."""
        loads = self.roller(frame)
        return loads.w if y is None else np.interp(y, loads.y, loads.w)

    def section(self, y: float = 0.0) -> Result:
        """Row of a plane nearest to y [m], as the result of a line contact; an OutputError in a line contact.

        Scalars of the steps remain those of the whole contact.
        """
        return Section(self, y)

    def contacts_at(self, frames: int | slice, nodes: slice = slice(None)) -> np.ndarray:
        """Whether nodes are in contact; an OutputError if the result does not store it."""
        return self["in_contact"][frames, nodes].astype(bool)

    def nearest_frame(self, *, time: float | None = None, step: int | None = None) -> int:
        """Index of the stored frame nearest to a time [s] or to a step number."""
        value, stored = (time, self.time) if step is None else (step, self.step)
        return int(np.argmin(np.abs(stored - value)))

    def profile(self, surface: str) -> tuple[np.ndarray, np.ndarray, float] | None:
        """Roughness of surface "1" or "2" as ``(s, z, speed)``, z of a map (ny, ns); None if it is smooth."""
        name = f"surface/{surface}"
        if name not in self:
            return None
        return self[f"{name}/s"][:], self[f"{name}/z"][:], float(self._file[name].attrs["speed"])

    def export(self, path: str | PathLike, name: str, frame: int = -1, *, overwrite: bool = False) -> None:
        """Write a field of a stored frame, or heights ``surface/1`` over s, as .gsf, .x3p (heights) or .vti.

        `frame`: index; negative ones count from the end. `overwrite`: replace an existing file. An
        OutputError for other datasets, as scalars.
        """
        target = file_path(path)
        from ehlpetsc.results.exports import WRITERS, GridField

        check_derived(
            target, inputs_of_result(self.path, self.attrs.get("case", "")), tuple(WRITERS), "export"
        )
        if target.exists() and not overwrite:
            raise OutputError(f"{target}: exists; give another name, or overwrite=True to replace it")
        names = [*self.fields, *(side for side in ("surface/1", "surface/2") if side in self)]
        if name not in names:
            raise OutputError(f"{self.path}: {name}: no field of a frame; allowed: {', '.join(names)}")
        if name.startswith("surface/"):
            x, values, unit = self[f"{name}/s"][:], self[f"{name}/z"][:], "m"
        else:
            x, values, unit = self.x, self.frame(name, frame), self.unit(name)
        y = self.x[:2] if self.y is None else self.y
        dx, dy = (float(axis[1] - axis[0]) for axis in (x, y))
        origin = float(x[0]), 0.0 if self.y is None else float(y[0])
        field = GridField(np.atleast_2d(values), dx, dy, name.replace("/", "_"), unit, origin)
        atomic_write(target, WRITERS[target.suffix.lower()](field))


class Row:
    """Row of a dataset whose last but one dimension is y, indexed as a dataset without it."""

    def __init__(self, dataset: h5py.Dataset, row: int) -> None:
        self._dataset, self._row = dataset, row
        self.attrs, self.dtype = dataset.attrs, dataset.dtype
        self.shape = (*dataset.shape[:-2], dataset.shape[-1])
        self.ndim = len(self.shape)

    def __len__(self) -> int:
        return self.shape[0]

    def __getitem__(self, key: int | slice | np.ndarray | tuple) -> np.ndarray:
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
