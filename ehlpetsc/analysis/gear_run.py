"""Gear run along the path of contact: pressure, film, friction and losses, as text and as a picture."""

import numpy as np

from ehlpetsc.errors import CaseError
from ehlpetsc.gears.losses import gear_loss_factor, loss, mean_friction
from ehlpetsc.gears.path import path_of_contact
from ehlpetsc.results.reader import read_result

PANELS = (  # scalar of the steps, factor, label
    ("p_max", 1e-9, "largest pressure\n[GPa]"),
    ("film_central", 1e6, "mean film of the\ncontact [um]"),
    ("h_min", 1e6, "least film [um]"),
    ("lambda_ratio", 1.0, "lambda ratio"),
    ("friction_coefficient", 1.0, "friction coefficient"),
    ("contact_share", 1.0, "share of the load\non the solids"),
    ("film_temperature_max", 1.0, "highest temperature\nof the film [K]"),
    ("temperature_1_max", 1.0, "highest temperature\nof the pinion [K]"),
    ("temperature_2_max", 1.0, "highest temperature\nof the wheel [K]"),
)
AVERAGING_LENGTH = 0.02  # of the path, for the thick line
COLOUR = "#1f4e79"


class GearRun:
    """Scalars of a result along the path of contact of its gear pair.

    Parameters
    ----------
    file : path-like
        Result of a case with a ``[gears]`` table.

    Attributes
    ----------
    path : ehlpetsc.gears.path.Path
    position : ndarray, shape (nsteps,)
        Position of each step on the line of action from the pitch point [m].
    friction : ndarray, shape (nsteps,)
        Magnitude of the friction coefficient, mean of both walls.
    scalars : dict of str to ndarray
        Scalars of the picture in the result.

    Raises
    ------
    CaseError
        The result is not that of a gear pair.
    """

    def __init__(self, file):
        with read_result(file) as result:
            gears = result.case.gears
            if gears is None:
                raise CaseError([f"{file}: its case has no [gears] table; allowed: a gear run"])
            self.path, self.title = path_of_contact(gears.pair), str(result.attrs["title"])
            rolling = result.steps("speed_1")[:]
            self.scalars = {name: result.steps(name)[:] for name, _, _ in PANELS if name in result.scalars}
            self.friction = result.steps("friction_coefficient")
        self.rho = rolling / self.path.pair.angular_speeds[0]
        self.position = self.rho - self.path.pair.points["C"]

    @property
    def profile_offsets(self):
        """Arc lengths of both flanks at the beginning of the run, from A [m]."""
        return tuple(float(arc) for arc in self.path.pair.flank_arcs(self.rho[0]))

    def friction_on_path(self):
        """Friction coefficient at the samples of the path; constant beyond the ends of the run."""
        return np.interp(self.path.rho, self.rho, self.friction)

    def lines(self):
        """Lines of text: extremes and losses."""
        friction = self.friction_on_path()
        lines = [
            f"gear loss factor H_V {gear_loss_factor(self.path):.4f} of the load sharing",
            f"mean friction coefficient {mean_friction(self.path, friction):.4f}",
            f"power lost over power transmitted {1e2 * loss(self.path, friction):.3f} %",
        ]
        for name, factor, label in PANELS:
            values = self.scalars.get(name)
            if values is not None and np.isfinite(values).any():
                low, high = (factor * f(values) for f in (np.nanmin, np.nanmax))
                lines.append(f"{' '.join(label.split())}: {low:.4g} to {high:.4g}")
        return lines

    def averaged(self, values):
        """Means over `AVERAGING_LENGTH` of the path around each step."""
        reach = 0.5 * AVERAGING_LENGTH * (self.rho[-1] - self.rho[0])
        total = np.append(0.0, np.cumsum(np.nan_to_num(values)))
        first = np.searchsorted(self.rho, self.rho - reach)
        last = np.searchsorted(self.rho, self.rho + reach, side="right")
        return (total[last] - total[first]) / (last - first)

    def draw(self, target):
        """Draw the scalars along the line of action into a file."""
        from matplotlib.figure import Figure

        rows = [row for row in PANELS if row[0] in self.scalars and np.isfinite(self.scalars[row[0]]).any()]
        figure = Figure(figsize=(7.0, 1.0 + 1.2 * len(rows)), layout="constrained")
        axes = figure.subplots(len(rows), 1, sharex=True, squeeze=False)[:, 0]
        points, c = self.path.pair.points, self.path.pair.points["C"]
        for axis, (name, factor, label) in zip(axes, rows, strict=True):
            values = factor * self.scalars[name]
            axis.plot(1e3 * self.position, values, color=COLOUR, alpha=0.3, linewidth=0.5)
            axis.plot(1e3 * self.position, self.averaged(values), color=COLOUR, linewidth=1.5)
            axis.set_ylabel(label, fontsize=7)
            axis.grid(alpha=0.3)
            for rho in points.values():
                axis.axvline(1e3 * (rho - c), color="0.7", linewidth=0.8)
        for name, rho in points.items():
            axes[0].annotate(name, (1e3 * (rho - c), 1.02), xycoords=("data", "axes fraction"), ha="center")
        axes[-1].set_xlabel("position on the line of action from the pitch point [mm]")
        figure.suptitle(self.title, fontsize=10)
        figure.savefig(target, dpi=120)
