"""The loads in a result file, read a few frames at a time."""

from pathlib import Path

import h5py
import numpy as np

from ehlpetsc.errors import OutputError, PostError
from ehlpetsc.post.inputs.reading import in_words, reading, text
from ehlpetsc.post.stresses.half_plane import spacing
from ehlpetsc.results.hdf5.opening import FORMAT_VERSION, open_for_reading

CACHE = 32 << 20  # bytes of chunks kept a dataset
SURFACES = ("slow", "fast")
UNITS = {"x": "m", "time": "s", "step": "1", "pressure": "Pa", "s": "m", "z": "m"} | {
    f"shear_stress_{surface}": "Pa" for surface in SURFACES
}
MOST_VALUES = 10_000_000  # of a row: nodes, frames, points of a profile
FEWEST_NODES = 8  # the slopes between nodes take seven


class Loads:
    """Pressure and wall shear over stored frames.

    Attributes
    ----------
    x : ndarray (nx,), m
    time : ndarray (nt,), s
    step : ndarray (nt,) or None
        Numbers of the stored steps; None where the file does not say.
    dx, a, p0 : float
    speeds : dict
        m/s, by surface.
    profiles : dict
        (s, z) sorted by s, or None where the surface is smooth.
    profile_speeds : dict
        m/s, by surface, as the profiles have them.
    case, title, status : str

    Raises
    ------
    PostError
        Not a result file, a dataset or attribute missing or damaged, nodes not uniform, times that do not
        increase.
    """

    def __init__(self, path):
        self.path = Path(path)
        self._file = _open(path)
        self._framed = {}
        try:
            self._read_head()
        except BaseException:
            self._file.close()
            raise

    def __enter__(self):
        return self

    def __exit__(self, *exception):
        self._file.close()

    def _read_head(self):
        with reading("the root group"):
            names, datasets = set(self._file.attrs), set(self._file)
        if "damage" in datasets and "pressure" not in datasets:
            raise PostError("a result of post-processing, not of ehlpetsc: give the file it was made from")
        missing = [name for name in ("case", "a", "p0", "u1", "u2") if name not in names]
        if missing:
            raise PostError(f"no attribute {', '.join(missing)}: not a result file of ehlpetsc")
        version = self._number("format_version") if "format_version" in names else 1
        if version > FORMAT_VERSION:
            raise PostError(f"format version {version:g}: written by a later ehlpetsc")
        self.case = self._text("case")
        self.title = self._text("title") if "title" in names else ""
        self.status = self._text("status") if "status" in names else "unknown"
        self.a, self.p0, fast, slow = (self._number(name) for name in ("a", "p0", "u1", "u2"))
        for name, value in (("a", self.a), ("p0", self.p0)):
            if value <= 0:
                raise PostError(f"attribute {name} = {value:g}: must be above 0")
        self.speeds = {"fast": fast, "slow": slow}
        self._read_nodes()
        self._read_times()
        self.profile_speeds = {}
        self.profiles = {surface: self._profile(surface) for surface in SURFACES}

    def _read_nodes(self):
        self.x = self._row("x")
        if self.x.size < FEWEST_NODES:
            raise PostError(f"dataset x: {self.x.size} nodes, at least {FEWEST_NODES} are needed")
        try:
            self.dx = spacing(self.x)
        except ValueError as fault:
            raise PostError(f"dataset x: {fault}") from None

    def _read_times(self):
        names = ("pressure", "shear_stress_slow", "shear_stress_fast")
        frames = min(self._dataset(name).shape[0] for name in ("time", *names) if self._has(name))
        self._dataset("time", 1)
        time = self._row("time", frames)
        while len(time) > 1 and time[-1] == 0:  # lengthened but never filled by a killed writer
            time = time[:-1]
        if not np.isfinite(time).all() or (np.diff(time) <= 0).any():
            raise PostError("dataset time: does not increase from frame to frame")
        self.time, self.step = time, None
        if self._has("step"):
            step = self._row("step", len(time))
            if len(step) < len(time) or (np.diff(step) <= 0).any():
                raise PostError("dataset step: does not increase from frame to frame")
            self.step = step.astype(np.int64)

    def _text(self, name):
        with reading(f"attribute {name}"):
            value = self._file.attrs[name]
        return text(value, f"attribute {name}")

    def _number(self, name, item=None, place=""):
        what = f"attribute {name}{place}"
        with reading(what):
            value = (item or self._file).attrs[name]
        try:
            number = float(value)
        except (TypeError, ValueError):
            number = np.nan
        if not np.isfinite(number):
            raise PostError(f"{what} = {in_words(value)}: not a finite number")
        return number

    def _has(self, name):
        with reading(f"dataset {name}"):
            return name in self._file

    def _dataset(self, name, dimensions=None):
        """The dataset of real numbers `name`; refused if its type, dimensions, size or unit are wrong."""
        with reading(f"dataset {name}"):
            found = self._file[name] if name in self._file else None
            is_dataset = isinstance(found, h5py.Dataset)
            kind, shape = (found.dtype.kind, found.shape) if is_dataset else ("", ())
            units = found.attrs.get("units") if is_dataset else None
        if not is_dataset:
            advice = ""
            if name == "pressure" or name.startswith("shear_stress"):
                advice = f': list "{name}" in output.fields of the case and run it again'
            raise PostError(f"no dataset {name}{advice}")
        if kind not in "fiu":
            raise PostError(f"dataset {name}: does not hold real numbers")
        if not shape or dimensions and len(shape) != dimensions:
            raise PostError(f"dataset {name}: has {len(shape or ())} dimensions, not {dimensions or 'one'}")
        wanted = UNITS[name.rpartition("/")[2]]
        unit = wanted if units is None else text(units, f"dataset {name}, attribute units")
        if unit != wanted:
            raise PostError(f'dataset {name}: its unit is "{in_words(unit)}", it must be "{wanted}"')
        return found

    def _row(self, name, most=MOST_VALUES):
        """The first `most` values of a one-dimensional dataset, as float64."""
        found = self._dataset(name, 1)
        if min(found.shape[0], most + 1) > MOST_VALUES:
            raise PostError(f"dataset {name}: {found.shape[0]} values are more than can be meant")
        with reading(f"dataset {name}"):
            return found[:most].astype(float)

    def _profile(self, surface):
        place = f"surface/{surface}"
        with reading(f"group {place}"):
            group = self._file.get(place)
            is_there = {name: group is not None and name in group for name in ("s", "z")}
            has_speed = group is not None and "speed" in group.attrs
        if group is None:
            return None
        if not all(is_there.values()):
            raise PostError(f"no dataset {place}/{'z' if is_there['s'] else 's'}")
        s, z = (self._row(f"{place}/{name}") for name in ("s", "z"))
        if s.size != z.size or s.size < 2:
            raise PostError(f"datasets {place}/s and z: {s.size} and {z.size} values, not one height a place")
        for name, values in (("s", s), ("z", z)):
            if not np.isfinite(values).all():
                row = np.flatnonzero(~np.isfinite(values))[0]
                raise PostError(f"dataset {place}/{name} is {values[row]} at point {row}")
        if has_speed:
            self.profile_speeds[surface] = self._number("speed", group, f" of {place}")
        order = np.argsort(s)
        return s[order], z[order]

    def check(self, surfaces):
        """Raise PostError if a load that `surfaces` need is not there, or not (frames, nodes)."""
        for name in ("pressure", *(f"shear_stress_{surface}" for surface in surfaces)):
            if self._dataset(name).shape[1:] != self.x.shape:
                raise PostError(f"dataset {name}: its rows do not have one value a node of x")

    def read(self, surface, first, last):
        """Pressure and traction in +x on the solid of `surface` in frames first .. last-1, float64, Pa."""
        return self.rows("pressure", first, last), self.rows(f"shear_stress_{surface}", first, last)

    def rows(self, name, first, last):
        """Frames first .. last-1 of one dataset, float64."""
        with reading(f"dataset {name}, frames {first} to {last - 1}"):
            if name not in self._framed:  # kept open, and with it HDF5's cache of its chunks
                self._framed[name] = self._file[name]
            return self._framed[name][first:last].astype(float, copy=False)

    def of_steps(self, name):
        """Per-step figure ``steps/name`` at each stored frame; None where the file does not hold it."""
        if self.step is None:
            return None
        with reading(f"dataset steps/{name}"):
            group = self._file.get("steps")
            found = [group.get(n) if isinstance(group, h5py.Group) else None for n in ("step", name)]
            if not all(isinstance(d, h5py.Dataset) and d.ndim == 1 and d.dtype.kind in "fiu" for d in found):
                return None
            number, values = (d[:MOST_VALUES] for d in found)
        rows = np.searchsorted(number, self.step)
        if values.shape != number.shape or (rows >= number.size).any():
            return None
        return values[rows].astype(float) if (number[rows] == self.step).all() else None


def check_readable(path):
    """Refuse a file that cannot be read, before its output is looked at; PostError says why."""
    _open(path).close()


def _open(path):
    try:
        with reading("the file"):
            return open_for_reading(path, rdcc_nbytes=CACHE)
    except OutputError as fault:
        raise PostError(str(fault).removeprefix(f"{path}: ")) from None
