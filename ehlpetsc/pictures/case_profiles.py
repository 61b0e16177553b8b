"""Profiles of a case before a run, with the part that passes the contact, and their bearing curves."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ehlpetsc.base.errors import OutputError
from ehlpetsc.case.loading import Case, load
from ehlpetsc.physics.scales import Scales
from ehlpetsc.pictures import style
from ehlpetsc.surfaces.parameters import abbott_curve, core, roughness_parameters
from ehlpetsc.surfaces.profile import Profile
from ehlpetsc.surfaces.profile_checks import entry_times
from ehlpetsc.surfaces.roughness import Roughness

SIZE = (12.0, 3.6)  # inches, for each profile
MAX_POINTS = 20_000  # drawn of a profile
MIN_VARIANCE = 1e-3  # of the heights, that is printed
NAMES = {"ra": "Ra", "rq": "Rq", "rz": "Rz", "rk": "Rk", "rpk": "Rpk", "rvk": "Rvk"}


def draw_case(path: Path | str, overrides: Iterable[str] = ()) -> Figure:
    """Profiles of a case file; overrides as in `ehlpetsc.load`."""
    case = load(path, overrides)
    scales = Scales.of(case)
    rough = Roughness.of(case, scales)
    sides = [side for side in ("1", "2") if rough and rough.side(side)]
    if not sides:
        raise OutputError(f"{path}: both surfaces are smooth: there is no profile to draw")
    size = (SIZE[0], SIZE[1] * len(sides) + 0.5)
    figure, axes = style.new_figure(len(sides), 2, size, squeeze=False, width_ratios=(3.2, 1.0))
    for row, side in zip(axes, sides, strict=True):
        profile = rough.side(side)
        _heights(row[0], profile, case, scales, side)
        _abbott(row[1], profile, style.SURFACES[side])
    texts = [f"a = {1e3 * scales.a:.3g} mm", f"p0 = {1e-9 * scales.p0:.3g} GPa"]
    if case.motion:
        texts.append(f"u = {scales.u:g} m/s, slide/roll ratio {scales.xi:g}")
    style.set_title(figure, case.title, ", ".join(texts))
    return figure


def passing(profile: Profile, case: Case, scales: Scales) -> tuple[float, float]:
    """Ends [m] of the part of a profile that passes the whole contact; equal if there is none."""
    first, last = float(profile.X[0]), float(profile.X[-1])
    arrives = entry_times(profile, scales)
    if arrives is None:
        return first, last
    if not profile.repeats:
        return (first, last) if case.time.travel >= arrives[1] else (first, first)
    slower = scales.u_max / abs(profile.speed)
    through = scales.a * (case.time.travel - arrives[0] - 2.0 * slower) / slower
    return first, float(np.clip(first + through, first, last))


def _heights(axes: Axes, profile: Profile, case: Case, scales: Scales, side: str) -> None:
    X, z = profile.X, profile.heights
    stride = -(-len(X) // MAX_POINTS)
    axes.plot(1e3 * X[::stride], 1e6 * z[::stride], color=style.FAINT, lw=0.7)
    begin, end = passing(profile, case, scales)
    inside = (X >= begin) & (X <= end)
    if end > begin:
        passes = 1e3 * X[inside][::stride], 1e6 * z[inside][::stride]
        axes.plot(*passes, color=style.SURFACES[side], lw=0.8)
    top, bottom = 1e6 * z.max(), 1e6 * z.min()
    room, at = 0.18 * (top - bottom), 1e3 * X[0] + 0.03e3 * (X[-1] - X[0])
    axes.set(xlim=(1e3 * X[0], 1e3 * X[-1]), ylim=(bottom - room, top + 1.4 * room))
    axes.set(xlabel="abscissa of the profile [mm]", ylabel=f"surface {side} [µm]")
    width = min(2e3 * scales.a, 0.5e3 * (X[-1] - X[0]))
    axes.plot([at, at + width], [top + 0.5 * room] * 2, color="k", lw=2.0)
    name = "2a" if width == 2e3 * scales.a else f"{width / (1e3 * scales.a):.2g} a"
    place = dict(xytext=(4, 0), textcoords="offset points", va="center")
    axes.annotate(name, (at + width, top + 0.5 * room), **place)
    axes.set_title(_description(profile, case, scales, begin, end), fontsize="small", loc="left")


def _description(profile: Profile, case: Case, scales: Scales, begin: float, end: float) -> str:
    coarse = profile.unresolved_variance(scales.dx)
    share = f"{100 * coarse:.2g} %" if coarse > MIN_VARIANCE else f"less than {100 * MIN_VARIANCE:g} %"
    mesh = f"{share} of the height variance in waves of fewer than 4 nodes"
    arrives = entry_times(profile, scales)
    if case.time is None or arrives is None:
        return f"under the domain from the start; {mesh}"
    part = "in colour: passes" if profile.X[-1] > end > begin else "none of it passes"
    part = "all of it passes" if end >= profile.X[-1] > begin else part
    enters = f"its left end enters first and reaches the contact at travel {arrives[0]:.2f} a"
    return f"{enters}\n{part} the whole contact within travel {case.time.travel:g} a; {mesh}"


def _abbott(axes: Axes, profile: Profile, colour: str) -> None:
    ratio, height = abbott_curve(profile.X, profile.heights)
    parameters, fit = roughness_parameters(profile.X, profile.heights), core(ratio, height)
    axes.plot(100.0 * ratio, 1e6 * height, color=colour, lw=1.2)
    axes.plot([0.0, 100.0], [1e6 * fit["top"], 1e6 * fit["bottom"]], color="0.35", lw=0.9, ls="--")
    axes.set(xlabel="material ratio [%]", ylabel="height [µm]", xlim=(0.0, 100.0))
    lines = [f"{name} {1e6 * parameters[key]:.3f} µm" for key, name in NAMES.items()]
    lines.insert(3, f"Rsk {parameters['rsk']:.2f}")
    axes.text(1.04, 0.5, "\n".join(lines), transform=axes.transAxes, va="center", fontsize="small")
