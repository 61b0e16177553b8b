"""Reading result files: whole ones, ones being written, and ones a killed run left behind."""

import os
from pathlib import Path

import h5py
import numpy as np

from ehlpetsc.errors import OutputError
from ehlpetsc.results.hdf5.attributes import Attributes, plain
from ehlpetsc.results.hdf5.stored import Stored, reading

FORMAT_VERSION = 1
"""Version of the layout; a reader refuses files of a later one."""

ATTRIBUTES = {"title": str, "case": str, "status": str, "a": float, "p0": float, "u1": float, "u2": float}
CHECKED = 1024  # frames at a time
BEYOND = 2000  # times the size of a file: more numbers than its packed bytes can stand for


def open_for_reading(path, **options):
    """Open an HDF5 file that may still be written to, or that a killed writer left open.

    Further options are those of `h5py.File`.

    Raises
    ------
    OutputError
        No such file, or not one HDF5 can read.
    """
    if not Path(path).is_file():
        raise OutputError(f"{path}: no such file")
    try:
        return h5py.File(path, "r", swmr=_marked_as_being_written(path), **options)
    except (OSError, ValueError, RuntimeError) as fault:
        raise OutputError(f"{path}: not an HDF5 file, or a damaged one ({fault})") from fault


def _marked_as_being_written(path):
    """Whether a live or killed SWMR writer left its mark, which only a SWMR reader accepts.

    On other files, damaged ones among them, a SWMR reader may wait for ever for a writer to mend them.
    """
    with open(path, "rb") as raw:
        head = raw.read(12)
    return head.startswith(b"\x89HDF\r\n\x1a\n") and len(head) == 12 and head[8] >= 3 and bool(head[11] & 4)


def read_result(path):
    """Open a result file.

    Parameters
    ----------
    path : str or path-like

    Returns
    -------
    Result
        To be closed, or used in a ``with`` statement.

    Raises
    ------
    OutputError
        Missing, damaged, not a result file, or of a later format version.
    """
    return Result(open_result(path), path)


def open_result(path):
    """The HDF5 file of a result, checked to be one; for the errors see `read_result`."""
    file = open_for_reading(path)
    try:
        with reading(path):
            fault = _fault(file)
        if fault:
            raise OutputError(f"{path}: {fault}")
    except OutputError:
        file.close()
        raise
    return file


def _fault(file):
    """What keeps an HDF5 file from being a result; None: nothing."""
    version = file.attrs.get("format_version")
    if version is None or "x" not in file or "steps" not in file:
        return "an HDF5 file, but not a result of ehlpetsc"
    if not np.isscalar(version) or isinstance(version, str | bytes) or not version >= 1:
        return f"damaged: its format version is {plain(version)!r}"
    if version > FORMAT_VERSION:
        return f"format version {version}, this ehlpetsc reads up to {FORMAT_VERSION}: use a later ehlpetsc"
    for name, kind in ATTRIBUTES.items():
        value = plain(file.attrs.get(name, kind()))
        if not isinstance(value, kind if kind is str else (int, float, np.number)):
            return f"damaged: its attribute {name} is {value!r}"
        if kind is float and not np.isfinite(value):
            return f"damaged: its attribute {name} is {value}"
    for name in ("a", "p0"):
        if name in file.attrs and not file.attrs[name] > 0.0:
            return f"damaged: its attribute {name} is {file.attrs[name]}"
    return _fault_of_datasets(file)


def _fault_of_datasets(file):
    lost = [name for name in str(plain(file.attrs.get("contents", ""))).split() if name not in file]
    if lost:
        return f"damaged: {lost[0]} is missing"
    room = BEYOND * os.fstat(file.id.get_vfd_handle()).st_size
    for name in ("x", "contact_count", *(f"surface/{s}/{v}" for s in ("fast", "slow") for v in "sz")):
        if name in file and not (isinstance(file[name], h5py.Dataset) and (file[name].nbytes or 0) <= room):
            return f"damaged: {name} is no dataset, or has more numbers than the file can hold"
    nodes = file["x"].shape
    if nodes is None or len(nodes) != 1 or nodes[0] < 2:
        return f"damaged: x has the shape {nodes}"
    x = file["x"][:]
    if x.dtype.kind != "f" or not (np.isfinite(x).all() and (np.diff(x) > 0.0).all()):
        return "damaged: x are not increasing numbers"
    for name in ("time", "step", *(f"steps/{n}" for n in file["steps"]), *_two_dimensional(file)):
        item = file.get(name)
        if not isinstance(item, h5py.Dataset) or item.dtype.kind not in "fiu" or item.ndim not in (1, 2):
            return f"damaged: {name} is no row of numbers"
        if item.ndim == 2 and item.shape[1:] != nodes:
            return f"damaged: {name} has {item.shape[1]} nodes, x {nodes[0]}"
        if item.ndim == 2 and "/" in name:
            return f"damaged: {name} has the shape {item.shape}"
        if item.nbytes > room:
            return f"damaged: {name} has {item.shape[0]} rows, more than the file can hold"
    if file["contact_count"].shape != nodes or file["contact_count"].dtype.kind not in "iu":
        return "damaged: contact_count is no number for every node"
    return None


def _two_dimensional(file):
    return [name for name in file if isinstance(file.get(name), h5py.Dataset) and file[name].ndim == 2]


def _whole_rows(group):
    """Rows that a group's datasets share; its ``time`` is written last and so vouches for the rest."""
    rows = [d.shape[0] for d in group.values() if isinstance(d, h5py.Dataset) and d.maxshape[0] is None]
    return min(rows, default=0)


class Steps:
    """Figures of every step by name: ``steps.h_min``, ``steps("h_min")``; arrays of shape (nsteps,).

    Attributes
    ----------
    names : list of str
    """

    def __init__(self, group, count, path):
        self._group, self._count, self._path, self.names = group, count, path, list(group)

    def __call__(self, name):
        if name not in self.names:
            raise OutputError(f"{self._path}: has no figure {name} of its steps")
        with reading(self._path, f"steps/{name}"):
            return self._group[name][: self._count]

    def __getattr__(self, name):
        if name in self.__dict__.get("names", ()):
            return self(name)
        raise AttributeError(f"{name}: no figure of the steps; there are {', '.join(self.names)}")

    def __dir__(self):
        return [*super().__dir__(), *self.names]


class Result:
    """A result file, read lazily; each of its `fields` is also an attribute, shape (nt, nx), kept once read.

    Attributes
    ----------
    path : Path
    attrs : dict
        Root attributes: case text, provenance, a, p0, speeds, status.
    x : ndarray, shape (nx,)
        Nodes [m].
    time, step : ndarray, shape (nt,)
        Times [s] and step numbers of the stored frames.
    fields, figures : list of str
        Names of the fields stored in every frame, and of the figures of every step.
    steps : Steps
        Figures of every step, stored or not.
    contact_count : ndarray, shape (nx,)
        Time steps in contact over the whole run.
    """

    def __init__(self, file, path):
        self._file, self._read = file, {}
        self.path = Path(path)
        self.attrs = Attributes(file, path)
        with reading(path):
            # a killed writer may have lengthened some datasets and not yet others
            self._frames = _whole_rows(file)
            self.steps = Steps(file["steps"], _whole_rows(file["steps"]), path)
            self.fields = [n for n, d in file.items() if isinstance(d, h5py.Dataset) and d.ndim == 2]
        self.figures = self.steps.names
        self.x, self.contact_count = self["x"][:], self["contact_count"][:]
        self.time, self.step = self["time"][: self._frames], self["step"][: self._frames]
        for times in (self.time, self.steps("time")):
            if not (np.isfinite(times).all() and (np.diff(times) >= 0.0).all()):
                raise OutputError(f"{path}: damaged, its times do not increase")

    def __enter__(self):
        return self

    def __exit__(self, *exception):
        self.close()

    def close(self):
        """Close the file."""
        self._file.close()

    def __getitem__(self, name):
        """The dataset `name`, not read yet; after a killed run it may have rows beyond `time`."""
        with reading(self.path, name):
            if not isinstance(self._file.get(name), h5py.Dataset):
                raise OutputError(f"{self.path}: does not store {name}")
            return Stored(self._file[name], self.path)

    def __contains__(self, name):
        return name in self._file

    def __getattr__(self, name):
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
        """Fields over (time, x) and figures over (step), with units, long names and the root attributes.

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
            about = {key: self[name].attrs[key] for key in ("units", "long_name")}
            return xarray.Variable(dims, values, about)

        fields = {name: variable(("time", "x"), name, getattr(self, name)) for name in self.fields}
        names = set(self.figures) - {"step", "time"}
        figures = {name: variable("step", f"steps/{name}", self.steps(name)) for name in names}
        return xarray.Dataset(
            fields | figures | {"contact_count": variable("x", "contact_count", self.contact_count)},
            {
                "x": variable("x", "x", self.x),
                "time": variable("time", "time", self.time),
                "frame_step": variable("time", "step", self.step),
                "step": variable("step", "steps/step", self.steps.step),
                "step_time": variable("step", "steps/time", self.steps.time),
            },
            dict(self.attrs),
        )

    def check(self):
        """Read everything once; OutputError where something is damaged."""
        for name in ["step", *self.fields]:
            for begin in range(0, self._frames, CHECKED):
                self[name][begin : min(begin + CHECKED, self._frames)]
        for name in self.figures:
            self.steps(name)

    def frame(self, name, index):
        """Field `name` of one stored frame as float64, shape (nx,); negative indices count from the end."""
        return self[name][range(len(self.time))[index]].astype(float)

    def nearest_frame(self, *, time=None, step=None):
        """Index of the stored frame nearest to a time [s] or to a step number."""
        wanted, stored = (time, self.time) if step is None else (step, self.step)
        return int(np.argmin(np.abs(stored - wanted)))

    def contact_rate(self):
        """Contacts per millisecond at each node, Q of Holmes et al. 2005, figure 7; shape (nx,).

        One time step in contact counts as one contact, so that Q grows as the time step falls.

        Raises
        ------
        OutputError
            The run has lasted no time: a steady one.
        """
        lasted = np.nansum(self.steps("dt"))
        if not lasted > 0.0:
            raise OutputError(f"{self.path}: a steady solution has no contacts per millisecond")
        return self.contact_count / (1e3 * lasted)

    def profile(self, surface):
        """Roughness of surface "fast" or "slow" as ``(s, z, speed)``; None if it was smooth."""
        name = f"surface/{surface}"
        with reading(self.path, name):
            if name not in self._file:
                return None
            speed = float(self._file[name].attrs["speed"])
        return self[f"{name}/s"][:], self[f"{name}/z"][:], speed
