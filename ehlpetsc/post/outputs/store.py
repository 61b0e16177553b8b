"""The post-processing result: its layout, and the parts from which an interrupted run goes on."""

import hashlib
import json
import os
import shutil
from pathlib import Path

import h5py
import numpy as np

from ehlpetsc import __version__

FORMAT_VERSION = 1
DESCRIPTIONS = {
    "damage/s": ("m", "body coordinate, x = s + speed * time"),
    "damage/z_over_a": ("1", "depth over half width"),
    "damage/slow": (
        "1",
        "fatigue damage of one pass, slow surface; nan where a point did not pass the whole contact",
    ),
    "damage/fast": (
        "1",
        "fatigue damage of one pass, fast surface; nan where a point did not pass the whole contact",
    ),
    "damage/slow_complete": ("1", "1 where a point of the slow surface entered and left the domain"),
    "damage/fast_complete": ("1", "1 where a point of the fast surface entered and left the domain"),
    "damage/cycles": ("1", "counted cycles of a pass"),
    "damage/peak_range": ("Pa", "largest equivalent stress range"),
    "asperities/s": ("m", "body coordinate of asperity peaks"),
    "asperities/height": ("m", "height of asperity peaks"),
    "asperities/damage": ("1", "damage under asperity peaks, at the nearest body point"),
    "weibull/alpha": ("1", "Weibull scale of -log10 of damage"),
    "weibull/beta": ("1", "Weibull shape"),
    "weibull/r_squared": ("1", "squared correlation of the median rank regression"),
    "weibull/at_least_one": ("1", "asperities with damage of 1 or more"),
    "weibull/undamaged": ("1", "asperities without damage, censored in the fit"),
    "profile/s": ("m", "body coordinate"),
    "profile/z": ("m", "profile height, positive out of the metal"),
}


def fingerprint(path, *choices):
    """Mark of an input file and of what is asked of it; parts of another mark are not used."""
    stat = os.stat(path)
    text = json.dumps(
        [str(Path(path).resolve()), stat.st_size, stat.st_mtime_ns, __version__, choices], default=str
    )
    return hashlib.sha256(text.encode()).hexdigest()


class Parts:
    """Finished (surface, depth) results beside the output, each written whole and renamed into place."""

    def __init__(self, output, mark):
        self.folder = Path(f"{output}.parts")
        self.mark = mark
        if self.folder.is_dir() and self._stored_mark() != mark:
            shutil.rmtree(self.folder)
        self.folder.mkdir(parents=True, exist_ok=True)
        _write_whole(self.folder / "mark", lambda file: file.write(mark.encode()))

    def _stored_mark(self):
        mark = self.folder / "mark"
        return mark.read_text() if mark.is_file() else None

    def _path(self, surface, depth):
        return self.folder / f"{surface}_{depth:.9g}.npy"

    def load(self, surface, depth):
        """Array (points, 3) of damage, cycles, peak range, or None."""
        path = self._path(surface, depth)
        return np.load(path) if path.is_file() else None

    def save(self, surface, depth, values):
        """Store one depth."""
        _write_whole(self._path(surface, depth), lambda file: np.save(file, values))

    def remove(self):
        """Delete all parts, once the result holds them."""
        shutil.rmtree(self.folder, ignore_errors=True)


def _write_whole(path, write):
    beside = path.with_name(f"{path.name}.tmp{os.getpid()}")
    with open(beside, "wb") as file:
        write(file)
        file.flush()
        os.fsync(file.fileno())
    os.replace(beside, path)


def write_result(path, datasets, attrs, group_attrs):
    """Write the result beside `path` and rename it, so that a file under that name is whole.

    Parameters
    ----------
    path : path-like
    datasets : dict
        Name to array; names of a second surface have it before the last part, as in ``weibull/fast/alpha``.
    attrs, group_attrs : dict
        Root attributes; attributes by group name.
    """
    beside = f"{path}.tmp"
    with h5py.File(beside, "w") as file:
        file.attrs.update({"format_version": FORMAT_VERSION, **attrs})
        for name, values in datasets.items():
            units, long_name = DESCRIPTIONS[_plain(name)]
            file[name] = values
            file[name].attrs.update(units=units, long_name=long_name)
        for name, values in group_attrs.items():
            file.require_group(name).attrs.update(values)
        _scales(file)
    with open(beside, "rb") as file:
        os.fsync(file.fileno())
    os.replace(beside, path)


def _plain(name):
    """The name under which DESCRIPTIONS knows it: without the second surface."""
    group, *_, last = name.split("/")
    plain = f"{group}/{last}"
    return plain if plain in DESCRIPTIONS else f"{group}/{last.partition('_')[2]}"


def _scales(file):
    s, z = file["damage/s"], file["damage/z_over_a"]
    s.make_scale("s")
    z.make_scale("z_over_a")
    for dataset in file["damage"].values():
        if isinstance(dataset, h5py.Dataset) and dataset.ndim == 2:
            dataset.dims[0].attach_scale(z)
            dataset.dims[1].attach_scale(s)
        elif isinstance(dataset, h5py.Dataset) and dataset not in (s, z):
            dataset.dims[0].attach_scale(s)


def stored_mark(path):
    """Fingerprint of a finished result, or None."""
    try:
        with h5py.File(path, "r") as file:
            return file.attrs.get("fingerprint")
    except OSError:
        return None
