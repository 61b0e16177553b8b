"""Pictures of post-processing as PNG and SVG: maps of damage, its distribution over asperities, stresses."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter

from ehlpetsc.pictures import style
from ehlpetsc.pictures.weibull import draw_distributions, weibull_picture
from ehlpetsc.post.loads import Loads
from ehlpetsc.post.stresses.half_plane import stress, von_mises, von_mises_squared
from ehlpetsc.post.stresses.half_space import StressTensor, stress_plane
from ehlpetsc.results.post_result import PostResult

FORMATS = ("png", "svg")
DECADES = 7  # of damage below the maximum, as in figure 8 of the paper
SECTION_LENGTH = 2.0  # half-widths of profile where several maps are compared, as in the paper
FIELD_DEPTH = 1.5  # half-widths
STRESSES = (r"$\sigma_x$", r"$\sigma_z$", r"$\tau_{xz}$", r"$\sigma_{vM}$")
MIN_TICK_DISTANCE = 0.09  # of the depth axis
SHOWN_CRITERIA = {"fatemi-socie": "Fatemi-Socie", "dang-van": "Dang Van: share of the fatigue limit; line: 1"}
MAP_COLUMNS = 3


def map_picture(
    result: PostResult, surface: str, place: Callable[[np.ndarray], np.ndarray], title: str
) -> Figure:
    """Maps of log10 D of a plane over the surface, one a depth, and its heights.

    `place`: abscissa [mm] of body points s [m].
    """
    passed = result.complete[surface]
    x, y = place(result.s[passed]), 1e3 * result.y
    count = result.z.size + (surface in result.profiles)
    rows = -(-count // MAP_COLUMNS)
    figure, panels = style.new_figure(
        rows, MAP_COLUMNS, (8.0, 1.0 + 2.2 * rows), sharex=True, sharey=True, squeeze=False
    )
    shown = list(panels.flat[:count])
    style.leave_out(panels, count)
    if surface in result.profiles:
        s, heights = result.profiles[surface]
        axes = shown.pop(0)
        low, high = 1e6 * heights.min(), 1e6 * heights.max()
        axes.set_title(f"height, {low:.2g} to {high:.2g} µm", fontsize="small", loc="left")
        axes.pcolormesh(place(s), y, 1e6 * heights, cmap="gray", rasterized=True)
    values = result.damage[surface][..., passed]
    top = int(np.ceil(np.log10(values.max()))) if values.max() > 0.0 else 0
    for axes, z, layer in zip(shown, result.z, values, strict=True):
        axes.set_title(f"z/a = {z:g}", fontsize="small", loc="left")
        powers = np.log10(np.maximum(layer, 10.0 ** (top - DECADES - 1.0)))
        limits = {"vmin": top - DECADES, "vmax": top, "cmap": "inferno_r", "rasterized": True}
        colours = axes.pcolormesh(x, y, powers, **limits)
    figure.colorbar(colours, ax=panels, label=r"$\log_{10}$ D of one pass")
    panels[0, 0].set_xlim(x.min(), x.max())
    figure.supxlabel(f"along surface {surface} [mm]", fontsize="medium")
    figure.supylabel("y [mm]", fontsize="medium")
    style.set_title(figure, title)
    return figure


class Map(NamedTuple):
    """A quantity (nz, ns) below one surface of a result: damage, or the utilisation of a fatigue limit."""

    label: str
    result: PostResult
    values: np.ndarray
    is_damage: bool = True


def draw(
    inputs: Sequence[str],
    outputs: Sequence[str],
    folder: str,
    kinds: Callable[[str, PostResult], Iterator[tuple[str, Figure]]] | None = None,
) -> list[str]:
    """Draw pictures of result files and their post-processing results; returns the names of the files.

    `folder` is "" for that of each result. `kinds` yields names and pictures, by default all of
    :func:`pictures`.
    """
    names = []
    if folder:
        Path(folder).mkdir(parents=True, exist_ok=True)
    for path, output in zip(inputs, outputs, strict=True):
        stem = Path(folder or Path(output).parent) / Path(path).stem
        for kind, figure in (kinds or pictures)(path, PostResult(output)):
            files = [f"{stem}.{kind}.{ending}" for ending in FORMATS]
            style.save(figure, *files)
            names += files
    return names


def pictures(path: str, result: PostResult) -> Iterator[tuple[str, Figure]]:
    """Names and pictures of a result file and its post-processing result."""
    for surface in result.surfaces:
        if not result.complete[surface].any():
            continue
        section = result
        if result.y is not None:
            place = partial(along_body, result, surface)
            yield f"damage_map_{surface}", map_picture(result, surface, place, _conditions(result, surface))
            section = result.section(result.worst_row(surface))
        if result.z.size > 1:
            yield f"damage_{surface}", damage_picture(section, surface)
            if result.criteria:
                yield f"criteria_{surface}", criteria_picture(section, surface)
    if result.height.size:
        yield "exceedance", depth_picture(result)
    yield "stress", field_picture(path, result)


def weibull_pictures(path: str, result: PostResult) -> Iterator[tuple[str, Figure]]:
    """Name and picture of the Weibull distributions, if there are enough asperities."""
    if any(fit.beta > 0 for fit in result.fits):
        yield "weibull", weibull_picture(result)


def damage_picture(result: PostResult, surface: str) -> Figure:
    """Damage under the whole profile (figure 8 of Holmes et al. 2005), with [heat] the temperatures."""
    (s, z), damage = result.worst_point(surface), result.damage[surface]
    place = f"{along_body(result, surface, s):.4g} mm, z/a = {z:g} (s/a = {s / result.a:.5g})"
    title = _conditions(result, surface)
    worst = f"maximum damage {np.nanmax(damage):.2g} at {place}"
    return draw_maps([Map("", result, damage)], surface, [title, worst])


def criteria_picture(result: PostResult, surface: str) -> Figure:
    """Damage by all criteria on one scale, and the utilisation of the fatigue limit."""
    maps = [Map("von Mises ranges", result, result.damage[surface])]
    for name, label in SHOWN_CRITERIA.items():
        if name in result.criteria:
            maps.append(Map(label, result, result.criteria[name][surface], name != "dang-van"))
    return draw_maps(maps, surface, [_conditions(result, surface)], SECTION_LENGTH)


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
    highest = max(np.nanmax(values) for values in used)
    top = int(np.ceil(np.log10(highest))) if highest > 0.0 else 0
    decades, damaged = np.arange(top - DECADES, top + 1), []
    for row, one in zip(rows, maps, strict=True):
        row.set_title(one.label, fontsize="small", loc="left")
        drawn = draw_map(row, one, surface, decades, deepest)
        if one.is_damage:
            damaged.append(row)
            contours = drawn
        else:
            figure.colorbar(drawn, ax=row, pad=0.02)
    powers = FuncFormatter(lambda power, _: f"$10^{{{power:.0f}}}$")
    figure.colorbar(contours, ax=damaged, label="damage D of one pass", pad=0.02, format=powers)
    rows[-1].set_xlim(*stretch([one.result for one in maps], surface, longest))
    rows[-1].set_xlabel(f"along surface {surface} [mm]")
    figure.align_ylabels(list(axes[:, 0]))
    style.set_title(figure, *title)
    return figure


def along_body(result: PostResult, surface: str, s: np.ndarray) -> np.ndarray:
    """Abscissa [mm] of the profile at body points s [m]: distance from the point at the inlet at time 0."""
    attrs = result.attrs
    return 1e3 * (s - attrs["outlet"] if attrs[f"speed_{surface}"] < 0.0 else attrs["inlet"] - s)


def stretch(results: list[PostResult], surface: str, longest: float = np.inf) -> tuple[float, float]:
    """Ends [mm] of the points that passed in all results, or of the first `longest` half-widths of them."""
    ends = [np.sort(along_body(one, surface, one.s[one.complete[surface]][[0, -1]])) for one in results]
    low, high = max(low for low, _ in ends), min(high for _, high in ends)
    return low, min(high, low + 1e3 * results[0].a * longest)


def profile(axes: Axes, result: PostResult, surface: str) -> None:
    """Draw the profile, heights in µm over mm."""
    axes.set_ylabel("z [µm]")
    axes.axhline(0.0, color="0.8", lw=0.6)
    if surface in result.profiles:
        s, z = result.profiles[surface]
        axes.plot(along_body(result, surface, s), 1e6 * z, color=style.DARK, lw=0.8)


def temperatures(axes: Axes, result: PostResult, surface: str) -> None:
    """Draw flash and mean temperature rise of the points that passed over mm."""
    temperature, passed = result.temperatures[surface], result.complete[surface]
    x = along_body(result, surface, result.s[passed])
    bulk = temperature.highest - temperature.flash
    axes.plot(x, temperature.flash[passed], color=style.SECOND, lw=0.8, label="flash")
    mean = (temperature.mean - bulk)[passed]
    axes.plot(x, mean, "--", color=style.DARK, lw=0.8, label="mean in\nthe contact")
    axes.set_ylabel("temperature\nover bulk [K]")
    axes.set_ylim(bottom=0.0)
    style.legend_beside(axes)


def draw_map(axes: Axes, one: Map, surface: str, decades: np.ndarray, deepest: float) -> ContourSet:
    """Draw contours of log10 D or of the utilisation of a fatigue limit, with a line at 1.

    The axis of the depth, in z/a and µm, stretches the layer near the surface.
    """
    result, passed = one.result, one.result.complete[surface]
    x = along_body(result, surface, result.s[passed])
    count = np.count_nonzero(result.z <= max(deepest, result.z[1]))
    z, values, ticks = np.sqrt(result.z[:count]), one.values[:count, passed], [0]
    for k, root in enumerate(z):
        if root - z[ticks[-1]] >= MIN_TICK_DISTANCE * np.ptp(z):
            ticks.append(k)
    axes.set_yticks(z[ticks], [f"{depth:g}" for depth in result.z[ticks]])
    axes.set(ylabel="z/a", ylim=(z[-1], z[0]))
    beside = axes.secondary_yaxis("right")
    beside.set_yticks(z[ticks], [f"{1e6 * depth * result.a:.3g}" for depth in result.z[ticks]])
    beside.set_ylabel("z [µm]")
    if one.is_damage:
        shown = np.log10(np.maximum(values, 10.0 ** (decades[0] - 1.0)))
        return axes.contourf(x, z, shown, levels=decades, cmap="inferno_r", extend="min")
    if values.min() < 1.0 < values.max():
        axes.contour(x, z, values, levels=[1.0], colors="white", linewidths=0.8)
    return axes.contourf(x, z, np.minimum(values, np.quantile(values, 0.999)), 10, zorder=0)


def field_picture(path: str, result: PostResult) -> Figure:
    """Pressure, and stresses in the solid of the result's main surface, at the middle stored frame.

    The colours span all but the highest thousandth, because peaks below single asperities would leave all
    other values in one colour.
    """
    surface = result.main
    with Loads(path, result.attrs["settings"].splitlines()) as loads:
        frame = loads.time.size // 2
        z = FIELD_DEPTH * np.linspace(0.0, 1.0, 31 if loads.rows else 121) ** 2
        p, shown = _stresses_below(loads, surface, frame, z * loads.a)
        x, time, a = loads.x / loads.a, loads.time[frame], loads.a
        middle = None if loads.y is None else loads.y[loads.y.size // 2]
    figure, (top, *rows) = style.new_figure(5, 1, (8.0, 9.0), sharex=True, height_ratios=(0.7, 1, 1, 1, 1))
    top.plot(x, 1e-9 * p, color=style.SINGLE, lw=0.9)
    top.set_ylabel("p [GPa]")
    for row, name, values in zip(rows, STRESSES, shown, strict=True):
        limit = 1e-9 * np.quantile(np.abs(values), 0.999)
        clipped, colours = np.clip(1e-9 * values, -limit, limit), dict(cmap="RdBu_r", vmin=-limit, vmax=limit)
        figure.colorbar(row.contourf(x, z, clipped, 25, **colours), ax=row, label="GPa", pad=0.01)
        row.set(ylim=(z[-1], z[0]), ylabel="z/a")
        row.set_title(name, fontsize="small", loc="left")
    k, j = np.unravel_index(values.argmax(), values.shape)
    row.plot(x[j], z[k], "x", color=style.DARK, ms=6)
    depth = f"z/a = {z[k]:.3g}, {1e6 * z[k] * a:.3g} µm deep"
    row.set_title(f"{name}, maximum {1e-9 * values[k, j]:.3g} GPa at {depth}", fontsize="small", loc="left")
    row.set_xlabel(style.ACROSS)
    across = "" if middle is None else f", y = {1e3 * middle:.4g} mm"
    style.set_title(figure, _case(result), f"solid of surface {surface}{across}, {1e6 * time:.4g} µs")
    return figure


def _stresses_below(
    loads: Loads, surface: str, frame: int, z: np.ndarray
) -> tuple[np.ndarray, list[np.ndarray]]:
    """Pressure (nx,) and the `STRESSES` (nz, nx) below it in a frame, of a plane in its middle row [Pa]."""
    p, q = (values[0] for values in loads.read(surface, frame, frame + 1))
    nu = loads.case.contact.poisson_ratio[int(surface) - 1]
    if loads.y is None:
        stresses = stress(loads.x, z, p, q, nu)
        return p, [*stresses, von_mises(*stresses, nu)]
    middle = loads.y.size // 2
    whole = stress_plane(loads.x, loads.y, z, p, q, nu, loads.is_periodic)
    at = StressTensor(*(field[:, middle] for field in whole))
    squared = von_mises_squared(at.sx, at.sy, at.sz, at.txz) + 3 * (at.txy**2 + at.tyz**2)
    return p[middle], [at.sx, at.sz, at.txz, np.sqrt(squared)]


def depth_picture(result: PostResult) -> Figure:
    """Distributions of damage at the asperities of one surface, by depth (figure 10)."""
    curves = [(f"z/a = {z:g}", result.under[k], result.fits[k]) for k, z in enumerate(result.z)]
    counted = f"{result.height.size} asperities, surface {result.main}, {_ratio(result)}"
    return draw_distributions(curves, f"{_case(result)}\n{counted}, {rule_name(result)}")


def _case(result: PostResult) -> str:
    """Title of the case."""
    return str(result.attrs["title"])


def _conditions(result: PostResult, surface: str) -> str:
    """Title of the case; surface, section of a plane, slide/roll ratio and rule."""
    across = "" if result.section_y is None else f", y = {1e3 * result.section_y:.4g} mm"
    return f"{_case(result)}\nsurface {surface}{across}, {_ratio(result)}, {rule_name(result)}"


def _ratio(result: PostResult) -> str:
    """Slide/roll ratio, of conditions over time its range."""
    low, high = result.attrs.get("slide_roll_ratios", (result.ratio, result.ratio))
    if not np.isfinite(high - low):
        return "entrainment that reverses"
    return f"slide/roll ratio {low:.3g}" + ("" if low == high else f" to {high:.3g}")


def rule_name(result: PostResult) -> str:
    """Rule by which the elastic range enters the cyclic stress-strain curve."""
    return f'strain = "{result.attrs["strain"]}"'
