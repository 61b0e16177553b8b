r"""Load along a roller, and what follows from it: edge factors, moment, films of the ends, life.

Load per length :math:`w(y)=\sum p\,\Delta x`. Life over that of a uniform load, of line contacts
:math:`\left(\frac1L\int(w/\bar w)^{9/2}dy\right)^{-8/9}` (Lundberg and Palmgren 1952).

The lamina model of ISO/TS 16281 beside it: slices that do not feel each other,

.. math:: w=35948\,L^{-1/9}\,\delta^{10/9}\quad\mathrm{N, mm},\qquad\delta=2\,(d-z-\varphi y)_+,

the approach of both contacts of a roller, hence twice that of one. The constant is of steel; that of other
bodies is in proportion to E'.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ehlpetsc.physics.scales import Scales

LIFE_EXPONENT, LIFE_POWER = 4.5, 8.0 / 9.0
LAMINA = 35948.0, -1.0 / 9.0, 10.0 / 9.0  # N/mm, exponents of length and approach in mm
STEEL_MODULUS = 2.2747e11  # Pa: E' of two bodies of 207 GPa and 0.3
BISECTIONS = 60  # of an interval, down to rounding
END_PART = 0.5  # of the half-length: beyond it films are those of the ends


def load_per_length(pressure: np.ndarray, dx: float) -> np.ndarray:
    """Load per length [N/m] of rows of pressures (..., ny, nx) [Pa] dx [m] apart."""
    return dx * pressure.sum(axis=-1)


def life_factor(w: np.ndarray, dy: float, length: float) -> float:
    """Life of a roller of a length [m] over that with the same load evenly; w [N/m] of rows dy [m] wide."""
    mean = w.sum() * dy / length
    return float(((np.maximum(w, 0.0) / mean) ** LIFE_EXPONENT).sum() * dy / length) ** -LIFE_POWER


def lamina_load(gap: np.ndarray, dy: float, load: float, length: float, modulus: float) -> np.ndarray:
    """Load per length [N/m] by the lamina model, of rows dy [m] wide whose gap is given with the tilt [m]."""
    constant, of_length, exponent = LAMINA
    stiffness = 1e3 * constant * (1e3 * length) ** of_length * modulus / STEEL_MODULUS  # N/m at 1 mm

    def carried(approach: float) -> np.ndarray:
        return stiffness * (2e3 * np.maximum(approach - gap, 0.0)) ** exponent

    low = float(gap.min())
    high = low + 0.5e-3 * (load / (dy * stiffness)) ** (1.0 / exponent)  # on a single row
    for _ in range(BISECTIONS):
        approach = 0.5 * (low + high)
        low, high = (low, approach) if carried(approach).sum() * dy > load else (approach, high)
    return carried(high)


@dataclass(frozen=True)
class RollerLoads:
    """Loads along a roller at an instant.

    `y`: of the rows, from the middle [m]. `w`, `highest`, `thinnest`: load per length [N/m], maximum pressure
    [Pa] and minimum film [m] of each row. `gap`: of the undeformed solids across, with the tilt [m].
    `length`, `radius`: [m]. `modulus`: E' [Pa].
    """

    y: np.ndarray
    w: np.ndarray
    highest: np.ndarray
    thinnest: np.ndarray
    gap: np.ndarray
    length: float
    radius: float
    modulus: float

    @classmethod
    def of(
        cls, scales: Scales, radius: float, tilt: float, pressure: np.ndarray, film: np.ndarray
    ) -> RollerLoads:
        """Loads of fields [Pa, m] at the nodes, flat or as maps, under a radius [m] and a tilt."""
        rows, y = scales.grid.rows, scales.grid.axes[0]
        gap = scales.h * scales.grid.shapes[0].beside(y) + tilt * scales.a * y
        loads = load_per_length(rows(pressure), scales.spacing)
        shape = scales.extent, radius, scales.E
        return cls(scales.a * y, loads, rows(pressure).max(axis=1), rows(film).min(axis=1), gap, *shape)

    @property
    def dy(self) -> float:
        """Width of a row [m]."""
        return float(self.y[1] - self.y[0])

    @property
    def load(self) -> float:
        """Load [N]."""
        return float(self.w.sum() * self.dy)

    @property
    def edge_factor(self) -> float:
        """Maximum pressure over Hertz' of the mean load per length."""
        return float(self.highest.max() / self._hertz(self.load / self.length))

    @property
    def edge_factor_inside(self) -> float:
        """The same of the rows at least a half-width a of the mean load inside the ends."""
        mean = self.load / self.length
        a = np.sqrt(8.0 * mean * self.radius / (np.pi * self.modulus))
        return float(self.highest[np.abs(self.y) <= 0.5 * self.length - a].max() / self._hertz(mean))

    @property
    def local_edge_factor(self) -> float:
        """Maximum pressure over Hertz' of the load per length of its row."""
        row = np.argmax(self.highest)
        return float(self.highest[row] / self._hertz(self.w[row]))

    def _hertz(self, w: float) -> float:
        return np.sqrt(w * self.modulus / (2.0 * np.pi * self.radius))

    @property
    def moment(self) -> float:
        """Moment of the pressure about the middle [N m]."""
        return float((self.w * self.y).sum() * self.dy)

    @property
    def middle(self) -> float:
        """Load per length in the middle [N/m]."""
        return self.at(0.0)

    @property
    def ends(self) -> tuple[float, float]:
        """Load per length of the first and the last row within the length [N/m]."""
        inside = np.flatnonzero(np.abs(self.y) < 0.5 * self.length)
        return float(self.w[inside[0]]), float(self.w[inside[-1]])

    def at(self, y: float) -> float:
        """Load per length at y [N/m], linear between the rows."""
        return float(np.interp(y, self.y, self.w))

    @property
    def highest_at(self) -> float:
        """Place of the largest load per length [m]."""
        return float(self.y[np.argmax(self.w)])

    @property
    def film_of_ends(self) -> float:
        """Minimum film of the outer halves over that of the middle."""
        outer = np.abs(self.y) > END_PART * 0.5 * self.length
        return float(self.thinnest[outer].min() / np.interp(0.0, self.y, self.thinnest))

    @property
    def life_factor(self) -> float:
        """See :func:`life_factor`."""
        return life_factor(self.w, self.dy, self.length)

    @cached_property
    def lamina(self) -> np.ndarray:
        """Load per length by the lamina model [N/m]."""
        return lamina_load(self.gap, self.dy, self.load, self.length, self.modulus)

    @property
    def lamina_moment(self) -> float:
        """Moment by the lamina model [N m]."""
        return float((self.lamina * self.y).sum() * self.dy)

    @property
    def lamina_life_factor(self) -> float:
        """Life by the lamina model over that with the same load evenly."""
        return life_factor(self.lamina, self.dy, self.length)
