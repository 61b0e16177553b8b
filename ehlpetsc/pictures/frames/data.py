"""Fields of one stored frame in view, of a line contact, point contact or strip; lengths in half-widths a."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ehlpetsc.base.case import KINDS
from ehlpetsc.base.errors import OutputError
from ehlpetsc.physics.contact.hertz import hertz_pressure
from ehlpetsc.pictures import style
from ehlpetsc.results.reader import Result

PRESSURE_LABEL = "pressure [GPa]"
FILM_FIELD = "film_thickness"
FILM_LABEL, GAP_LABEL = "film thickness [µm]", "gap [µm]"  # the latter of a dry contact
SHOWN_UNITS = {"m": ("µm", 1e6), "Pa": ("GPa", 1e-9), "s": ("µs", 1e6), "N/m": ("N/mm", 1e-3), "1": ("", 1.0)}
LABEL_WIDTH = 26  # letters of a line beside an axis
COLOUR_PERCENTILE = 99.9  # upper end of the colours of pressure, without a few sharp peaks
FILM_ROOM, ROOM = 1.15, 0.05  # above the maximum film inside the dry contact; around all values of a field
MOSTLY = 0.5  # share of the pressure on the solids above which a node of a compliant layer is marked


class Limits(NamedTuple):
    """Ends of axes: of pressures and of their colours, from 0 [GPa], and of the other values."""

    pressure: float
    brightest: float
    low: float
    high: float


def common(limits: Iterable[Limits]) -> Limits:
    """Limits around those of several frames."""
    pressure, brightest, low, high = zip(*limits, strict=True)
    return Limits(max(pressure), max(brightest), min(low), max(high))


@dataclass(frozen=True)
class Frame:
    """Fields of a frame in view.

    `x`, `y`: nodes in half-widths a, shapes (nx,), (ny,); `y` is None of a line or section.
    `pressure`, `solids`: total and of the solids [GPa], `values`: film or another field, `share`: see
        :func:`contact_share`; shape (nx,) or (ny, nx).
    `half_widths`: of the dry contact along and across in a, across infinite in a line and strip.
    `p0`: maximum pressure of the dry contact [GPa].
    `word`, `label`: of the values, in legends and beside axes.
    """

    x: np.ndarray
    y: np.ndarray | None
    pressure: np.ndarray
    solids: np.ndarray
    values: np.ndarray
    share: np.ndarray
    half_widths: tuple[float, float]
    p0: float
    word: str
    label: str

    @classmethod
    def of(cls, result: Result, index: int, window: Sequence[float], field: str | None = None) -> Frame:
        """Frame `index` of a result within limits of x/a, with a field, by default the film."""
        part, x, y = in_view(result, window)
        key = (index, *part)
        a, p0 = style.hertz_at(result, index)
        width = a / result.attrs["a"]
        pressure = 1e-9 * result["pressure"][key].astype(float)
        solids = np.zeros_like(pressure)
        if "contact_pressure" in result:
            solids = 1e-9 * result["contact_pressure"][key].astype(float)
        word, label, factor = described(result, field)
        values = factor * result[field or FILM_FIELD][key].astype(float)
        half_widths = width, np.inf if y is None else width * aspect(result)
        share = contact_share(result, key)
        return cls(x, y, pressure, solids, values, share, half_widths, 1e-9 * p0, word, label)

    @property
    def is_film(self) -> bool:
        """Whether the values are those of film or gap."""
        return self.label in (FILM_LABEL, GAP_LABEL)

    @property
    def distance(self) -> np.ndarray:
        """Distance from the middle over the half-width of the dry contact, of the shape of the fields."""
        across = 0.0 if self.y is None else self.y[:, np.newaxis] / self.half_widths[1]
        return np.hypot(self.x / self.half_widths[0], across)

    @property
    def limits(self) -> Limits:
        """Ends of axes; that of film is above the maximum inside the dry contact, if any of it is in view."""
        highest = max(self.pressure.max(), hertz_pressure(self.distance, 1.0, self.p0).max(), 1e-3)
        brightest = float(np.percentile(self.pressure, COLOUR_PERCENTILE)) or 1.0
        inside = self.distance <= 1.0
        if self.is_film:
            high = self.values[inside if inside.any() else ...].max() or self.values.max() or 1.0
            return Limits(1.05 * highest, brightest, 0.0, FILM_ROOM * float(high))
        low, high = float(np.nanmin(self.values)), float(np.nanmax(self.values))
        room = ROOM * (high - low) or max(ROOM * abs(high), 1e-12)
        return Limits(1.05 * highest, brightest, low - room, high + room)

    def section(self, along: bool) -> Frame:
        """Row or column of a plane through the middle, as a frame of a line contact."""
        row, column = int(np.argmin(np.abs(self.y))), int(np.argmin(np.abs(self.x)))
        (a, b), nodes = self.half_widths, np.s_[row, :] if along else np.s_[:, column]
        offset = self.y[row] / b if along else self.x[column] / a
        part = float(np.sqrt(max(1.0 - offset**2, 1e-12)))  # not 0: widths divide
        pressure, solids, values, share = (
            field[nodes] for field in (self.pressure, self.solids, self.values, self.share)
        )
        x, half_widths, p0 = self.x if along else self.y, (part * (a if along else b), np.inf), part * self.p0
        return Frame(x, None, pressure, solids, values, share, half_widths, p0, self.word, self.label)


def described(result: Result, field: str | None) -> tuple[str, str, float]:
    """Short name and label of a stored field, by default of the film, and the factor to its unit."""
    if field in (None, FILM_FIELD):
        return ("film", FILM_LABEL, 1e6) if result.case.fluid else ("gap", GAP_LABEL, 1e6)
    if field not in result.fields:
        raise OutputError(f"{result.path}: --field {field}: not stored; allowed: {', '.join(result.fields)}")
    unit, factor = SHOWN_UNITS.get(result.unit(field), (result.unit(field), 1.0))
    name = str(result[field].attrs.get("long_name", field)) + (f" [{unit}]" if unit else "")
    return field, textwrap.fill(name, LABEL_WIDTH), factor


def aspect(result: Result) -> float:
    """Half-width of the dry contact across over that along; infinite in a strip and along a roller."""
    ends = KINDS[result.case.kind].has_ends
    return np.inf if ends else float(result.attrs["b"] / result.attrs["a"])


def in_view(result: Result, window: Sequence[float]) -> tuple[tuple, np.ndarray, np.ndarray | None]:
    """Nodes within limits of x/a, with x/a and y/a; of a line, those next to the limits too.

    Across, as far from the middle as :func:`.style.reach_across`.
    """
    a, x = result.attrs["a"], result.x / result.attrs["a"]
    along = style.in_view(x, window)
    if result.y is None:
        along = slice(max(along.start - 1, 0), along.stop + 1)
        return (along,), x[along], None
    reach, y = style.reach_across(result, window) / a, result.y / a
    part = style.in_view(y, (-reach, reach)), along
    return part, x[along], y[part[0]]


def has_layer(result: Result) -> bool:
    """Whether the solids touch in a compliant layer, nearly everywhere, and their pressure is stored."""
    return result.case.contact.asperity_height is not None and "contact_pressure" in result


def contact_share(result: Result, key: tuple) -> np.ndarray:
    """Share of the solids in the pressure of the nodes of a key of the fields, 0 out of contact.

    Of a compliant layer; otherwise 1 in contact. 0 where contacts are not stored.
    """
    if "in_contact" not in result:
        return np.zeros_like(result["pressure"][key], dtype=float)
    touching = result["in_contact"][key].astype(float)
    if not has_layer(result):
        return touching
    total, solids = (result[name][key].astype(float) for name in ("pressure", "contact_pressure"))
    return np.divide(solids * touching, total, out=np.zeros_like(total), where=total > 0.0)


def contact_word(result: Result) -> str:
    """Meaning of a node that is marked because its :func:`contact_share` is above `MOSTLY`."""
    return "mostly on the solids" if has_layer(result) else "in contact"
