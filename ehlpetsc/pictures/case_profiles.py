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
    x, z = 1e3 * profile.X, 1e6 * profile.heights
    axes.plot(x, z, color=style.FAINT, lw=0.7)
    begin, end = passing(profile, case, scales)
    inside = (profile.X >= begin) & (profile.X <= end) & (end > begin)
    axes.plot(x[inside], z[inside], color=style.SURFACES[side], lw=0.8, label="passes the whole contact")
    room = 0.18 * np.ptp(z)
    width = dict(color="k", lw=2.0, label=f"2a = {2e3 * scales.a:.3g} mm")
    axes.plot([x[0], x[0] + 2e3 * scales.a], [z.max() + 0.5 * room] * 2, **width)
    axes.set(xlim=(x[0], x[-1]), ylim=(z.min() - room, z.max() + 1.4 * room))
    axes.set(xlabel="abscissa of the profile [mm]", ylabel=f"surface {side} [µm]")
    axes.set_title(_description(profile, case, scales), fontsize="small", loc="left")
    axes.legend(loc="upper right", ncols=2, frameon=False, **style.SMALL)


def _description(profile: Profile, case: Case, scales: Scales) -> str:
    coarse = 100.0 * profile.unresolved_variance(scales.dx)
    mesh = f"{coarse:.2g} % of the height variance in waves of fewer than 4 nodes" if coarse > 0.1 else ""
    arrives = entry_times(profile, scales)
    if case.time is None or arrives is None:
        return ", ".join(filter(None, ["under the domain from the start", mesh]))
    enters = (
        f"left end enters first, reaches the contact at travel {arrives[0]:.2f} a of {case.time.travel:g} a"
    )
    return "\n".join(filter(None, [enters, mesh]))


def _abbott(axes: Axes, profile: Profile, colour: str) -> None:
    ratio, height = abbott_curve(profile.X, profile.heights)
    parameters, fit = roughness_parameters(profile.X, profile.heights), core(ratio, height)
    axes.plot(100.0 * ratio, 1e6 * height, color=colour, lw=1.2)
    axes.plot([0.0, 100.0], [1e6 * fit["top"], 1e6 * fit["bottom"]], color="0.35", lw=0.9, ls="--")
    axes.set(xlabel="material ratio [%]", ylabel="height [µm]", xlim=(0.0, 100.0))
    lines = [f"{name} {1e6 * parameters[key]:.3f} µm" for key, name in NAMES.items()]
    lines.insert(3, f"Rsk {parameters['rsk']:.2f}")
    axes.text(1.04, 0.5, "\n".join(lines), transform=axes.transAxes, va="center", fontsize="small")
