"""Reading of result files, complete or left by a killed run: fields and scalars by name."""

from functools import cached_property
from pathlib import Path

import h5py
import numpy as np

from ehlpetsc.case.loading import Case, stored_case
from ehlpetsc.errors import CaseError, OutputError
from ehlpetsc.names import current_name, stored_name
from ehlpetsc.results.hdf5.attributes import Attributes
from ehlpetsc.results.hdf5.lazy_dataset import LazyDataset, reading
from ehlpetsc.results.hdf5.opening import open_result

FRAMES_PER_BLOCK = 1024  # read at once
NODE_DATASETS = ("x", "contact_count")  # without a time axis


def read_result(path, **options):
    """Open a result file as `Result`, to be closed or used in a ``with`` statement.

    Options are those of `h5py.File`, errors those of `open_result`.
    """
    return Result(open_result(path, **options), path)


def _complete_rows(group, path):
    """Number of complete rows of a group, whose ``time`` is written last."""
    rows = [d for n, d in group.items() if isinstance(d, h5py.Dataset) and n not in NODE_DATASETS]
    for dataset in rows:
        if not dataset.shape:
            raise OutputError(f"{path}: {dataset.name.lstrip('/')}: damaged, it has no rows")
    return min((dataset.shape[0] for dataset in rows), default=0)


class Steps:
    """Scalars of every step by name: ``steps.h_min``, ``steps("h_min")``; arrays of shape (nsteps,).

    Attributes
    ----------
    names : list of str
    """

    def __init__(self, group, count, path):
        self._group, self._count, self._path = group, count, path
        self.names = [current_name(name) for name in group]

    def __call__(self, name):
        if current_name(name) not in self.names:
            raise OutputError(f"{self._path}: has no scalar {name} of its steps")
        with reading(self._path, f"steps/{name}"):
            return self._group[stored_name(self._group, name)][: self._count]

    def __getattr__(self, name):
        if current_name(name) in self.__dict__.get("names", ()):
            return self(name)
        raise AttributeError(f"{name}: no scalar of the steps; there are {', '.join(self.names)}")

    def __dir__(self):
        return [*super().__dir__(), *self.names]


class Result:
    """Result file, read lazily; each of the `fields` is also an attribute, shape (nt, nx).

    Attributes
    ----------
    path : Path
    attrs : dict
        Root attributes: case text, provenance, a, p0, speeds, status.
    x : ndarray, shape (nx,)
        Nodes [m].
    time, step : ndarray, shape (nt,)
        Times [s] and step numbers of the stored frames.
    fields, scalars : list of str
        Names of the fields stored in every frame, and of the scalars of every step.
    steps : Steps
        Scalars of every step, stored or not.
    contact_count : ndarray, shape (nx,)
        Time steps in contact over the whole run.
    """

    def __init__(self, file, path):
        self._file, self._read = file, {}
        self.path = Path(path)
        self.attrs = Attributes(file, path)
        with reading(path):
            # a killed writer may have extended only some datasets
            self._frames = _complete_rows(file, path)
            self.steps = Steps(file["steps"], _complete_rows(file["steps"], path), path)
            datasets = {n: d for n, d in file.items() if isinstance(d, h5py.Dataset)}
            self.fields = [current_name(name) for name, dataset in datasets.items() if dataset.ndim == 2]
        self.scalars = self.steps.names
        self.x, self.contact_count = self["x"][:], self["contact_count"][:]
        self.time, self.step = self["time"][: self._frames], self["step"][: self._frames]
        for times in (self.time, self.steps("time")):
            if not (np.isfinite(times).all() and (np.diff(times) >= 0.0).all()):
                raise OutputError(f"{path}: damaged, its times do not increase")
        for steps in (self.step, self.steps("step")) if "step" in self.scalars else ():
            if not (np.diff(steps) > 0).all():
                raise OutputError(f"{path}: damaged, its numbers of steps do not increase")
        if "step" in self.scalars and not np.isin(self.step, self.steps("step")).all():
            raise OutputError(f"{path}: damaged, a frame is of a step that it does not have")

    def __enter__(self):
        return self

    def __exit__(self, *exception):
        self.close()

    def close(self):
        """Close the file."""
        self._file.close()

    def __getitem__(self, name):
        """Dataset `name`, read on demand; after a killed run it may have rows beyond `time`."""
        with reading(self.path, name):
            dataset = self._file.get(stored_name(self._file, name))
            if not isinstance(dataset, h5py.Dataset):
                raise OutputError(f"{self.path}: does not store {name}")
            return LazyDataset(dataset, self.path)

    def __contains__(self, name):
        return stored_name(self._file, name) in self._file

    def __getattr__(self, name):
        name = current_name(name)
        if name not in self.__dict__.get("fields", ()):
            raise AttributeError(f"{name}: no field of this result")
        if name not in self._read:
            self._read[name] = self[name][: self._frames]
        return self._read[name]

    def __dir__(self):
        return [*super().__dir__(), *self.fields]

    def __repr__(self):
        size = f"{len(self.x)} nodes, {len(self.time)} frames"
        return f"<Result {self.attrs['title']!r}: {size}, {self.attrs['status']}; {', '.join(self.fields)}>"

    def to_xarray(self):
        """Fields over (time, x) and scalars over (step), with units, long names and the root attributes.

        Returns
        -------
        xarray.Dataset
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

        def variable(dims, name, values):
            attributes = {key: self[name].attrs[key] for key in ("units", "long_name")}
            return xarray.Variable(dims, values, attributes)

        fields = {name: variable(("time", "x"), name, getattr(self, name)) for name in self.fields}
        names = set(self.scalars) - {"step", "time"}
        scalars = {name: variable("step", f"steps/{name}", self.steps(name)) for name in names}
        return xarray.Dataset(
            fields | scalars | {"contact_count": variable("x", "contact_count", self.contact_count)},
            {
                "x": variable("x", "x", self.x),
                "time": variable("time", "time", self.time),
                "frame_step": variable("time", "step", self.step),
                "step": variable("step", "steps/step", self.steps.step),
                "step_time": variable("step", "steps/time", self.steps.time),
            },
            dict(self.attrs),
        )

    @cached_property
    def case(self) -> Case:
        """Case as run, without its profile files."""
        try:
            return stored_case(self.attrs["case"])
        except CaseError as error:
            raise OutputError(f"{self.path}: {error.faults[0]}") from None

    def check(self):
        """Read all data once; OutputError if any is damaged."""
        for name in ["step", *self.fields]:
            for begin in range(0, self._frames, FRAMES_PER_BLOCK):
                self[name][begin : min(begin + FRAMES_PER_BLOCK, self._frames)]
        for name in self.scalars:
            self.steps(name)

    def frame(self, name, index):
        """Field `name` of one stored frame as float64, shape (nx,); negative indices count from the end."""
        return self[name][range(len(self.time))[index]].astype(float)

    def nearest_frame(self, *, time=None, step=None):
        """Index of the stored frame nearest to a time [s] or to a step number."""
        if (time is None) == (step is None):
            raise OutputError(f"{self.path}: nearest_frame needs either time or step")
        value, stored = (time, self.time) if step is None else (step, self.step)
        return int(np.argmin(np.abs(stored - value)))

    def contact_rate(self):
        """Contacts per millisecond at each node, Q of Holmes et al. 2005, figure 7; shape (nx,).

        Every time step in contact counts as one contact, so that Q increases as the time step decreases.

        Raises
        ------
        OutputError
            The run is steady.
        """
        duration = np.nansum(self.steps("dt"))
        if not duration > 0.0:
            raise OutputError(f"{self.path}: a steady solution has no contacts per millisecond")
        return self.contact_count / (1e3 * duration)

    def profile(self, surface):
        """Roughness of surface "1" or "2" as ``(s, z, speed)``; None if the surface is smooth."""
        name = f"surface/{surface}"
        with reading(self.path, name):
            name = stored_name(self._file, name)
            if name not in self._file:
                return None
            speed = float(self._file[name].attrs["speed"])
        return self[f"{name}/s"][:], self[f"{name}/z"][:], speed
