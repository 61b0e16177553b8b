"""A post-processing result read back for the summary and the pictures."""

from copy import copy

import h5py
import numpy as np

from ehlpetsc.post.fatigue.statistics import WeibullFit

BOUNDS = tuple(f"{name}_{what}" for name in ("alpha", "beta") for what in ("likelihood", "low", "high"))


def _criteria(file, surfaces):
    found = {}
    for name, group in file.get("criteria", {}).items():
        kind = "utilisation" if name == "dang_van" else "damage"
        found[name.replace("_", "-")] = {surface: group[f"{surface}_{kind}"][:] for surface in surfaces}
    return found


class PostResult:
    """Everything of a result in memory.

    Attributes
    ----------
    s, z : ndarray
        Body points, m; depths z/a.
    surfaces : list of str
    main : str
        Surface of `height`, `under` and `fits`: that under the fixed names of the file.
    damage, complete : dict
        By surface, (nz, ns) and (ns,).
    profiles : dict
        (s, z), by rough surface.
    height : ndarray (n_peaks,)
    under : ndarray (nz, n_peaks)
        Damage under the asperity peaks.
    fits : list of WeibullFit, one a depth
    bounds : list of dict
        alpha and beta of the largest likelihood and their bounds, one a depth; empty in older results.
    criteria : dict
        By criterion, then surface: damage or utilisation (nz, ns).
    path, a, ratio, title, attrs
    """

    def __init__(self, path):
        self.path = path
        with h5py.File(path, "r") as file:
            self.attrs = dict(file.attrs)
            self.a, self.ratio = self.attrs["a"], self.attrs["slide_roll_ratio"]
            self.title = self.attrs["title"]
            damage = file["damage"]
            self.s, self.z, self.main = damage["s"][:], damage["z_over_a"][:], damage.attrs["surface"]
            self.surfaces = [name for name in ("slow", "fast") if name in damage]
            self.damage = {name: damage[name][:] for name in self.surfaces}
            self.complete = {name: damage[f"{name}_complete"][:].astype(bool) for name in self.surfaces}
            self.profiles = {
                name: (file[f"profile/{name}/s"][:], file[f"profile/{name}/z"][:])
                for name in self.surfaces
                if f"profile/{name}" in file
            }
            self.height, self.under = file["asperities/height"][:], file["asperities/damage"][:]
            weibull = file["weibull"]
            columns = (weibull[name][:] for name in WeibullFit._fields)
            self.bounds = [
                {name: weibull[name][k] for name in BOUNDS if name in weibull} for k in range(len(self.z))
            ]
            self.criteria = _criteria(file, self.surfaces)
            self.fits = [WeibullFit(*row) for row in zip(*columns, strict=True)]

    def shown_as(self, surface, values):
        """A copy whose damage of one surface is `values` (nz, ns)."""
        other = copy(self)
        other.damage = {**self.damage, surface: values}
        return other

    def largest(self, surface, depth):
        """Largest damage of a surface at depth number `depth`; nan if no point passed."""
        values = self.damage[surface][depth][self.complete[surface]]
        return values.max() if values.size else np.nan

    def worst_point(self, surface):
        """(s, z/a) of the largest damage."""
        values = np.nan_to_num(self.damage[surface], nan=-1.0)
        k, j = np.unravel_index(values.argmax(), values.shape)
        return self.s[j], self.z[k]
