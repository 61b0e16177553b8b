"""Results of post-processing, ``RESULT.post.h5``, for summaries, pictures and indices."""

from copy import copy
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ehlpetsc.errors import OutputError
from ehlpetsc.names import current_name, stored_name
from ehlpetsc.results.hdf5.attributes import Attributes
from ehlpetsc.results.hdf5.lazy_dataset import reading
from ehlpetsc.results.hdf5.opening import open_for_reading

SURFACES = ("2", "1")
BOUNDS = tuple(f"{name}_{kind}" for name in ("alpha", "beta") for kind in ("likelihood", "low", "high"))


class WeibullFit(NamedTuple):
    """Scale alpha, shape beta and squared correlation of the fitted line."""

    alpha: float
    beta: float
    r_squared: float


class PointTemperatures(NamedTuple):
    """Surface temperatures of body points in one pass, (ns,) [K]; nan for points that did not pass.

    Attributes
    ----------
    highest : ndarray
    mean : ndarray
        Mean over the time inside the Hertz contact.
    flash : ndarray
        Highest temperature minus that of the body.
    """

    highest: np.ndarray
    mean: np.ndarray
    flash: np.ndarray


def post_path(path):
    """``RESULT.post.h5`` in the folder of ``RESULT.h5``."""
    path = Path(path)
    return path.with_name(f"{path.stem}.post.h5")


class PostResult:
    """Result of post-processing in memory; data missing in an older file are empty.

    Attributes
    ----------
    s, z : ndarray
        Body points, m; depths z/a.
    surfaces : list of str
    main : str
        Surface of `height`, `under` and `fits`.
    damage, complete : dict
        By surface, (nz, ns) and (ns,).
    profiles : dict
        (s, z), by rough surface.
    height : ndarray (n_peaks,)
    under : ndarray (nz, n_peaks)
        Damage under the asperity peaks.
    fits : list of WeibullFit, one a depth
    bounds : list of dict
        alpha and beta of the largest likelihood and their bounds, one a depth.
    criteria : dict
        By criterion, then surface: damage or utilisation (nz, ns).
    temperatures : dict
        PointTemperatures by surface; empty of a run without [heat].
    path, a, ratio, title, attrs

    Raises
    ------
    OutputError
        No such file, damaged, or not a result of post-processing.
    """

    def __init__(self, path):
        self.path = path
        with open_for_reading(path) as file, reading(path):
            if "damage/s" not in file:
                raise OutputError(f"{path}: not a result of post-processing")
            self.attrs = Attributes(file, path)
            self._read(file)

    def _read(self, file):
        self.a, self.ratio = float(self.attrs["a"]), self.attrs.get("slide_roll_ratio", np.nan)
        self.title = self.attrs.get("title", "")
        damage = file["damage"]
        self.s, self.z = damage["s"][:], damage["z_over_a"][:]
        self.surfaces = [name for name in SURFACES if stored_name(damage, name) in damage]
        main = Attributes(damage, self.path).get("surface", next(iter(self.surfaces), None))
        self.main = main and current_name(main)
        self.damage = {name: damage[stored_name(damage, name)][:] for name in self.surfaces}
        self.complete = {
            name: _array(damage, f"{name}_complete", ~np.isnan(values[0])).astype(bool)
            for name, values in self.damage.items()
        }
        self.profiles = {
            name: tuple(file[f"{group}/{axis}"][:] for axis in "sz")
            for name in self.surfaces
            if (group := stored_name(file, f"profile/{name}")) in file
        }
        none = np.empty((len(self.z), 0))
        self.height = _array(file, "asperities/height", none[0])
        self.under = _array(file, "asperities/damage", none)
        self.fits, self.bounds = [], []
        if "weibull" in file:
            group = file["weibull"]
            columns = [group[name][:] for name in WeibullFit._fields]
            self.fits = [WeibullFit(*row) for row in zip(*columns, strict=True)]
            self.bounds = [{n: group[n][k] for n in BOUNDS if n in group} for k in range(len(self.z))]
        heat = file.get("temperature", {})
        self.temperatures = {
            side: PointTemperatures(*(heat[f"{side}_{name}"][:] for name in PointTemperatures._fields))
            for side in self.surfaces
            if f"{side}_flash" in heat
        }
        self.criteria = {}
        for name, group in file.get("criteria", {}).items():
            kind = "utilisation" if name == "dang_van" else "damage"
            self.criteria[name.replace("_", "-")] = {
                side: group[stored_name(group, f"{side}_{kind}")][:] for side in self.surfaces
            }

    def with_damage(self, surface, values):
        """A copy whose damage of one surface is `values` (nz, ns)."""
        other = copy(self)
        other.damage = {**self.damage, surface: values}
        return other

    def passed(self, surface):
        """Damage (nz, points) of the points that passed the whole contact; empty if not computed."""
        if surface not in self.damage:
            return np.empty((len(self.z), 0))
        return self.damage[surface][:, self.complete[surface]]

    def largest(self, surface, depth):
        """Largest damage of a surface at depth number `depth`; nan if no point passed."""
        return self.passed(surface)[depth].max(initial=-np.inf) if self.complete[surface].any() else np.nan

    def summary(self):
        """Depths, and for each surface the maximum and median damage at each depth.

        With [heat] also the maximum flash temperature [K].
        """
        summary = {"z_over_a": self.z.tolist()}
        for side in self.surfaces:
            values = self.passed(side)
            if values.size:
                largest, median = values.max(axis=1), np.median(values, axis=1)
                summary[side] = {"largest": largest.tolist(), "median": median.tolist()}
                if side in self.temperatures:
                    summary[side]["flash_temperature"] = float(np.nanmax(self.temperatures[side].flash))
        return summary

    def worst_point(self, surface):
        """(s, z/a) of the largest damage."""
        values = np.nan_to_num(self.damage[surface], nan=-1.0)
        k, j = np.unravel_index(values.argmax(), values.shape)
        return self.s[j], self.z[k]


def _array(file, name, default):
    name = stored_name(file, name)
    return file[name][:] if name in file else default


def damage_beside(result):
    """Post-processing result of a result, ``RESULT.post.h5``; None if it is missing or of another case.

    Parameters
    ----------
    result : ehlpetsc.results.reader.Result

    Returns
    -------
    PostResult or None
    """
    path = post_path(result.path)
    if not path.exists():
        return None
    post = PostResult(path)
    return post if post.attrs["case"] == result.attrs["case"] else None
