"""Pictures of one result, and of several results over slide/roll ratios, as PNG and SVG."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from ehlpetsc.base.errors import PostError
from ehlpetsc.pictures import damage_panels as plots
from ehlpetsc.pictures import style
from ehlpetsc.pictures.distributions import criteria_picture, depth_picture, passes_picture, ratio_picture
from ehlpetsc.post.fatigue.strain_life import cycles_to_failure, equivalent_range
from ehlpetsc.post.loads import Loads
from ehlpetsc.post.prepare import read_settings
from ehlpetsc.post.stresses.body_stress import QUANTUM, history_at
from ehlpetsc.post.stresses.half_plane import stress
from ehlpetsc.post.temperatures import temperature_history
from ehlpetsc.results.output_guard import PICTURES, check_derived
from ehlpetsc.results.post_result import PostResult

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.contour import ContourSet


FORMATS = ("png", "svg")
FIELD_DEPTH = 1.5  # half widths
SECTION_LENGTH = 2.0  # half widths of profile, as in the paper
LAYER_DEPTH = 0.2  # half widths in a picture of several results: damage below asperities is shallower


def _save(figure: Figure, stem: str | Path) -> list[str]:
    """Write all formats; returns their names."""
    names = [f"{stem}.{kind}" for kind in FORMATS]
    for name in names:
        check_derived(Path(name), (), PICTURES, "--pictures")
    style.save(figure, *names)
    return names


@matplotlib.rc_context({"font.size": 9})
def draw(
    inputs: Sequence[str],
    outputs: Sequence[str],
    folder: str,
    point: tuple[float, float] | None = None,
    frame: int | None = None,
    passes: str | None = None,
) -> list[str]:
    """Draw all pictures; returns the names of the files.

    Parameters
    ----------
    inputs, outputs
        Result files and their post-processing results.
    folder
        Folder of the pictures; "": temporary each result.
    point
        s/a and z/a of the history picture.
    frame
        Stored frame of the stress picture.
    passes
        Surface of which the results are passes: statistics instead of a comparison.
    """
    names = []
    if folder:
        Path(folder).mkdir(parents=True, exist_ok=True)
    results = [PostResult(output) for output in outputs]
    for path, output, result in zip(inputs, outputs, results, strict=True):
        stem = Path(folder or Path(output).parent) / Path(path).stem
        names += _of_one(path, result, stem, point, frame)
    if passes:
        temporary = Path(folder or Path(outputs[0]).parent)
        names += _save(passes_picture(results, passes), temporary / f"passes.damage_{passes}")
    elif len(results) > 1:
        names += _compared(sorted(results, key=lambda r: r.ratio), Path(folder or Path(outputs[0]).parent))
    return names


def _of_one(
    path: str, result: PostResult, stem: str | Path, point: tuple[float, float] | None, frame: int | None
) -> list[str]:
    names = []
    for surface in result.surfaces:
        if result.complete[surface].any():
            names += _save(damage_picture(result, surface), f"{stem}.damage_{surface}")
    for surface in result.surfaces:
        if result.criteria and result.complete[surface].any():
            names += _save(criteria_picture(result, surface), f"{stem}.criteria_{surface}")
    if result.height.size:
        names += _save(depth_picture(result), f"{stem}.exceedance")
    names += _save(field_picture(path, result, frame), f"{stem}.stress")
    return names + _save(history_picture(path, result, point), f"{stem}.history")


def _compared(results: list[PostResult], folder: Path) -> list[str]:
    names = []
    for surface in ("2", "1"):
        if all(surface in result.surfaces and result.complete[surface].any() for result in results):
            names += _save(stacked_picture(results, surface), folder / f"compared.damage_{surface}")
    if all(result.height.size for result in results) and len({result.main for result in results}) == 1:
        shared = [z for z in results[0].z if all(np.isclose(r.z, z).any() for r in results)]
        for z in shared:
            names += _save(ratio_picture(results, z), folder / f"compared.exceedance_z{z:g}")
    return names


def _bar(figure: Figure, contours: ContourSet | None, axes: list[Axes]) -> None:
    if contours is not None:
        bar = figure.colorbar(contours, ax=axes, label="damage D of one pass", pad=0.02)
        bar.ax.yaxis.set_major_formatter(lambda power, position: f"$10^{{{power:.0f}}}$")


def damage_picture(result: PostResult, surface: str) -> Figure:
    """Damage under the profile (figure 8 of Holmes et al. 2005)."""
    above = [1.0] * ((surface in result.profiles) + (surface in result.temperatures))
    figure = Figure(figsize=(8, 3.2 + len(above)), layout="constrained")
    axes = figure.subplots(len(above) + 1, 1, sharex=True, height_ratios=(*above, 2.4), squeeze=False)[:, 0]
    ends = plots.stretch(result, surface)
    largest = max(result.largest(surface, k) for k in range(len(result.z)))
    if surface in result.profiles:
        plots.profile(axes[0], result, surface, ends)
    if surface in result.temperatures:
        plots.temperatures(axes[-2], result, surface)
    s, z = result.worst_point(surface)
    place = f"{plots.along_body(result, surface, s):.4g} mm, z/a = {z:g} (s/a = {s / result.a:.5g})"
    axes[0].set_title(
        f"surface {surface}, slide/roll ratio {result.ratio:.3g}, {plots.strain_rule(result)}\n"
        f"largest damage {largest:.2g} at {place}",
        fontsize=9,
    )
    _bar(figure, plots.damage_contours(axes[-1], result, surface, ends, plots.decades(largest)), list(axes))
    axes[-1].set_xlabel(plots.body_label(surface))
    figure.align_ylabels(axes)
    return figure


def stacked_picture(results: list[PostResult], surface: str) -> Figure:
    """Damage at several slide/roll ratios under one scale (figure 9)."""
    count = len(results)
    figure = Figure(figsize=(8, 1.2 + 1.7 * count), layout="constrained")
    axes = figure.subplots(count + 1, 1, sharex=True, height_ratios=(0.7, *[1] * count))
    levels = plots.decades(max(r.largest(surface, k) for r in results for k in range(len(r.z))))
    start = [_aligned(result, surface, results) for result in results]
    ends = plots.stretch(start[0], surface, SECTION_LENGTH)
    plots.profile(axes[0], start[0], surface, ends)
    contours = None
    for row, result in zip(axes[1:], start, strict=True):
        drawn = plots.damage_contours(row, result, surface, ends, levels, LAYER_DEPTH, gap=0.1)
        contours = contours or drawn
        row.set_title(f"slide/roll ratio {result.ratio:.3g}", fontsize=8, loc="left", pad=2)
    axes[0].set_title(f"surface {surface}, {plots.strain_rule(results[0])}", fontsize=9)
    axes[-1].set_xlabel(plots.body_label(surface))
    _bar(figure, contours, list(axes))
    figure.align_ylabels(axes)
    return figure


def _aligned(result: PostResult, surface: str, results: list[PostResult]) -> PostResult:
    """Result reduced to the points that passed in all results, so that all have the same profile."""
    first = max(r.s[r.complete[surface]][0] for r in results)
    last = min(r.s[r.complete[surface]][-1] for r in results)
    if last <= first:
        raise PostError(f"no point of surface {surface} passed the whole contact in all of the results")
    last_shown = last + 0.5 * (result.s[1] - result.s[0])
    first_shown = max(first, last - SECTION_LENGTH * result.a) - 0.5 * (result.s[1] - result.s[0])
    result.complete[surface] &= (result.s >= first_shown) & (result.s <= last_shown)
    return result


def field_picture(path: str, result: PostResult, frame: int | None) -> Figure:
    """Pressure, and stresses in the solid of the result's main surface, at one stored frame."""
    surface = result.main
    with Loads(path, result.attrs.get("settings", "").splitlines()) as loads:
        frame = loads.time.size // 2 if frame is None else frame
        if not 0 <= frame < loads.time.size:
            raise PostError(f"frame {frame}: there are frames 0 to {loads.time.size - 1}")
        p, q = (row[0] for row in loads.read(surface, frame, frame + 1))
        nu = read_settings(loads.case).material(surface).poisson_ratio
        z = FIELD_DEPTH * np.linspace(0, 1, 121) ** 2
        fields = plots.stress_fields(*stress(loads.x, z * loads.a, p, q, nu), nu)
        x, time, width = loads.x / loads.a, loads.time[frame], loads.a
    figure = Figure(figsize=(8, 9), layout="constrained")
    top, *axes = figure.subplots(5, 1, sharex=True, height_ratios=(0.7, 1, 1, 1, 1))
    top.plot(x, p / 1e9, color=plots.DARK, lw=0.9)
    top.set_ylabel("p [GPa]")
    top.set_title(f"solid of surface {surface}, t = {time * 1e6:.4g} µs", fontsize=9)
    for row, (name, values) in zip(axes, fields.items(), strict=True):
        mesh = plots.stress_field(row, x, z, values, name)
        if name == plots.VON_MISES:
            plots.mark_largest(row, x, z, values, width)
        figure.colorbar(mesh, ax=row, label="GPa", pad=0.01, ticks=plots.ticks_within(mesh.levels))
    axes[-1].set_xlabel("x/a")
    return figure


def _check_passed(result: PostResult, surface: str, s: float) -> None:
    """Refuse a body point whose history is incomplete; the message names the range of complete ones."""
    passed, spacing = result.complete[surface], (result.s[-1] - result.s[0]) / (result.s.size - 1)
    node = (s - result.s[0]) / spacing
    around = np.clip(np.array([np.floor(node + 1e-6), np.ceil(node - 1e-6)]), -1, passed.size).astype(int)
    if not all(0 <= j < passed.size and passed[j] for j in around):
        first, last = result.s[passed][[0, -1]] / result.a
        raise PostError(
            f"--point s/a = {s / result.a:.6g}: not a point of surface {surface} that passed the whole "
            f"contact with all its frames stored; s/a = {first:.6g} to {last:.6g} is allowed"
        )


def history_picture(path: str, result: PostResult, point: tuple[float, float] | None) -> Figure:
    """Stress history of one body point and its counted cycles."""
    surface = result.main
    s, z = (point[0] * result.a, point[1]) if point else result.worst_point(surface)
    _check_passed(result, surface, s)
    with Loads(path, result.attrs.get("settings", "").splitlines()) as loads:
        material = read_settings(loads.case).material(surface)
        time, values = history_at(loads, surface, s, z * loads.a, QUANTUM * loads.p0)
        heat = temperature_history(loads, surface, s) if loads.heated([surface]) else None
    step = time[1] - time[0]
    time = 1e6 * np.concatenate([[time[0] - step], time, [time[-1] + step]])
    channel = plots.counted_channel(result.attrs["count"], values, material)
    heights = (1.6, 1) if heat is None else (1.6, 0.7, 1)
    figure = Figure(figsize=(8, 2 * sum(heights)), layout="constrained")
    top, *between, bottom = figure.subplots(len(heights), 1, height_ratios=heights)
    cycles = plots.history(top, time, values, channel)
    i, j = cycles[:, 3].astype(int), cycles[:, 4].astype(int)
    dx, dz, dt = (component[j] - component[i] for component in values)
    ranges = equivalent_range(dx, material.poisson_ratio * (dx + dz), dz, dt)
    damages = 1 / cycles_to_failure(ranges, material, strain=result.attrs.get("strain", "direct"))
    for axes in between:
        plots.surface_temperature(axes, time[1:-1], heat)
        axes.set_xlim(top.get_xlim())
    (between or [top])[0].set_xlabel("time [µs]")
    marked = f"the {plots.MARKED_CYCLES} largest" if len(cycles) > plots.MARKED_CYCLES else "all"
    top.set_title(
        f"surface {surface}, {plots.along_body(result, surface, s):.4g} mm (s/a = {s / result.a:.4g}), z/a = "
        f"{z:g}: {len(cycles)} cycles of {plots.COMPONENTS[channel]}, {marked} marked, damage "
        f"{np.sum(damages):.3g}",
        fontsize=9,
    )
    plots.cycle_histogram(bottom, cycles, damages)
    return figure
