"""Profiles of a case before a run, with the part that passes the contact."""

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
from ehlpetsc.surfaces.profile import Profile
from ehlpetsc.surfaces.profile_checks import entry_times
from ehlpetsc.surfaces.roughness import Roughness

SIZE = (9.0, 3.3)  # inches, for each profile


def draw_case(path: Path | str, overrides: Iterable[str] = ()) -> Figure:
    """Profiles of a case file; overrides as in `ehlpetsc.load`."""
    case = load(path, overrides)
    scales = Scales.of(case)
    rough = Roughness.of(case, scales)
    sides = [side for side in ("1", "2") if rough and rough.side(side)]
    if not sides:
        raise OutputError(f"{path}: both surfaces are smooth: there is no profile to draw")
    size = (SIZE[0], SIZE[1] * len(sides) + 0.5)
    figure, axes = style.new_figure(len(sides), 1, size, squeeze=False)
    for panel, side in zip(axes[:, 0], sides, strict=True):
        draw_heights(panel, rough.side(side), case, scales, style.SURFACES[side])
        panel.set_ylabel(f"surface {side} [µm]")
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


def draw_heights(axes: Axes, profile: Profile, case: Case, scales: Scales, colour: str) -> None:
    """Draw a profile, the part of it that passes the contact, and the width of the contact."""
    x, z = 1e3 * profile.X, 1e6 * profile.heights
    axes.plot(x, z, color=style.FAINT, lw=0.7)
    arrives = entry_times(profile, scales)
    begin, end = passing(profile, case, scales)
    inside = (profile.X >= begin) & (profile.X <= end) & (end > begin)
    label = "passes the whole contact" if arrives else None  # not where it is in the contact from the start
    axes.plot(x[inside], z[inside], color=colour, lw=0.8, label=label)
    room = 0.18 * np.ptp(z)
    width = dict(color="k", lw=2.0, label=f"2a = {2e3 * scales.a:.3g} mm")
    axes.plot([x[0], x[0] + 2e3 * scales.a], [z.max() + 0.5 * room] * 2, **width)
    axes.set(xlim=(x[0], x[-1]), ylim=(z.min() - room, z.max() + 1.4 * room))
    axes.set_xlabel("abscissa of the profile [mm]")
    text = f"Ra {1e6 * profile.ra:.3f} µm, Rq {1e6 * profile.rq:.3f} µm, Rsk {profile.rsk:.2f}"
    if arrives:
        text += f"; left end first, at the contact at travel {arrives[0]:.2f} a of {case.time.travel:g} a"
    axes.set_title(text, fontsize="small", loc="left")
    axes.legend(loc="upper right", ncols=2, frameon=False, **style.SMALL)
