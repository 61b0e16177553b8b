"""Results of post-processing, ``RESULT.post.h5``: the table of their datasets, and their reader."""

from __future__ import annotations

import copy
import math
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ehlpetsc.base.errors import OutputError
from ehlpetsc.results.hdf5_file import attributes, open_for_reading

if TYPE_CHECKING:
    from ehlpetsc.results.reader import Result

UPPER_FIRST = ("2", "1")
DAMAGED = 0.1  # damage from which a point counts as damaged
SMOOTH_SHARE = 0.1  # of the damage of a point: more by the smooth contact is not damage of asperities
COMPARED = {  # name in files: quantity that compares points
    "fatemi_socie": "damage",
    "dang_van": "utilisation",
}


def is_damaged(damage: np.ndarray, smooth: np.ndarray) -> np.ndarray:
    """Whether points are damaged by asperities: D above `DAMAGED`, less than a tenth of it by the smooth
    contact.

    A mirror has no such point, whatever the depths.

    `smooth`: damage of the same depths and passes under the smooth contact.
    """
    return (damage > DAMAGED) & (smooth < SMOOTH_SHARE * damage)


class SmoothContact(NamedTuple):
    """Damage of a pass under the smooth contact of a case, see :mod:`ehlpetsc.post.smooth_contact`.

    `depths`: equally spaced from 0 on [m], shape (n,). `damage`: of a pass, shape (n,).
    """

    depths: np.ndarray
    damage: np.ndarray

    @property
    def life(self) -> float:
        """Passes until D = 1 at the worst depth; inf without damage."""
        return 1.0 / self.damage.max() if self.damage.any() else math.inf

    @property
    def depth(self) -> float:
        """Worst depth, the vertex of the parabola through three depths [m]."""
        k = int(np.clip(self.damage.argmax(), 1, len(self.depths) - 2))
        above, at, below = self.damage[k - 1 : k + 2]
        bend = above - 2.0 * at + below
        step = 0.5 * (above - below) / bend if bend < 0.0 else 0.0
        return float(self.depths[k] + np.clip(step, -1.0, 1.0) * (self.depths[1] - self.depths[0]))

    def damage_at(self, depths: np.ndarray) -> np.ndarray:
        """Damage of a pass at depths [m], interpolated; below the last depth that of the last."""
        return np.interp(depths, self.depths, self.damage)


class Dataset(NamedTuple):
    """Unit, meaning and axes of a dataset: z depths, s body points, peak asperities, node of a profile."""

    unit: str
    text: str
    axes: str

    def axes_of(self, count: int) -> list[str]:
        """Axes of an array with `count` of them: one more, y across, in a plane."""
        axes = self.axes.split()
        return axes if count == len(axes) else [*axes[:-1], "y", axes[-1]]


NOT_PASSED = "nan where a point did not pass the whole contact"
DATASETS = {  # {n}: surface; {criterion}: as in CRITERIA
    "damage/s": Dataset("m", "body coordinate, x = s + distance travelled", "s"),
    "damage/y": Dataset("m", "position across the contact", "y"),
    "damage/z_over_a": Dataset("1", "depth over half-width", "z"),
    "damage/{n}": Dataset("1", f"fatigue damage of one pass; {NOT_PASSED}", "z s"),
    "damage/{n}_cycles": Dataset("1", "counted cycles of a pass", "z s"),
    "damage/{n}_peak_range": Dataset("Pa", "largest equivalent stress range", "z s"),
    "damage/{n}_complete": Dataset("1", "1 where a point entered and left the domain", "s"),
    "asperities/{n}_s": Dataset("m", "body coordinate of asperity peaks", "peak"),
    "asperities/{n}_y": Dataset("m", "position of asperity peaks across the contact", "peak"),
    "asperities/{n}_height": Dataset("m", "height of asperity peaks", "peak"),
    "asperities/{n}_damage": Dataset("1", "damage under asperity peaks, at the nearest body point", "z peak"),
    "criteria/{criterion}/{n}_damage": Dataset("1", "damage of one pass on the worst plane", "z s"),
    "criteria/{criterion}/{n}_inclination": Dataset("degrees", "worst plane's normal, from x to z", "z s"),
    "criteria/{criterion}/{n}_tilt": Dataset("degrees", "worst plane's normal, out of the section", "z s"),
    "criteria/{criterion}/{n}_utilisation": Dataset("1", "of the fatigue limit; to 1 no crack starts", "z s"),
    "weibull/{n}_alpha": Dataset("1", "Weibull scale of -log10 of the damage under asperities", "z"),
    "weibull/{n}_beta": Dataset("1", "Weibull shape", "z"),
    "weibull/{n}_r_squared": Dataset("1", "squared correlation of the median rank regression", "z"),
    "weibull/{n}_likely_alpha": Dataset("1", "Weibull scale by maximum likelihood", "z"),
    "weibull/{n}_likely_beta": Dataset("1", "Weibull shape by maximum likelihood", "z"),
    "weibull/{n}_alpha_bounds": Dataset("1", "90 % confidence bounds of the scale", "z bound"),
    "weibull/{n}_beta_bounds": Dataset("1", "90 % confidence bounds of the shape", "z bound"),
    "weibull/{n}_at_least_one": Dataset("1", "asperities with damage of 1 or more", "z"),
    "weibull/{n}_undamaged": Dataset("1", "asperities without damage, censored in the fit", "z"),
    "smooth/depth": Dataset("m", "depth below the smooth contact", "depth"),
    "smooth/damage/{n}": Dataset("1", "damage of one pass under the smooth contact", "depth"),
    "smooth/criteria/{criterion}/{n}_damage": Dataset("1", "the same on the worst plane", "depth"),
    "temperature/{n}_highest": Dataset("K", f"highest surface temperature in one pass; {NOT_PASSED}", "s"),
    "temperature/{n}_mean": Dataset("K", "surface temperature, mean over the time in the Hertz contact", "s"),
    "temperature/{n}_flash": Dataset("K", "flash temperature: the highest over that of the body", "s"),
    "profile/{n}_s": Dataset("m", "body coordinate", "node"),
    "profile/{n}_z": Dataset("m", "profile height, positive out of the metal", "node"),
}


class WeibullFit(NamedTuple):
    """Scale alpha, shape beta and squared correlation of the fitted line."""

    alpha: float
    beta: float
    r_squared: float


class PointTemperatures(NamedTuple):
    """Surface temperatures [K] of body points in one pass: highest, mean in the Hertz contact, flash."""

    highest: np.ndarray
    mean: np.ndarray
    flash: np.ndarray


def post_path(path: str | Path) -> Path:
    """``RESULT.post.h5`` in the folder of ``RESULT.h5``."""
    path = Path(path)
    return path.parent / f"{path.stem}.post.h5"


def stored_names(*surfaces: str) -> dict[str, Dataset]:
    """The datasets that a result may have of surfaces, by name in the file."""
    return {
        key.format(n=surface, criterion=criterion): dataset
        for surface in surfaces
        for key, dataset in DATASETS.items()
        for criterion in (COMPARED if "{criterion}" in key else ("",))
    }


class PostResult:
    """Result of post-processing in memory.

    Attributes
    ----------
    a, ratio
        Half-width [m], slide/roll ratio.
    main, height, under
        Surface whose asperities are evaluated; their heights [m], the damage under them, shape (nz, peaks).
    s, z
        Body points [m]; depths z/a.
    y
        Positions across the contact [m]; None for a line contact. Arrays over s then have the shape
        (..., ny, ns).
    section_y
        Position of a section of a plane [m], otherwise None.
    surfaces
        Surfaces with damage.
    damage, complete
        By surface, shapes (nz, ns) and (ns,).
    profiles
        (s, z) by rough surface.
    criteria
        By criterion, then surface: damage or utilisation (nz, ns).
    temperatures
        By surface; empty of a run without [heat].
    smooth
        Smooth contact by criterion, None of the default damage, then surface.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = path = Path(path)
        with open_for_reading(path) as file:
            if "damage/s" not in file:
                raise OutputError(f"{path}: not a result of post-processing")
            self.attrs = attributes(file)
            self._arrays = {name: file[name][:] for name in stored_names(*UPPER_FIRST) if name in file}
        self.section_y: float | None = None
        self._assign()

    def _assign(self) -> None:
        """Set the attributes that are stored arrays."""
        named = ("a", "slide_roll_ratio", "surface")
        self.a, self.ratio, self.main = (self.attrs.get(name) for name in named)
        asperities = (f"asperities/{self.main}_{name}" for name in ("height", "damage"))
        self.height, self.under = map(self._arrays.get, asperities)
        self.s, self.z = self._arrays["damage/s"], self._arrays["damage/z_over_a"]
        self.y = self._arrays.get("damage/y")
        self.damage = self._of_surfaces("damage/{n}")
        self.surfaces = list(self.damage)
        passed = self._of_surfaces("damage/{n}_complete")
        self.complete = {side: values.astype(bool) for side, values in passed.items()}
        heights = self._of_surfaces("profile/{n}_z")
        self.profiles = {side: (s, heights[side]) for side, s in self._of_surfaces("profile/{n}_s").items()}
        columns = [self._of_surfaces(f"temperature/{{n}}_{name}") for name in PointTemperatures._fields]
        self.temperatures = {
            side: PointTemperatures(*(column[side] for column in columns)) for side in columns[0]
        }
        self.criteria = {
            name.replace("_", "-"): found
            for name, kind in COMPARED.items()
            if (found := self._of_surfaces(f"criteria/{name}/{{n}}_{kind}"))
        }

        depths = self._arrays.get("smooth/depth")
        names: dict[str | None, str] = {None: "smooth/damage/{n}"}
        names |= {key.replace("_", "-"): f"smooth/criteria/{key}/{{n}}_damage" for key in COMPARED}
        self.smooth = {
            name: {side: SmoothContact(depths, values) for side, values in found.items()}
            for name, place in names.items()
            if (found := self._of_surfaces(place))
        }

    def _of_surfaces(self, name: str) -> dict[str, np.ndarray]:
        """Stored arrays of a name with {n} by surface."""
        names = {side: name.format(n=side) for side in UPPER_FIRST}
        return {side: self._arrays[key] for side, key in names.items() if key in self._arrays}

    @property
    def fits(self) -> list[WeibullFit]:
        """Weibull distribution of `under`, one a depth."""
        columns = [self._arrays[f"weibull/{self.main}_{name}"] for name in WeibullFit._fields]
        return [WeibullFit(*map(float, row)) for row in zip(*columns, strict=True)]

    def section(self, y: float) -> PostResult:
        """Result along x in the row of a plane nearest to y [m], as that of a line contact."""
        if self.y is None:
            raise OutputError(f"{self.path}: a line contact has no sections")
        row, table = int(np.argmin(np.abs(self.y - y))), stored_names(*UPPER_FIRST)
        one = copy.copy(self)
        one.section_y, one._arrays = float(self.y[row]), {}
        for name, values in self._arrays.items():
            axes = table[name].axes_of(values.ndim)
            if axes != ["y"]:
                one._arrays[name] = values.take(row, axes.index("y")) if "y" in axes else values
        one._assign()
        return one

    def passed(self, surface: str, criterion: str | None = None) -> np.ndarray:
        """Damage (nz, points), or that of a criterion, of the points that passed the whole contact."""
        values = (self.criteria[criterion] if criterion else self.damage)[surface]
        return values[..., self.complete[surface]].reshape(len(self.z), -1)

    def worst_point(self, surface: str) -> tuple[float, float]:
        """(s, z/a) of the largest damage."""
        k, *_, j = self._worst(surface)
        return self.s[j], self.z[k]

    def worst_row(self, surface: str) -> float:
        """y [m] of the largest damage of a plane."""
        return self.y[self._worst(surface)[1]]

    def _worst(self, surface: str) -> tuple:
        values = np.nan_to_num(self.damage[surface], nan=-1.0)
        return np.unravel_index(values.argmax(), values.shape)


def damage_beside(result: Result) -> PostResult | None:
    """Post-processing result of a result, ``RESULT.post.h5``; None if it is missing or of another case."""
    path = post_path(result.path)
    if not path.exists():
        return None
    post = PostResult(path)
    return post if post.attrs["case"] == result.attrs["case"] else None
