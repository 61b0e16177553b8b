"""The loads in a result file, read a few frames at a time, and what makes a file unfit for damage."""

from pathlib import Path

import h5py
import numpy as np

from ehlpetsc.errors import PostError
from ehlpetsc.post.stresses.half_plane import spacing

FORMAT_VERSION = 1
CACHE = 32 << 20  # bytes of chunks kept a dataset
SURFACES = ("slow", "fast")


def _open(path):
    if not Path(path).is_file():
        raise PostError("no such file")
    try:
        return h5py.File(path, "r", rdcc_nbytes=CACHE)
    except OSError as plain:
        try:  # a killed writer leaves the file marked as being written
            return h5py.File(path, "r", swmr=True, rdcc_nbytes=CACHE)
        except (OSError, ValueError):
            raise PostError(f"not an HDF5 file, or a truncated one ({plain})") from None


class Loads:
    """Pressure and wall shear over stored frames.

    Attributes
    ----------
    x : ndarray (nx,), m
    time : ndarray (nt,), s
    dx, a, p0 : float
    speeds : dict
        m/s, by surface.
    profiles : dict
        (s, z) sorted by s, or None where the surface is smooth.
    case, title, status : str
    every : int
        Steps between stored frames.

    Raises
    ------
    PostError
        Not a result file, a dataset or attribute missing, nodes not uniform, times that do not increase.
    """

    def __init__(self, path):
        self.path = Path(path)
        self._file = _open(path)
        try:
            self._read_head()
        except OSError as fault:
            raise PostError(f"damaged: {fault}") from None

    def __enter__(self):
        return self

    def __exit__(self, *exception):
        self._file.close()

    def _read_head(self):
        attrs = self._file.attrs
        missing = [name for name in ("case", "a", "p0", "u1", "u2") if name not in attrs]
        if missing:
            raise PostError(f"no attribute {', '.join(missing)}: not a result file of ehlpetsc")
        if attrs.get("format_version", 1) > FORMAT_VERSION:
            raise PostError(f"format version {attrs['format_version']}: written by a later ehlpetsc")
        self.case, self.title = _text(attrs["case"]), _text(attrs.get("title", ""))
        self.status = _text(attrs.get("status", "unknown"))
        self.a, self.p0, fast, slow = (self._number(name) for name in ("a", "p0", "u1", "u2"))
        self.speeds = {"fast": fast, "slow": slow}
        self.x = self._dataset("x")[:]
        try:
            self.dx = spacing(self.x)
        except ValueError as fault:
            raise PostError(f"dataset x: {fault}") from None
        self._read_times()
        self.profiles = {surface: self._profile(surface) for surface in SURFACES}

    def _read_times(self):
        fields = [
            self._file[name]
            for name in ("pressure", "shear_stress_slow", "shear_stress_fast")
            if name in self._file
        ]
        frames = min([self._dataset("time").shape[0]] + [field.shape[0] for field in fields])
        time = self._dataset("time")[:frames]
        while len(time) > 1 and time[-1] == 0:  # lengthened but never filled by a killed writer
            time = time[:-1]
        if not np.isfinite(time).all() or (np.diff(time) <= 0).any():
            raise PostError("dataset time: does not increase from frame to frame")
        self.time = time
        steps = self._file["step"][: len(time)] if "step" in self._file else np.arange(len(time))
        self.every = int(np.median(np.diff(steps))) if len(time) > 1 else 1

    def _number(self, name):
        try:
            value = float(self._file.attrs[name])
        except (TypeError, ValueError):
            value = np.nan
        if not np.isfinite(value) or name in ("a", "p0") and value <= 0:
            raise PostError(f"attribute {name} = {self._file.attrs[name]}: not a width, pressure or speed")
        return value

    def _dataset(self, name):
        found = self._file.get(name)
        if not isinstance(found, h5py.Dataset):
            advice = ""
            if name == "pressure" or name.startswith("shear_stress"):
                advice = f': list "{name}" in output.fields of the case and run it again'
            raise PostError(f"no dataset {name}{advice}")
        return found

    def _profile(self, surface):
        group = self._file.get(f"surface/{surface}")
        if group is None:
            return None
        if "s" not in group or "z" not in group:
            raise PostError(f"no dataset surface/{surface}/{'z' if 's' in group else 's'}")
        s, z = group["s"][:], group["z"][:]
        order = np.argsort(s)
        return s[order], z[order]

    def check(self, surfaces):
        """Raise PostError if a load that `surfaces` need is not there, or not (frames, nodes)."""
        for name in ("pressure", *(f"shear_stress_{surface}" for surface in surfaces)):
            if self._dataset(name).shape[1:] != self.x.shape:
                raise PostError(f"dataset {name}: its rows do not have one value a node of x")

    def read(self, surface, first, last):
        """Pressure and traction in +x on the solid of `surface` in frames first .. last-1, float64, Pa."""
        return (self._finite("pressure", first, last), self._finite(f"shear_stress_{surface}", first, last))

    def _finite(self, name, first, last):
        try:
            rows = self._dataset(name)[first:last].astype(float, copy=False)
        except OSError as fault:
            raise PostError(f"dataset {name}: frames {first} to {last - 1} cannot be read: {fault}") from None
        if not np.isfinite(rows).all():
            frame, node = np.argwhere(~np.isfinite(rows))[0]
            raise PostError(
                f"{name} is {rows[frame, node]} at frame {first + frame} "
                f"(t = {self.time[first + frame]:.6g} s), x/a = {self.x[node] / self.a:.4g}"
            )
        return rows


def _text(value):
    return value.decode() if isinstance(value, bytes) else str(value)
