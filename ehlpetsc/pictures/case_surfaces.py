"""Profiles or maps of a case before a run, with the part that passes the contact."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse, Rectangle

from ehlpetsc.base.case import KINDS
from ehlpetsc.base.errors import OutputError
from ehlpetsc.case.loading import Case, load
from ehlpetsc.physics.scales import Scales
from ehlpetsc.pictures import style
from ehlpetsc.pictures.surface import MAX_PIXELS, draw_heights
from ehlpetsc.surfaces.motion.profile_checks import entry_times
from ehlpetsc.surfaces.motion.roughness import Roughness, RoughSurface

PROFILE_SIZE = (9.0, 3.3)  # inches, for each profile
CASE_WIDTH, CASE_MAP, CASE_MARGIN = 7.0, 5.3, 1.1  # inches: of the figure, of a map, above and below a map
MAX_LENGTH = 4.0  # shown length of a map over the width of the mesh


def draw_case(path: Path | str, overrides: Iterable[str] = ()) -> Figure:
    """Profiles or maps of a case file; overrides as in `ehlpetsc.load`."""
    case = load(path, overrides)
    scales = Scales.of(case)
    rough = Roughness.of(case, scales)
    if not rough:
        raise OutputError(f"{path}: both surfaces are smooth: there is no profile to draw")
    if KINDS[case.kind].is_areal:
        width = scales.grid.spacings[0] * scales.grid.shape[0]
        lengths = [min(surface.given.length, MAX_LENGTH * width) for surface in rough.sides.values()]
        size = CASE_WIDTH, len(lengths) * (CASE_MAP * width / max(lengths) + CASE_MARGIN) + 0.5
        draw = draw_map
    else:
        size, draw = (PROFILE_SIZE[0], PROFILE_SIZE[1] * len(rough.sides) + 0.5), draw_profile
    figure, axes = style.new_figure(len(rough.sides), 1, size, squeeze=False)
    for panel, (side, surface) in zip(axes[:, 0], rough.sides.items(), strict=True):
        draw(panel, side, surface, case, scales)
    texts = [f"a = {1e3 * scales.a:.3g} mm", f"p0 = {1e-9 * scales.p0:.3g} GPa"]
    if case.conditions is not None:
        texts.append("of the widest contact; conditions over time")
    elif case.motion:
        texts.append(f"u = {scales.u:g} m/s, slide/roll ratio {scales.xi:g}")
    style.set_title(figure, case.title, ", ".join(texts))
    return figure


def passing(surface: RoughSurface, case: Case, scales: Scales) -> tuple[float, float]:
    """Ends [m] of the part of a surface that passes the whole contact; equal if there is none."""
    first, last = float(surface.X[0]), float(surface.X[-1])
    arrives = entry_times(surface, scales)
    if arrives is None:
        return first, last
    if not surface.repeats:
        return (first, last) if case.time.travel >= arrives[1] else (first, first)
    slower = scales.u_max / abs(surface.speed)
    through = scales.a * (case.time.travel - arrives[0] - 2.0 * slower) / slower
    return first, float(np.clip(first + through, first, last))


def arrival(surface: RoughSurface, case: Case, scales: Scales) -> str:
    """When a surface arrives at the contact, for titles; "" if it is in the contact from the start."""
    arrives = entry_times(surface, scales)
    if arrives is None:
        return ""
    return f"left end first, at the contact at travel {arrives[0]:.2f} a of {case.time.travel:g} a"


def draw_profile(axes: Axes, side: str, surface: RoughSurface, case: Case, scales: Scales) -> None:
    """Draw a profile, the part of it that passes the contact, and the width of the contact."""
    x, z = 1e3 * surface.X, 1e6 * surface.given.z[0]
    axes.plot(x, z, color=style.FAINT, lw=0.7)
    begin, end = passing(surface, case, scales)
    inside = (surface.X >= begin) & (surface.X <= end) & (end > begin)
    arrives = arrival(surface, case, scales)
    label = "passes the whole contact" if arrives else None  # not where it is in the contact from the start
    axes.plot(x[inside], z[inside], color=style.SURFACES[side], lw=0.8, label=label)
    room = 0.18 * np.ptp(z)
    width = dict(color="k", lw=2.0, label=f"2a = {2e3 * scales.a:.3g} mm")
    axes.plot([x[0], x[0] + 2e3 * scales.a], [z.max() + 0.5 * room] * 2, **width)
    axes.set(xlim=(x[0], x[-1]), ylim=(z.min() - room, z.max() + 1.4 * room))
    axes.set(xlabel="abscissa of the profile [mm]", ylabel=f"surface {side} [µm]")
    ra, rq, rsk = surface.statistics.values()
    parameters = f"Ra {1e6 * ra:.3f} µm, Rq {1e6 * rq:.3f} µm, Rsk {rsk:.2f}"
    axes.set_title("; ".join(filter(None, (parameters, arrives))), fontsize="small", loc="left")
    axes.legend(loc="upper right", ncols=2, frameon=False, **style.SMALL)


def draw_map(axes: Axes, side: str, surface: RoughSurface, case: Case, scales: Scales) -> None:
    """Draw the map of a surface, pale beyond the part that passes the whole contact, and the dry contact."""
    width = scales.grid.spacings[0] * scales.grid.shape[0]
    X, z = heights_on_rows(surface, scales, min(surface.given.length, MAX_LENGTH * width))
    draw_heights(axes, z, (X[0], X[-1], -0.5 * width, 0.5 * width), interpolation="nearest")
    axes.set(xlabel="abscissa of the map [mm]", ylabel=f"surface {side}, across [mm]")
    found, arrives = surface.given.parameters, arrival(surface, case, scales)
    texts = f"Sa {1e6 * found['Sa']:.3f} µm, Sq {1e6 * found['Sq']:.3f} µm, Sdq {found['Sdq']:.3g}"
    if np.isfinite(found["Str"]):
        texts += f", Str {found['Str']:.2g}"
    if arrives:
        texts += f"\n{arrives}"
    _, end = passing(surface, case, scales)
    if end < X[-1]:
        texts += "; pale: does not pass the whole contact"
        axes.axvspan(1e3 * max(end, X[0]), 1e3 * X[-1], color="w", alpha=0.6, lw=0)
    axes.set_title(texts, fontsize="small", loc="left")
    a, centre, line = 1e3 * scales.a, 1e3 * (X[0] + 1.2 * scales.a), dict(fill=False, color="k", lw=1.0)
    if np.isfinite(scales.b):
        axes.add_patch(Ellipse((centre, 0.0), 2.0 * a, 2e3 * scales.b, **line))
    else:
        axes.add_patch(Rectangle((centre - a, -5e2 * width), 2.0 * a, 1e3 * width, **line))


def heights_on_rows(surface: RoughSurface, scales: Scales, length: float) -> tuple[np.ndarray, np.ndarray]:
    """Abscissas [m] up to a length, and mean heights [m] of the rows of the mesh there, shape (ny, n)."""
    topography, dy, ny = surface.given, scales.grid.spacings[0], scales.grid.shape[0]
    rows = np.atleast_2d(topography.row_means(topography.middle + dy * (np.arange(ny + 1) - 0.5 * ny)).T)
    X = np.linspace(topography.X[0], topography.X[0] + length, min(MAX_PIXELS, len(topography.X)))
    z = np.stack([np.interp(X, topography.X, row) for row in rows])
    return X, np.broadcast_to(z, (ny, len(X)))
