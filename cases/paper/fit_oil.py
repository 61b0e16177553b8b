"""Constants of an oil fitted to measured traction, with their standard errors.

``ehlpetsc python cases/paper/fit_oil.py [DATA.csv] [--case CASE.toml] [--oil OIL] [-o PICTURE]`` fits Eyring
stress, limiting shear stress and pressure-viscosity coefficient by least squares over computed contacts, with
heat where the case has it. Without arguments it takes FVA 3 on the discs of `data/discs.csv`.

DATA.csv has the columns ``entrainment_speed`` [m/s], ``slide_roll_ratio`` and ``friction``; a column named as
a key of the case, ``contact.load``, sets that key; of a column ``oil`` the rows of OIL are taken. A line
``# reading error: 0.005`` gives the error of a coefficient. CASE.toml is the steady contact, with an oil of
any law; its constants are the first guess.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import measured_data
import numpy as np
from matplotlib.figure import Figure
from scipy.optimize import least_squares

from ehlpetsc.base.errors import NotConverged
from ehlpetsc.case.loading import load
from ehlpetsc.pictures import style
from ehlpetsc.run.simulation import Simulation

CASE = Path(__file__).parents[1] / "discs.toml"
POINTS = 30  # nodes per half-width
STEP = 0.02  # of the derivatives, in logarithms of the constants
MAX_STEPS = 15  # of the fit, each of four times the computed points
KEYS = {"entrainment_speed": "motion.entrainment_speed", "slide_roll_ratio": "motion.slide_roll_ratio"}
MODULI = ("modulus_a1", "modulus_a2", "modulus_b1", "modulus_b2")
NAMES = ("Eyring stress [MPa]", "limiting shear stress over pressure", "pressure-viscosity [1/GPa]")
UNITS = (1e6, 1.0, 1e-9)


class Fit:
    """Computed friction of the measured points over the three constants.

    Attributes
    ----------
    first : numpy.ndarray
        Constants of the case: Eyring stress [Pa], limit, pressure-viscosity coefficient [1/Pa].
    values, errors, correlation : numpy.ndarray
        Fitted constants, their standard errors and correlation matrix, after :meth:`fit`.
    residual : float
        Root mean square deviation of friction, after :meth:`fit`.
    """

    def __init__(
        self, case: Path | dict[str, Any], rows: dict[str, np.ndarray], error: float, oil: str | None
    ) -> None:
        columns = {
            KEYS.get(name, name): values for name, values in rows.items() if name in KEYS or "." in name
        }
        keys = {"series": None, "mesh.points_per_half_width": POINTS} | ({"fluid.oil": oil} if oil else {})
        points = zip(*columns.values(), strict=True)
        self.points = [keys | dict(zip(columns, map(float, point), strict=True)) for point in points]
        self.case, self.measured, self.error = case, rows["friction"], error
        self.fluid = load(case, self.points[0]).fluid
        limit = self.fluid.limiting_shear or 0.1
        self.first = np.array([self.fluid.eyring_stress, limit, self.fluid.pressure_viscosity])

    def fit(self) -> None:
        """Find `values`, `errors`, `correlation` and `residual`.

        SystemExit, in one sentence, where `MAX_STEPS` do not suffice or a contact has no solution.
        """
        limits = dict(bounds=(-0.5, 2.5), xtol=1e-3, max_nfev=MAX_STEPS)
        try:  # from 1, as a relative step of the derivatives has no length at 0
            found = least_squares(self._deviations, np.ones(3), diff_step=STEP, **limits)
        except NotConverged as error:
            raise SystemExit(f"fit_oil: a contact of the fit has no solution: {error}") from None
        if not found.success:
            raise SystemExit(
                f"fit_oil: not converged in {MAX_STEPS} steps, as these {len(self.measured)} points do not "
                "determine all three constants; allowed: points at several speeds and slide/roll ratios"
            )
        self.values = self.first * np.exp(found.x - 1.0)
        scatter = 2.0 * found.cost / max(len(self.measured) - len(found.x), 1)
        self.residual = float(np.sqrt(scatter)) * self.error
        covariance = scatter * np.linalg.pinv(found.jac.T @ found.jac)
        spread = np.sqrt(np.diag(covariance))
        self.errors, self.correlation = self.values * spread, covariance / np.outer(spread, spread)

    def _deviations(self, logarithms: np.ndarray) -> np.ndarray:
        return (self.friction(self.first * np.exp(logarithms - 1.0)) - self.measured) / self.error

    def friction(self, constants: np.ndarray) -> np.ndarray:
        """Computed friction coefficients of the measured points."""
        return np.array([self._friction(keys, constants) for keys in self.points])

    def _friction(self, keys: dict[str, Any], constants: np.ndarray) -> float:
        eyring, limit, alpha = map(float, constants)
        of_oil: dict[str, float] = {"eyring_stress": eyring, "limiting_shear": limit}
        if self.fluid.law == "modulus":  # its alpha(p) by one factor
            factor = float(self.first[2]) / alpha
            of_oil |= {name: factor * getattr(self.fluid, name) for name in MODULI}
            of_oil["eyring_stress_pressure"] = self.fluid.eyring_stress_pressure
        else:
            of_oil["pressure_viscosity"] = alpha
        case = load(self.case, keys | {f"fluid.{name}": value for name, value in of_oil.items()})
        (state,) = Simulation(case)
        return float(state.scalars["friction_coefficient"])

    def lines(self) -> list[str]:
        """Fitted constants with standard errors, correlations and deviation, as lines."""
        rows = zip(NAMES, UNITS, self.first, self.values, self.errors, strict=True)
        lines = [
            f"{name}: {value / unit:.3g} +- {error / unit:.2g} ({100 * error / value:.0f} %), "
            f"first guess {first / unit:.3g}"
            for name, unit, first, value, error in rows
        ]
        pairs = ", ".join(f"{self.correlation[i, j]:+.2f}" for i, j in ((0, 1), (0, 2), (1, 2)))
        deviation = f"deviation {self.residual:.4f} of {len(self.measured)} points"
        return [*lines, f"{deviation}; correlations (stress, limit), (stress, alpha), (limit, alpha) {pairs}"]


def draw(fit: Fit, rows: dict[str, np.ndarray]) -> Figure:
    """Measured and fitted friction over the slide/roll ratio, a colour for each speed."""
    figure, panel = style.new_figure(1, 1, (6.0, 4.2))
    fitted, speeds = fit.friction(fit.values), np.unique(rows["entrainment_speed"])
    for speed, colour in zip(speeds, style.shades(len(speeds)), strict=True):
        of = np.flatnonzero(rows["entrainment_speed"] == speed)
        of = of[np.argsort(rows["slide_roll_ratio"][of])]
        at = rows["slide_roll_ratio"][of]
        panel.errorbar(at, fit.measured[of], yerr=fit.error, fmt="o", ms=4, lw=0.8, capsize=2, color=colour)
        panel.plot(at, fitted[of], color=colour, lw=1.4, label=f"{speed:g} m/s")
    panel.set(xscale="log", xlabel=style.LABELS["motion.slide_roll_ratio"], ylabel="friction coefficient")
    panel.set_ylim(bottom=0.0)
    panel.grid(lw=0.3)
    panel.legend(**style.SMALL)
    style.set_title(figure, "Measured friction (points) and the fitted oil (lines)")
    return figure


def main(words: list[str] | None = None) -> None:
    """Print the fitted constants and write the picture."""
    parser = measured_data.parser(__doc__, "fit_oil.png")
    parser.add_argument("data", nargs="?", default="discs.csv", metavar="DATA.csv", help="[discs.csv]")
    parser.add_argument("--case", type=Path, default=CASE, metavar="CASE.toml", help="[cases/discs.toml]")
    parser.add_argument("--oil", help="of the column `oil` [the first one]")
    chosen = parser.parse_args(words)
    data = measured_data.read(chosen.data)
    oil = chosen.oil or (str(data.columns["oil"][0]) if "oil" in data.columns else None)
    rows = data.where(oil=oil) if "oil" in data.columns else data.columns
    number = re.search(r"\d*\.\d+", data.notes.get("reading error", ""))
    fit = Fit(chosen.case, rows, float(number[0]) if number else 0.005, oil)
    fit.fit()
    print("\n".join(fit.lines()))
    style.save(draw(fit, rows), chosen.output)
    print(chosen.output)


if __name__ == "__main__":
    main()
