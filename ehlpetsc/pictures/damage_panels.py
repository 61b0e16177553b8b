"""Plots of stresses, histories and damage, drawn into axes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.ticker import MaxNLocator

from ehlpetsc.pictures import style
from ehlpetsc.post.fatigue.accumulate import CHANNELS
from ehlpetsc.post.fatigue.cycles import rainflow
from ehlpetsc.post.stresses.half_plane import von_mises

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.contour import ContourSet
    from matplotlib.figure import Figure

    from ehlpetsc.post.fatigue.strain_life import Material
    from ehlpetsc.results.post_result import PostResult


DECADES = 7  # of damage below the maximum, as in figure 8 of the paper
COMPONENTS = (r"$\sigma_x$", r"$\sigma_z$", r"$\tau_{xz}$")
VON_MISES = r"$\sigma_{vM}$"
MARKED_CYCLES = 12  # in the picture of a history
DARK = "#222222"
HOT = "#cc3311"


STRAIN_RULES = {"direct": "elastic range as it is", "neuber": "Neuber's rule", "glinka": "Glinka's rule"}


def strain_rule(result: PostResult) -> str:
    """Rule for the elastic stress range of a result, for titles."""
    return STRAIN_RULES[result.attrs.get("strain", "direct")]


def decades(largest: float) -> np.ndarray | None:
    """Integer powers of ten up to above the largest damage; None without damage."""
    if not (np.isfinite(largest) and largest > 0):
        return None
    top = int(np.ceil(np.log10(largest)))
    return np.arange(top - DECADES, top + 1)


def along_body(result: PostResult, surface: str, s: Any) -> Any:
    """Abscissa [mm] of the profile: distance from the point that was at the inlet at time 0."""
    passed = result.s[result.complete[surface]]
    if result.attrs.get(f"speed_{surface}", 1.0) < 0:
        return 1e3 * (s - result.attrs.get("outlet", passed[0]))
    return 1e3 * (result.attrs.get("inlet", passed[-1]) - s)


def body_label(surface: str) -> str:
    """Label of an axis of :func:`along_body`."""
    return f"along surface {surface} [mm]"


def stretch(result: PostResult, surface: str, longest: float | None = None) -> tuple[float, float]:
    """Ends [mm] of the points that passed, or of the first `longest` half widths of them."""
    low, high = np.sort(along_body(result, surface, result.s[result.complete[surface]][[0, -1]]))
    return low, min(high, low + 1e3 * result.a * (longest or np.inf))


def profile(axes: Axes, result: PostResult, surface: str, ends: tuple[float, float]) -> None:
    """Draw the profile between two ends in mm, heights in µm."""
    axes.set_ylabel("z [µm]")
    axes.axhline(0, color="0.8", lw=0.6)
    axes.yaxis.set_major_locator(MaxNLocator(3))
    if surface in result.profiles:
        s, z = result.profiles[surface]
        x = along_body(result, surface, s)
        shown = (x >= ends[0]) & (x <= ends[1])
        axes.plot(x[shown], z[shown] * 1e6, color=DARK, lw=0.8)


def temperatures(axes: Axes, result: PostResult, surface: str) -> None:
    """Draw flash and mean temperature rise of the points of a surface over mm."""
    temperature, passed = result.temperatures[surface], result.complete[surface]
    x, bulk = along_body(result, surface, result.s[passed]), temperature.highest - temperature.flash
    axes.plot(x, temperature.flash[passed], color=HOT, lw=0.8, label="flash")
    axes.plot(x, (temperature.mean - bulk)[passed], color=DARK, lw=0.8, ls="--", label="mean in\nthe contact")
    axes.set_ylabel("temperature\nover bulk [K]")
    axes.set_ylim(bottom=0.0)
    axes.yaxis.set_major_locator(MaxNLocator(4))
    style.legend_beside(axes)


def _under_surface(
    axes: Axes, result: PostResult, surface: str, ends: tuple[float, float], depths: np.ndarray, gap: float
) -> tuple[np.ndarray, np.ndarray]:
    """Set the axes of a map under a surface, in mm, z/a and µm; returns abscissae and depths."""
    depth, ticks = _depth_axis(depths, gap)
    axes.set_yticks(depth[ticks], [f"{z:g}" for z in depths[ticks]])
    axes.set_xlim(*ends)
    axes.set_ylabel("z/a")
    if len(depth) > 1:
        axes.set_ylim(depth[-1], depth[0])
        right_axis = axes.secondary_yaxis("right")
        right_axis.set_yticks(depth[ticks], [f"{1e6 * z * result.a:.3g}" for z in depths[ticks]])
        right_axis.set_ylabel("z [µm]")
    return along_body(result, surface, result.s[result.complete[surface]]), depth


def damage_contours(
    axes: Axes,
    result: PostResult,
    surface: str,
    ends: tuple[float, float],
    levels: np.ndarray,
    deepest: float = np.inf,
    gap: float = 0.07,
) -> ContourSet | None:
    """Draw filled contours of log10 D over body point and square root of depth.

    Ticks are `gap` of the axis or more apart.
    """
    z = result.z[result.z <= max(deepest, result.z[:2].max())]
    x, depth = _under_surface(axes, result, surface, ends, z, gap)
    if levels is None or len(depth) < 2:
        axes.text(
            0.5, 0.5, "no damage" if levels is None else "one depth", transform=axes.transAxes, ha="center"
        )
        return None
    shown = np.log10(np.maximum(result.passed(surface)[: z.size], 10.0 ** (levels[0] - 1.0)))
    return axes.contourf(x, depth, shown, levels=levels, cmap="inferno_r", extend="min")


def utilisation_contours(
    figure: Figure,
    axes: Axes,
    result: PostResult,
    surface: str,
    values: np.ndarray,
    ends: tuple[float, float],
) -> None:
    """Draw filled contours of the utilisation of a fatigue limit, and its contour at 1."""
    x, depth = _under_surface(axes, result, surface, ends, result.z, 0.1)
    if len(depth) < 2:
        return
    shown = values[:, result.complete[surface]]
    levels = MaxNLocator(10).tick_values(0, np.quantile(shown, 0.999))
    mesh = axes.contourf(x, depth, shown, levels=levels, cmap="viridis", extend="max")
    if shown.min() < 1 < shown.max():
        axes.contour(x, depth, shown, levels=[1.0], colors="white", linewidths=0.8)
    figure.colorbar(mesh, ax=axes, pad=0.01, ticks=ticks_within(levels))


def _depth_axis(z: np.ndarray, gap: float) -> tuple[np.ndarray, list[int]]:
    """Square root of depth, which stretches the layer near the surface, and ticks at least `gap` apart."""
    depth = np.sqrt(z)
    gap *= depth[-1] - depth[0] or 1.0
    ticks: list[int] = []
    for k, root in enumerate(depth):
        if not ticks or root - depth[ticks[-1]] >= gap:
            ticks.append(k)
    return depth, ticks


def stress_field(axes: Axes, x: np.ndarray, z: np.ndarray, values: np.ndarray, label: str) -> ContourSet:
    """Draw one stress over x/a and z/a, z downwards; colours centred on zero unless it has one sign.

    The colours span all but the highest and lowest thousandths, because peaks below single asperities would
    leave all other values in one colour.
    """
    low, high = np.quantile(values, [0.001, 0.999])
    limit = max(-low, high)
    colours = "viridis"
    if low < -0.1 * limit and high > 0.1 * limit:
        low, high, colours = -limit, limit, "RdBu_r"
    if high <= low:
        high = low + 1.0
    levels = MaxNLocator(25).tick_values(low, high)
    mesh = axes.contourf(x, z, values, levels=levels, cmap=colours, extend="both")
    axes.set_ylim(z[-1], z[0])
    axes.set_ylabel("z/a")
    axes.set_title(label, fontsize=9, loc="left")
    return mesh


def mark_largest(axes: Axes, x: np.ndarray, z: np.ndarray, values: np.ndarray, a: float) -> None:
    """Mark the largest von Mises stress, with its depth in the title; z in half widths."""
    k, j = np.unravel_index(values.argmax(), values.shape)
    axes.plot(x[j], z[k], "x", color="#cc3311", ms=6)
    axes.set_title(
        f"{VON_MISES}, largest {values[k, j]:.3g} GPa at z/a = {z[k]:.3g}, {1e6 * z[k] * a:.3g} µm deep",
        fontsize=9,
        loc="left",
    )


def ticks_within(levels: np.ndarray) -> np.ndarray:
    """About five round values within the range of `levels`."""
    ticks = MaxNLocator(5).tick_values(levels[0], levels[-1])
    return ticks[(ticks >= levels[0]) & (ticks <= levels[-1])]


def stress_fields(sx: np.ndarray, sz: np.ndarray, txz: np.ndarray, nu: float) -> dict[str, np.ndarray]:
    """The four stresses of the picture, GPa, by label."""
    names = (*COMPONENTS, VON_MISES)
    stresses = (sx, sz, txz, von_mises(sx, sz, txz, nu))
    return {name: values / 1e9 for name, values in zip(names, stresses, strict=True)}


def history(axes: Axes, time: np.ndarray, values: np.ndarray, channel: int) -> np.ndarray:
    """Draw three components over time and the largest cycles of the counted one; returns its cycles."""
    for values_of, name, color in zip(values, COMPONENTS, ("#4477aa", DARK, "#228833"), strict=True):
        axes.plot(time, values_of / 1e9, lw=0.9, color=color, label=name)
    counted = values[channel] / 1e9
    cycles = rainflow(counted)
    for row in cycles[np.argsort(-cycles[:, 0])][:MARKED_CYCLES][::-1]:
        i, j = int(row[3]), int(row[4])
        axes.plot(time[[i, j]], counted[[i, j]], "o", ms=3, color="#cc3311")
        axes.vlines(time[j], *sorted((counted[i], counted[j])), color="#cc3311", lw=0.8)
        axes.hlines(counted[i], *sorted((time[i], time[j])), color="#cc3311", lw=0.5, ls=":")
    axes.set_ylabel("stress [GPa]")
    style.legend_beside(axes)
    return cycles


def surface_temperature(axes: Axes, time: np.ndarray, temperature: np.ndarray) -> None:
    """Draw the surface temperature of a body point over time."""
    axes.plot(time, temperature, color=HOT, lw=0.9)
    axes.set_ylabel("temperature\nof the surface [K]")


def cycle_histogram(axes: Axes, cycles: np.ndarray, damages: np.ndarray) -> None:
    """Draw range and damage of each cycle above 1e-12 of the largest damage."""
    shown = damages > 1e-12 * damages.max(initial=0.0)
    axes.scatter(cycles[shown, 0], damages[shown], s=10, color="#cc3311")
    axes.set_yscale("log")
    left_out = np.count_nonzero(~shown)
    if left_out:
        axes.set_title(
            f"{left_out} cycles of less than 1e-12 of the largest left out", fontsize=8, loc="left"
        )
    axes.set_xlabel("range of the counted stress [GPa]")
    axes.set_ylabel("1/N of the cycle")
    axes.grid(color="0.92")
    axes.set_axisbelow(True)


def counted_channel(count: str, values: np.ndarray, material: Material) -> int:
    """Channel of the cycles in a picture: the counted one, or that of the largest damage."""
    from ehlpetsc.post.fatigue.accumulate import damage

    if len(CHANNELS[count]) == 1:
        return min(CHANNELS[count][0], 2)
    names, (dx, dz, dt) = ("sx", "sz", "txz"), values
    return int(np.argmax([damage(dx, dz, dt, material, count=name).damage for name in names]))
