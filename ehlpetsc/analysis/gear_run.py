"""Gear run along the path of contact: scalars of the steps, friction and losses, damage of both flanks."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ehlpetsc.base.errors import CaseError
from ehlpetsc.gears.path import gear_loss_factor, loss, mean_friction, path_of_contact
from ehlpetsc.results.post_result import PostResult
from ehlpetsc.results.reader import read_result

SCALARS = (  # scalar of the steps, factor, label
    ("p_max", 1e-9, "maximum pressure\n[GPa]"),
    ("film_central", 1e6, "mean film of the\ncontact [µm]"),
    ("h_min", 1e6, "minimum film [µm]"),
    ("lambda_ratio", 1.0, "lambda ratio"),
    ("friction_coefficient", 1.0, "friction coefficient"),
    ("contact_share", 1.0, "share of the load\non the solids"),
    ("film_temperature_max", 1.0, "maximum temperature\nof the film [K]"),
    ("temperature_1_max", 1.0, "maximum temperature\nof the pinion [K]"),
    ("temperature_2_max", 1.0, "maximum temperature\nof the wheel [K]"),
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
    friction
        Friction coefficient of each step.
    scalars
        Those of `SCALARS` in the result.
    """

    def __init__(self, file: Path) -> None:
        with read_result(file) as result:
            gears = result.case.gears
            if gears is None:
                raise CaseError([f"{file}: its case has no [gears] table; allowed: a gear run"])
            self.path, self.title = path_of_contact(gears.pair), result.attrs["title"]
            self.rho = result.steps("speed_1") / self.path.pair.angular_speeds[0]
            self.scalars = {name: result.steps(name) for name, _, _ in SCALARS if name in result.scalars}
            self.friction = result.steps("friction_coefficient")
        self.position = self.rho - self.path.pair.points["C"]

    @property
    def profile_offsets(self) -> tuple[float, float]:
        """Arc lengths of both flanks at the beginning of the run, from A [m]."""
        first, second = self.path.pair.flank_arcs(self.rho[0])
        return float(first), float(second)

    def friction_on_path(self) -> np.ndarray:
        """Friction coefficient at the samples of the path; constant beyond the ends of the run."""
        return np.interp(self.path.rho, self.rho, self.friction)

    def lines(self) -> list[str]:
        """Lines of text: extremes and losses."""
        friction = self.friction_on_path()
        lines = [
            f"gear loss factor H_V {gear_loss_factor(self.path):.4f} of the load sharing",
            f"mean friction coefficient {mean_friction(self.path, friction):.4f}",
            f"power lost over power transmitted {1e2 * loss(self.path, friction):.3f} %",
        ]
        for name, factor, label in SCALARS:
            values = self.scalars.get(name)
            if values is not None and np.isfinite(values).any():
                low, high = (factor * f(values) for f in (np.nanmin, np.nanmax))
                lines.append(f"{' '.join(label.split())}: {low:.4g} to {high:.4g}")
        return lines

    def averaged(self, values: np.ndarray) -> np.ndarray:
        """Means over `AVERAGING_LENGTH` of the path around each step."""
        reach = 0.5 * AVERAGING_LENGTH * (self.rho[-1] - self.rho[0])
        total = np.append(0.0, np.cumsum(np.nan_to_num(values)))
        first = np.searchsorted(self.rho, self.rho - reach)
        last = np.searchsorted(self.rho, self.rho + reach, side="right")
        return (total[last] - total[first]) / (last - first)


class FlankDamage:
    """Damage of one engagement along both flanks, from the post-processing of a gear run.

    `profile_offsets` are the arc lengths from A at which both flanks are at x = 0 at time 0 [m].

    Attributes
    ----------
    depths
        [m], shape (nz,).
    arcs
        Arc lengths from A along the flanks of pinion and wheel [m], increasing.
    damage
        By flank, shape (nz, ns), nan for points that did not pass the contact; None without damage.
    """

    def __init__(self, file: Path, profile_offsets: tuple[float, float]) -> None:
        post = PostResult(file)
        self.depths = post.z * post.a
        self.arcs = [begin - post.s[::-1] for begin in profile_offsets]
        self.damage = [post.damage[side][:, ::-1] if side in post.damage else None for side in ("1", "2")]

    def lines(self) -> list[str]:
        """Lines of text: maximum damage of each flank with its position and depth."""
        lines = []
        for flank, damage, arc in zip(FLANKS, self.damage, self.arcs, strict=True):
            if damage is None or not np.isfinite(damage).any():
                continue
            depth, point = np.unravel_index(np.nanargmax(damage), damage.shape)
            lines.append(
                f"largest damage of the {flank}: {damage[depth, point]:.3g} at an arc length of "
                f"{1e3 * arc[point]:.3f} mm from A, {1e6 * self.depths[depth]:.1f} um deep"
            )
        return lines
