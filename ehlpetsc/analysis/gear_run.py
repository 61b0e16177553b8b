"""Gear runs along the path of contact: scalars of the steps, friction and losses, damage of both flanks."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ehlpetsc.base.errors import CaseError
from ehlpetsc.elasticity.bodies import reduced_modulus
from ehlpetsc.gears.path import gear_loss_factor, hertz, loss, mean_friction, path_of_contact
from ehlpetsc.gears.standards import STANDARDS, Rating, values_of
from ehlpetsc.results.post_result import PostResult
from ehlpetsc.results.reader import read_result

SCALARS = (  # scalar of the steps, factor, label
    ("p_max", 1e-9, "maximum\npressure [GPa]"),
    ("film_central", 1e6, "mean film\n[µm]"),
    ("h_min", 1e6, "minimum film\n[µm]"),
    ("lambda_ratio", 1.0, "lambda ratio"),
    ("friction_coefficient", 1.0, "friction\ncoefficient"),
    ("contact_share", 1.0, "share of load\non the solids"),
    ("film_temperature_max", 1.0, "maximum of\nthe film [K]"),
    ("temperature_1_max", 1.0, "maximum of\nthe pinion [K]"),
    ("temperature_2_max", 1.0, "maximum of\nthe wheel [K]"),
)
AVERAGING_LENGTH = 0.02  # of the path
FLANKS = ("pinion", "wheel")  # surfaces 1 and 2


class GearRun:
    """Scalars of a result along the path of contact of its gear pair; CaseError if it has none.

    Attributes
    ----------
    path : ehlpetsc.gears.path.Path
    rho, position
        Position of each step on the line of action from the base circle and from the pitch point [m].
    scalars
        Those of `SCALARS` in the result.
    rating
        Of the standards; None without oil or profiles.
    damage
        Of its post-processing, None without.
    """

    def __init__(self, file: Path, rating: Rating | None = None) -> None:
        with read_result(file) as result:
            gears, heat, contact = result.case.gears, result.case.heat, result.case.contact
            if gears is None:
                raise CaseError([f"{file}: its case has no [gears] table; allowed: a gear run"])
            self.path, self.title = path_of_contact(gears.pair), result.attrs["title"]
            self.rho = result.steps("speed_1") / self.path.pair.angular_speeds[0]
            self.scalars = {name: result.steps(name) for name, _, _ in SCALARS if name in result.scalars}
        self.modulus = reduced_modulus(contact.youngs_modulus, contact.poisson_ratio)
        self.position = self.rho - self.path.pair.points["C"]
        self.rating, self.bulk = rating, min(heat.bulk_temperature) if heat else np.nan
        self.standards = values_of(rating) if rating else {}
        post = Path(file).with_suffix(".post.h5")
        self.damage = FlankDamage(post, self.path.pair.flank_arcs(self.rho[0])) if post.exists() else None

    def friction_on_path(self) -> np.ndarray:
        """Friction coefficient at the samples of the path; constant beyond the ends of the run."""
        return np.interp(self.path.rho, self.rho, self.scalars["friction_coefficient"])

    def mean(self, name: str) -> float:
        """Mean of a scalar along the path, nan without."""
        values = self.scalars.get(name, np.full_like(self.rho, np.nan))
        return float(0.5 * (values[1:] + values[:-1]) @ np.diff(self.rho) / np.ptp(self.rho))

    def figures(self) -> dict[str, float]:
        """Figures of the run by name and unit, those of standards under their names; nan without."""
        friction, nothing = self.friction_on_path(), np.full(len(self.rho), np.nan)
        pressure, film = self.scalars["p_max"], self.scalars["film_central"]
        hottest = [self.scalars.get(f"temperature_{side}_max", nothing).max() for side in "12"]
        roughness = self.rating.roughness if self.rating and self.rating.roughness else np.nan
        figures = {
            "mean film": 1e6 * self.mean("film_central"),
            "minimum lambda_GF": float(self.averaged(film).min() / roughness),
            "maximum flash temperature": max(hottest) - self.bulk,
            "mean friction coefficient": mean_friction(self.path, friction),
            "loss factor H_V": gear_loss_factor(self.path),
            "power lost": 1e2 * loss(self.path, friction),
            "bulk temperature": self.bulk,
            "Hertz pressure at A [GPa]": 1e-9 * hertz(self.path, self.modulus)[1][0],
            "maximum pressure at A, mean over 1 % of the path [GPa]": 1e-9 * self.averaged(pressure)[0],
            "maximum pressure [GPa]": 1e-9 * pressure.max(),
            "minimum film [µm]": 1e6 * self.scalars["h_min"].min(),
            "mean share of the load on the solids": self.mean("contact_share"),
        }
        maxima = self.damage.maxima() if self.damage else {}
        return figures | {f"maximum damage of the {flank}": value for flank, (value, *_) in maxima.items()}

    def averaged(self, values: np.ndarray) -> np.ndarray:
        """Means over `AVERAGING_LENGTH` of the path around each step."""
        reach = 0.5 * AVERAGING_LENGTH * (self.rho[-1] - self.rho[0])
        total = np.append(0.0, np.cumsum(np.nan_to_num(values)))
        first = np.searchsorted(self.rho, self.rho - reach)
        last = np.searchsorted(self.rho, self.rho + reach, side="right")
        return (total[last] - total[first]) / (last - first)


def lines(runs: list[GearRun]) -> list[str]:
    """Lines of text: figures of all runs, and of the standards beside them."""
    texts = [f"{run.title}: {run.path.pair.torque:g} N m, {run.path.pair.rule}" for run in runs]
    all_figures = [run.figures() for run in runs]
    for name in dict.fromkeys(name for figures in all_figures for name in figures):
        values = [figures.get(name, np.nan) for figures in all_figures]
        if not np.isfinite(values).any():
            continue
        text = f"{name} {', '.join(f'{value:.4g}' for value in values)}"
        if name in STANDARDS:
            entry = STANDARDS[name]
            beside = [entry.reduction(run.standards[name]) for run in runs if name in run.standards]
            text += f" {entry.unit}" if entry.unit else ""
            text += f"; {', '.join(f'{value:.4g}' for value in beside)} by {entry.source}" if beside else ""
        texts.append(text)
    return texts + [
        f"maximum damage of the {flank}: {damage:.3g} at an arc length of {1e3 * arc:.3f} mm from A, "
        f"{1e6 * depth:.1f} µm deep"
        for run in runs
        if run.damage
        for flank, (damage, arc, depth) in run.damage.maxima().items()
    ]


def panels(runs: list[GearRun]) -> dict[str, list[str]]:
    """Scalars that all runs have, by the ending of their picture: "" or temperatures."""
    known = [
        name for name, *_ in SCALARS if all(np.isfinite(run.scalars.get(name, np.nan)).any() for run in runs)
    ]
    hot = [name for name in known if "temperature" in name]
    return {"": [name for name in known if name not in hot]} | ({".temperatures": hot} if hot else {})


class FlankDamage:
    """Damage of one engagement along both flanks, from the post-processing of a gear run.

    `profile_offsets` are the arc lengths from A at which both flanks are at x = 0 at time 0 [m].

    `depths`: [m], shape (nz,). `arcs`: arc lengths from A along the flanks of pinion and wheel [m],
    increasing. `damage`: by flank, shape (nz, ns), nan for points that did not pass the contact; None without
    damage.
    """

    def __init__(self, file: Path, profile_offsets: Sequence[float]) -> None:
        post = PostResult(file)
        self.depths = post.z * post.a
        self.arcs = [begin - post.s[::-1] for begin in profile_offsets]
        self.damage = [post.damage[side][:, ::-1] if side in post.damage else None for side in ("1", "2")]

    def maxima(self) -> dict[str, tuple[float, float, float]]:
        """Maximum damage of each flank, its arc length and depth [m]."""
        found = {}
        for flank, damage, arc in zip(FLANKS, self.damage, self.arcs, strict=True):
            if damage is not None and np.isfinite(damage).any():
                depth, point = np.unravel_index(np.nanargmax(damage), damage.shape)
                found[flank] = float(damage[depth, point]), float(arc[point]), float(self.depths[depth])
        return found
