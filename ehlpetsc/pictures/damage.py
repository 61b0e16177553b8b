"""Pictures of post-processing as PNG and SVG: maps of damage, its distribution over asperities."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, MaxNLocator

from ehlpetsc.base.errors import PostError
from ehlpetsc.pictures import style
from ehlpetsc.pictures.stresses import along_body, field_picture, history_picture
from ehlpetsc.post.fatigue.statistics import exceedance, fitted_exceedance
from ehlpetsc.results.output_guard import PICTURES, check_derived
from ehlpetsc.results.post_result import PostResult, WeibullFit

FORMATS = ("png", "svg")
DECADES = 7  # of damage below the maximum, as in figure 8 of the paper
SECTION_LENGTH = 2.0  # half-widths of profile where several maps are compared, as in the paper
MIN_TICK_DISTANCE = 0.09  # of the depth axis
CRITERIA = {
    "fatemi-socie": "Fatemi-Socie",
    "dang-van": "Dang Van: share of the fatigue limit; line: 1",
}


class Map(NamedTuple):
    """A quantity (nz, ns) below one surface of a result: damage, or the utilisation of a fatigue limit."""

    label: str
    result: PostResult
    values: np.ndarray
    is_damage: bool = True


def draw(inputs: Sequence[str], outputs: Sequence[str], folder: str) -> list[str]:
    """Draw all pictures of result files and their post-processing results; returns the names of the files.

    `folder` is "" for that of each result.
    """
    names = []
    if folder:
        Path(folder).mkdir(parents=True, exist_ok=True)
    for path, output in zip(inputs, outputs, strict=True):
        stem = Path(folder or Path(output).parent) / Path(path).stem
        names += _of_one(path, PostResult(output), stem)
    return names


def _save(figure: Figure, stem: str | Path) -> list[str]:
    """Write all formats; returns their names."""
    names = [f"{stem}.{kind}" for kind in FORMATS]
    for name in names:
        check_derived(Path(name), (), PICTURES, "--pictures")
    style.save(figure, *names)
    return names


def _of_one(path: str, result: PostResult, stem: Path) -> list[str]:
    names = []
    for surface in result.surfaces:
        if result.complete[surface].any():
            names += _save(damage_picture(result, surface), f"{stem}.damage_{surface}")
            if result.criteria:
                names += _save(criteria_picture(result, surface), f"{stem}.criteria_{surface}")
    if result.height.size:
        names += _save(depth_picture(result), f"{stem}.exceedance")
    names += _save(field_picture(path, result), f"{stem}.stress")
    return names + _save(history_picture(path, result), f"{stem}.history")


def damage_picture(result: PostResult, surface: str) -> Figure:
    """Damage under the whole profile (figure 8 of Holmes et al. 2005), with [heat] the temperatures."""
    s, z = result.worst_point(surface)
    place = f"{along_body(result, surface, s):.4g} mm, z/a = {z:g} (s/a = {s / result.a:.5g})"
    maximum = np.nanmax(result.damage[surface])
    title = [
        f"surface {surface}, {_ratio(result)}, {rule_name(result)}",
        f"maximum damage {maximum:.2g} at {place}",
    ]
    return draw_maps([Map("", result, result.damage[surface])], surface, title)


def criteria_picture(result: PostResult, surface: str) -> Figure:
    """Damage by all criteria on one scale, and the utilisation of the fatigue limit."""
    maps = [Map("von Mises ranges", result, result.damage[surface])]
    for name, label in CRITERIA.items():
        if name in result.criteria:
            maps.append(Map(label, result, result.criteria[name][surface], name != "dang-van"))
    return draw_maps(maps, surface, [f"surface {surface}, {_ratio(result)}"], SECTION_LENGTH)


def draw_maps(
    maps: list[Map], surface: str, title: list[str], longest: float = np.inf, deepest: float = np.inf
) -> Figure:
    """The profile above maps of log10 D; of at most `longest` half-widths, down to z/a = `deepest`."""
    first = maps[0].result
    heated = len(maps) == 1 and surface in first.temperatures
    heights = [0.8] * (1 + heated) + [2.4 if len(maps) == 1 else 1.5] * len(maps)
    size = (8.0, 1.0 + 1.1 * sum(heights))
    figure, axes = style.new_figure(len(heights), 1, size, sharex=True, height_ratios=heights, squeeze=False)
    panels, rows = axes[: 1 + heated, 0], axes[1 + heated :, 0]
    profile(panels[0], first, surface)
    if heated:
        temperatures(panels[1], first, surface)
    used = [one.values[:, one.result.complete[surface]] for one in maps if one.is_damage]
    levels, contours = decades(max(np.nanmax(values) for values in used)), []
    for row, one in zip(rows, maps, strict=True):
        row.set_title(one.label, fontsize="small", loc="left")
        if one.is_damage:
            drawn = damage_map(row, one, surface, levels, deepest)
            contours += [drawn] if drawn else []
        elif drawn := utilisation_map(row, one, surface):
            figure.colorbar(drawn, ax=row, pad=0.02)
    if contours:
        shown = [row for row, one in zip(rows, maps, strict=True) if one.is_damage]
        powers = FuncFormatter(lambda power, _: f"$10^{{{power:.0f}}}$")
        figure.colorbar(contours[0], ax=shown, label="damage D of one pass", pad=0.02, format=powers)
    rows[-1].set_xlim(*stretch([one.result for one in maps], surface, longest))
    rows[-1].set_xlabel(f"along surface {surface} [mm]")
    figure.align_ylabels(list(axes[:, 0]))
    style.set_title(figure, *title)
    return figure


def stretch(results: list[PostResult], surface: str, longest: float = np.inf) -> tuple[float, float]:
    """Ends [mm] of the points that passed in all results, or of the first `longest` half-widths of them."""
    ends = [np.sort(along_body(one, surface, one.s[one.complete[surface]][[0, -1]])) for one in results]
    low, high = max(low for low, _ in ends), min(high for _, high in ends)
    if high <= low:
        raise PostError(f"no point of surface {surface} passed the whole contact in all of the results")
    return low, min(high, low + 1e3 * results[0].a * longest)


def profile(axes: Axes, result: PostResult, surface: str) -> None:
    """Draw the profile in view, heights in µm over mm."""
    axes.set_ylabel("z [µm]")
    axes.axhline(0.0, color="0.8", lw=0.6)
    if surface in result.profiles:
        s, z = result.profiles[surface]
        shown = (s >= result.s[result.complete[surface]][0]) & (s <= result.s[result.complete[surface]][-1])
        axes.plot(along_body(result, surface, s[shown]), 1e6 * z[shown], color=style.DARK, lw=0.8)


def temperatures(axes: Axes, result: PostResult, surface: str) -> None:
    """Draw flash and mean temperature rise of the points that passed over mm."""
    temperature, passed = result.temperatures[surface], result.complete[surface]
    x = along_body(result, surface, result.s[passed])
    bulk = temperature.highest - temperature.flash
    axes.plot(x, temperature.flash[passed], color=style.SECOND, lw=0.8, label="flash")
    axes.plot(
        x, (temperature.mean - bulk)[passed], "--", color=style.DARK, lw=0.8, label="mean in\nthe contact"
    )
    axes.set_ylabel("temperature\nover bulk [K]")
    axes.set_ylim(bottom=0.0)
    style.legend_beside(axes)


def decades(maximum: float) -> np.ndarray | None:
    """Integer powers of ten up to above the maximum damage; None without damage."""
    if not (np.isfinite(maximum) and maximum > 0.0):
        return None
    top = int(np.ceil(np.log10(maximum)))
    return np.arange(top - DECADES, top + 1)


def damage_map(
    axes: Axes, one: Map, surface: str, levels: np.ndarray | None, deepest: float = np.inf
) -> ContourSet | None:
    """Draw contours of log10 D; returns them."""
    x, z, values = _under_surface(axes, one, surface, deepest)
    if levels is None or len(z) < 2:
        text = "no damage" if levels is None else "one depth"
        axes.text(0.5, 0.5, text, transform=axes.transAxes, ha="center")
        return None
    shown = np.log10(np.maximum(values, 10.0 ** (levels[0] - 1.0)))
    return axes.contourf(x, z, shown, levels=levels, cmap="inferno_r", extend="min")


def utilisation_map(axes: Axes, one: Map, surface: str) -> ContourSet | None:
    """Draw contours of the utilisation of a fatigue limit and a line at 1; returns them."""
    x, z, values = _under_surface(axes, one, surface)
    if len(z) < 2:
        return None
    levels = MaxNLocator(10).tick_values(0.0, np.quantile(values, 0.999))
    if values.min() < 1.0 < values.max():
        axes.contour(x, z, values, levels=[1.0], colors="white", linewidths=0.8)
    return axes.contourf(x, z, values, levels=levels, cmap="viridis", extend="max", zorder=0)


def _under_surface(
    axes: Axes, one: Map, surface: str, deepest: float = np.inf
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Set a depth axis in z/a and µm that stretches the layer near the surface; returns abscissae, ordinates,
    values of the points that passed."""
    result, passed = one.result, one.result.complete[surface]
    count = np.count_nonzero(result.z <= max(deepest, result.z[:2].max()))
    z, ticks = np.sqrt(result.z[:count]), [0]
    for k, root in enumerate(z):
        if root - z[ticks[-1]] >= MIN_TICK_DISTANCE * np.ptp(z) > 0.0:
            ticks.append(k)
    axes.set_yticks(z[ticks], [f"{depth:g}" for depth in result.z[ticks]])
    axes.set_ylabel("z/a")
    if count > 1:
        axes.set_ylim(z[-1], z[0])
        beside = axes.secondary_yaxis("right")
        beside.set_yticks(z[ticks], [f"{1e6 * depth * result.a:.3g}" for depth in result.z[ticks]])
        beside.set_ylabel("z [µm]")
    return along_body(result, surface, result.s[passed]), z, one.values[:count, passed]


def depth_picture(result: PostResult) -> Figure:
    """Distributions of damage at the asperities of one surface, by depth (figure 10)."""
    curves = [(f"z/a = {z:g}", result.under[k], result.fits[k]) for k, z in enumerate(result.z)]
    counted = f"{result.height.size} asperities, surface {result.main}, {_ratio(result)}"
    return draw_distributions(curves, f"{counted}, {rule_name(result)}")


def draw_distributions(curves: list[tuple[str, np.ndarray, WeibullFit]], title: str) -> Figure:
    """Fractions of asperities above a damage with their Weibull fits; curves: label, damage, fit."""
    figure, axes = style.new_figure(1, 1, (7.0, 4.0))
    for (label, under, fit), colour in zip(curves, style.shades(len(curves)), strict=True):
        falling, fraction = exceedance(under)
        damaged = falling[falling > 0.0]
        axes.plot(damaged, fraction[falling > 0.0], ".", ms=3, color=colour)
        values = np.geomspace(damaged[-1] / 3.0, 3.0 * damaged[0], 300) if damaged.size else damaged
        axes.plot(values, fitted_exceedance(values, fit.alpha, fit.beta), color=colour, lw=1.2, label=label)
    axes.set(xscale="log", ylim=(0.0, 1.0))
    axes.set(xlabel="damage D of one pass", ylabel="share of asperities above D")
    axes.grid(color="0.92")
    style.legend_beside(axes, title="dots: asperities\nlines: Weibull fit")
    style.set_title(figure, title)
    return figure


def _ratio(result: PostResult) -> str:
    return f"slide/roll ratio {result.ratio:.3g}"


def rule_name(result: PostResult) -> str:
    """Rule by which the elastic range enters the cyclic stress-strain curve."""
    return f'strain = "{result.attrs.get("strain", "direct")}"'
