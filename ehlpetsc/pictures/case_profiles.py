"""Picture of a case before a run: profiles, with the part that passes the contact."""

import numpy as np

from ehlpetsc.case.loading import load
from ehlpetsc.errors import CaseError, OutputError
from ehlpetsc.physics.scales import Scales
from ehlpetsc.pictures import labels
from ehlpetsc.surfaces.parameters import abbott_curve, core, roughness_parameters
from ehlpetsc.surfaces.profile_checks import entry_times
from ehlpetsc.surfaces.roughness import Roughness

SIZE = (12.0, 3.6)  # inches, for each profile
MAX_POINTS = 20_000  # drawn of a profile
PASSING_COLOUR, OTHER_COLOUR = labels.SINGLE_COLOUR, "0.65"
NAMES = {"ra": "Ra", "rq": "Rq", "rz": "Rz", "rk": "Rk", "rpk": "Rpk", "rvk": "Rvk"}


def draw_case(path, overrides=()):
    """Figure of the profiles of a case file.

    Parameters
    ----------
    path : path-like
    overrides : iterable of str
        See `ehlpetsc.load`.

    Raises
    ------
    OutputError
        The case has faults, or both surfaces are smooth.
    """
    try:
        case = load(path, overrides)
    except CaseError as error:
        raise OutputError("\n".join(error.faults)) from None
    scales = Scales.of(case)
    rough = Roughness.of(case, scales)
    sides = [side for side in ("1", "2") if rough and rough.side(side)]
    if not sides:
        raise OutputError(f"{path}: both surfaces are smooth: there is no profile to draw")
    size = (SIZE[0], SIZE[1] * len(sides) + 0.5)
    figure, axes = labels.new_figure(len(sides), 2, size, squeeze=False, width_ratios=(3.2, 1.0))
    for row, side in zip(axes, sides, strict=True):
        profile = rough.side(side)
        _heights(row[0], profile, case, scales, side)
        _abbott(row[1], profile)
    figure.suptitle(f"{case.title}\n{conditions(case, scales)}", fontsize="medium")
    return figure


def conditions(case, scales):
    """Text with half-width, Hertz pressure and speeds."""
    texts = [f"a = {1e3 * scales.a:.3g} mm", f"p0 = {1e-9 * scales.p0:.3g} GPa"]
    if case.motion:
        texts.append(f"u = {scales.u:g} m/s, slide/roll ratio {scales.xi:g}")
    return ", ".join(texts)


def passing(profile, case, scales):
    """Part of a profile that passes the whole contact during a run.

    Returns
    -------
    begin, end : float
        Abscissas [m]; equal if there is no such part.
    """
    first, last = float(profile.X[0]), float(profile.X[-1])
    arrives = entry_times(profile, scales)
    if arrives is None:
        return first, last
    if not profile.repeats:
        return (first, last) if case.time.travel >= arrives[1] else (first, first)
    slower = scales.u_max / abs(profile.speed)
    through = scales.a * (case.time.travel - arrives[0] - 2.0 * slower) / slower
    return first, float(np.clip(first + through, first, last))


def _heights(axes, profile, case, scales, side):
    X, z = profile.X, profile.heights
    stride = -(-len(X) // MAX_POINTS)
    axes.plot(1e3 * X[::stride], 1e6 * z[::stride], color=OTHER_COLOUR, lw=0.7)
    begin, end = passing(profile, case, scales)
    inside = (X >= begin) & (X <= end)
    if end > begin:
        axes.plot(1e3 * X[inside][::stride], 1e6 * z[inside][::stride], color=PASSING_COLOUR, lw=0.8)
    axes.set_xlim(1e3 * X[0], 1e3 * X[-1])
    top, bottom = 1e6 * z.max(), 1e6 * z.min()
    room = 0.18 * (top - bottom)
    axes.set_ylim(bottom - room, top + 1.4 * room)
    axes.set(xlabel="abscissa of the profile [mm]", ylabel=f"surface {side} [µm]")
    width = min(2e3 * scales.a, 0.5e3 * (X[-1] - X[0]))
    at = 1e3 * X[0] + 0.03e3 * (X[-1] - X[0])
    axes.plot([at, at + width], [top + 0.5 * room] * 2, color="k", lw=2.0)
    name = "2a" if width == 2e3 * scales.a else f"{width / (1e3 * scales.a):.2g} a"
    axes.annotate(
        name, (at + width, top + 0.5 * room), xytext=(4, 0), textcoords="offset points", va="center"
    )
    axes.set_title(_description(profile, case, scales, begin, end), fontsize="small", loc="left")


def _description(profile, case, scales, begin, end):
    coarse = profile.unresolved_variance(scales.dx)
    mesh = f"{100 * coarse:.2g} % of the height variance in waves of fewer than 4 nodes"
    if case.time is None or not profile.enters:
        return f"under the domain from the start; {mesh}"
    if end >= profile.X[-1] > begin:
        passing = f"all of it passes the whole contact within travel {case.time.travel:g} a"
    elif end > begin:
        passing = f"dark: passes the whole contact within travel {case.time.travel:g} a"
    else:
        passing = f"none of it passes the contact within travel {case.time.travel:g} a"
    arrives = entry_times(profile, scales)
    enters = f"its left end enters first and reaches the contact at travel {arrives[0]:.2f} a"
    return f"{enters}\n{passing}; {mesh}"


def _abbott(axes, profile):
    ratio, height = abbott_curve(profile.X, profile.heights)
    parameters, fit = roughness_parameters(profile.X, profile.heights), core(ratio, height)
    axes.plot(100.0 * ratio, 1e6 * height, color=PASSING_COLOUR, lw=1.2)
    axes.plot(
        [0.0, 100.0], [1e6 * fit["top"], 1e6 * fit["bottom"]], color=labels.SECOND_COLOUR, lw=0.9, ls="--"
    )
    axes.set(xlabel="material ratio [%]", ylabel="height [µm]", xlim=(0.0, 100.0))
    lines = [f"{name} {1e6 * parameters[key]:.3f} µm" for key, name in NAMES.items()]
    lines.insert(3, f"Rsk {parameters['rsk']:.2f}")
    axes.text(1.04, 0.5, "\n".join(lines), transform=axes.transAxes, va="center", fontsize="small")
